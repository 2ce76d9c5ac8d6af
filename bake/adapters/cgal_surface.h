/* cgal_surface.h - checks of a surface with CGAL.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_CGAL_SURFACE_H
#define PARIAN_BAKE_CGAL_SURFACE_H

#include <stdint.h>

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Count the pairs of triangles that cross, exactly (filtered predicates). The mesh is an oriented
 * 2-manifold with boundary. It stops at pair_max pairs and returns that number. Errors:
 * PARIAN_E_COMPUTE (the mesh is not manifold), PARIAN_E_NOMEM. */
parian_result parian_cgal_count_crossings(const parian_env *env, const parian_mesh *mesh,
                                          uint32_t pair_max, uint32_t *pair_count);

#ifdef __cplusplus
}
#endif
#endif
