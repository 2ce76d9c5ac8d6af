/* bar_chart.c - grouped bars: where they stand, their values as text, the script for gnuplot.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/bar_chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "tests/measure/chart_axis.h"
#include "tests/measure/chart_style.h"
#include "tests/measure/chart_text.h"
#include "tests/measure/gnuplot.h"

enum {
    GROUPS_MAX = 200,
    SERIES_MAX = 24,
    UPRIGHT_HEIGHT = 600,
    LYING_BAR = 16, /* pixels across a lying bar */
    LEFT = 88,
    RIGHT = 30,
    VALUE_AXIS_ROOM = 56,
    GROUP_AXIS_ROOM = 34,
    GROUP_NAME_COLUMNS = 32,
    VALUE_COLUMNS = 8, /* of a number beside a bar */
    LEFT_OUT_MAX = 160
};

static const double GROUP_SHARE = 0.8; /* of the room of a group that its bars take */

typedef struct bars {
    const parian_bar_chart *chart;
    parian_chart_axis axis;
    int height;
    parian_chart_box frame; /* pixels, from the lower left corner */
    double bar;             /* pixels across one */
    bool legend, turned;    /* turned: names of groups are set upwards */
    size_t drawn, left_out;
    char left_out_text[LEFT_OUT_MAX];
} bars;

static parian_result check(const parian_env *env, const parian_bar_chart *chart)
{
    if (chart->group_count > GROUPS_MAX || chart->series_count > SERIES_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "a bar chart of %zu groups and %zu series; at most %d and %d",
                           chart->group_count, chart->series_count, GROUPS_MAX, SERIES_MAX);
    }
    return PARIAN_OK;
}

static void fit_axis(bars *b)
{
    double smallest = INFINITY, largest = -INFINITY;
    for (size_t s = 0; s < b->chart->series_count; s++) {
        for (size_t g = 0; g < b->chart->group_count; g++) {
            double v = b->chart->series[s].values[g];
            bool takes = parian_chart_axis_takes(b->chart->logarithmic, v);
            b->left_out += !takes && !isnan(v);
            b->drawn += takes;
            smallest = takes ? fmin(smallest, v) : smallest;
            largest = takes ? fmax(largest, v) : largest;
        }
    }
    if (!b->chart->logarithmic) {
        smallest = fmin(smallest, 0);
    }
    if (b->drawn > 0) { /* room for the number behind the longest bar */
        largest = b->chart->logarithmic ? largest * pow(largest / smallest, 0.05)
                                        : largest + 0.04 * (largest - smallest);
    }
    b->axis = parian_chart_axis_fit(b->chart->logarithmic, smallest, largest, true);
    if (b->left_out) {
        snprintf(b->left_out_text, sizeof b->left_out_text, "Not drawn: %zu value%s not%s finite.",
                 b->left_out, b->left_out == 1 ? "" : "s",
                 b->chart->logarithmic ? " above zero or not" : "");
    }
}

static size_t longest_group(const parian_bar_chart *chart)
{
    size_t longest = 0;
    for (size_t g = 0; g < chart->group_count; g++) {
        size_t columns = parian_chart_text_columns(chart->groups[g], GROUP_NAME_COLUMNS);
        longest = columns > longest ? columns : longest;
    }
    return longest;
}

static void arrange(bars *b)
{
    const parian_bar_chart *c = b->chart;
    const char *names[SERIES_MAX];
    for (size_t s = 0; s < c->series_count; s++) {
        names[s] = c->series[s].name;
    }
    fit_axis(b);
    b->legend = c->series_count > 1;
    parian_chart_key key = parian_chart_measure_key(names, c->series_count);
    double name_width = parian_chart_text_width(longest_group(c), PARIAN_CHART_FONT);
    double right = PARIAN_CHART_WIDTH - RIGHT - (b->legend ? key.width : 0),
           left = c->lying ? 24 + name_width : LEFT;
    double groups = (double)(c->group_count ? c->group_count : 1),
           series = (double)(c->series_count ? c->series_count : 1);
    double bottom = (c->lying ? VALUE_AXIS_ROOM : GROUP_AXIS_ROOM) +
                    parian_chart_note_room(c->note, b->left_out_text);
    double top = parian_chart_title_room(c->title), across = (right - left) / groups;
    if (c->lying) {
        double inner = fmax(groups * series * LYING_BAR / GROUP_SHARE, b->legend ? key.height : 60);
        b->height = (int)ceil(bottom + top + inner);
        across = inner / groups;
    } else {
        b->height = UPRIGHT_HEIGHT;
        b->turned = name_width > 0.95 * across;
        bottom += b->turned ? name_width - 10 : 0;
    }
    b->bar = across * GROUP_SHARE / series;
    b->frame = (parian_chart_box){left, bottom, right, b->height - top};
}

