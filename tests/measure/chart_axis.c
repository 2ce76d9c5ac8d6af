/* chart_axis.c - the range of an axis around its data, and ticks at round numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/chart_axis.h"

#include <math.h>

/* Beyond these, differences and ratios of values leave the range of double. */
static const double VALUE_MAX = 1e100, POSITIVE_MIN = 1e-100;
enum { LINEAR_TICKS = 6, DECADES_LABELLED_MAX = 8 };

bool parian_chart_axis_takes(bool logarithmic, double value)
{
    return logarithmic ? value >= POSITIVE_MIN && value <= VALUE_MAX : fabs(value) <= VALUE_MAX;
}

/* 1, 2 or 5 times a power of ten, about span / LINEAR_TICKS. */
static double round_step(double span)
{
    double raw = span / LINEAR_TICKS, power = pow(10, floor(log10(raw))), mantissa = raw / power;
    return power * (mantissa < 1.5 ? 1 : mantissa < 3.5 ? 2 : mantissa < 7.5 ? 5 : 10);
}

static parian_chart_axis fit_logarithmic(double smallest, double largest)
{
    if (smallest > largest) {
        return (parian_chart_axis){true, 0.1, 10};
    }
    double decades = log10(largest) - log10(smallest),
           room = fmax(0.06 * decades, 0.5 * (0.4 - decades));
    double factor = pow(10, fmax(room, 0.07));
    return (parian_chart_axis){true, smallest / factor, largest * factor};
}

static parian_chart_axis fit_linear(double smallest, double largest, bool from_zero)
{
    if (smallest > largest) {
        return (parian_chart_axis){false, 0, 1};
    }
    double size = fmax(fabs(smallest), fabs(largest)), span = largest - smallest;
    bool zero_below = smallest >= 0 && (from_zero || smallest < span);
    bool zero_above = largest <= 0 && (from_zero || -largest < span);
    if (!(span > 1e-9 * size)) { /* one value */
        span = size > 0 ? size : 1;
    }
    double low = zero_below ? 0 : smallest - 0.05 * span,
           high = zero_above ? 0 : largest + 0.05 * span;
    if (!(high > low)) {
        high = low + 1;
    }
    double step = round_step(high - low);
    return (parian_chart_axis){false, step * floor(low / step + 1e-9),
                               step * ceil(high / step - 1e-9)};
}

parian_chart_axis parian_chart_axis_fit(bool logarithmic, double smallest, double largest,
                                        bool from_zero)
{
    return logarithmic ? fit_logarithmic(smallest, largest)
                       : fit_linear(smallest, largest, from_zero);
}

double parian_chart_axis_place(const parian_chart_axis *axis, double value)
{
    return axis->logarithmic
               ? (log10(value) - log10(axis->low)) / (log10(axis->high) - log10(axis->low))
               : (value - axis->low) / (axis->high - axis->low);
}

double parian_chart_axis_value(const parian_chart_axis *axis, double place)
{
    return axis->logarithmic
               ? pow(10, log10(axis->low) + place * (log10(axis->high) - log10(axis->low)))
               : axis->low + place * (axis->high - axis->low);
}

static void add_tick(const parian_chart_axis *axis, parian_chart_tick *ticks, size_t *count,
                     double value, bool labelled)
{
    double slack = axis->logarithmic ? 1e-9 * value : 1e-9 * (axis->high - axis->low);
    if (value >= axis->low - slack && value <= axis->high + slack &&
        *count < PARIAN_CHART_TICKS_MAX) {
        ticks[(*count)++] = (parian_chart_tick){value, labelled};
    }
}

static size_t linear_ticks(const parian_chart_axis *axis, parian_chart_tick *ticks)
{
    size_t count = 0;
    double step = round_step(axis->high - axis->low);
    for (double i = ceil(axis->low / step - 1e-6); i <= axis->high / step + 1e-6; i++) {
        add_tick(axis, ticks, &count, i * step, true);
    }
    return count;
}

/* Powers of ten, every n-th labelled; 2 and 5 as well where there are few, all the rest as small
 * ticks. */
static size_t decade_ticks(const parian_chart_axis *axis, double decades, parian_chart_tick *ticks)
{
    size_t count = 0;
    int first = (int)floor(log10(axis->low)), last = (int)ceil(log10(axis->high));
    int every = (int)ceil(decades / DECADES_LABELLED_MAX), between = decades <= 7 ? 9 : 1;
    for (int d = first; d <= last; d++) {
        for (int m = 1; m <= between; m++) {
            bool labelled = (m == 1 && d % every == 0) || (decades < 2.3 && (m == 2 || m == 5)) ||
                            (decades < 1.2 && (m == 3 || m == 7));
            add_tick(axis, ticks, &count, m * pow(10, d), labelled);
        }
    }
    return count;
}

size_t parian_chart_axis_ticks(const parian_chart_axis *axis,
                               parian_chart_tick ticks[PARIAN_CHART_TICKS_MAX])
{
    double decades = axis->logarithmic ? log10(axis->high) - log10(axis->low) : 0;
    return decades > 0.6 ? decade_ticks(axis, decades, ticks) : linear_ticks(axis, ticks);
}

void parian_chart_axis_put(parian_chart_text *out, const parian_chart_axis *axis, char letter)
{
    parian_chart_tick ticks[PARIAN_CHART_TICKS_MAX];
    size_t count = parian_chart_axis_ticks(axis, ticks);
    parian_chart_text_put(
        out, "%sset logscale %c\nset %crange [%.12g:%.12g] noextend\nset %ctics (",
        axis->logarithmic ? "" : "un", letter, letter, axis->low, axis->high, letter);
    for (size_t i = 0; i < count; i++) {
        double value = fabs(ticks[i].value) < 1e-12 * (axis->high - axis->low) ? 0 : ticks[i].value;
        parian_chart_text_put(out, "%s'", i ? ", " : "");
        if (ticks[i].labelled) {
            parian_chart_text_put_number(out, value);
        }
        parian_chart_text_put(out, "' %.12g%s", value, ticks[i].labelled ? "" : " 1");
    }
    parian_chart_text_put(out, ")\n");
}
