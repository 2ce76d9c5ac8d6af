/* bar_chart.h - grouped bars, upright or lying, drawn by gnuplot: SVG and PNG, with the script and
 * the data beside.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_BAR_CHART_H
#define PARIAN_MEASURE_BAR_CHART_H

#include <stdbool.h>
#include <stddef.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_bar_series {
    const char *name;
    const double *values; /* [group_count]; NaN: no bar */
} parian_bar_series;

typedef struct parian_bar_chart {
    const char *title, *value_label;
    bool logarithmic;          /* bars that are not above zero are left out, and said to be */
    bool lying;                /* groups from top to bottom: for many groups, or long names */
    const char *const *groups; /* [group_count] names */
    size_t group_count;
    const parian_bar_series *series;
    size_t series_count;
    const char *note; /* small, under the picture; NULL for none */
} parian_bar_chart;

/* Write FOLDER/NAME.gp, NAME.dat, NAME.svg and NAME.png, as parian_plot_write does, with its
 * errors. Values stand at the ends of bars while these are broad enough. At most 200 groups and 24
 * series. */
parian_result parian_bar_chart_write(const parian_env *env, const char *folder, const char *name,
                                     const parian_bar_chart *chart);

#endif