/* Where bar s of group g lies across the axis of groups: group g has [g - 0.5, g + 0.5]. */
static void bar_sides(const bars *b, size_t g, size_t s, double *from, double *to)
{
    double width = GROUP_SHARE / (double)b->chart->series_count;
    *from = (double)g - 0.5 * GROUP_SHARE + (double)s * width;
    *to = *from + width;
}

/* One block for each series: middle of the bar, its value, its corners. */
static void put_data(parian_chart_text *data, const bars *b)
{
    double base = b->chart->logarithmic ? b->axis.low : 0;
    bool lying = b->chart->lying;
    parian_chart_text_put(data, "# x y x_low x_high y_low y_high # group\n");
    for (size_t s = 0; s < b->chart->series_count; s++) {
        parian_chart_text_put(data, "%s# ", s ? "\n\n" : "");
        parian_chart_text_put_plain(data, b->chart->series[s].name, PARIAN_CHART_NOTE_COLUMNS);
        parian_chart_text_put(data, "\n");
        for (size_t g = 0; g < b->chart->group_count; g++) {
            double v = b->chart->series[s].values[g], side[2],
                   end[2] = {fmin(base, v), fmax(base, v)};
            bar_sides(b, g, s, &side[0], &side[1]);
            double middle = 0.5 * (side[0] + side[1]);
            const double *x = lying ? end : side, *y = lying ? side : end;
            parian_chart_text_put(
                data, "%s%.17g %.17g %.17g %.17g %.17g %.17g # ",
                parian_chart_axis_takes(b->chart->logarithmic, v) ? "" : "# left out: ",
                lying ? v : middle, lying ? middle : v, x[0], x[1], y[0], y[1]);
            parian_chart_text_put_plain(data, b->chart->groups[g], PARIAN_CHART_NOTE_COLUMNS);
            parian_chart_text_put(data, "\n");
        }
    }
}

static void put_group_axis(parian_chart_text *out, const bars *b)
{
    const parian_bar_chart *c = b->chart;
    char letter = c->lying ? 'y' : 'x';
    double last = (double)(c->group_count ? c->group_count : 1) - 0.5;
    parian_chart_text_put(out, "unset logscale %c\nset %crange [%g:%g] noextend\n", letter, letter,
                          c->lying ? last : -0.5, c->lying ? -0.5 : last);
    parian_chart_text_put(out, "set grid no%ctics nom%ctics\nset %ctics %s scale 0 (", letter,
                          letter, letter, b->turned ? "rotate by 90 right" : "norotate");
    for (size_t g = 0; g < c->group_count; g++) {
        parian_chart_text_put(out, "%s", g ? ", " : "");
        parian_chart_text_put_quoted(out, c->groups[g], GROUP_NAME_COLUMNS);
        parian_chart_text_put(out, " %zu", g);
    }
    parian_chart_text_put(out, ")\n");
    if (c->group_count == 0) {
        parian_chart_text_put(out, "unset %ctics\n", letter);
    }
}

/* The value of a bar as text at its end. */
static void put_value(parian_chart_text *out, const bars *b, size_t tag, double value,
                      double middle)
{
    bool lying = b->chart->lying, below = value < 0;
    char number[32];
    snprintf(number, sizeof number, "%.3g", value);
    parian_chart_text_put(out, "set label %zu '", tag);
    parian_chart_text_put_number(out, strtod(number, NULL));
    parian_chart_text_put(
        out, "' at first %.12g,%.12g %s offset %s front font ',%d' textcolor rgb '#303030'\n",
        lying ? value : middle, lying ? middle : value,
        !lying  ? "center"
        : below ? "right"
                : "left",
        lying ? (below ? "-0.5,0" : "0.5,0") : (below ? "0,-0.6" : "0,0.5"),
        PARIAN_CHART_LABEL_FONT);
}

