/* plot.c - speed-against-error plots: which points are drawn, where legend and labels go, the
 * script for gnuplot.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tests/measure/chart_axis.h"
#include "tests/measure/chart_labels.h"
#include "tests/measure/chart_style.h"
#include "tests/measure/chart_text.h"
#include "tests/measure/gnuplot.h"

enum { HEIGHT = 600, LEFT = 88, RIGHT = 26, AXIS_ROOM = 56, LEFT_OUT_MAX = 160 };

/* Where a legend stands: in a corner of the plot that nothing is drawn in, else beside the plot. */
typedef enum legend_place { LEGEND_NONE, LEGEND_CORNER, LEGEND_BESIDE } legend_place;

typedef struct layout {
    const parian_env *env;
    const parian_plot *plot;
    parian_chart_axis x, y;
    parian_chart_box frame; /* of the plot, in pixels from the lower left corner of the picture */
    double title_room, note_room, beside; /* beside: width of a legend there */
    legend_place legend;
    parian_chart_box legend_box;
    int corner; /* bit 0: right, bit 1: top */
    size_t point_count, label_count, left_out;
    parian_chart_dot *dots;     /* [point_count] that are drawn */
    parian_chart_label *labels; /* [label_count] */
    const char **label_texts;   /* [label_count] */
    char left_out_text[LEFT_OUT_MAX];
} layout;

/* ---- data --------------------------------------------------------------------------------------
 */
static bool is_drawn(const parian_plot *plot, const parian_plot_point *p)
{
    return parian_chart_axis_takes(plot->log_x, p->x) && parian_chart_axis_takes(plot->log_y, p->y);
}

static size_t count_drawn(const parian_plot *plot, const parian_plot_series *series)
{
    size_t count = 0;
    for (size_t i = 0; i < series->count; i++) {
        count += is_drawn(plot, &series->points[i]);
    }
    return count;
}

static void fit_axes(layout *l)
{
    double x[2] = {INFINITY, -INFINITY}, y[2] = {INFINITY, -INFINITY};
    for (size_t s = 0; s < l->plot->series_count; s++) {
        const parian_plot_series *series = &l->plot->series[s];
        for (size_t i = 0; i < series->count; i++) {
            const parian_plot_point *p = &series->points[i];
            if (!is_drawn(l->plot, p)) {
                l->left_out++;
                continue;
            }
            x[0] = fmin(x[0], p->x), x[1] = fmax(x[1], p->x);
            y[0] = fmin(y[0], p->y), y[1] = fmax(y[1], p->y);
            l->point_count++;
            l->label_count += p->label && *p->label;
        }
    }
    l->x = parian_chart_axis_fit(l->plot->log_x, x[0], x[1], false);
    l->y = parian_chart_axis_fit(l->plot->log_y, y[0], y[1], false);
}

/* One block for each series with points, two empty lines between; all labels, and what is left out,
 * in comments. */
static void put_data(parian_chart_text *data, const parian_plot *plot)
{
    parian_chart_text_put(data, "# x y # label\n");
    for (size_t s = 0, blocks = 0; s < plot->series_count; s++) {
        const parian_plot_series *series = &plot->series[s];
        parian_chart_text_put(data, "%s# ", blocks ? "\n\n" : "");
        parian_chart_text_put_plain(data, series->name, PARIAN_CHART_NOTE_COLUMNS);
        parian_chart_text_put(data, "\n");
        for (size_t i = 0; i < series->count; i++) {
            const parian_plot_point *p = &series->points[i];
            bool drawn = is_drawn(plot, p);
            parian_chart_text_put(data, "%s%.17g %.17g%s", drawn ? "" : "# left out: ", p->x, p->y,
                                  p->label ? " # " : "");
            parian_chart_text_put_plain(data, p->label, PARIAN_CHART_NOTE_COLUMNS);
            parian_chart_text_put(data, "\n");
        }
        blocks += count_drawn(plot, series) > 0;
    }
}

/* ---- layout ------------------------------------------------------------------------------------
 */
/* Places of points in the frame that leaves room for what stands around it. */
static void place_points(layout *l)
{
    l->frame = (parian_chart_box){LEFT, AXIS_ROOM + l->note_room,
                                  PARIAN_CHART_WIDTH - RIGHT - l->beside, HEIGHT - l->title_room};
    size_t n = 0, labels = 0;
    for (size_t s = 0; s < l->plot->series_count; s++) {
        const parian_plot_series *series = &l->plot->series[s];
        bool joined = false;
        for (size_t i = 0; i < series->count; i++) {
            const parian_plot_point *p = &series->points[i];
            if (!is_drawn(l->plot, p)) {
                continue;
            }
            const parian_chart_box *f = &l->frame;
            l->dots[n] = (parian_chart_dot){
                f->x0 + parian_chart_axis_place(&l->x, p->x) * (f->x1 - f->x0),
                f->y0 + parian_chart_axis_place(&l->y, p->y) * (f->y1 - f->y0), joined};
            if (p->label && *p->label) {
                size_t columns = parian_chart_text_columns(p->label, PARIAN_CHART_NAME_COLUMNS);
                l->label_texts[labels] = p->label;
                l->labels[labels++] = (parian_chart_label){
                    .dot = n,
                    .width = parian_chart_text_width(columns, PARIAN_CHART_LABEL_FONT),
                    .height = 1.3 * PARIAN_CHART_LABEL_FONT};
            }
            joined = true;
            n++;
        }
    }
}

