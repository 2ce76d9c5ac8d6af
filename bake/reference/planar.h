/* planar.h - radiative transfer by Monte Carlo in closed-form geometry: half-space, slab and
 * sphere.
 *
 * Light enters at one point. Whatever meets the boundary from inside leaves by the share that
 * crosses, and the rest goes on. Profiles are the flux that leaves, by distance from the entry: the
 * radius on planes, the arc on a sphere.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PLANAR_H
#define PARIAN_BAKE_PLANAR_H

#include "bake/reference/walk.h"
#include "parian/env.h"
#include "parian/result.h"

typedef enum parian_planar_shape {
    PARIAN_HALF_SPACE = 0,
    PARIAN_SLAB,
    PARIAN_SPHERE
} parian_planar_shape;

typedef struct parian_planar_desc {
    parian_planar_shape shape;
    double size;               /* slab: thickness; sphere: radius; metres */
    parian_walk_medium medium; /* albedo and sigma_t are derived anew */
    bool normal_incidence;     /* a beam along the normal; otherwise diffuse light */
    uint64_t photons, seed;    /* at least 2 photons */
    uint32_t bin_count;        /* 0: totals only */
    double bin_width;          /* metres; the last bin takes what lies beyond it too */
} parian_planar_desc;

/* Shares of the flux that has crossed the boundary inwards. Index 0: the lit side (all of a
 * sphere); 1: the far side of a slab. Errors are standard errors, from the scatter of batches of
 * photons. */
typedef struct parian_planar_profile {
    double total[2], total_error[2];
    double unscattered, unscattered_error; /* the part of both totals that never scattered, after
                                            * any number of inner reflections */
    double *bin[2], *bin_error[2];         /* [bin_count] per bin, not per area */
    parian_walk_books books;
} parian_planar_profile;

/* profile is set in every case, and needs no free after a failure.
 * Errors: PARIAN_E_ARGUMENT (an empty half-space too), PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED.
 * Threads: env->par; the same bytes for any count. */
parian_result parian_planar_profile_make(const parian_env *env, const parian_planar_desc *desc,
                                         parian_planar_profile *profile);
void parian_planar_profile_free(const parian_env *env, parian_planar_profile *profile);

#endif
