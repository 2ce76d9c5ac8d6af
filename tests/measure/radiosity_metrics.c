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
    double area, value, truth, truth_abs, truth_square, difference, difference_square, error_square,
        smallest;
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
    return whole != 0 ? part / whole : part == 0 ? 0 : copysign(INFINITY, part);
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

/* Everything but B has to be sound. */
static parian_result check(const parian_env *env, size_t count, int channel,
                           const double (*truth)[3], const double (*truth_error)[3],
                           const double *area)
{
    if (channel < 0 || channel > 2) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "channel %d, expected 0 to 2", channel);
    }
    for (size_t i = 0; i < count; i++) {
        double error = truth_error ? truth_error[i][channel] : 0;
        if (!isfinite(truth[i][channel]) || !isfinite(error) || !isfinite(area[i]) || area[i] < 0) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "receiver %zu has truth %g, standard error %g, area %g; expected "
                               "finite numbers and no "
                               "area below zero",
                               i, truth[i][channel], error, area[i]);
        }
    }
    return PARIAN_OK;
}

static parian_radiosity_metrics summarise(const sums *s, weighted *list, size_t used)
{
    double mean = over(s->truth, s->area);
    return (parian_radiosity_metrics){
        .l1 = over(s->difference, s->truth_abs),
        .l2 = sqrt(over(s->difference_square, s->truth_square)),
        .energy_ratio = s->truth == 0 && s->value == 0 ? 1 : over(s->value, s->truth),
        .p999 = over(percentile(list, used, 0.999), mean),
        .minimum = over(s->smallest, mean),
        .truth_error = over(sqrt(over(s->error_square, s->area)), mean),
    };
}

parian_result parian_radiosity_measure(const parian_env *env, size_t count, int channel,
                                       const double (*value)[3], const double (*truth)[3],
                                       const double (*truth_error)[3], const double *area,
                                       parian_radiosity_metrics *metrics)
{
    weighted *list = NULL;
    size_t used = 0;
    parian_result result = check(env, count, channel, truth, truth_error, area);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW(env, list, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu errors", count);
    }
    sums s = {.smallest = INFINITY};
    for (size_t i = 0; i < count; i++) {
        double b = value[i][channel], t = truth[i][channel];
        if (isfinite(b)) {
            add(&s, area[i], b, t, truth_error ? truth_error[i][channel] : 0);
            list[used++] = (weighted){fabs(b - t), area[i]};
        }
    }
    *metrics = used > 0     ? summarise(&s, list, used)
               : count == 0 ? (parian_radiosity_metrics){.energy_ratio = 1}
                            : (parian_radiosity_metrics){NAN, NAN, NAN, NAN, NAN, NAN, 0};
    metrics->not_finite = count - used;
    parian_free(env, list);
    return PARIAN_OK;
}
