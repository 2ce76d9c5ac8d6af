/* renderer_memory.c - GL memory: estimated, counted, kept within a budget, filled in slices.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/memory.h"
#include "renderer_internal.h"

static double megabytes(uint64_t bytes)
{
    return 1e-6 * (double)bytes;
}

uint64_t parian_renderer_memory(const parian_renderer *renderer)
{
    return parian_renderer_get_memory(renderer).total;
}

parian_memory parian_renderer_get_memory(const parian_renderer *renderer)
{
    return renderer->backend->memory(renderer);
}

parian_result parian_renderer_check_scene(const parian_renderer *renderer,
                                          const parian_memory *scene)
{
    uint64_t budget = renderer->desc.memory_budget;
    if (budget == 0 || scene->total <= budget) {
        return PARIAN_OK;
    }
    return parian_fail(&renderer->env, PARIAN_E_NOMEM,
                       "the scene needs %.1f MB of GL memory (factors %.1f, kernels %.1f, atlases "
                       "%.1f, meshes %.1f), the "
                       "budget is %.1f MB: raise memory_budget, or bake with a smaller atlas, "
                       "fewer transfer vertices or a "
                       "higher threshold",
                       megabytes(scene->total), megabytes(scene->bytes[PARIAN_MEMORY_FACTORS]),
                       megabytes(scene->bytes[PARIAN_MEMORY_KERNELS]),
                       megabytes(scene->bytes[PARIAN_MEMORY_ATLAS]),
                       megabytes(scene->bytes[PARIAN_MEMORY_MESHES]), megabytes(budget));
}

/* ---- budget of a frame ---- */

/* Shadow maps of at most size texels a side, and smaller until all of them take at most memory_max.
 */
static parian_result place_shadows(const parian_renderer *renderer, uint32_t size,
                                   uint64_t memory_max, parian_light_list *list)
{
    const parian_bounds *bounds = &renderer->bounds;
    bool surrounded = renderer->scene->data.surrounding_count > 0 &&
                      bounds->everything.radius > 1.05f * bounds->bodies.radius;
    return parian_shadow_fit(&renderer->env, list, size, memory_max, &bounds->bodies,
                             &bounds->everything, surrounded, bounds->lower, bounds->upper);
}

/* What shadow maps may take: what the budget leaves beside everything else, and no more than ever.
 */
static uint64_t shadow_room(uint64_t budget, uint64_t others)
{
    uint64_t room = budget > others ? budget - others : 0;
    return budget == 0 || room > PARIAN_SHADOW_MEMORY_MAX ? PARIAN_SHADOW_MEMORY_MAX : room;
}

/* Bytes of the scene and its instances: what is there, and what is still to be uploaded. */
static uint64_t scene_size(const parian_renderer *renderer)
{
    parian_memory used = parian_renderer_get_memory(renderer);
    return used.total - used.bytes[PARIAN_MEMORY_LIGHTS] - used.bytes[PARIAN_MEMORY_SHADOWS] -
           used.bytes[PARIAN_MEMORY_PICTURE] + renderer->upload_left;
}

/* A refusal that says what would help. */
static parian_result refuse_frame(const parian_renderer *renderer, uint64_t scene,
                                  const parian_memory *frame, uint32_t width, uint32_t height)
{
    return parian_fail(&renderer->env, PARIAN_E_NOMEM,
                       "lights (%.1f MB), shadow maps (%.1f MB) and a picture of %u x %u pixels "
                       "(%.1f MB) do not fit beside "
                       "the scene (%.1f MB) into the budget of %.1f MB of GL memory: raise "
                       "memory_budget, draw smaller "
                       "pictures or use fewer lights",
                       megabytes(frame->bytes[PARIAN_MEMORY_LIGHTS]),
                       megabytes(frame->bytes[PARIAN_MEMORY_SHADOWS]), width, height,
                       megabytes(frame->bytes[PARIAN_MEMORY_PICTURE]), megabytes(scene),
                       megabytes(renderer->desc.memory_budget));
}

