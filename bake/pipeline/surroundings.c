/* surroundings.c - the diffuse meshes around the bodies, as the asset stores them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/pipeline/bake.h"
#include "bake/stages/surface.h"
#include "core/memory.h"
#include "tool/picture.h"

/* Base colour factor times the mean of its texture, linear. */
static void mean_reflectance(const parian_source_scene *scene, const parian_source_part *part,
                             float reflectance[3])
{
    const parian_source_material *material =
        part->material < scene->material_count ? &scene->materials[part->material] : NULL;
    double mean[3] = {1, 1, 1};
    int32_t index = material ? material->base_color_picture : -1;
    if (index >= 0 && (uint32_t)index < scene->picture_count) {
        const parian_picture *picture = &scene->pictures[index];
        size_t count = (size_t)picture->width * picture->height;
        for (int k = 0; k < 3 && count > 0; k++) {
            double sum = 0;
            for (size_t i = 0; i < count; i++) {
                sum += parian_srgb_decode(picture->pixel[i][k]);
            }
            mean[k] = sum / (double)count;
        }
    }
    for (int k = 0; k < 3; k++) {
        double value = (material ? material->base_color[k] : 0.5) * mean[k];
        reflectance[k] = (float)(value < 0 ? 0 : value > 1 ? 1 : value);
    }
}

static parian_result copy_mesh(const parian_env *env, parian_mesh *mesh, parian_surrounding *out)
{
    if (!PARIAN_NEW(env, out->vertex_position, mesh->vertex_count) ||
        !PARIAN_NEW(env, out->triangle, mesh->triangle_count) ||
        !PARIAN_NEW(env, out->corner_normal, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", mesh->triangle_count);
    }
    out->vertex_count = mesh->vertex_count;
    out->triangle_count = mesh->triangle_count;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            out->vertex_position[v][k] = (float)mesh->position[v][k];
        }
    }
    memcpy(out->triangle, mesh->triangle, mesh->triangle_count * sizeof *out->triangle);
    memcpy(out->corner_normal, mesh->corner_normal,
           mesh->triangle_count * sizeof *out->corner_normal);
    return PARIAN_OK;
}

parian_result parian_make_surrounding(const parian_env *env, const parian_source_scene *scene,
                                      uint32_t part, parian_surrounding *surrounding)
{
    parian_source_part *source = &scene->parts[part];
    parian_result r = PARIAN_OK;
    *surrounding = (parian_surrounding){0};
    memcpy(surrounding->name, source->name, sizeof surrounding->name);
    mean_reflectance(scene, source, surrounding->reflectance);
    if (!source->mesh.corner_normal) {
        r = parian_mesh_make_corner_normals(env, &source->mesh, PARIAN_CREASE_DEG);
    }
    if (r == PARIAN_OK) {
        r = copy_mesh(env, &source->mesh, surrounding);
    }
    return r;
}
