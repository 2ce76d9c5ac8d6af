/* atlas_case.h - makes a body's transfer surface from a generated mesh, for the tests of atlas and
 * texels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_ATLAS_CASE_H
#define PARIAN_TEST_ATLAS_CASE_H

#include <string.h>

#include "core/body.h"
#include "core/memory.h"

/* Copy positions and triangles into a zeroed body, with corner normals that are smooth below 40
 * degrees. */
static inline parian_result atlas_case_body(const parian_env *env, parian_mesh *mesh,
                                            parian_body *body)
{
    memset(body, 0, sizeof *body);
    parian_result result = parian_mesh_make_corner_normals(env, mesh, 40.0);
    if (result != PARIAN_OK) {
        return result;
    }
    body->vertex_count = mesh->vertex_count;
    body->triangle_count = mesh->triangle_count;
    if (!PARIAN_NEW(env, body->vertex_position, mesh->vertex_count) ||
        !PARIAN_NEW(env, body->triangle, mesh->triangle_count) ||
        !PARIAN_NEW(env, body->corner_normal, mesh->triangle_count)) {
        parian_body_free(env, body);
        return PARIAN_E_NOMEM;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int d = 0; d < 3; d++) {
            body->vertex_position[v][d] = (float)mesh->position[v][d];
        }
    }
    memcpy(body->triangle, mesh->triangle, mesh->triangle_count * sizeof *body->triangle);
    memcpy(body->corner_normal, mesh->corner_normal,
           mesh->triangle_count * sizeof *body->corner_normal);
    body->kernel_width = 7;
    return PARIAN_OK;
}

/* Area of the body's surface from its own single-precision positions, in double. */
static inline double atlas_case_area(const parian_body *body)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        double u[3], v[3], n[3];
        for (int d = 0; d < 3; d++) {
            double a = (double)body->vertex_position[body->triangle[t][0]][d];
            u[d] = (double)body->vertex_position[body->triangle[t][1]][d] - a;
            v[d] = (double)body->vertex_position[body->triangle[t][2]][d] - a;
        }
        n[0] = u[1] * v[2] - u[2] * v[1];
        n[1] = u[2] * v[0] - u[0] * v[2];
        n[2] = u[0] * v[1] - u[1] * v[0];
        sum += 0.5 * __builtin_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}

#endif
