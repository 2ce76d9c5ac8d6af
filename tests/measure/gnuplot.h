/* gnuplot.h - draws a script with gnuplot: NAME.gp and NAME.dat in, NAME.svg and NAME.png out.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_GNUPLOT_H
#define PARIAN_MEASURE_GNUPLOT_H

#include "parian/env.h"
#include "parian/result.h"
#include "tests/measure/chart_text.h"

/* Whether a name can be that of a file: not empty, no '/', no control characters. Logs one line if
 * not. */
parian_result parian_gnuplot_check_name(const parian_env *env, const char *name);

/* The lines that begin a script: they set the variables `data`, the path of NAME.dat, and `base`,
 * that of the outputs without ".svg" and ".png"; and those that end it: the plot command for a
 * picture of this size in pixels. */
void parian_gnuplot_begin(parian_chart_text *script, const char *name);
void parian_gnuplot_finish(parian_chart_text *script, int width, int height, const char *plot);

/* Write script and data, run gnuplot on them in FOLDER, and rename its pictures. No shell, no
 * start-up files. Errors: PARIAN_E_IO, PARIAN_E_UNSUPPORTED (no gnuplot; script and data are
 * there), PARIAN_E_NOMEM. */
parian_result parian_gnuplot_draw(const parian_env *env, const char *folder, const char *name,
                                  const parian_chart_text *script, const parian_chart_text *data);

#endif
