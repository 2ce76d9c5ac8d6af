/* gl_sets.c - E by rays, and the mean of E over sets of samples. C: cpu/cpu_irradiance.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_state.h"

/* Starts of rays as an atlas; zero where no texel is. */
static void place_origins(parian_renderer *renderer, uint32_t b, uint32_t set, float (*atlas)[4])
{
    const parian_body *body = &renderer->scene->data.bodies[b];
    const float(*origin)[3] = parian_renderer_origins(renderer, b, set);
    memset(atlas, 0, (size_t)body->atlas_size * body->atlas_size * sizeof *atlas);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        memcpy(atlas[body->texel_index[t]], origin[t], sizeof origin[t]);
    }
}

static gl_texture describe_casters(uint32_t count)
{
    return gl_texture_describe(GL_FORMAT_RGBA32F, 4, count ? count : 1);
}

void gl_casters_count(uint32_t count, parian_memory *memory)
{
    uint64_t size = describe_casters(count).size;
    memory->bytes[PARIAN_MEMORY_INSTANCES] += size;
    memory->total += size;
}

parian_result gl_casters_upload(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_texture wanted = describe_casters(renderer->caster_count);
    state->device.part = PARIAN_MEMORY_INSTANCES;
    return gl_texture_update(&state->device, &wanted, 4 * (uint64_t)renderer->caster_count,
                             renderer->caster, &state->caster);
}

void gl_sets_destroy(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    gl_texture_destroy(&state->device, &state->tree);
    gl_texture_destroy(&state->device, &state->caster);
    gl_texture_destroy(&state->device, &state->set_light);
    parian_free(&renderer->env, state->scratch);
    state->scratch = NULL;
}

/* What warm_up makes. */
void gl_sets_count(const parian_scene_data *scene, parian_memory *memory)
{
    uint64_t lights =
        gl_texture_describe(GL_FORMAT_RGBA32F, PARIAN_LIGHT_ROW, PARIAN_LIGHT_MAX).size;
    uint64_t atlases = 0;
    for (uint32_t b = 0; b < scene->body_count; b++) {
        uint32_t side = scene->bodies[b].atlas_size;
        atlases += 2 * gl_texture_describe(GL_FORMAT_RGBA32F, side, side).size;
    }
    memory->bytes[PARIAN_MEMORY_LIGHTS] += lights;
    memory->bytes[PARIAN_MEMORY_INSTANCES] += atlases;
    memory->total += lights + atlases;
}

/* Textures and room of refinements; all of them are there after the first. */
static parian_result warm_up(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    size_t room = (size_t)PARIAN_LIGHT_ROW * PARIAN_LIGHT_MAX;
    parian_result result = PARIAN_OK;
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        size_t side = renderer->scene->data.bodies[b].atlas_size;
        room = side * side > room ? side * side : room;
    }
    if (!state->scratch && !PARIAN_NEW0(&renderer->env, state->scratch, room)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory to refine %zu texels", room);
    }
    if (!state->set_light.name) {
        state->device.part = PARIAN_MEMORY_LIGHTS;
        result = gl_texture_create(&state->device, GL_FORMAT_RGBA32F, PARIAN_LIGHT_ROW,
                                   PARIAN_LIGHT_MAX, NULL, &state->set_light);
    }
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        gl_texture *textures[2] = {&state->body[b].set_origin, &state->body[b].irradiance_spare};
        uint32_t side = renderer->scene->data.bodies[b].atlas_size;
        state->device.part = PARIAN_MEMORY_INSTANCES;
        for (int k = 0; k < 2; k++) {
            if (result == PARIAN_OK && !textures[k]->name) {
                result = gl_texture_create(&state->device, GL_FORMAT_RGBA32F, side, side, NULL,
                                           textures[k]);
            }
        }
    }
    return result;
}

parian_result gl_set_upload(parian_renderer *renderer, uint32_t set)
{
    gl_state *state = renderer->state;
    parian_result result = warm_up(renderer);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_light_sample_table(renderer->varied, renderer->lights.sample_count, state->scratch);
    gl_texture_write(&state->device, &state->set_light, 0,
                     (uint64_t)PARIAN_LIGHT_ROW * PARIAN_LIGHT_MAX, state->scratch);
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        place_origins(renderer, b, set, state->scratch);
        const gl_texture *to = &state->body[b].set_origin;
        gl_texture_write(&state->device, to, 0, (uint64_t)to->width * to->height, state->scratch);
    }
    return PARIAN_OK;
}

/* E of a body of an instance under the samples of a table. share 1: the first set. */
static void light_body(parian_renderer *renderer, uint32_t index, const gl_texture *samples,
                       const gl_texture *origin, const gl_texture *target, float share)
{
    gl_state *state = renderer->state;
    gl_device *device = &state->device;
    const uint32_t bodies = renderer->scene->data.body_count, b = index % bodies;
    const parian_placement *at = &renderer->instances[index / bodies];
    const gl_body *body = &state->body[b];
    gl_pass_begin(device, GL_PROGRAM_IRRADIANCE, &target, 1);
    gl_pass_texture(device, "u_light", samples);
    gl_pass_texture(device, "u_image", &state->image);
    gl_pass_texture(device, "u_tree", &state->tree);
    gl_pass_texture(device, "u_caster", &state->caster);
    gl_pass_texture(device, "u_position", &body->position);
    gl_pass_texture(device, "u_normal", &body->normal);
    gl_pass_texture(device, "u_origin", origin);
    gl_pass_texture(device, "u_base", share < 1.0f ? &state->lit[index].irradiance : &body->normal);
    gl_pass_int(device, "u_light_count", (int)renderer->lights.sample_count);
    gl_pass_int(device, "u_caster_count", (int)renderer->caster_count);
    gl_pass_int(device, "u_own_first", (int)(index - b));
    gl_pass_int(device, "u_own_count", (int)bodies);
    gl_pass_mat4(device, "u_model", at->model);
    gl_pass_float(device, "u_scale", at->scale);
    gl_pass_float(device, "u_share", share);
    gl_pass_float(device, "u_eta", renderer->optics[b].eta);
    gl_pass_float(device, "u_relief_reach", renderer->relief_reach[b]);
    gl_pass_quad(device);
}

void gl_irradiance_run(parian_renderer *renderer)
{
    gl_state *state = renderer->state;
    const uint32_t bodies = renderer->scene->data.body_count;
    for (uint32_t i = 0; i < renderer->instance_count * bodies; i++) {
        light_body(renderer, i, &state->light, &state->body[i % bodies].origin,
                   &state->lit[i].irradiance, 1.0f);
    }
}

void gl_irradiance_refine(parian_renderer *renderer, uint32_t set)
{
    gl_state *state = renderer->state;
    const uint32_t bodies = renderer->scene->data.body_count;
    for (uint32_t i = 0; i < renderer->instance_count * bodies; i++) {
        gl_body *body = &state->body[i % bodies];
        light_body(renderer, i, &state->set_light, &body->set_origin, &body->irradiance_spare,
                   1.0f / (float)(set + 1));
        gl_texture swap = state->lit[i].irradiance;
        state->lit[i].irradiance = body->irradiance_spare;
        body->irradiance_spare = swap;
    }
}
