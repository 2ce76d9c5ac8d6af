/* refine.c - sets of samples: the first one of every relight, and others whose mean approaches the
 * integrals over lights and texels.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/memory.h"
#include "lights/sample_set.h"
#include "renderer_internal.h"

/* Sets beyond this would change floats by less than their rounding. */
enum { SET_MAX = 1 << 20 };

parian_result parian_renderer_prepare_sets(parian_renderer *renderer)
{
    const parian_scene_data *data = &renderer->scene->data;
    uint32_t texels = 0;
    for (uint32_t b = 0; b < data->body_count; b++) {
        texels = data->bodies[b].texel_count > texels ? data->bodies[b].texel_count : texels;
    }
    if (!PARIAN_NEW0(&renderer->env, renderer->cover, data->body_count) ||
        !PARIAN_NEW(&renderer->env, renderer->origin, texels)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for the rays of %u texels",
                           texels);
    }
    parian_result result = parian_occluder_tree_build(&renderer->env, data, &renderer->tree);
    parian_frame_memory_trim(&renderer->frame_memory); /* frames do not need what sorting did */
    return result;
}

void parian_renderer_free_sets(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    for (uint32_t b = 0; renderer->cover && b < renderer->scene->data.body_count; b++) {
        parian_texel_cover_free(env, &renderer->cover[b]);
    }
    parian_free(env, renderer->cover);
    parian_free(env, renderer->origin);
    parian_free(env, renderer->varied);
    parian_free(env, renderer->caster);
    parian_occluder_tree_free(env, &renderer->tree);
}

parian_result parian_renderer_place_casters(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    const parian_scene_data *data = &renderer->scene->data;
    uint32_t placed = renderer->instance_count * data->body_count;
    uint32_t count = placed + data->surrounding_count;
    if (count > renderer->caster_room) {
        parian_caster *room;
        if (!PARIAN_NEW0(env, room, count)) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u casters of shadows", count);
        }
        parian_free(env, renderer->caster);
        renderer->caster = room;
        renderer->caster_room = count;
    }
    for (uint32_t c = 0; c < count; c++) {
        bool body = c < placed;
        renderer->caster[c] = parian_caster_place(
            &renderer->tree, body ? c % data->body_count : c - placed + data->body_count,
            body ? &renderer->instances[c / data->body_count] : NULL);
    }
    renderer->caster_count = count;
    return PARIAN_OK;
}

const float (*parian_renderer_origins(parian_renderer *renderer, uint32_t body, uint32_t set))[3]
{
    parian_ray_origins(&renderer->env, &renderer->scene->data.bodies[body], &renderer->cover[body],
                       set, renderer->origin);
    return (const float(*)[3])renderer->origin;
}

/* What the first refinement needs, and later ones find. */
static parian_result warm_up(parian_renderer *renderer)
{
    const parian_scene_data *data = &renderer->scene->data;
    parian_result result = PARIAN_OK;
    for (uint32_t b = 0; b < data->body_count && result == PARIAN_OK; b++) {
        if (!renderer->cover[b].offset) {
            result =
                parian_texel_cover_build(&renderer->env, &data->bodies[b], &renderer->cover[b]);
        }
    }
    if (result == PARIAN_OK && !renderer->varied &&
        !PARIAN_NEW0(&renderer->env, renderer->varied, PARIAN_LIGHT_MAX)) {
        result = parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for light samples");
    }
    return result;
}

parian_result parian_renderer_refine(parian_renderer *renderer)
{
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    if (renderer->lights_changed || renderer->edited_from < PARIAN_PASS_SHADE) {
        return parian_renderer_relight(renderer);
    }
    if (renderer->set_count >= SET_MAX) {
        return PARIAN_OK;
    }
    parian_result result = warm_up(renderer);
    if (result == PARIAN_OK) {
        parian_light_list_vary(&renderer->lights, renderer->set_count, renderer->varied);
        result = renderer->backend->refine(renderer, renderer->set_count);
    }
    renderer->picture_stale = true;
    if (result == PARIAN_OK) {
        renderer->set_count++;
    } else {
        renderer->lights_changed = true; /* E may be half done */
    }
    return result;
}

uint32_t parian_renderer_set_count(const parian_renderer *renderer)
{
    bool stale = renderer->lights_changed || renderer->edited_from <= PARIAN_PASS_IRRADIANCE;
    return stale ? 0 : renderer->set_count;
}
