/* global_coarse.h - coarse points among the transfer vertices, and how finer points are
 * interpolated from them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_COARSE_H
#define PARIAN_BAKE_GLOBAL_COARSE_H

#include "core/coarse_points.h"

/* Choose coarse points such that each finer point has one within `reach` metres along the surface,
 * normals within 60 degrees, and interpolate: Delaunay barycentrics in the finer point's tangent
 * plane (distances kept), of coarse points within 2.2 reaches on the same side; at tips and rims,
 * where none surround it, of the nearest two or the nearest.
 *
 * fine   [fine_count] transfer vertices of the finer points, ascending; NULL: all vertices
 * Errors PARIAN_E_NOMEM */
parian_result parian_coarse_make(const parian_env *env, const parian_body *body,
                                 const parian_vertex_frame *frame, const uint32_t *fine,
                                 uint32_t fine_count, double reach, parian_coarse *coarse);

/* The interpolation as operators: P, and its transpose. Registers are the caller's. */
parian_result parian_coarse_up(const parian_env *env, const parian_coarse *coarse,
                               parian_operator *op);
parian_result parian_coarse_down(const parian_env *env, const parian_coarse *coarse,
                                 parian_operator *op);

#endif
