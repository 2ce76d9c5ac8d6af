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
    gl_sets_destroy(renderer);
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
        gl_upload_list_free(&state->upload);
        parian_free(&renderer->env, state->source);
        parian_free(&renderer->env, state->body);
        parian_free(&renderer->env, state->surrounding);
        parian_free(&renderer->env, state);
        renderer->state = NULL;
    }
}

/* ---- the scene ---- */

/* Describe everything that a scene needs. body and surrounding are zeroed; tree: NULL to count
 * alone. */
static parian_result plan_scene(const parian_scene_data *data, gl_body_source *source,
                                gl_body *body, gl_mesh *surrounding,
                                const parian_occluder_tree *tree, gl_texture *boxes,
                                gl_upload_list *list)
{
    uint64_t elements = parian_occluder_tree_room(data);
    for (uint32_t b = 0; b < data->body_count; b++) {
        gl_body_plan(&data->bodies[b], &source[b], &body[b], list);
    }
    for (uint32_t s = 0; s < data->surrounding_count; s++) {
        gl_mesh_plan_surrounding(list, &data->surroundings[s], &surrounding[s]);
    }
    *boxes = gl_vector_describe(elements);
    gl_upload_texture(list, PARIAN_MEMORY_MESHES, boxes, elements, NULL,
                      tree ? tree->element : NULL);
    return gl_upload_plan_end(list);
}

static parian_result allocate_scene(const parian_env *env, const parian_scene_data *data,
                                    const parian_occluder_tree *tree, gl_state *state)
{
    if (!PARIAN_NEW0(env, state->body, data->body_count) ||
        !PARIAN_NEW0(env, state->surrounding, data->surrounding_count) ||
        !PARIAN_NEW0(env, state->source, data->body_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", data->body_count);
    }
    state->upload.env = env;
    return plan_scene(data, state->source, state->body, state->surrounding, tree, &state->tree,
                      &state->upload);
}

static parian_result gl_count_scene(const parian_env *env, const parian_scene_data *data,
                                    uint32_t instance_count, parian_memory *memory)
{
    gl_state state = {.shadow_framebuffer = 0};
    parian_result result = allocate_scene(env, data, NULL, &state);
    if (result == PARIAN_OK) {
        gl_upload_count(&state.upload, memory);
    }
    for (uint32_t i = 0; i < data->body_count; i++) {
        gl_lit_count(&data->bodies[i], instance_count, memory);
    }
    gl_casters_count(instance_count * data->body_count + data->surrounding_count, memory);
    gl_upload_list_free(&state.upload);
    parian_free(env, state.source);
    parian_free(env, state.body);
    parian_free(env, state.surrounding);
    return result;
}

static void gl_count_frame(const parian_light_list *list, uint32_t width, uint32_t height,
                           parian_memory *memory)
{
    gl_lights_count(list, memory);
    if (width > 0) {
        gl_picture_count(width, height, memory);
    }
}

static parian_result gl_upload_scene(parian_renderer *renderer, uint64_t max_bytes)
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    parian_result result = gl_upload_run(&state->device, &state->upload, max_bytes);
    renderer->upload_left = gl_upload_left(&state->upload);
    result = gl_device_leave(&state->device, result, "took in the scene");
    if (result == PARIAN_OK && state->upload.next == state->upload.count) {
        gl_upload_list_free(&state->upload);
        parian_free(&renderer->env, state->source);
        state->source = NULL;
    }
    return result;
}

static parian_result plan_upload(parian_renderer *renderer, gl_state *state)
{
    parian_memory planned = {.total = 0};
    parian_result result =
        allocate_scene(&renderer->env, &renderer->scene->data, &renderer->tree, state);
    if (result == PARIAN_OK) {
        gl_upload_count(&state->upload, &planned);
        renderer->upload_left = planned.total;
        for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
            gl_lit_count(&renderer->scene->data.bodies[b], 1, &planned);
        }
        result = parian_renderer_check_scene(renderer, &planned);
    }
    return result;
}

