/* polygonize.h - the surface of an implicit solid as a triangle mesh.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_POLYGONIZE_H
#define PARIAN_ASSETS_POLYGONIZE_H

#include "implicit.h"
#include "model_mesh.h"
#include "parian/env.h"
#include "parian/result.h"

/* Triangulate the zero set of a field inside a box that holds it whole.
 *
 * lower, upper     the box, in the field's unit of length
 * triangle_count   wanted number of triangles, met within 5 % where the solid is smooth at that
 * size mesh             closed, manifold, outward; unit normals from the field's gradient; written
 * only on success
 *
 * Errors   PARIAN_E_COMPUTE (the mesh is too coarse for the solid's thin parts), PARIAN_E_NOMEM
 * Threads  uses env->par; the field must be a pure function; the same bytes for any number of
 * threads Source   surface nets [Gibson98]; vertices are then moved along the surface to even out
 * the triangles */
parian_result polygonize(const parian_env *env, field_function field, vec3 lower, vec3 upper,
                         uint32_t triangle_count, model_mesh *mesh);

#endif