parian_result parian_renderer_fit_budget(parian_renderer *renderer, parian_light_list *list,
                                         uint32_t width, uint32_t height, bool *smaller)
{
    const parian_backend_table *backend = renderer->backend;
    uint64_t budget = renderer->desc.memory_budget, scene;
    uint32_t size = list->shadow_size;
    parian_memory frame = {.total = 0};
    *smaller = false;
    if (budget == 0 || !backend->count_frame) {
        return PARIAN_OK;
    }
    scene = scene_size(renderer);
    backend->count_frame(list, width, height, &frame);
    if (frame.total <= budget && scene <= budget - frame.total) {
        return PARIAN_OK;
    }
    uint64_t others = scene + frame.total - frame.bytes[PARIAN_MEMORY_SHADOWS];
    parian_result result = place_shadows(renderer, size, shadow_room(budget, others), list);
    if (result != PARIAN_OK) {
        return result;
    }
    frame = (parian_memory){.total = 0};
    backend->count_frame(list, width, height, &frame);
    if (scene + frame.total > budget) {
        refuse_frame(renderer, scene, &frame, width, height);
        result = place_shadows(renderer, size, UINT64_MAX, list);
        return result == PARIAN_OK ? PARIAN_E_NOMEM : result;
    }
    *smaller = list->shadow_size != size;
    parian_log(
        &renderer->env, PARIAN_LOG_WARNING,
        "shadow maps of %u texels a side instead of %u, to stay within the budget of %.1f MB of GL "
        "memory",
        list->shadow_size, size, megabytes(budget));
    return PARIAN_OK;
}

parian_result parian_renderer_fit_shadows(parian_renderer *renderer, parian_light_list *list)
{
    bool smaller;
    parian_result result =
        place_shadows(renderer, renderer->desc.shadow_size, PARIAN_SHADOW_MEMORY_MAX, list);
    return result == PARIAN_OK ? parian_renderer_fit_budget(renderer, list, renderer->picture_width,
                                                            renderer->picture_height, &smaller)
                               : result;
}

/* ---- estimate ---- */

/* renderer: env, scene, desc, backend and one instance alone. */
static parian_result estimate_frame(const parian_renderer *renderer, const parian_memory_desc *desc,
                                    parian_memory *memory)
{
    parian_light_list list;
    parian_result result = parian_light_list_build(&renderer->env, desc->lights, desc->light_count,
                                                   renderer->desc.environment_lights, &list);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_memory others = *memory;
    renderer->backend->count_frame(&list, desc->width, desc->height, &others);
    others.total -= others.bytes[PARIAN_MEMORY_SHADOWS];
    result = place_shadows(renderer, renderer->desc.shadow_size,
                           shadow_room(renderer->desc.memory_budget, others.total), &list);
    if (result == PARIAN_OK) {
        renderer->backend->count_frame(&list, desc->width, desc->height, memory);
    }
    parian_light_list_free(&renderer->env, &list);
    return result;
}

parian_result parian_renderer_estimate_memory(const parian_env *env, const parian_scene *scene,
                                              const parian_renderer_desc *renderer,
                                              const parian_memory_desc *desc, parian_memory *memory)
{
    const parian_memory_desc nothing = {.lights = NULL};
    parian_memory made = {.total = 0};
    desc = desc ? desc : &nothing;
    if (!scene || !renderer || !memory || (desc->light_count > 0 && !desc->lights)) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "an estimate of memory needs a scene, a renderer's desc and a place to go");
    }
    if (renderer->backend == PARIAN_BACKEND_GL) {
        parian_renderer bare = {.scene = scene, .desc = *renderer, .backend = &parian_gl_backend};
        if (env) {
            bare.env = *env;
        }
        if (!bare.desc.shadow_size) {
            bare.desc.shadow_size = PARIAN_SHADOW_SIZE_DEFAULT;
        }
        parian_result result = parian_renderer_start_instances(&bare);
        if (result == PARIAN_OK) {
            uint32_t copies = desc->instance_count ? desc->instance_count : 1;
            result = bare.backend->count_scene(env, &scene->data, copies, &made);
        }
        if (result == PARIAN_OK && desc->refined) {
            bare.backend->count_sets(&scene->data, &made);
        }
        if (result == PARIAN_OK) {
            result = estimate_frame(&bare, desc, &made);
        }
        parian_free(env, bare.instances);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    *memory = made;
    return PARIAN_OK;
}

/* ---- uploads ---- */

parian_result parian_renderer_check_uploaded(const parian_renderer *renderer)
{
    if (renderer->upload_left == 0) {
        return PARIAN_OK;
    }
    return parian_fail(
        &renderer->env, PARIAN_E_ARGUMENT,
        "%.1f MB of the scene are not uploaded yet: call parian_renderer_upload until nothing "
        "is left",
        megabytes(renderer->upload_left));
}

parian_result parian_renderer_upload(parian_renderer *renderer, uint64_t max_bytes,
                                     uint64_t *bytes_left)
{
    parian_result result = PARIAN_OK;
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    if (renderer->upload_left > 0) {
        result = renderer->backend->upload(renderer, max_bytes ? max_bytes : UINT64_MAX);
        if (renderer->upload_left == 0) {
            parian_frame_memory_trim(&renderer->frame_memory);
        }
    }
    if (bytes_left) {
        *bytes_left = renderer->upload_left;
    }
    return result;
}