static parian_result gl_create(parian_renderer *renderer)
{
    gl_state *state;
    if (!PARIAN_NEW0(&renderer->env, state, 1)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for a renderer");
    }
    renderer->state = state;
    parian_result result = plan_upload(renderer, state);
    if (result == PARIAN_OK) {
        result = gl_device_init(&renderer->env, renderer->desc.get_proc_address,
                                renderer->desc.memory_budget, &state->device, renderer->name,
                                sizeof renderer->name);
    }
    if (result == PARIAN_OK) {
        state->device.gl.GenFramebuffers(1, &state->shadow_framebuffer);
    }
    if (result == PARIAN_OK && !renderer->desc.deferred_upload) {
        result = gl_upload_scene(renderer, UINT64_MAX);
    }
    return result;
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

static parian_result run_shadow(parian_renderer *renderer)
{
    parian_result result = gl_lights_upload(renderer);
    parian_renderer_begin_pass(renderer);
    if (result == PARIAN_OK) {
        result = gl_shadow_run(renderer);
    }
    if (result == PARIAN_OK) {
        end_pass(renderer, PARIAN_PASS_SHADOW);
    }
    return result;
}

/* What follows from E, from a pass on. */
static void run_transfer(parian_renderer *renderer, parian_pass from)
{
    static void (*const passes[])(parian_renderer *) = {gl_restrict_run, gl_product_run,
                                                        gl_filter_run, gl_gutter_run};
    for (parian_pass p = from > PARIAN_PASS_RESTRICT ? from : PARIAN_PASS_RESTRICT;
         p <= PARIAN_PASS_GUTTER; p++) {
        parian_renderer_begin_pass(renderer);
        passes[p - PARIAN_PASS_RESTRICT](renderer);
        end_pass(renderer, p);
    }
}

static parian_result run_relight(parian_renderer *renderer, parian_pass from)
{
    parian_result result = from == PARIAN_PASS_SHADOW ? run_shadow(renderer) : PARIAN_OK;
    if (result != PARIAN_OK) {
        return result;
    }
    if (from <= PARIAN_PASS_IRRADIANCE) {
        parian_renderer_begin_pass(renderer);
        gl_irradiance_run(renderer);
        end_pass(renderer, PARIAN_PASS_IRRADIANCE);
    }
    run_transfer(renderer, from);
    return PARIAN_OK;
}

static parian_result gl_relight(parian_renderer *renderer, parian_pass from)
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    return gl_device_leave(&state->device, run_relight(renderer, from), "relit");
}

/* ---- medium ---- */

static parian_result gl_edit(parian_renderer *renderer, uint32_t body, parian_edited_body *edited)
{
    gl_state *state = renderer->state;
    gl_upload_list list = {.env = &renderer->env};
    gl_body_source source;
    gl_device_enter(&state->device);
    parian_result result = gl_body_edit(edited, &source, &state->body[body], &list);
    if (result == PARIAN_OK) {
        result = gl_upload_run(&state->device, &list, UINT64_MAX);
    }
    gl_upload_list_free(&list);
    return gl_device_leave(&state->device, result, "took in another medium");
}

static parian_result gl_refine(parian_renderer *renderer, uint32_t set)
{
    gl_state *state = renderer->state;
    gl_device_enter(&state->device);
    parian_result result = gl_set_upload(renderer, set);
    if (result == PARIAN_OK) {
        parian_renderer_begin_pass(renderer);
        gl_irradiance_refine(renderer, set);
        end_pass(renderer, PARIAN_PASS_IRRADIANCE);
        run_transfer(renderer, PARIAN_PASS_RESTRICT);
    }
    return gl_device_leave(&state->device, result, "refined");
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

static parian_result gl_hand_out(parian_renderer *renderer, uint32_t instance, uint32_t body,
                                 parian_gl_textures *textures)
{
    gl_state *state = renderer->state;
    gl_lit *lit = &state->lit[instance * renderer->scene->data.body_count + body];
    parian_result result = PARIAN_OK;
    if (!lit->radiosity.name) {
        gl_device_enter(&state->device);
        result = gl_lit_add_radiosity(&state->device, lit);
        if (result == PARIAN_OK) {
            gl_gutter_run_one(renderer, instance, body);
        }
        result = gl_device_leave(&state->device, result, "handed out textures");
    }
    if (result == PARIAN_OK) {
        textures->irradiance = lit->shown_irradiance.name;
        textures->radiosity = lit->radiosity.name;
        textures->albedo = state->body[body].albedo.name;
        textures->normal_map = state->body[body].normal_map.name;
    }
    return result;
}

static parian_memory gl_memory(const parian_renderer *renderer)
{
    return ((const gl_state *)renderer->state)->device.memory;
}

const parian_backend_table parian_gl_backend = {
    .create = gl_create,
    .destroy = gl_destroy,
    .resize = gl_resize,
    .relight = gl_relight,
    .edit = gl_edit,
    .refine = gl_refine,
    .draw = gl_draw,
    .read_picture = gl_read_picture,
    .read_texels = gl_read_texels,
    .set_values = gl_set_values,
    .read_register = gl_read_register,
    .hand_out = gl_hand_out,
    .memory = gl_memory,
    .upload = gl_upload_scene,
    .count_scene = gl_count_scene,
    .count_sets = gl_sets_count,
    .count_frame = gl_count_frame,
};
