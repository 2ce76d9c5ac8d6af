/* cgal_rectangle.h - the minimal-area rectangle around points of a plane. Adapter to CGAL.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_CGAL_RECTANGLE_H
#define PARIAN_BAKE_CGAL_RECTANGLE_H

#include <stddef.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Find the direction of one side of the rectangle of least area that holds all points, by rotating
 * calipers over their convex hull.
 *
 * points  [count], finite; collinear and coinciding points are fine
 * axis    unit vector; (1, 0) for fewer than two different points
 *
 * Errors   PARIAN_E_NOMEM, PARIAN_E_COMPUTE
 * Threads  pure function */
parian_result parian_minimal_rectangle(const parian_env *env, size_t count,
                                       const double (*points)[2], double axis[2]);

#ifdef __cplusplus
}
#endif
#endif
