/* chart_axis.h - the range of an axis around its data, and ticks at round numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_CHART_AXIS_H
#define PARIAN_MEASURE_CHART_AXIS_H

#include <stdbool.h>
#include <stddef.h>

#include "tests/measure/chart_text.h"

typedef struct parian_chart_axis {
    bool logarithmic;
    double low, high; /* low < high; logarithmic: both above 0 */
} parian_chart_axis;

/* Whether an axis of this kind can show a value. */
bool parian_chart_axis_takes(bool logarithmic, double value);
/* An axis with room around the smallest and the largest value (smallest > largest: there is none).
 * from_zero: a linear axis begins at zero if nothing is below. */
parian_chart_axis parian_chart_axis_fit(bool logarithmic, double smallest, double largest,
                                        bool from_zero);
/* Where a value lies: 0 at low, 1 at high; and the value at a place. */
double parian_chart_axis_place(const parian_chart_axis *axis, double value);
double parian_chart_axis_value(const parian_chart_axis *axis, double place);

typedef struct parian_chart_tick {
    double value;
    bool labelled;
} parian_chart_tick;

enum { PARIAN_CHART_TICKS_MAX = 128 };
/* Ticks in [low, high], ascending; gives their number. Two of them at least are labelled. */
size_t parian_chart_axis_ticks(const parian_chart_axis *axis,
                               parian_chart_tick ticks[PARIAN_CHART_TICKS_MAX]);
/* "set xrange ... set logscale x ... set xtics (...)" for the axis of this letter. */
void parian_chart_axis_put(parian_chart_text *out, const parian_chart_axis *axis, char letter);

#endif
