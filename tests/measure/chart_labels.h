/* chart_labels.h - places labels beside points so that they cover neither each other nor what is
 * drawn.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_CHART_LABELS_H
#define PARIAN_MEASURE_CHART_LABELS_H

#include <stdbool.h>
#include <stddef.h>

/* Pixels, y upwards. */
typedef struct parian_chart_box {
    double x0, y0, x1, y1;
} parian_chart_box;

typedef struct parian_chart_dot {
    double x, y;
    bool joined; /* by a line to the dot before */
} parian_chart_dot;

typedef struct parian_chart_label {
    size_t dot;           /* that it belongs to */
    double width, height; /* of its text */
    double x, y;          /* out: left end of the text, half its height */
    bool shown;           /* out: false where there was no room */
    bool led;             /* out: so far off that a line should lead to it */
} parian_chart_label;

/* Whether a box is clear of dots and lines. */
bool parian_chart_box_is_free(const parian_chart_box *box, const parian_chart_dot *dots,
                              size_t dot_count);

/* frame: no label leaves it; taken: boxes that no label covers. Labels are placed in their order.
 */
void parian_chart_labels_place(const parian_chart_box *frame, const parian_chart_dot *dots,
                               size_t dot_count, const parian_chart_box *taken, size_t taken_count,
                               parian_chart_label *labels, size_t label_count);

#endif
