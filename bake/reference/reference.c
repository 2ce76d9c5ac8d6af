/* reference.c - the owners' side of what every reference model shares.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/reference.h"

#include "bake/reference/light_sampler.h"
#include "bake/reference/rays.h"
#include "core/memory.h"

static void field_free(const parian_env *env, parian_medium_field *field)
{
    if (field) {
        parian_free(env, field->sigma_s);
        parian_free(env, field->sigma_a);
        parian_free(env, field);
    }
}

void parian_reference_scene_free(const parian_env *env, parian_reference_scene *scene)
{
    if (!scene) {
        return;
    }
    for (uint32_t b = 0; scene->bodies && b < scene->body_count; b++) {
        parian_mesh_free(env, &scene->bodies[b].mesh);
        field_free(env, scene->bodies[b].field);
    }
    for (uint32_t s = 0; scene->surroundings && s < scene->surrounding_count; s++) {
        parian_mesh_free(env, &scene->surroundings[s]);
    }
    parian_free(env, scene->bodies);
    parian_free(env, scene->surroundings);
    parian_free(env, scene->lights);
    parian_light_sampler_destroy(scene->sampler);
    parian_rays_destroy(scene->rays);
    *scene = (parian_reference_scene){0};
}

void parian_receivers_free(const parian_env *env, parian_receivers *receivers)
{
    if (receivers) {
        parian_free(env, receivers->position);
        parian_free(env, receivers->normal);
        parian_free(env, receivers->smooth_normal);
        parian_free(env, receivers->area);
        parian_free(env, receivers->body);
        parian_free(env, receivers->triangle);
        parian_free(env, receivers->barycentric);
        *receivers = (parian_receivers){0};
    }
}

void parian_reference_result_free(const parian_env *env, parian_reference_result *result)
{
    if (result) {
        parian_free(env, result->irradiance);
        parian_free(env, result->radiosity);
        parian_free(env, result->standard_error);
        parian_free(env, result->unscattered);
        *result = (parian_reference_result){0};
    }
}

parian_result parian_reference_result_init(const parian_env *env, size_t count, bool with_unscattered,
                                           parian_reference_result *result)
{
    *result = (parian_reference_result){0};
    if (!PARIAN_NEW0(env, result->irradiance, count) || !PARIAN_NEW0(env, result->radiosity, count) ||
        !PARIAN_NEW0(env, result->standard_error, count) ||
        (with_unscattered && !PARIAN_NEW0(env, result->unscattered, count))) {
        parian_reference_result_free(env, result);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", count);
    }
    return PARIAN_OK;
}
