/* chart_text.h - text that grows, and texts of others made safe for gnuplot.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_CHART_TEXT_H
#define PARIAN_MEASURE_CHART_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "parian/env.h"

/* Zeroed with env set is empty. After a failed allocation nothing is added any more and `failed` is
 * true. */
typedef struct parian_chart_text {
    const parian_env *env;
    char *text; /* [size], then a NUL; NULL while empty */
    size_t size, capacity;
    bool failed;
} parian_chart_text;

void parian_chart_text_free(parian_chart_text *out);
/* Append as printf does. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void parian_chart_text_put(parian_chart_text *out, const char *format, ...);

/* Append a text of others on one line: control characters become spaces, what is not UTF-8 becomes
 * '?', what is longer than `columns` is cut with an ellipsis. NULL is empty. */
void parian_chart_text_put_plain(parian_chart_text *out, const char *text, size_t columns);
/* The same as a string constant of gnuplot. */
void parian_chart_text_put_quoted(parian_chart_text *out, const char *text, size_t columns);
/* The same over at most two lines, parted between words. Gives the number of lines, 0 for an empty
 * text. */
int parian_chart_text_put_lines(parian_chart_text *out, const char *text, size_t columns);

/* Columns that a text takes, at most `columns` (what is longer is cut): wide characters of East
 * Asia count twice. */
size_t parian_chart_text_columns(const char *text, size_t columns);

/* Append a number with at most 6 digits and a short exponent: 0.0001, 1e-5, 250000, 1e6. */
void parian_chart_text_put_number(parian_chart_text *out, double value);

#endif
