/* global_rounding.c - rounds the factors of a row to what their sums need, so that files get small.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_rounding.h"

#include <math.h>

/* Of the threshold, what rounding may add to a row's response. Rounding between coarse points is no
 * smooth function of the vertices: the more of it, the more pairs finer levels have to keep. */
static const double ROUNDING_SHARE = 1.0 / 8, ROUNDING_SHARE_COARSE = 1.0 / 256;

/* Independent errors, uniform over a step, of n factors over areas a: step a sqrt(n / 12). */
static float choose_step(const parian_row_maker *maker, double area_mean_m2, double whole,
                         uint32_t kept)
{
    double share = maker->finer ? ROUNDING_SHARE_COARSE : ROUNDING_SHARE;
    double step = share * maker->threshold * whole / (area_mean_m2 * sqrt(kept / 12.0));
    return step > 0x1p-100 && step < 0x1p100 ? ldexpf(1, ilogb(step)) : 0;
}

/* *owed: factor times area that the factors so far have lost. */
static float round_factor(float value, float step, float area, double *owed)
{
    float rounded = 0;
    if (value == 0) {
        return 0; /* what another level carries stays there */
    }
    if (value < 0) {
        rounded = -step * floorf(-value / step);
    } else {
        double debt = area > 0 ? fmin(fmax(*owed / area, -step), step) : 0, wanted = value + debt;
        rounded = wanted > 0 ? step * (float)rint(wanted / step) : 0;
    }
    *owed += ((double)value - rounded) * area;
    return rounded;
}

/* What negative factors at a row's end have gained is taken from factors before them, a step each.
 */
static void settle(const uint8_t *keep, const float *area, uint32_t count, float step, double owed,
                   float *value)
{
    for (uint32_t i = count; i-- > 0;) {
        double least = 0.5 * step * area[i];
        if (keep[i] && owed < -least && value[i] >= 2 * step) {
            value[i] -= step;
            owed += (double)step * area[i];
        }
    }
}

void parian_row_round(const parian_row_maker *maker, double area_mean_m2, parian_row_work *work)
{
    const float *area = maker->factors.frame.area;
    uint32_t count = maker->factors.frame.points.count, kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        kept += work->keep[i];
    }
    if (maker->threshold_absolute > 0 || !(maker->threshold > 0) || kept == 0) {
        return;
    }
    for (int c = 0; c < 3; c++) {
        float *value = work->row.value[c];
        float step = choose_step(maker, area_mean_m2, work->whole[c], kept);
        double owed = 0;
        for (uint32_t i = 0; step > 0 && i < count; i++) {
            value[i] = work->keep[i] ? round_factor(value[i], step, area[i], &owed) : value[i];
        }
        settle(work->keep, area, count, step, owed, value);
    }
}
