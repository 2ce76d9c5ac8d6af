/* plot.h - speed-against-error plots, drawn by gnuplot: SVG and PNG, with the script and the data
 * beside them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_PLOT_H
#define PARIAN_MEASURE_PLOT_H

#include <stdbool.h>
#include <stddef.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_plot_point {
    double x, y;
    const char *label; /* beside the point; NULL for none */
} parian_plot_point;

typedef struct parian_plot_series {
    const char *name;
    const parian_plot_point *points; /* joined in this order */
    size_t count;
} parian_plot_series;

typedef struct parian_plot {
    const char *title, *x_label, *y_label;
    bool log_x, log_y; /* points that are not above zero are left out of a logarithmic axis, and
                          said to be */
    const parian_plot_series *series;
    size_t series_count;
    const char *note; /* small, under the picture; NULL for none */
} parian_plot;

/* Write FOLDER/NAME.gp, NAME.dat, NAME.svg and NAME.png: the same bytes for the same plot. Texts
 * are UTF-8 and mean themselves; long ones are cut. Labels that find no room are left out, and said
 * to be; NAME.dat has them all. Where gnuplot is missing the first two files are written and
 * PARIAN_E_UNSUPPORTED says so. Errors: PARIAN_E_ARGUMENT (name), PARIAN_E_IO,
 * PARIAN_E_UNSUPPORTED, PARIAN_E_NOMEM. */
parian_result parian_plot_write(const parian_env *env, const char *folder, const char *name,
                                const parian_plot *plot);

#endif
