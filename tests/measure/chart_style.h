/* chart_style.h - what plots and bar charts share: colours, sizes of text, the frame.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_CHART_STYLE_H
#define PARIAN_MEASURE_CHART_STYLE_H

#include <stddef.h>

#include "tests/measure/chart_labels.h"
#include "tests/measure/chart_text.h"

enum {
    PARIAN_CHART_WIDTH = 960,
    PARIAN_CHART_FONT = 11, /* of everything but titles and point labels */
    PARIAN_CHART_TITLE_FONT = 14,
    PARIAN_CHART_LABEL_FONT = 10,
    PARIAN_CHART_NAME_COLUMNS = 52,
    PARIAN_CHART_TITLE_COLUMNS = 86,
    PARIAN_CHART_NOTE_COLUMNS = 130,
    PARIAN_CHART_KEY_MARGIN = 12
};

/* Pixels that a text of so many columns takes at a font size, on average; and the height of a line.
 */
double parian_chart_text_width(size_t columns, int font);
double parian_chart_line_height(int font);

/* "set style line" 1 to count: colours that the colour-blind tell apart, with markers and dashes.
 */
void parian_chart_put_styles(parian_chart_text *out, size_t count);

/* Title, axis names, notes and margins; frame: that of the plot in pixels, y upwards. The note and
 * what was left out (may be empty) stand under the picture. */
typedef struct parian_chart_frame {
    int width, height;
    double left, right, bottom, top; /* of the plot, from the edges of the picture */
    const char *title, *x_label, *y_label, *note, *left_out;
} parian_chart_frame;
/* Room that title and notes need at the top and at the bottom, without the axis. */
double parian_chart_title_room(const char *title);
double parian_chart_note_room(const char *note, const char *left_out);
void parian_chart_put_frame(parian_chart_text *out, const parian_chart_frame *frame);

/* Size of a legend of these names. */
typedef struct parian_chart_key {
    double width, height;
} parian_chart_key;
parian_chart_key parian_chart_measure_key(const char *const *names, size_t count);

#endif
