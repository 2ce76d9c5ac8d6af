/* factor_far.h - what coarser points carry between finer ones: a row of P A P^T, A their factors.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_FACTOR_FAR_H
#define PARIAN_CORE_FACTOR_FAR_H

#include "core/coarse_points.h"

enum { PARIAN_LEVELS_MAX = 4, PARIAN_FAR_SOURCES = 81 /* 3^PARIAN_LEVELS_MAX */ };

/* Levels above some points, the nearest first. Arrays belong to others. */
typedef struct parian_far {
    uint32_t count;
    const parian_coarse *coarse[PARIAN_LEVELS_MAX];
    const parian_operator *factors[PARIAN_LEVELS_MAX]; /* between the coarse points, as stored */
} parian_far;

/* Points of one level with weights. */
typedef struct parian_far_sources {
    uint32_t count, point[PARIAN_FAR_SOURCES];
    float weight[PARIAN_FAR_SOURCES];
} parian_far_sources;

/* Buffers of one thread. */
typedef struct parian_far_work {
    float (*row[PARIAN_LEVELS_MAX])[4]; /* [coarse points], RGB and a spare */
    parian_far_sources sources[PARIAN_LEVELS_MAX];
} parian_far_work;

parian_result parian_far_work_make(const parian_env *env, const parian_far *far,
                                   parian_far_work *work);
void parian_far_work_free(const parian_env *env, parian_far_work *work);

/* value[channel][u] -= what the coarser points carry to v from every u. */
void parian_far_subtract(const parian_far *far, uint32_t v, parian_far_work *work,
                         float *const value[3]);

#endif
