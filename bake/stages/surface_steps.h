/* surface_steps.h - the steps of the surface stage, in the order they run.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SURFACE_STEPS_H
#define PARIAN_BAKE_SURFACE_STEPS_H

#include "bake/stages/surface.h"

enum { SURFACE_NO_MATE = 0xFFFFFFFFu };

/* Half-edge 3 t + i of triangle t goes from its corner i to corner (i + 1) % 3. Half-edges between
 * the same two vertices stand next to each other in `half_edge`: group k is [offset[k], offset[k +
 * 1]). */
typedef struct surface_edges {
    uint32_t group_count;
    uint32_t *offset;    /* [group_count + 1] */
    uint32_t *half_edge; /* [3 * triangle_count] */
} surface_edges;

parian_result surface_edges_make(const parian_env *env, const parian_mesh *mesh,
                                 surface_edges *edges);
void surface_edges_free(const parian_env *env, surface_edges *edges);

/* The vertex that a half-edge comes from and goes to. */
uint32_t surface_from(const parian_mesh *mesh, uint32_t half_edge);
uint32_t surface_to(const parian_mesh *mesh, uint32_t half_edge);
double surface_doubled_area(const parian_mesh *mesh, uint32_t triangle);

/* Keep the triangles whose keep flag is set, in their order, with their attributes. */
void surface_keep_triangles(parian_mesh *mesh, const bool *keep);
/* Turn a triangle over, its attributes with it (normals are reversed). */
void surface_turn_triangle(parian_mesh *mesh, uint32_t triangle);

/* Drop vertices that no triangle names. */
parian_result surface_drop_unreferenced(const parian_env *env, parian_mesh *mesh,
                                        uint32_t *dropped);
/* Merge vertices nearer than the tolerance to the first of them. */
parian_result surface_weld(const parian_env *env, parian_mesh *mesh, double tolerance,
                           uint32_t *welded);
/* Drop triangles over the same three vertices, but for the first of each. */
parian_result surface_drop_duplicates(const parian_env *env, parian_mesh *mesh, uint32_t *dropped);
/* Take triangles lower than the tolerance out: those with two equal corners are dropped, a flat one
 * gives its middle vertex to the neighbour on its longest edge, so that no gap opens. */
parian_result surface_drop_degenerate(const parian_env *env, parian_mesh *mesh, double tolerance,
                                      uint32_t *dropped);

/* Neighbourhood of an oriented manifold: mate[h] is the half-edge on the other side, or
 * SURFACE_NO_MATE. */
/* Turn triangles so that neighbours agree, cutting where they cannot; pair the triangles around an
 * edge of more than two so that each pair bounds a solid wedge; duplicate vertices where several
 * fans touch. */
parian_result surface_make_manifold(const parian_env *env, parian_mesh *mesh, uint32_t **mate,
                                    parian_surface_report *report);
/* Number components, count boundaries, turn components that are inside out. */
parian_result surface_face_outward(const parian_env *env, parian_mesh *mesh, const uint32_t *mate,
                                   parian_surface_report *report);

#endif
