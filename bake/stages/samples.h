/* samples.h - the samples stage: Poisson-disk sample sets of a surface.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SAMPLES_H
#define PARIAN_BAKE_SAMPLES_H

#include "core/surface_samples.h"

/* Just one of radius_m, count and cell_samples is above zero. */
typedef struct parian_samples_desc {
    double radius_m; /* least distance, metres */
    uint32_t count;  /* so many, within 2 %, at the largest radius that is found */
    uint32_t
        cell_samples;   /* at most so many in any cell [Koa17], at the least radius that is found */
    uint32_t grid_side; /* cells along the longest side of the surface's box; 0: 32 */
    uint64_t seed;
} parian_samples_desc;

typedef struct parian_samples_report {
    uint32_t tries;      /* sets that were made to find the radius */
    double area_m2;      /* of the surface */
    double uncovered_m2; /* at most so much of it has no sample within the radius */
    uint32_t cell_most;  /* samples in the fullest cell */
} parian_samples_report;

enum { PARIAN_SAMPLES_MAX = 1 << 24, PARIAN_SAMPLES_GRID = 32 };

/* Make the set. A surface without area gives an empty one. A closed surface takes some samples at
 * any radius, because sides that face away from one another do not count as near: a count below
 * that is answered by the nearest one that was found, with a warning, as is any that was not met.
 *
 * Errors   PARIAN_E_NOMEM, PARIAN_E_LIMIT (more than PARIAN_SAMPLES_MAX), PARIAN_E_ARGUMENT,
 *          PARIAN_E_INTERRUPTED
 * Threads  env->par; the same set for any number of them
 * Source   darts in random order as [Ying13]'s priorities; gaps found as in [Ebeida12]; the order
 *          of [Yuksel15] */
parian_result parian_stage_samples(const parian_env *env, const parian_sampled_surface *surface,
                                   const parian_samples_desc *desc, parian_surface_samples *samples,
                                   parian_samples_report *report);

#endif
