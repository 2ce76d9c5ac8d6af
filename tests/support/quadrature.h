/* quadrature.h - brute-force quadrature of the dipole over the texels of a scene: the truth that
 * the discretisation is measured against.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_QUADRATURE_H
#define PARIAN_TEST_QUADRATURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/medium.h"
#include "parian/env.h"
#include "parian/result.h"

/* Texels of one body, SI units. */
typedef struct quadrature_texels {
    size_t count;
    const float (*position)[3];
    const float (*normal)[3];
    const float *area;
    const float (*irradiance)[3];
} quadrature_texels;

/* Area-weighted relative errors over the receivers, per channel. */
typedef struct quadrature_error {
    double l1[3], l2[3]; /* of B, relative */
    double energy[3];    /* sum of B over sum of the truth */
    double p999[3];      /* 99.9th percentile of |B - truth| over the mean of the truth */
    double smallest;     /* of B over all texels, over its largest */
} quadrature_error;

/* Pick count receivers, a texel each, with a probability in proportion to its area (systematic,
 * seeded). */
void quadrature_pick(const quadrature_texels *texels, size_t count, uint64_t seed,
                     size_t *receiver);

/* Truth at the receivers: every texel's flux times R_d of the exact distance; texels nearer than 20
 * texel edges as 2 x 2 Gauss points on a square of their area in their tangent plane, the
 * receiver's own texel as the disc of its area in closed form. */
parian_result quadrature_radiosity(const parian_env *env, const parian_medium *medium, bool fit_fdr,
                                   const quadrature_texels *texels, const size_t *receiver,
                                   size_t count, double (*truth)[3]);

/* Compare radiosity [texels->count] at the receivers with the truth. */
quadrature_error quadrature_compare(const quadrature_texels *texels, const float (*radiosity)[3],
                                    const size_t *receiver, size_t count, const double (*truth)[3]);

#endif
