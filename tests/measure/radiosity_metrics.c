/* radiosity_metrics.c - area-weighted errors of B.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/radiosity_metrics.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

typedef struct weighted {
    double value, weight;
} weighted;

typedef struct sums {
    double area, value, truth, truth_abs, truth_square, difference, difference_square, error_square, smallest;
} sums;

static int by_value(const void *a, const void *b)
{
    double x = ((const weighted *)a)->value, y = ((const weighted *)b)->value;
    return (x > y) - (x < y);
}

/* Smallest value that at least `share` of the weight does not exceed. */
static double percentile(weighted *list, size_t count, double share)
{
    double total = 0, sum = 0;
    qsort(list, count, sizeof *list, by_value);
    for (size_t i = 0; i < count; i++) {
        total += list[i].weight;
    }
    for (size_t i = 0; i < count; i++) {
        sum += list[i].weight;
        if (sum >= share * total) {
            return list[i].value;
        }
    }
    return count ? list[count - 1].value : 0;
}

static double over(double part, double whole)
{
    return whole != 0 ? part / whole : part == 0 ? 0 : INFINITY;
}

static void add(sums *s, double area, double value, double truth, double error)
{
    double d = value - truth;
    s->area += area;
    s->value += area * value;
    s->truth += area * truth;
    s->truth_abs += area * fabs(truth);
    s->truth_square += area * truth * truth;
    s->difference += area * fabs(d);
    s->difference_square += area * d * d;
    s->error_square += area * error * error;
    s->smallest = fmin(s->smallest, value);
}

parian_result parian_radiosity_measure(const parian_env *env, size_t count, int channel, const double (*value)[3],
                                       const double (*truth)[3], const double (*truth_error)[3],
                                       const double *area, parian_radiosity_metrics *metrics)
{
    weighted *list = NULL;
    size_t used = 0;
    if (!PARIAN_NEW(env, list, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu errors", count);
    }
    sums s = {.smallest = INFINITY};
    *metrics = (parian_radiosity_metrics){0};
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(value[i][channel])) {
            metrics->not_finite++;
            continue;
        }
        double t = truth[i][channel];
        add(&s, area[i], value[i][channel], t, truth_error ? truth_error[i][channel] : 0);
        list[used++] = (weighted){fabs(value[i][channel] - t), area[i]};
    }
    double mean = over(s.truth, s.area);
    metrics->l1 = over(s.difference, s.truth_abs);
    metrics->l2 = sqrt(over(s.difference_square, s.truth_square));
    metrics->energy_ratio = s.truth == 0 && s.value == 0 ? 1 : over(s.value, s.truth);
    metrics->p999 = over(percentile(list, used, 0.999), mean);
    metrics->minimum = used ? over(s.smallest, mean) : 0;
    metrics->truth_error = over(sqrt(over(s.error_square, s.area)), mean);
    parian_free(env, list);
    return PARIAN_OK;
}