static parian_chart_box corner_box(const layout *l, parian_chart_key key, int corner)
{
    const parian_chart_box *f = &l->frame;
    double x =
        corner & 1 ? f->x1 - PARIAN_CHART_KEY_MARGIN - key.width : f->x0 + PARIAN_CHART_KEY_MARGIN;
    double y =
        corner & 2 ? f->y1 - PARIAN_CHART_KEY_MARGIN - key.height : f->y0 + PARIAN_CHART_KEY_MARGIN;
    return (parian_chart_box){x, y, x + key.width, y + key.height};
}

static parian_result place_legend(layout *l)
{
    static const int order[4] = {3, 1, 0, 2}; /* upper right first: fast and exact are lower left */
    const char **names;
    size_t count = l->plot->series_count;
    if (count == 0 || (count == 1 && (!l->plot->series[0].name || !*l->plot->series[0].name))) {
        return PARIAN_OK;
    }
    if (!PARIAN_NEW(l->env, names, count)) {
        return PARIAN_E_NOMEM;
    }
    for (size_t i = 0; i < count; i++) {
        names[i] = l->plot->series[i].name;
    }
    parian_chart_key key = parian_chart_measure_key(names, count);
    parian_free(l->env, names);
    double width = l->frame.x1 - l->frame.x0, height = l->frame.y1 - l->frame.y0;
    for (int i = 0; i < 4 && key.width < 0.65 * width && key.height < 0.5 * height; i++) {
        parian_chart_box box = corner_box(l, key, order[i]);
        if (parian_chart_box_is_free(&box, l->dots, l->point_count)) {
            l->legend = LEGEND_CORNER;
            l->legend_box = box;
            l->corner = order[i];
            return PARIAN_OK;
        }
    }
    l->legend = LEGEND_BESIDE;
    l->beside = key.width;
    place_points(l);
    return PARIAN_OK;
}

static parian_result arrange(layout *l)
{
    fit_axes(l);
    if (!PARIAN_NEW0(l->env, l->dots, l->point_count) ||
        !PARIAN_NEW0(l->env, l->labels, l->label_count) ||
        !PARIAN_NEW0(l->env, l->label_texts, l->label_count)) {
        return PARIAN_E_NOMEM;
    }
    if (l->left_out) {
        bool one = l->left_out == 1, positive = l->plot->log_x || l->plot->log_y;
        snprintf(l->left_out_text, sizeof l->left_out_text,
                 "Not drawn: %zu point%s that %s%s not finite.", l->left_out, one ? "" : "s",
                 one ? "is" : "are", positive ? " not above zero or" : "");
    }
    l->title_room = parian_chart_title_room(l->plot->title);
    l->note_room = parian_chart_note_room(l->plot->note, l->left_out_text);
    place_points(l);
    parian_result result = place_legend(l);
    if (result == PARIAN_OK) {
        parian_chart_box inner = {l->frame.x0 + 3, l->frame.y0 + 3, l->frame.x1 - 3,
                                  l->frame.y1 - 3};
        parian_chart_labels_place(&inner, l->dots, l->point_count, &l->legend_box,
                                  l->legend == LEGEND_CORNER, l->labels, l->label_count);
    }
    return result;
}

/* ---- script ------------------------------------------------------------------------------------
 */
static void put_legend(parian_chart_text *out, const layout *l)
{
    if (l->legend == LEGEND_NONE) {
        parian_chart_text_put(out, "unset key\n");
    } else if (l->legend == LEGEND_CORNER) {
        parian_chart_text_put(
            out, "set key inside %s %s Left reverse samplen 2 spacing 1.25 maxcols 1\n",
            l->corner & 1 ? "right" : "left", l->corner & 2 ? "top" : "bottom");
    } else {
        parian_chart_text_put(
            out,
            "set key at screen %.6g,%.6g left top Left reverse samplen 2 spacing 1.25 maxcols 1\n",
            (l->frame.x1 + 2) / PARIAN_CHART_WIDTH, l->frame.y1 / HEIGHT);
    }
}

/* A place in pixels as numbers of the axes, so that labels stay with their points when a range is
 * edited. */
