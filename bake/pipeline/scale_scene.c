/* scale_scene.c - brings a scene to metres and to the size asked for.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/pipeline/bake.h"
#include "core/memory.h"

typedef struct scene_box {
    double lower[3], upper[3];
    bool any;
} scene_box;

static void box_add(scene_box *box, const parian_mesh *mesh)
{
    double lower[3], upper[3];
    if (mesh->triangle_count == 0) {
        return;
    }
    parian_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        box->lower[k] = box->any ? fmin(box->lower[k], lower[k]) : lower[k];
        box->upper[k] = box->any ? fmax(box->upper[k], upper[k]) : upper[k];
    }
    box->any = true;
}

static scene_box bodies_box(const parian_source_scene *scene, const parian_selection *selection)
{
    scene_box box = {0};
    for (uint32_t p = 0; p < scene->part_count; p++) {
        if (selection->is_body[p]) {
            box_add(&box, &scene->parts[p].mesh);
        }
    }
    return box;
}

static void transform_mesh(parian_mesh *mesh, double scale, const double centre[3])
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            mesh->position[v][k] = (mesh->position[v][k] - centre[k]) * scale;
        }
    }
}

/* Lengths by scale, intensities by its square, so that the picture stays the same. */
static void transform_light(parian_light *light, double scale, const double centre[3])
{
    bool is_local = light->type == PARIAN_LIGHT_POINT || light->type == PARIAN_LIGHT_SPOT;
    for (int k = 0; k < 3; k++) {
        light->position[k] = (float)((light->position[k] - centre[k]) * scale);
        light->axis_u[k] *= (float)scale;
        light->axis_v[k] *= (float)scale;
        if (is_local) {
            light->color[k] *= (float)(scale * scale);
        }
    }
}

static parian_result find_scale(const parian_env *env, const parian_bake_desc *desc, bool is_scene,
                                double side, double *scale)
{
    if (!(side > 0) || !isfinite(side)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: the bounding box has no extent", desc->input);
    }
    if (desc->scale_m > 0) {
        *scale = desc->scale_m / side;
    } else if (desc->unit_m > 0) {
        *scale = desc->unit_m;
    } else if (is_scene) {
        *scale = 1;
    } else {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "%s: this format has no unit of length; give --scale 50mm (longest side) or "
            "--unit mm|cm|m",
            desc->input);
    }
    return PARIAN_OK;
}

parian_result parian_scale_scene(const parian_env *env, const parian_bake_desc *desc,
                                 const parian_selection *selection, parian_source_scene *scene)
{
    scene_box box = bodies_box(scene, selection);
    double side = 0, scale = 1, centre[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        side = fmax(side, box.upper[k] - box.lower[k]);
    }
    parian_result r = find_scale(env, desc, scene->is_scene, side, &scale);
    if (r != PARIAN_OK) {
        return r;
    }
    if (!isfinite(scale) || !isfinite(side * scale)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: extent %g cannot be scaled", desc->input,
                           side);
    }
    if (!scene->is_scene && !desc->keep_origin && desc->scale_m > 0) {
        for (int k = 0; k < 3; k++) {
            centre[k] = 0.5 * (box.lower[k] + box.upper[k]);
        }
    }
    for (uint32_t p = 0; p < scene->part_count; p++) {
        transform_mesh(&scene->parts[p].mesh, scale, centre);
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        transform_light(&scene->lights[i], scale, centre);
    }
    return PARIAN_OK;
}
