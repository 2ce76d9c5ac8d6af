/* gl_light.c - light tables, projected pictures and shadow maps in GL.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/memory.h"
#include "gl/gl_state.h"

/* What the light textures of a list are. */
typedef struct light_textures {
    gl_texture light, layer, image, shadow;
} light_textures;

static light_textures describe(const parian_light_list *list)
{
    const bool shadows = list->layer_count > 0;
    return (light_textures){
        gl_texture_describe(GL_FORMAT_RGBA32F, PARIAN_LIGHT_ROW, list->sample_count + 1),
        gl_texture_describe(GL_FORMAT_RGBA32F, PARIAN_LAYER_ROW, list->layer_count + 1),
        gl_array_describe(GL_FORMAT_RGBA32F, list->image_total),
        gl_depth_describe(shadows ? list->shadow_size : 1, shadows ? list->layer_count : 1)};
}

void gl_lights_count(const parian_light_list *list, parian_memory *memory)
{
    light_textures made = describe(list);
    uint64_t tables = made.light.size + made.layer.size + made.image.size;
    memory->bytes[PARIAN_MEMORY_LIGHTS] += tables;
    memory->bytes[PARIAN_MEMORY_SHADOWS] += made.shadow.size;
    memory->total += tables + made.shadow.size;
}

static parian_result upload_tables(gl_device *device, const parian_light_list *list,
                                   const light_textures *wanted, gl_state *state)
{
    size_t sample_count = ((size_t)list->sample_count + 1) * PARIAN_LIGHT_ROW;
    size_t layer_count = ((size_t)list->layer_count + 1) * PARIAN_LAYER_ROW;
    float(*samples)[4] = NULL, (*layers)[4] = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW0(device->env, samples, sample_count) ||
        !PARIAN_NEW0(device->env, layers, layer_count)) {
        parian_fail(device->env, result, "no memory for %u light samples", list->sample_count);
        goto done;
    }
    parian_light_list_tables(list, samples, layers);
    result = gl_texture_update(device, &wanted->light, sample_count, samples, &state->light);
    if (result == PARIAN_OK) {
        result = gl_texture_update(device, &wanted->layer, layer_count, layers, &state->layer);
    }
done:
    parian_free(device->env, samples);
    parian_free(device->env, layers);
    return result;
}

/* Textures of the same size are written anew, others made anew: old ones go first. */
parian_result gl_lights_upload(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const parian_light_list *list = &renderer->lights;
    const light_textures wanted = describe(list);
    device->part = PARIAN_MEMORY_SHADOWS;
    parian_result result = gl_texture_update(device, &wanted.shadow, 0, NULL, &state->shadow);
    device->part = PARIAN_MEMORY_LIGHTS;
    if (result == PARIAN_OK) {
        result = upload_tables(device, list, &wanted, state);
    }
    if (result == PARIAN_OK) {
        result =
            gl_texture_update(device, &wanted.image, list->image_total, list->image, &state->image);
    }
    if (result == PARIAN_OK) {
        result = gl_casters_upload(renderer);
    }
    return result;
}

static void draw_instance(parian_renderer *renderer, const parian_shadow_layer *layer,
                          const parian_placement *at)
{
    gl_state *state = renderer->state;
    float row[4][4];
    for (int r = 0; r < 4; r++) {
        placement_fold(at, layer->row[r], row[r]);
    }
    gl_pass_vec4(&state->device, "u_row", 4, &row[0][0]);
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_mesh_draw(&state->device, &state->body[b].mesh);
    }
}

static void draw_layer(parian_renderer *renderer, const parian_shadow_layer *layer)
{
    gl_state *state = renderer->state;
    const float fit[4] = {layer->texel_scale, layer->perspective ? 1.0f : 0.0f, layer->near_m,
                          layer->far_m};
    gl_pass_vec4(&state->device, "u_fit", 1, fit);
    for (uint32_t i = 0; i < renderer->instance_count; i++) {
        draw_instance(renderer, layer, &renderer->instances[i]);
    }
    gl_pass_vec4(&state->device, "u_row", 4, &layer->row[0][0]);
    for (uint32_t s = 0; s < renderer->scene->data.surrounding_count; s++) {
        gl_mesh_draw(&state->device, &state->surrounding[s]);
    }
}

parian_result gl_shadow_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    const parian_gl_api *gl = &state->device.gl;
    const GLenum none = GL_NONE;
    const GLfloat farthest = 1.0f;
    gl_pass_begin(&state->device, GL_PROGRAM_SHADOW, NULL, 0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, state->shadow_framebuffer);
    gl->DrawBuffers(1, &none);
    gl->ReadBuffer(GL_NONE);
    gl->Viewport(0, 0, (GLsizei)state->shadow.width, (GLsizei)state->shadow.height);
    gl->Enable(GL_DEPTH_TEST);
    for (uint32_t l = 0; l < renderer->lights.layer_count; l++) {
        gl->FramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, state->shadow.name, 0,
                                    (GLint)l);
        if (l == 0 && gl->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
            return parian_fail(state->device.env, PARIAN_E_DEVICE,
                               "this OpenGL cannot draw %u shadow maps of %u texels",
                               state->shadow.layers, state->shadow.width);
        }
        gl->ClearBufferfv(GL_DEPTH, 0, &farthest);
        draw_layer(renderer, &renderer->lights.layer[l]);
    }
    gl->Disable(GL_DEPTH_TEST);
    return PARIAN_OK;
}

void gl_pass_lights(const parian_renderer *renderer, float scale)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const parian_light_list *list = &renderer->lights;
    gl_pass_texture(device, "u_light", &state->light);
    gl_pass_texture(device, "u_layer", &state->layer);
    gl_pass_texture(device, "u_shadow", &state->shadow);
    gl_pass_texture(device, "u_image", &state->image);
    gl_pass_int(device, "u_light_count", (int)list->sample_count);
    gl_pass_int(device, "u_shadow_size", (int)state->shadow.width);
    gl_pass_float(device, "u_lift", parian_renderer_shadow_lift(renderer, scale));
    gl_pass_int(device, "u_environment", list->sky_count > 0 ? 1 : 0);
    gl_pass_vec3(device, "u_sh", PARIAN_SH_COUNT, &list->environment_sh[0][0]);
}
