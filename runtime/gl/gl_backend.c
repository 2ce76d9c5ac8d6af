/* gl_backend.c - a renderer in an OpenGL context: lights to E to B to pictures.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_state.h"

static void destroy_objects(parian_renderer *renderer, gl_state *state)
{
    gl_device *device = &state->device;
    for (uint32_t i = 0; i < state->lit_count * renderer->scene->data.body_count; i++) {
        gl_lit_destroy(device, &state->lit[i]);
    }
    for (uint32_t b = 0; state->body && b < renderer->scene->data.body_count; b++) {
        gl_body_destroy(device, &state->body[b]);
    }
    for (uint32_t s = 0; state->surrounding && s < renderer->scene->data.surrounding_count; s++) {
        gl_mesh_destroy(device, &state->surrounding[s]);
    }
    gl_texture_destroy(device, &state->light);
    gl_texture_destroy(device, &state->layer);
    gl_texture_destroy(device, &state->image);
    gl_texture_destroy(device, &state->shadow);
    gl_picture_destroy(device, &state->picture);
    if (state->shadow_framebuffer) {
        device->gl.DeleteFramebuffers(1, &state->shadow_framebuffer);
    }
    gl_device_destroy(device);
}

static void gl_destroy(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    if (state) {
        destroy_objects(renderer, state);
        parian_free(&renderer->env, state->lit);
        parian_free(&renderer->env, state->body);
        parian_free(&renderer->env, state->surrounding);
        parian_free(&renderer->env, state);
        renderer->state = NULL;
    }
}

static parian_result upload_scene(parian_renderer *renderer, gl_state *state)
{
    const parian_scene_data *data = &renderer->scene->data;
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW0(&renderer->env, state->body, data->body_count) ||
        !PARIAN_NEW0(&renderer->env, state->surrounding, data->surrounding_count)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for %u bodies",
                           data->body_count);
    }
    for (uint32_t b = 0; result == PARIAN_OK && b < data->body_count; b++) {
        result = gl_body_create(&state->device, &data->bodies[b], &state->body[b]);
    }
    for (uint32_t s = 0; result == PARIAN_OK && s < data->surrounding_count; s++) {
        result =
            gl_mesh_create(&state->device, NULL, &data->surroundings[s], &state->surrounding[s]);
    }
    state->device.gl.GenFramebuffers(1, &state->shadow_framebuffer);
    return result;
}

static parian_result gl_create(parian_renderer *renderer)
{
    gl_state *state;
    if (!PARIAN_NEW0(&renderer->env, state, 1)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for a renderer");
    }
    renderer->state = state;
    parian_result result = gl_device_init(&renderer->env, renderer->desc.get_proc_address,
                                          renderer->desc.memory_budget, &state->device,
                                          renderer->name, sizeof renderer->name);
    if (result != PARIAN_OK) {
        return result;
    }
    gl_device_enter(&state->device);
    result = upload_scene(renderer, state);
    return gl_device_leave(&state->device, result, "took in the scene");
}

/* ---- instances ---- */

static void shrink(gl_state *state, uint32_t instance_count, uint32_t body_count)
{
    for (uint32_t i = instance_count * body_count; i < state->lit_count * body_count; i++) {
        gl_lit_destroy(&state->device, &state->lit[i]);
    }
    state->lit_count = instance_count;
}

/* Longer arrays: the old textures move over, new ones are made. */
static parian_result grow(parian_renderer *renderer, gl_state *state, uint32_t instance_count)
{
    const parian_scene_data *data = &renderer->scene->data;
    const uint32_t bodies = data->body_count, before = state->lit_count;
    parian_result result = PARIAN_OK;
    gl_lit *lit;
    if (!PARIAN_NEW0(&renderer->env, lit, (size_t)instance_count * bodies)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for %u instances",
                           instance_count);
    }
    for (uint32_t i = 0; i < before * bodies; i++) {
        lit[i] = state->lit[i];
    }
    parian_free(&renderer->env, state->lit);
    state->lit = lit;
    state->lit_count = instance_count;
    for (uint32_t i = before * bodies; result == PARIAN_OK && i < instance_count * bodies; i++) {
        result = gl_lit_create(&state->device, &data->bodies[i % bodies], &lit[i]);
    }
    if (result != PARIAN_OK) {
        shrink(state, before, bodies);
    }
    return result;
}

static parian_result gl_resize(parian_renderer *renderer, uint32_t instance_count)
{
    gl_state *state = renderer->state;
    parian_result result = PARIAN_OK;
    if (instance_count == state->lit_count) {
        return PARIAN_OK;
    }
    gl_device_enter(&state->device);
    if (instance_count < state->lit_count) {
        shrink(state, instance_count, renderer->scene->data.body_count);
    } else {
        result = grow(renderer, state, instance_count);
    }
    return gl_device_leave(&state->device, result, "made room for instances");
}

/* ---- running ---- */

static void end_pass(parian_renderer *renderer, parian_pass pass)
{
    if (renderer->timing) {
        ((gl_state *)renderer->state)->device.gl.Finish();
    }
    parian_renderer_end_pass(renderer, pass);
}

