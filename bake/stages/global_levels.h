/* global_levels.h - coarse levels above the transfer vertices: points, interpolation, factors.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_LEVELS_H
#define PARIAN_BAKE_GLOBAL_LEVELS_H

#include "bake/stages/global_operator.h"
#include "bake/stages/global_pairs.h"

typedef struct parian_level {
    parian_coarse coarse;
    parian_row_maker maker; /* its model belongs to the vertices' maker */
    parian_bits finer;      /* pairs that finer points carry */
    parian_far far;         /* what the levels above carry between its points */
    parian_operator factors;
} parian_level;

typedef struct parian_levels {
    uint32_t count;
    parian_level level[PARIAN_LEVELS_MAX];
    parian_far far; /* what all of them carry between the vertices */
} parian_levels;

/* Set levels of coarse points upon those of base, as many as save factors (at least one, if
 * forced), without their factors. reason tells why in words. */
parian_result parian_levels_choose(const parian_env *env, const parian_body *body,
                                   const parian_row_maker *base, bool forced, parian_levels *levels,
                                   char *reason, size_t reason_size);

/* Make the factors of every level, the coarsest first. */
parian_result parian_levels_make(const parian_env *env, double begin, double end,
                                 parian_levels *levels);

/* Put near, the vertices' own factors, and the levels' operators into the body, in the order of
 * application; the operators are the body's afterwards. */
parian_result parian_levels_store(const parian_env *env, parian_operator *near,
                                  parian_levels *levels, parian_body *body);

void parian_levels_free(const parian_env *env, parian_levels *levels);

#endif
