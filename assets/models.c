/* models.c - the table of example models, and what their generators share.
 *
 * SPDX-License-Identifier: MIT
 */
#include "models.h"

#include <stdio.h>

#include "core/memory.h"
#include "polygonize.h"

enum { LATHE_SEGMENTS = 96 };
static const double METRES_PER_MM = 1e-3;

const model_entry model_table[] = {
    {"figurine", model_figurine, 100000,
     "an elephant calf of honey alabaster on a slate base, 50 mm high"},
    {"candle", model_candle, 80000, "a wax candle with drips, a wick and a flame, 80 mm high"},
    {"cup", model_cup, 100000,
     "a thin cup of milk glass with a fluted side and a handle, 80 mm wide"},
    {"leaf", model_leaf, 100000, "a green leaf with veins, 0.8 mm thick, 60 mm wide"},
    {"sphere", model_sphere, 24576, "a ball of honey alabaster, 50 mm across: has closed forms"},
    {"slab", model_slab, 20000, "a slab of honey alabaster, 50 mm x 50 mm x 5 mm"},
};
const uint32_t model_count = sizeof model_table / sizeof model_table[0];

static void to_metres(model_mesh *mesh, vec3 at_mm)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        mesh->position[v] = v3_scale(v3_add(mesh->position[v], at_mm), METRES_PER_MM);
    }
}

parian_result model_add_solid(const parian_env *env, glb_scene *scene, const glb_part *part,
                              field_function field, vec3 lower_mm, vec3 upper_mm,
                              uint32_t triangle_count)
{
    glb_part *added = &scene->part[scene->part_count];
    *added = *part;
    parian_result result = polygonize(env, field, lower_mm, upper_mm, triangle_count, &added->mesh);
    if (result == PARIAN_OK) {
        scene->part_count++;
        to_metres(&added->mesh, v3(0, 0, 0));
    }
    return result;
}

parian_result model_add_lathe(const parian_env *env, glb_scene *scene, const glb_part *part,
                              const double (*profile_mm)[2], uint32_t count, vec3 at_mm)
{
    glb_part *added = &scene->part[scene->part_count];
    *added = *part;
    parian_result result = model_mesh_lathe(env, profile_mm, count, LATHE_SEGMENTS, &added->mesh);
    if (result == PARIAN_OK) {
        scene->part_count++;
        to_metres(&added->mesh, at_mm);
    }
    return result;
}

void model_add_light(glb_scene *scene, const glb_light *light)
{
    scene->light[scene->light_count++] = *light;
}

parian_result model_write(const parian_env *env, const model_entry *entry, uint32_t triangle_count,
                          const char *folder)
{
    char path[4096];
    glb_scene scene = {0};
    parian_result result =
        entry->make(env, triangle_count ? triangle_count : entry->triangle_count, &scene);
    for (uint32_t i = 0; result == PARIAN_OK && i < scene.part_count; i++) {
        result = model_mesh_check(env, &scene.part[i].mesh, scene.part[i].name);
    }
    if (result == PARIAN_OK) {
        int length = snprintf(path, sizeof path, "%s/%s.glb", folder, entry->name);
        result = length < 0 || (size_t)length >= sizeof path
                     ? parian_fail(env, PARIAN_E_ARGUMENT,
                                   "the folder's name is longer than %zu bytes", sizeof path)
                     : glb_write(env, path, &scene);
    }
    if (result == PARIAN_OK) {
        parian_log(env, PARIAN_LOG_INFO, "%s: %u triangles in the body, %u parts, %u lights", path,
                   scene.part[0].mesh.triangle_count, scene.part_count, scene.light_count);
    }
    glb_scene_free(env, &scene);
    return result;
}
