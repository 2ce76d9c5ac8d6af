/* model_primitives.c - the ball and the slab, whose relit pictures can be checked by formula.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "models.h"

static const model_medium ALABASTER = {.sigma_s_prime_per_mm = {1.6, 1.9, 2.3},
                                       .sigma_a_per_mm = {0.003, 0.013, 0.045},
                                       .g = 0,
                                       .eta = 1.5};

static glb_part *add_body(glb_scene *scene, const char *name)
{
    const glb_light key = {"key", true, {-0.4, -0.6, -1}, {3, 3, 3}};
    glb_part *part = &scene->part[scene->part_count++];
    *part = (glb_part){.name = name,
                       .material_name = "honey alabaster",
                       .medium = &ALABASTER,
                       .base_color = {1, 1, 1},
                       .roughness = 0.25};
    model_add_light(scene, &key);
    return part;
}

parian_result model_sphere(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    uint32_t cuts = (uint32_t)fmax(round(sqrt(triangle_count / 12.0)), 2);
    return model_mesh_sphere(env, 0.025, cuts, &add_body(scene, "sphere")->mesh);
}

parian_result model_slab(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    uint32_t cuts =
        (uint32_t)fmax(round(sqrt(triangle_count / 4.8)), 2); /* 12 cuts^2 (1 + 0.1 + 0.1) / 3 */
    return model_mesh_box(env, v3(0.050, 0.050, 0.005), cuts, &add_body(scene, "slab")->mesh);
}
