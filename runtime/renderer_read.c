/* renderer_read.c - arrays and pictures that a renderer hands back.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "renderer_internal.h"

parian_result parian_renderer_read_picture(parian_renderer *renderer, float (*radiance)[4],
                                           uint8_t (*srgb)[4])
{
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    if (!renderer->picture_width) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "there is no picture before the first draw");
    }
    return renderer->backend->read_picture(renderer, radiance, srgb);
}

/* Positions, normals and areas where the instance stands. */
static void copy_surface(const parian_placement *at, const parian_body *body,
                         const parian_texel_arrays *arrays, size_t first)
{
    for (size_t t = 0; arrays->position && t < body->texel_count; t++) {
        placement_point(at, body->texel_position[t], arrays->position[first + t]);
    }
    for (size_t t = 0; arrays->normal && t < body->texel_count; t++) {
        placement_normal(at, parian_body_lit_normal(body, t), arrays->normal[first + t]);
    }
    for (size_t t = 0; arrays->area && t < body->texel_count; t++) {
        arrays->area[first + t] = at->scale * at->scale * body->texel_area[t];
    }
    for (size_t t = 0; arrays->place && t < body->texel_count; t++) {
        arrays->place[first + t][0] = body->texel_index[t] % body->atlas_size;
        arrays->place[first + t][1] = body->texel_index[t] / body->atlas_size;
    }
    for (size_t t = 0; arrays->chart && t < body->texel_count; t++) {
        arrays->chart[first + t] = body->triangle_chart[body->texel_triangle[t]];
    }
}

/* local, global and their sum, each where asked for. */
static parian_result read_radiosity(parian_renderer *renderer, uint32_t b,
                                    const parian_texel_arrays *arrays, size_t first)
{
    const parian_backend_table *backend = renderer->backend;
    size_t count = renderer->scene->data.bodies[b].texel_count;
    float(*local)[3] = NULL, (*global)[3] = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(&renderer->env, local, count) || !PARIAN_NEW(&renderer->env, global, count)) {
        parian_fail(&renderer->env, result, "no memory for the radiosity of %zu texels", count);
        goto done;
    }
    result = backend->read_texels(renderer, arrays->instance, b, PARIAN_RESULT_LOCAL, local);
    if (result == PARIAN_OK) {
        result = backend->read_texels(renderer, arrays->instance, b, PARIAN_RESULT_GLOBAL, global);
    }
    for (size_t t = 0; result == PARIAN_OK && t < count; t++) {
        for (int c = 0; c < 3; c++) {
            if (arrays->radiosity) {
                arrays->radiosity[first + t][c] = local[t][c] + global[t][c];
            }
            if (arrays->radiosity_local) {
                arrays->radiosity_local[first + t][c] = local[t][c];
            }
            if (arrays->radiosity_global) {
                arrays->radiosity_global[first + t][c] = global[t][c];
            }
        }
    }
done:
    parian_free(&renderer->env, local);
    parian_free(&renderer->env, global);
    return result;
}

parian_result parian_renderer_read_texels(parian_renderer *renderer,
                                          const parian_texel_arrays *arrays)
{
    if (!renderer || !arrays) {
        return PARIAN_E_ARGUMENT;
    }
    if (arrays->instance >= renderer->instance_count) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "texels of instance %u were asked for, there are %u instances",
                           arrays->instance, renderer->instance_count);
    }
    size_t first = 0;
    const bool lit = arrays->irradiance || arrays->radiosity || arrays->radiosity_local ||
                     arrays->radiosity_global;
    parian_result result = lit ? parian_renderer_relight(renderer) : PARIAN_OK;
    for (uint32_t b = 0; result == PARIAN_OK && b < renderer->scene->data.body_count; b++) {
        const parian_body *body = &renderer->scene->data.bodies[b];
        copy_surface(&renderer->instances[arrays->instance], body, arrays, first);
        if (arrays->irradiance) {
            result = renderer->backend->read_texels(renderer, arrays->instance, b,
                                                    PARIAN_RESULT_IRRADIANCE,
                                                    arrays->irradiance + first);
        }
        if (result == PARIAN_OK &&
            (arrays->radiosity || arrays->radiosity_local || arrays->radiosity_global)) {
            result = read_radiosity(renderer, b, arrays, first);
        }
        first += body->texel_count;
    }
    return result;
}

parian_result parian_renderer_read_register(parian_renderer *renderer, uint32_t body,
                                            uint32_t index, float (*value)[3])
{
    parian_result result = parian_renderer_relight(renderer);
    return result == PARIAN_OK ? renderer->backend->read_register(renderer, body, index, value)
                               : result;
}

parian_result parian_renderer_get_gl_textures(parian_renderer *renderer, uint32_t instance,
                                              uint32_t body, parian_gl_textures *textures)
{
    if (!renderer || !textures) {
        return PARIAN_E_ARGUMENT;
    }
    if (!renderer->backend->hand_out) {
        return parian_fail(&renderer->env, PARIAN_E_UNSUPPORTED,
                           "the C evaluation has no GL textures to hand out");
    }
    if (instance >= renderer->instance_count || body >= renderer->scene->data.body_count) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "textures of body %u of instance %u were asked for, there are %u bodies "
                           "and %u instances",
                           body, instance, renderer->scene->data.body_count,
                           renderer->instance_count);
    }
    const parian_placement *at = &renderer->instances[instance];
    parian_gl_textures made = {.size = renderer->scene->data.bodies[body].atlas_size,
                               .scale = at->scale,
                               .eta = renderer->optics[body].eta,
                               .exit_norm = renderer->optics[body].exit_norm};
    memcpy(made.model, at->model, sizeof made.model);
    memcpy(made.tint, renderer->optics[body].tint, sizeof made.tint);
    parian_result result = parian_renderer_relight(renderer);
    if (result == PARIAN_OK) {
        result = renderer->backend->hand_out(renderer, instance, body, &made);
    }
    if (result == PARIAN_OK) {
        *textures = made;
    }
    return result;
}
