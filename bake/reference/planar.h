/* planar.h - radiative transfer by Monte Carlo in closed-form geometry: half-space, slab and sphere.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PLANAR_H
#define PARIAN_BAKE_PLANAR_H

#include "bake/reference/walk.h"
#include "parian/env.h"
#include "parian/result.h"

typedef enum parian_planar_shape { PARIAN_HALF_SPACE = 0, PARIAN_SLAB, PARIAN_SPHERE } parian_planar_shape;

typedef struct parian_planar_desc {
    parian_planar_shape shape;
    double size;             /* slab: thickness; sphere: radius; metres */
    parian_walk_medium medium;
    bool normal_incidence;   /* a beam along the normal instead of diffuse light; both after transmission */
    uint64_t photons;
    uint64_t seed;
    uint32_t bin_count;      /* of radius (planes) or arc (sphere) from the entry point */
    double bin_width;        /* metres; what lies beyond the last bin is counted in it */
} parian_planar_desc;

typedef struct parian_planar_profile {
    double total[2], total_error[2]; /* flux out of the lit side and of the far side per unit in; standard errors */
    double unscattered;              /* the part of both that never scattered */
    double *bin[2];                  /* [bin_count] flux per bin */
    double *bin_error[2];            /* [bin_count] standard errors */
    parian_walk_books books;
} parian_planar_profile;

/* Errors: PARIAN_E_ARGUMENT, PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. Threads: env->par; same bytes for any count. */
parian_result parian_planar_profile_make(const parian_env *env, const parian_planar_desc *desc,
                                         parian_planar_profile *profile);
void parian_planar_profile_free(const parian_env *env, parian_planar_profile *profile);

#endif
