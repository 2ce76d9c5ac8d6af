/* openmesh_decimate.h - simplification of a triangle mesh by quadric errors, by OpenMesh's
 * decimater.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_OPENMESH_DECIMATE_H
#define PARIAN_BAKE_OPENMESH_DECIMATE_H

#include <stdbool.h>

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Collapse half-edges of a mesh, cheapest first, until vertex_target vertices are left or nothing
 * more can go without turning a triangle by more than 45 degrees. Vertices that stay keep their
 * positions.
 *
 * locked    [vertex_count]; such vertices stay
 * triangle  the triangles of mesh are replaced in place by those that are left, fewer of them
 *
 * Errors   PARIAN_E_COMPUTE where the mesh is not an oriented 2-manifold, PARIAN_E_NOMEM
 * Threads  pure function
 * Source   [Garland97] */
parian_result parian_decimate(const parian_env *env, parian_mesh *mesh, const bool *locked,
                              uint32_t vertex_target);

#ifdef __cplusplus
}
#endif
#endif