static parian_result run_relight(parian_renderer *renderer)
{
    static void (*const passes[])(parian_renderer *) = {
        gl_irradiance_run, gl_restrict_run, gl_product_run, gl_filter_run, gl_gutter_run};
    parian_result result = gl_lights_upload(renderer);
    parian_renderer_begin_pass(renderer);
    if (result == PARIAN_OK) {
        result = gl_shadow_run(renderer);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    end_pass(renderer, PARIAN_PASS_SHADOW);
    for (int p = 0; p < 5; p++) {
        parian_renderer_begin_pass(renderer);
        passes[p](renderer);
        end_pass(renderer, (parian_pass)(PARIAN_PASS_IRRADIANCE + p));
    }
    return PARIAN_OK;
}

static parian_result gl_relight(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    return gl_device_leave(&state->device, run_relight(renderer), "relit");
}

static parian_result gl_draw(parian_renderer *renderer, const parian_draw_desc *desc, bool shade)
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    parian_result result = gl_picture_prepare(renderer, desc->width, desc->height);
    if (result == PARIAN_OK) {
        if (shade) {
            parian_renderer_begin_pass(renderer);
            gl_shade_run(renderer, desc);
            end_pass(renderer, PARIAN_PASS_SHADE);
        }
        parian_renderer_begin_pass(renderer);
        gl_tone_run(renderer, desc);
        end_pass(renderer, PARIAN_PASS_TONE);
    }
    return gl_device_leave(&state->device, result, "drew");
}

/* ---- reading ---- */

/* Read a texture and turn it upside down: GL starts below. */
static parian_result read_flipped(gl_device *device, const gl_texture *texture, size_t pixel_size,
                                  void *pixels)
{
    size_t stride = texture->width * pixel_size;
    uint8_t *rows, *to = pixels;
    if (!PARIAN_NEW(device->env, rows, stride * texture->height)) {
        return parian_fail(device->env, PARIAN_E_NOMEM,
                           "no memory to read a picture of %u x %u pixels", texture->width,
                           texture->height);
    }
    gl_texture_read(device, texture, rows);
    for (uint32_t y = 0; y < texture->height; y++) {
        memcpy(to + y * stride, rows + (texture->height - 1 - y) * stride, stride);
    }
    parian_free(device->env, rows);
    return PARIAN_OK;
}

static parian_result gl_read_picture(parian_renderer *renderer, float (*radiance)[4],
                                     uint8_t (*srgb)[4])
{
    gl_state *state = renderer->state;
    parian_result result = PARIAN_OK;
    gl_device_enter(&state->device);
    if (radiance) {
        result = read_flipped(&state->device, &state->picture.picture, sizeof *radiance, radiance);
    }
    if (srgb && result == PARIAN_OK) {
        result = read_flipped(&state->device, &state->picture.srgb, sizeof *srgb, srgb);
    }
    return gl_device_leave(&state->device, result, "read a picture");
}

/* Read a float texture and pick its texels: element i is at place[i], or at i without places. */
static parian_result read_picked(gl_device *device, const gl_texture *texture,
                                 const uint32_t *place, uint32_t count, float (*value)[3])
{
    float(*pixels)[4];
    if (!PARIAN_NEW(device->env, pixels, (size_t)texture->width * texture->height)) {
        return parian_fail(device->env, PARIAN_E_NOMEM, "no memory to read %u x %u texels",
                           texture->width, texture->height);
    }
    gl_device_enter(device);
    gl_texture_read(device, texture, pixels);
    parian_result result = gl_device_leave(device, PARIAN_OK, "read texels");
    for (uint32_t i = 0; i < count; i++) {
        memcpy(value[i], pixels[place ? place[i] : i], sizeof value[i]);
    }
    parian_free(device->env, pixels);
    return result;
}

static parian_result gl_read_texels(parian_renderer *renderer, uint32_t instance, uint32_t body,
                                    parian_texel_result which, float (*value)[3])
{
    gl_state *state = renderer->state;
    const parian_body *data = &renderer->scene->data.bodies[body];
    const gl_lit *made = &state->lit[instance * renderer->scene->data.body_count + body];
    const gl_texture *texture = which == PARIAN_RESULT_IRRADIANCE ? &made->irradiance
                                : which == PARIAN_RESULT_LOCAL    ? &made->local
                                                                  : &made->global;
    return read_picked(&state->device, texture, data->texel_index, data->texel_count, value);
}

static parian_result gl_set_values(parian_renderer *renderer, uint32_t body,
                                   const float (*value)[3])
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    parian_result result = gl_body_set_values(&state->device, &renderer->scene->data.bodies[body],
                                              value, &state->body[body]);
    return gl_device_leave(&state->device, result, "took in values");
}

static parian_result gl_read_register(parian_renderer *renderer, uint32_t body, uint32_t index,
                                      float (*value)[3])
{
    gl_state *state = renderer->state;
    uint32_t size = parian_body_register_size(&renderer->scene->data.bodies[body], index);
    return read_picked(&state->device, &state->lit[body].registers[index], NULL, size, value);
}

static uint64_t gl_memory(const parian_renderer *renderer)
{
    return ((const gl_state *)renderer->state)->device.memory;
}

const parian_backend_table parian_gl_backend = {
    .create = gl_create,
    .destroy = gl_destroy,
    .resize = gl_resize,
    .relight = gl_relight,
    .draw = gl_draw,
    .read_picture = gl_read_picture,
    .read_texels = gl_read_texels,
    .set_values = gl_set_values,
    .read_register = gl_read_register,
    .memory = gl_memory,
};
