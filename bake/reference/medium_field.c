/* medium_field.c - coefficients on a grid, from an array of factors or of values.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/medium_field.h"

#include <math.h>

#include "bake/reference/walk.h"
#include "core/memory.h"

enum { VALUES = 6, NODES_MAX = 4096 };
static const double PER_MM = 1e3, COEFFICIENT_MAX = 1e15; /* m^-1, as path tracing takes it */

parian_result parian_medium_field_check(const parian_env *env, const char *path,
                                        const parian_npy *array)
{
    bool values = array->rank == 4 && array->shape[3] == VALUES;
    if (array->rank != 3 && !values) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "%s: an array of %u dimensions, expected [z][y][x] or [z][y][x][6]",
                           path, array->rank);
    }
    for (int a = 0; a < 3; a++) {
        if (array->shape[a] < 2 || array->shape[a] > NODES_MAX) {
            return parian_fail(env, PARIAN_E_FORMAT,
                               "%s: %llu nodes along an axis, expected 2 to %d", path,
                               (unsigned long long)array->shape[a], NODES_MAX);
        }
    }
    for (size_t i = 0; i < array->count; i++) {
        if (!(array->value[i] >= 0 && isfinite(array->value[i]))) {
            return parian_fail(env, PARIAN_E_FORMAT,
                               "%s: element %zu is %g, expected a finite number from 0", path, i,
                               array->value[i]);
        }
    }
    return PARIAN_OK;
}

/* The coefficients of one node. */
static void fill_node(const parian_npy *array, const parian_medium *medium, size_t node,
                      float sigma_s[3], float sigma_a[3])
{
    for (int c = 0; c < 3; c++) {
        if (array->rank == 4) {
            sigma_s[c] = (float)(PER_MM * array->value[node * VALUES + c]);
            sigma_a[c] = (float)(PER_MM * array->value[node * VALUES + 3 + c]);
        } else {
            parian_walk_medium m = parian_walk_medium_make(medium, c);
            sigma_s[c] = (float)(m.sigma_s * array->value[node]);
            sigma_a[c] = (float)(m.sigma_a * array->value[node]);
        }
    }
}

/* Whether a node, with factors already multiplied, can be traced. */
static parian_result check_node(const parian_env *env, const char *path,
                                const parian_medium_field *field, size_t node)
{
    for (int c = 0; c < 3; c++) {
        double s = (double)field->sigma_s[node][c], a = (double)field->sigma_a[node][c];
        if (!(s < COEFFICIENT_MAX && a < COEFFICIENT_MAX)) {
            return parian_fail(env, PARIAN_E_FORMAT,
                               "%s: node %zu has sigma_s %g, sigma_a %g m^-1, expected below %g",
                               path, node, s, a, COEFFICIENT_MAX);
        }
    }
    return PARIAN_OK;
}

static parian_result attach_to_body(const parian_env *env, const char *path,
                                    const parian_npy *array, parian_reference_body *body)
{
    size_t nodes = (size_t)(array->shape[0] * array->shape[1] * array->shape[2]);
    parian_medium_field *field;
    if (!PARIAN_NEW0(env, field, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a field");
    }
    body->field = field; /* freed with the scene from here on */
    if (!PARIAN_NEW(env, field->sigma_s, nodes) || !PARIAN_NEW(env, field->sigma_a, nodes)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a field of %zu nodes", nodes);
    }
    for (int a = 0; a < 3; a++) {
        field->size[a] = (uint32_t)array->shape[2 - a];
    }
    parian_mesh_bounds(&body->mesh, field->lower, field->upper);
    parian_result r = PARIAN_OK;
    for (size_t i = 0; r == PARIAN_OK && i < nodes; i++) {
        fill_node(array, &body->medium, i, field->sigma_s[i], field->sigma_a[i]);
        r = check_node(env, path, field, i);
    }
    return r;
}

parian_result parian_medium_field_attach(const parian_env *env, const char *path,
                                         const parian_npy *array, parian_reference_scene *scene)
{
    parian_result r = PARIAN_OK;
    for (uint32_t b = 0; r == PARIAN_OK && b < scene->body_count; b++) {
        r = attach_to_body(env, path, array, &scene->bodies[b]);
    }
    return r;
}
