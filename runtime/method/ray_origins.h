/* ray_origins.h - where the shadow rays of texels start.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RAY_ORIGINS_H
#define PARIAN_RAY_ORIGINS_H

#include "core/body.h"

/* What finds points of texels: for each texel the triangles of its chart that reach into it. */
typedef struct parian_texel_cover {
    uint32_t *offset;   /* [texel_count + 1] */
    uint32_t *triangle; /* [offset[texel_count]] ascending in a texel */
} parian_texel_cover;

/* Errors: PARIAN_E_NOMEM. Threads: none. */
parian_result parian_texel_cover_build(const parian_env *env, const parian_body *body,
                                       parian_texel_cover *cover);
void parian_texel_cover_free(const parian_env *env, parian_texel_cover *cover);

/* A start for each texel, [texel_count], metres: on the surface that the corner normals span, so
 * that facets of a curved surface do not shadow their neighbours by the horizon, and a few
 * roundings above it. Set 0 starts at the centroids (cover may be NULL); any other at a point of
 * the texel that is its own for each texel and set, uniform over the part of the texel that its
 * chart covers.
 *
 * Threads  uses env->par; the same for any number of them
 * Source   [Hanika21]; the points of one texel are a lattice [Roberts18] with a random shift */
void parian_ray_origins(const parian_env *env, const parian_body *body,
                        const parian_texel_cover *cover, uint32_t set, float (*origin)[3]);

#endif
