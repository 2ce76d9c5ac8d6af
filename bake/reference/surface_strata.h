/* surface_strata.h - cuts a surface into compact strata of any fineness: a binary tree over the
 * triangles, and pieces of triangles below it.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SURFACE_STRATA_H
#define PARIAN_BAKE_SURFACE_STRATA_H

#include "bake/reference/light_sampler.h"
#include "core/mesh.h"
#include "core/random.h"

enum { PARIAN_STRATUM_PIECE = 0xFFFFFFFFu };

/* A part of the surface: the triangles below a node of the tree, or a piece of one triangle. */
typedef struct parian_stratum {
    uint32_t node;            /* or PARIAN_STRATUM_PIECE */
    uint32_t triangle;        /* of a piece */
    double centre[3], radius; /* of a ball around it; relative to the tree's origin, metres */
    double area;              /* m^2 */
    double corner[3][2];      /* of a piece: barycentrics 0 and 1 of its corners */
} parian_stratum;

typedef struct parian_strata_node {
    float centre[3], radius;
    double area;
    uint32_t first, end; /* triangles order[first..end) */
    uint32_t below;      /* the first of two children, or 0: one triangle */
} parian_strata_node;

typedef struct parian_strata_tree {
    const parian_mesh *mesh; /* has corner_normal; outlives the tree */
    double origin[3];        /* middle of the mesh's box */
    double area;
    uint32_t node_count;
    parian_strata_node *node; /* [node_count] the root first */
    uint32_t *order;          /* [triangle_count] along the tree */
    double *sum;              /* [triangle_count + 1] areas of order[0..i) */
} parian_strata_tree;

/* Errors: PARIAN_E_NOMEM. */
parian_result parian_strata_tree_make(const parian_env *env, const parian_mesh *mesh,
                                      parian_strata_tree *tree);
void parian_strata_tree_free(const parian_env *env, parian_strata_tree *tree);

/* The whole surface, and the two halves of a stratum; nodes follow the tree, pieces are cut across
 * their longest edge. */
void parian_stratum_root(const parian_strata_tree *tree, parian_stratum *stratum);
void parian_stratum_split(const parian_strata_tree *tree, const parian_stratum *stratum,
                          parian_stratum half[2]);

/* The strata not larger than area_max, in the tree's order, without empty ones.
 * Errors: PARIAN_E_NOMEM. */
parian_result parian_strata_cut(const parian_env *env, const parian_strata_tree *tree,
                                double area_max, parian_stratum **strata, size_t *count);

/* A place spread evenly over the stratum by area. Threads: any. */
void parian_stratum_place(const parian_strata_tree *tree, const parian_stratum *stratum,
                          uint32_t body, parian_random *random, parian_place *place);

#endif
