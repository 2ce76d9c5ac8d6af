/* cgal_remesh.h - isotropic remeshing of a triangle mesh, by CGAL's Polygon Mesh Processing.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_CGAL_REMESH_H
#define PARIAN_BAKE_CGAL_REMESH_H

#include <stdbool.h>

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A mesh that is remeshed in steps. Its features (borders, and creases that are long enough not to
 * be noise) stay in place: vertices on them are added and removed, never moved. */
typedef struct parian_remesher parian_remesher;

typedef struct parian_remesher_desc {
    double crease_deg; /* edges with a larger angle between their faces' normals may be features */
    double feature_area;   /* m^2; creases that enclose less on one side are noise */
    double feature_length; /* metres; connected creases that are shorter in sum are noise */
    double corner_length;  /* metres; how far features are followed to see whether they turn */
} parian_remesher_desc;

/* Copy a mesh, an oriented 2-manifold with boundary. Errors: PARIAN_E_COMPUTE where it is not,
 * PARIAN_E_NOMEM. Threads: pure function. */
parian_result parian_remesher_create(const parian_env *env, const parian_mesh *mesh,
                                     const parian_remesher_desc *desc, parian_remesher **remesher);
void parian_remesher_destroy(parian_remesher *remesher);

/* One round without relaxation: split edges longer than 4/3 of edge_length, collapse those shorter
 * than 4/5, flip for valence and shape. Relaxation is the caller's, through parian_remesher_move:
 * CGAL's own reads an invalid half-edge where no triangle around a vertex has an area.
 * Errors: PARIAN_E_COMPUTE, PARIAN_E_NOMEM.
 * Source: [Botsch04] */
parian_result parian_remesher_run(const parian_env *env, parian_remesher *remesher,
                                  double edge_length);

/* Remove needles (longest edge over shortest above 3) by collapses and caps (an angle above 140
 * degrees) by flips, as far as topology and geometry allow. Errors: PARIAN_E_COMPUTE,
 * PARIAN_E_NOMEM. */
parian_result parian_remesher_repair(const parian_env *env, parian_remesher *remesher);

uint32_t parian_remesher_vertex_count(const parian_remesher *remesher);

/* Copy the present mesh out, and which vertices lie on features ([vertex_count]; NULL: not wanted).
 * Errors: PARIAN_E_NOMEM. */
parian_result parian_remesher_copy(const parian_env *env, const parian_remesher *remesher,
                                   parian_mesh *mesh, bool **on_feature);

/* Replace the positions, [vertex_count] in the order of the last copy. */
void parian_remesher_move(parian_remesher *remesher, const double (*position)[3]);

#ifdef __cplusplus
}
#endif
#endif
