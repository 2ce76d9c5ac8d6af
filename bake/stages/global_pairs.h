/* global_pairs.h - pairs of coarse points whose exchange is left to finer points.
 *
 * Sets are symmetric, [points^2] bits.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_PAIRS_H
#define PARIAN_BAKE_GLOBAL_PAIRS_H

#include "bake/stages/global_coarse.h"
#include "core/array_check.h"

/* Add the pairs of coarse points nearer than reach, a point with itself included. */
void parian_pairs_add_near(const parian_body *body, const parian_coarse *coarse, double reach,
                           parian_bits *pairs);

/* Add the pairs that would carry anything between vertices of triangles whose texels see each other
 * in a window or in its ring: there the vertices' own factors must be complete, since blend and
 * kernels are made from them alone. Errors: PARIAN_E_NOMEM. */
parian_result parian_pairs_add_windows(const parian_env *env, const parian_body *body,
                                       const parian_coarse *coarse, parian_bits *pairs);

/* Add the pairs that would carry anything between finer points whose pair is in `finer`. */
void parian_pairs_add_lifted(const parian_coarse *coarse, const parian_bits *finer,
                             parian_bits *pairs);

#endif
