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

/* A mesh that is remeshed in steps. Its features (borders, creases that are long enough not to be
 * noise, and rounded ridges between two given sides) stay edges: vertices on them are added and
 * removed. */
typedef struct parian_remesher parian_remesher;

typedef struct parian_remesher_desc {
    double crease_deg; /* edges with a larger angle between their faces' normals may be features */
    double feature_area;   /* m^2; creases that enclose less on one side are noise */
    double feature_length; /* metres; connected creases that are shorter in sum are noise */
    double corner_length;  /* metres; how far features are followed to see whether they turn */
    double ridge_deg, ridge_area; /* what crease_deg and feature_area are, for rounded ridges */
    const double (*side)[3]; /* [triangle_count], or NULL: an edge between triangles whose vectors
                              * are at more than 90 degrees may be on a rounded ridge */
} parian_remesher_desc;

/* Where features are, [vertex_count] each; freed by parian_remesher_features_free. */
typedef struct parian_remesher_features {
    bool *on; /* lies on a feature */
    /* On a rounded ridge and no corner: the vertices before and after it, which it may be moved
     * between; else PARIAN_NO_NEIGHBOUR twice. */
    uint32_t (*along)[2];
} parian_remesher_features;

void parian_remesher_features_free(const parian_env *env, parian_remesher_features *features);

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

/* Copy the present mesh and its features out. Errors: PARIAN_E_NOMEM. */
parian_result parian_remesher_copy(const parian_env *env, const parian_remesher *remesher,
                                   parian_mesh *mesh, parian_remesher_features *features);

/* Replace the positions, [vertex_count] in the order of the last copy. */
void parian_remesher_move(parian_remesher *remesher, const double (*position)[3]);

#ifdef __cplusplus
}
#endif
#endif
