/* medium.h - the scattering medium inside a body.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_MEDIUM_H
#define PARIAN_CORE_MEDIUM_H

#include <stdbool.h>

#include "parian/env.h"
#include "parian/result.h"

enum { PARIAN_CHANNELS = 3, PARIAN_NAME_MAX = 64, PARIAN_SOURCE_MAX = 192 };

/* A homogeneous medium. Coefficients are per RGB channel in m^-1. What the literature gives as
 * reduced is kept reduced and never reduced twice: sigma_s_prime is the quantity that transport
 * uses, and sigma_s = sigma_s_prime / (1 - g) is known only where reduced_only is false. */
typedef struct parian_medium {
    char name[PARIAN_NAME_MAX];
    char source[PARIAN_SOURCE_MAX];        /* where the numbers are from */
    double sigma_s_prime[PARIAN_CHANNELS]; /* reduced scattering, m^-1 */
    double sigma_a[PARIAN_CHANNELS];       /* absorption, m^-1 */
    double g[PARIAN_CHANNELS];             /* mean cosine; 0 where reduced_only */
    double eta;                            /* index of refraction, inside over outside */
    bool reduced_only;                     /* only sigma_s_prime was measured */
} parian_medium;

/* Refuse what is physically impossible (negative, not finite, a channel without scattering and
 * absorption, no scattering at all, eta outside [1, 4], |g| >= 1), naming the coefficient:
 * PARIAN_E_ARGUMENT. g is capped at
 * +-0.995 with a warning. */
parian_result parian_medium_check(const parian_env *env, parian_medium *medium);

#endif