static void put_place(parian_chart_text *out, const layout *l, double x, double y)
{
    parian_chart_text_put(
        out, "%.6g,%.6g",
        parian_chart_axis_value(&l->x, (x - l->frame.x0) / (l->frame.x1 - l->frame.x0)),
        parian_chart_axis_value(&l->y, (y - l->frame.y0) / (l->frame.y1 - l->frame.y0)));
}

static size_t put_labels(parian_chart_text *out, const layout *l)
{
    size_t hidden = 0;
    for (size_t i = 0; i < l->label_count; i++) {
        const parian_chart_label *label = &l->labels[i];
        const parian_chart_dot *dot = &l->dots[label->dot];
        if (!label->shown) {
            hidden++;
            continue;
        }
        parian_chart_text_put(out, "set label %zu ", i + 10);
        parian_chart_text_put_quoted(out, l->label_texts[i], PARIAN_CHART_NAME_COLUMNS);
        parian_chart_text_put(out, " at ");
        put_place(out, l, label->x, label->y);
        parian_chart_text_put(out, " left front font ',%d' textcolor rgb '#303030'\n",
                              PARIAN_CHART_LABEL_FONT);
        if (label->led) {
            double end = fmin(fmax(dot->x, label->x), label->x + label->width);
            parian_chart_text_put(out, "set arrow from ");
            put_place(out, l, dot->x, dot->y);
            parian_chart_text_put(out, " to ");
            put_place(out, l, end, label->y + (dot->y > label->y ? 0.5 : -0.5) * label->height);
            parian_chart_text_put(out, " nohead back lc rgb '#909090' lw 0.7\n");
        }
    }
    return hidden;
}

static void put_plot_command(parian_chart_text *out, const layout *l)
{
    parian_chart_text_put(out, "plot ");
    for (size_t s = 0, block = 0; s < l->plot->series_count; s++) {
        const parian_plot_series *series = &l->plot->series[s];
        size_t drawn = count_drawn(l->plot, series);
        if (drawn > 0) {
            parian_chart_text_put(out, "data index %zu using 1:2", block++);
        } else {
            parian_chart_text_put(out, "NaN");
        }
        parian_chart_text_put(out, " with linespoints ls %zu title ", s + 1);
        parian_chart_text_put_quoted(out, series->name, PARIAN_CHART_NAME_COLUMNS);
        parian_chart_text_put(out, "%s", s + 1 < l->plot->series_count ? ", \\\n    " : "");
    }
    if (l->plot->series_count == 0) {
        parian_chart_text_put(out, "NaN notitle");
    }
}

static size_t put_script(parian_chart_text *out, const layout *l, const char *name)
{
    parian_chart_text command = {.env = l->env};
    parian_gnuplot_begin(out, name);
    parian_chart_put_styles(out, l->plot->series_count);
    parian_chart_put_frame(out, &(parian_chart_frame){PARIAN_CHART_WIDTH, HEIGHT, l->frame.x0,
                                                      PARIAN_CHART_WIDTH - l->frame.x1, l->frame.y0,
                                                      HEIGHT - l->frame.y1, l->plot->title,
                                                      l->plot->x_label, l->plot->y_label,
                                                      l->plot->note, l->left_out_text});
    parian_chart_axis_put(out, &l->x, 'x');
    parian_chart_axis_put(out, &l->y, 'y');
    put_legend(out, l);
    size_t hidden = put_labels(out, l);
    if (l->point_count == 0) {
        parian_chart_text_put(
            out, "set label 3 'no data' at graph 0.5,0.5 center textcolor rgb '#606060'\n");
    }
    put_plot_command(&command, l);
    parian_gnuplot_finish(out, PARIAN_CHART_WIDTH, HEIGHT, command.text ? command.text : "");
    out->failed = out->failed || command.failed;
    parian_chart_text_free(&command);
    return hidden;
}

parian_result parian_plot_write(const parian_env *env, const char *folder, const char *name,
                                const parian_plot *plot)
{
    layout l = {.env = env, .plot = plot};
    parian_chart_text script = {.env = env}, data = {.env = env};
    parian_result result = parian_gnuplot_check_name(env, name);
    if (result != PARIAN_OK) {
        return result;
    }
    result = arrange(&l);
    if (result != PARIAN_OK) {
        parian_fail(env, result, "no memory for a plot of %zu points", l.point_count);
    } else {
        size_t hidden = put_script(&script, &l, name);
        put_data(&data, plot);
        result = parian_gnuplot_draw(env, folder, name, &script, &data);
        if (l.left_out || hidden) {
            parian_log(env, PARIAN_LOG_WARNING,
                       "plot '%s': %zu points and %zu labels are left out; '%s.dat' has them", name,
                       l.left_out, hidden, name);
        }
    }
    parian_chart_text_free(&script);
    parian_chart_text_free(&data);
    parian_free(env, l.dots);
    parian_free(env, l.labels);
    parian_free(env, (void *)l.label_texts);
    return result;
}
