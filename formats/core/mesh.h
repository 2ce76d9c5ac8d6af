/* mesh.h - an indexed triangle mesh as plain arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_MESH_H
#define PARIAN_CORE_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Arrays belong to the mesh and are freed by parian_mesh_free with the env they were made with. */
typedef struct parian_mesh {
    uint32_t vertex_count;
    uint32_t triangle_count;
    double (*position)[3];   /* [vertex_count] metres */
    uint32_t (*triangle)[3]; /* [triangle_count] vertex indices, counterclockwise seen from outside */
    float (*corner_uv)[3][2];     /* [triangle_count] texture coordinates of the source (glTF: v downward), or NULL */
    float (*corner_normal)[3][3]; /* [triangle_count] unit shading normals, or NULL */
    uint32_t *material;           /* [triangle_count] index into the scene's materials, or NULL */
} parian_mesh;

/* Free the arrays and zero the struct; NULL and a zeroed mesh are fine. */
void parian_mesh_free(const parian_env *env, parian_mesh *mesh);

/* Sum of the triangle areas, m^2. */
double parian_mesh_area(const parian_mesh *mesh);

/* Axis-aligned bounds over the referenced vertices, metres; zeros for a mesh without triangles. */
void parian_mesh_bounds(const parian_mesh *mesh, double lower[3], double upper[3]);

/* Angle-weighted corner normals that are smooth across edges flatter than crease_deg and sharp across
 * the others; allocates mesh->corner_normal (replacing it). Errors: PARIAN_E_NOMEM. */
parian_result parian_mesh_make_corner_normals(const parian_env *env, parian_mesh *mesh, double crease_deg);

/* The half-edge across every edge: neighbour[t][k] = 3 * t2 + k2 where edge k of t (corner k to corner k + 1) is
 * edge k2 of t2 in the opposite direction; PARIAN_NO_NEIGHBOUR at a boundary, at an edge of more than two
 * triangles, and where orientations disagree. triangle, neighbour: [triangle_count].
 * Errors: PARIAN_E_NOMEM. */
enum { PARIAN_NO_NEIGHBOUR = 0xFFFFFFFFu };
parian_result parian_triangle_neighbours(const parian_env *env, uint32_t vertex_count,
                                         uint32_t triangle_count, const uint32_t (*triangle)[3],
                                         uint32_t (*neighbour)[3]);

#ifdef __cplusplus
}
#endif
#endif
