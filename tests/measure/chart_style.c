/* chart_style.c - what plots and bar charts share: colours, sizes of text, the frame.
 *
 * Source  colours [OkabeIto08]
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/chart_style.h"

#include <math.h>

/* Without the yellow, which white swallows. */
static const char *const COLOR[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#e69f00", "#56b4e9", "#000000"};
static const int MARKER[] = {7, 5, 9, 13, 11, 6, 4, 8, 12, 10};
enum { COLOR_COUNT = sizeof COLOR / sizeof *COLOR, MARKER_COUNT = sizeof MARKER / sizeof *MARKER };

double parian_chart_text_width(size_t columns, int font)
{
    return 0.82 * font * (double)columns;
}

double parian_chart_line_height(int font)
{
    return 1.7 * font;
}

void parian_chart_put_styles(parian_chart_text *out, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        parian_chart_text_put(out, "set style line %zu lc rgb '%s' lw 2 dt %zu pt %d ps 1.1\n",
                              i + 1, COLOR[i % COLOR_COUNT], 1 + i / COLOR_COUNT % 4,
                              MARKER[i % MARKER_COUNT]);
    }
}

double parian_chart_title_room(const char *title)
{
    size_t columns = parian_chart_text_columns(title, PARIAN_CHART_TITLE_COLUMNS + 1);
    int count = (columns > 0) + (columns > PARIAN_CHART_TITLE_COLUMNS);
    return 22 + count * parian_chart_line_height(PARIAN_CHART_TITLE_FONT);
}

double parian_chart_note_room(const char *note, const char *left_out)
{
    int count = (note && *note) + (left_out && *left_out);
    return count ? 6 + count * parian_chart_line_height(PARIAN_CHART_LABEL_FONT) : 0;
}

static void put_note(parian_chart_text *out, int tag, const char *text, int line,
                     const parian_chart_frame *frame)
{
    double y = 6 + (0.5 + line) * parian_chart_line_height(PARIAN_CHART_LABEL_FONT);
    parian_chart_text_put(out, "set label %d ", tag);
    parian_chart_text_put_quoted(out, text, PARIAN_CHART_NOTE_COLUMNS);
    parian_chart_text_put(out, " at screen %.6g,%.6g left font ',%d' textcolor rgb '#606060'\n",
                          12.0 / frame->width, y / frame->height, PARIAN_CHART_LABEL_FONT);
}

void parian_chart_put_frame(parian_chart_text *out, const parian_chart_frame *frame)
{
    parian_chart_text_put(out, "set title ");
    parian_chart_text_put_lines(out, frame->title, PARIAN_CHART_TITLE_COLUMNS);
    parian_chart_text_put(out, " font ',%d'\nset xlabel ", PARIAN_CHART_TITLE_FONT);
    parian_chart_text_put_quoted(out, frame->x_label, PARIAN_CHART_TITLE_COLUMNS);
    parian_chart_text_put(out, "\nset ylabel ");
    parian_chart_text_put_quoted(out, frame->y_label, PARIAN_CHART_TITLE_COLUMNS / 2);
    parian_chart_text_put(out, "\nset lmargin at screen %.6g\nset rmargin at screen %.6g\n",
                          frame->left / frame->width, 1 - frame->right / frame->width);
    parian_chart_text_put(out, "set bmargin at screen %.6g\nset tmargin at screen %.6g\n",
                          frame->bottom / frame->height, 1 - frame->top / frame->height);
    bool note = frame->note && *frame->note, left_out = frame->left_out && *frame->left_out;
    if (left_out) {
        put_note(out, 1, frame->left_out, 0, frame);
    }
    if (note) {
        put_note(out, 2, frame->note, left_out, frame);
    }
}

parian_chart_key parian_chart_measure_key(const char *const *names, size_t count)
{
    size_t longest = 0;
    for (size_t i = 0; i < count; i++) {
        size_t columns = parian_chart_text_columns(names[i], PARIAN_CHART_NAME_COLUMNS);
        longest = columns > longest ? columns : longest;
    }
    return (parian_chart_key){54 + parian_chart_text_width(longest, PARIAN_CHART_FONT),
                              8 + (double)count * 1.25 *
                                      parian_chart_line_height(PARIAN_CHART_FONT)};
}
