/* model_mesh.h - the triangle mesh that generators of example models make.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_MODEL_MESH_H
#define PARIAN_ASSETS_MODEL_MESH_H

#include <stdint.h>

#include "model_vec.h"
#include "parian/env.h"
#include "parian/result.h"

/* Arrays are allocated with the env of the call that filled the mesh. */
typedef struct model_mesh {
    uint32_t vertex_count, triangle_count;
    vec3 *position;          /* [vertex_count] */
    vec3 *normal;            /* [vertex_count] unit, outward; NULL: the triangles are flat */
    uint32_t (*triangle)[3]; /* [triangle_count] counterclockwise seen from outside */
} model_mesh;

void model_mesh_free(const parian_env *env, model_mesh *mesh);

/* Refuse a mesh that is not closed, oriented, edge-manifold and vertex-manifold, or that encloses
 * no positive volume; `name` is for the message. Errors: PARIAN_E_COMPUTE, PARIAN_E_NOMEM. */
parian_result model_mesh_check(const parian_env *env, const model_mesh *mesh, const char *name);

/* A solid of revolution about +y: the profile [count][2] of (radius, height) runs counterclockwise
 * seen with the radius to the right, from axis to axis (radius 0 at both ends). Smooth normals. */
parian_result model_mesh_lathe(const parian_env *env, const double (*profile)[2], uint32_t count,
                               uint32_t segments, model_mesh *mesh);

/* A sphere: a cube with each edge cut into `cuts` at equal angles, blown up. */
parian_result model_mesh_sphere(const parian_env *env, double radius, uint32_t cuts,
                                model_mesh *mesh);

/* A box centred at the origin, its longest edges cut into `cuts`, the others in proportion. No
 * normals: flat. */
parian_result model_mesh_box(const parian_env *env, vec3 size, uint32_t cuts, model_mesh *mesh);

#endif
