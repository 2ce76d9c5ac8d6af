/* cgal_closest.h - closest points of a triangle mesh, by CGAL's AABB tree.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_CGAL_CLOSEST_H
#define PARIAN_BAKE_CGAL_CLOSEST_H

#include "core/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A tree over the triangles of a mesh. It keeps pointers to the mesh's positions and triangles,
 * which must outlive it unchanged. After creation it is only read, so any number of threads may
 * query it. */
typedef struct parian_closest parian_closest;

typedef struct parian_closest_hit {
    uint32_t triangle;     /* 0xFFFFFFFF for an empty mesh */
    double barycentric[3]; /* of the triangle's corners; they sum to 1 */
    double point[3];
    double distance; /* to the query point */
} parian_closest_hit;

typedef struct parian_closest_query {
    size_t count;
    const double (*point)[3];
    const double (*normal)[3]; /* unit; NULL: every triangle is a candidate */
    double cosine_min;         /* a candidate's unit normal times the query's exceeds this */
    double radius;             /* candidates by normal are looked for this far; 0: anywhere */
} parian_closest_query;

/* Build the tree. Errors: PARIAN_E_NOMEM, PARIAN_E_COMPUTE. Threads: pure function. */
parian_result parian_closest_create(const parian_env *env, const parian_mesh *mesh,
                                    parian_closest **closest);
void parian_closest_destroy(parian_closest *closest);

/* Find for each query point the closest point of the triangles whose normal agrees; where none does
 * within the radius, the closest point of all triangles. Neighbouring queries should be near in
 * space: each starts from the answer of the one before.
 *
 * hit      [count]
 * Errors   PARIAN_E_COMPUTE
 * Threads  uses env->par; the same results for any number of threads */
parian_result parian_closest_find(const parian_env *env, const parian_closest *closest,
                                  const parian_closest_query *query, parian_closest_hit *hit);

#ifdef __cplusplus
}
#endif
#endif