/* Values of all bars, where these are broad enough for it. */
static void put_values(parian_chart_text *out, const bars *b)
{
    const parian_bar_chart *c = b->chart;
    double width = parian_chart_text_width(VALUE_COLUMNS, PARIAN_CHART_LABEL_FONT);
    double need = c->lying ? PARIAN_CHART_LABEL_FONT * 1.2 : 0.7 * width;
    size_t tag = 10;
    for (size_t s = 0; b->bar >= need && s < c->series_count; s++) {
        for (size_t g = 0; g < c->group_count; g++) {
            double v = c->series[s].values[g], from, to;
            if (parian_chart_axis_takes(c->logarithmic, v)) {
                bar_sides(b, g, s, &from, &to);
                put_value(out, b, tag++, v, 0.5 * (from + to));
            }
        }
    }
}

static bool has_bars(const bars *b, size_t series)
{
    size_t count = 0;
    for (size_t g = 0; g < b->chart->group_count; g++) {
        count += parian_chart_axis_takes(b->chart->logarithmic, b->chart->series[series].values[g]);
    }
    return count > 0;
}

static void put_plot_command(parian_chart_text *out, const bars *b)
{
    const parian_bar_chart *c = b->chart;
    size_t block = 0;
    parian_chart_text_put(out, "plot ");
    for (size_t s = 0; s < c->series_count; s++) {
        if (has_bars(b, s)) {
            parian_chart_text_put(out, "data index %zu using 1:2:3:4:5:6 with boxxyerror", block++);
        } else {
            parian_chart_text_put(out, "NaN with boxes");
        }
        parian_chart_text_put(out, " ls %zu fillstyle solid 1 noborder title ", s + 1);
        parian_chart_text_put_quoted(out, c->series[s].name, PARIAN_CHART_NAME_COLUMNS);
        parian_chart_text_put(out, "%s", s + 1 < c->series_count ? ", \\\n    " : "");
    }
    if (c->series_count == 0) {
        parian_chart_text_put(out, "NaN notitle");
    }
}

static void put_script(parian_chart_text *out, const bars *b, const char *name)
{
    const parian_bar_chart *c = b->chart;
    parian_chart_text command = {.env = out->env};
    parian_gnuplot_begin(out, name);
    parian_chart_put_styles(out, c->series_count);
    parian_chart_put_frame(
        out, &(parian_chart_frame){
                 PARIAN_CHART_WIDTH, b->height, b->frame.x0, PARIAN_CHART_WIDTH - b->frame.x1,
                 b->frame.y0, b->height - b->frame.y1, c->title, c->lying ? c->value_label : "",
                 c->lying ? "" : c->value_label, c->note, b->left_out_text});
    parian_chart_axis_put(out, &b->axis, c->lying ? 'x' : 'y');
    put_group_axis(out, b);
    if (b->axis.low < 0 && b->axis.high > 0 && !c->logarithmic) {
        parian_chart_text_put(out, "set %czeroaxis lt 1 lc rgb '#606060' lw 1\n",
                              c->lying ? 'y' : 'x');
    }
    if (b->legend) {
        parian_chart_text_put(out,
                              "set key at screen %.6g,%.6g left top Left reverse samplen 1.5 "
                              "spacing 1.25 maxcols 1\n",
                              (b->frame.x1 + 2) / PARIAN_CHART_WIDTH, b->frame.y1 / b->height);
    } else {
        parian_chart_text_put(out, "unset key\n");
    }
    put_values(out, b);
    if (b->drawn == 0) {
        parian_chart_text_put(
            out, "set label 3 'no data' at graph 0.5,0.5 center textcolor rgb '#606060'\n");
    }
    put_plot_command(&command, b);
    parian_gnuplot_finish(out, PARIAN_CHART_WIDTH, b->height, command.text ? command.text : "");
    out->failed = out->failed || command.failed;
    parian_chart_text_free(&command);
}

parian_result parian_bar_chart_write(const parian_env *env, const char *folder, const char *name,
                                     const parian_bar_chart *chart)
{
    bars b = {.chart = chart};
    parian_chart_text script = {.env = env}, data = {.env = env};
    parian_result result = parian_gnuplot_check_name(env, name);
    result = result == PARIAN_OK ? check(env, chart) : result;
    if (result != PARIAN_OK) {
        return result;
    }
    arrange(&b);
    put_script(&script, &b, name);
    put_data(&data, &b);
    result = parian_gnuplot_draw(env, folder, name, &script, &data);
    if (b.left_out) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "bar chart '%s': %zu values are left out; '%s.dat' has them", name, b.left_out,
                   name);
    }
    parian_chart_text_free(&script);
    parian_chart_text_free(&data);
    return result;
}
