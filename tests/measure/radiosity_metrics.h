/* radiosity_metrics.h - errors of B against a truth, area-weighted, per channel.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_RADIOSITY_METRICS_H
#define PARIAN_MEASURE_RADIOSITY_METRICS_H

#include <stddef.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_radiosity_metrics {
    double l1, l2;       /* sum A |B - T| / sum A |T|;  sqrt(sum A (B - T)^2 / sum A T^2) */
    double energy_ratio; /* sum A B / sum A T */
    double p999;        /* over the mean of T: what |B - T| does not exceed on 99.9 % of the area */
    double minimum;     /* smallest B over the mean of T */
    double truth_error; /* root mean square of the truth's standard error over the mean of T; 0
                           where exact */
    size_t not_finite;  /* values of B that are NaN or infinite; they are left out of the rest */
} parian_radiosity_metrics;

/* value, truth, truth_error (may be NULL): [count][3]; area [count]; channel 0 to 2. Means and sums
 * are over the receivers whose B is finite; where there are receivers and none is, every error is
 * NaN. A truth of zero everywhere gives an energy ratio of 1 and errors of 0 where B is zero too,
 * else infinities. Errors: PARIAN_E_ARGUMENT (channel, a truth, error or area that is not finite,
 * an area below zero), PARIAN_E_NOMEM. */
parian_result parian_radiosity_measure(const parian_env *env, size_t count, int channel,
                                       const double (*value)[3], const double (*truth)[3],
                                       const double (*truth_error)[3], const double *area,
                                       parian_radiosity_metrics *metrics);

#endif
