/* transfer_mesh_parts.h - the steps of the transfer-mesh stage, one file each, and vectors of
 * doubles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_TRANSFER_MESH_PARTS_H
#define PARIAN_BAKE_TRANSFER_MESH_PARTS_H

#include <math.h>
#include <stdbool.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/adapters/cgal_remesh.h"
#include "core/mesh.h"
#include "core/small_maths.h"

/* One connected component on its way from source to transfer surface. */
typedef struct transfer_part {
    parian_mesh source; /* positions and triangles */
    double area;        /* of the source */
    uint32_t target;    /* wanted vertices */
    parian_mesh result;
    double squared_sum; /* of sampled distances, both ways */
    double distance_max;
    uint32_t sample_count;
} transfer_part;

/* transfer_mesh_split.c: the connected components of a mesh, in the order of their first triangles.
 * parts: array of *count to be freed with parian_transfer_parts_free. */
parian_result parian_transfer_split(const parian_env *env, const parian_mesh *source,
                                    transfer_part **parts, uint32_t *count);
void parian_transfer_parts_free(const parian_env *env, transfer_part *parts, uint32_t count);
/* Append the results of all parts into one mesh. */
parian_result parian_transfer_join(const parian_env *env, const transfer_part *parts,
                                   uint32_t count, parian_mesh *mesh);

/* transfer_mesh_decimate.c: a mesh with about vertex_target of the source's vertices and its
 * topology, by quadric errors. *mesh stays untouched where that would break the topology. */
parian_result parian_transfer_decimate(const parian_env *env, const parian_mesh *source,
                                       uint32_t vertex_target, parian_mesh *mesh);

/* transfer_mesh_remesh.c: make part->result with about part->target near-equilateral vertices. */
parian_result parian_transfer_remesh(const parian_env *env, const parian_closest *source,
                                     transfer_part *part);

/* transfer_mesh_ridge.c: unit vectors, [triangle_count], of neighbouring triangles on the two sides
 * of a convex ridge, however rounded, pointing away from each other; zero where the surface is flat
 * over the length of an edge of the transfer mesh. */
parian_result parian_transfer_sides(const parian_env *env, const parian_mesh *mesh, double edge,
                                    double (*side)[3]);

/* transfer_mesh_untangle.c: move vertices around triangles that are next to nothing towards the
 * middle of their neighbours, where that helps; the fixed ones ([vertex_count]) only around the
 * worst. */
parian_result parian_transfer_untangle(const parian_env *env, const bool *fixed, parian_mesh *mesh);

/* transfer_mesh_fit.c: move the vertices of mesh to the middle of their neighbours and from there
 * onto the source surface (relax), or along their normals to where the mesh as a whole lies closest
 * to it (fit). A move of more than reach, or one that would turn a triangle over, is not made.
 * Vertices on features stay; with relax, those on rounded ridges move along these, and onto the
 * source as far out as it goes. */
parian_result parian_transfer_relax(const parian_env *env, const parian_closest *source,
                                    const parian_remesher_features *features, double reach,
                                    parian_mesh *mesh);
parian_result parian_transfer_fit(const parian_env *env, const parian_closest *source,
                                  const bool *fixed, double reach, parian_mesh *mesh);

/* transfer_mesh_measure.c: sample distances between part->result and part->source, both ways. */
parian_result parian_transfer_measure(const parian_env *env, const parian_closest *source,
                                      uint32_t sample_count, transfer_part *part);

/* transfer_mesh_curve.c: sort points, [count], along a Hilbert curve: order[i] is the i-th of them.
 */
parian_result parian_transfer_curve(const parian_env *env, uint32_t count, const double (*point)[3],
                                    uint32_t *order);

/* transfer_mesh_order.c: renumber the vertices along the surface, and sort the triangles by vertex.
 */
parian_result parian_transfer_order(const parian_env *env, parian_mesh *mesh);

static inline void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] - b[k];
    }
}

/* Twice the area of triangle abc times its normal. */
static inline void area_vector(const double a[3], const double b[3], const double c[3],
                               double out[3])
{
    double ab[3], ac[3];
    subtract(b, a, ab);
    subtract(c, a, ac);
    parian_cross3(ab, ac, out);
}

static inline double norm(const double a[3])
{
    return sqrt(parian_dot3(a, a));
}

#endif
