/* results_summary.c - measurements as tables for people.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/results_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_WIDTH = 26, CELL = 64 };

/* Three digits, and no exponent above a second. */
static void format_ms(double ms, char text[CELL])
{
    snprintf(text, CELL, ms < 100 ? "%.3g" : "%.0f", ms);
}

/* A name in its column; one that is too long has a line of its own. */
static void add_name(const char *name, parian_text *text)
{
    if (strlen(name) <= NAME_WIDTH) {
        parian_text_add(text, "%-*s", NAME_WIDTH, name);
    } else {
        parian_text_add(text, "%s\n%-*s", name, NAME_WIDTH, "");
    }
}

static void add_heading(const parian_results *results, size_t index, int markdown,
                        parian_text *text)
{
    const parian_measure_row *row = parian_measurement_at(results, index).row;
    parian_text_add(text,
                    markdown ? "\n**%s**, lights `%s`, truth `%s`, %llu receivers\n\n"
                             : "\n%s, lights %s, truth %s, %llu receivers\n",
                    row->model, row->lights, row->reference, (unsigned long long)row->receivers);
}

/* What tells measurements of one model apart: the bake and the method. */
static void name_of(const parian_measure_row *row, char *name, size_t size)
{
    snprintf(name, size, "%s%s%s", row->method, *row->bake ? " " : "", row->bake);
}

static void add_line(const parian_measurement *m, int markdown, parian_text *text)
{
    char name[2 * PARIAN_RESULT_TEXT_MAX + 2], seconds[16] = "-", ms[CELL];
    const parian_measure_row *row = m->row;
    name_of(row, name, sizeof name);
    format_ms(row->relight_ms, ms);
    if (!isnan(row->bake_s)) {
        snprintf(seconds, sizeof seconds, "%.1f", row->bake_s);
    }
    if (markdown) {
        parian_text_add(
            text,
            "| `%s` | %s | %.2f | %.2f | %.2f | %.2f | %.4f | %.2f | %.3f | %s | %.2f | %s |\n",
            name, row->backend, 100 * m->l1, 100 * m->l2, 100 * m->irradiance_l2,
            100 * m->transport_l2, m->energy_ratio, 100 * m->p999, m->minimum, ms,
            (double)row->asset_bytes * 1e-6, seconds);
        return;
    }
    add_name(name, text);
    parian_text_add(text, " %6.2f %6.2f %6.2f %6.2f %7.4f %7.2f %6.3f %8s %7.2f %6s\n", 100 * m->l1,
                    100 * m->l2, 100 * m->irradiance_l2, 100 * m->transport_l2, m->energy_ratio,
                    100 * m->p999, m->minimum, ms, (double)row->asset_bytes * 1e-6, seconds);
    if (m->not_finite > 0) {
        parian_text_add(text, "  %zu values of B are not finite, and left out\n", m->not_finite);
    }
}

static void add_names(int markdown, parian_text *text)
{
    if (markdown) {
        parian_text_add(
            text,
            "| method, bake | backend | L1 %% | L2 %% | E %% | own E %% | energy | p99.9 %% | "
            "least | relight ms | MB | "
            "bake s |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
    } else {
        parian_text_add(text, "%-*s %6s %6s %6s %6s %7s %7s %6s %8s %7s %6s\n", NAME_WIDTH,
                        "method, bake", "L1 %", "L2 %", "E %", "own E%", "energy", "p99.9%",
                        "least", "ms", "MB", "bake s");
    }
}

void parian_results_summary(const parian_results *results, int markdown, parian_text *text)
{
    size_t count = parian_measurement_count(results);
    for (size_t i = 0; i < count; i++) {
        if (!parian_measurement_leads(results, i)) {
            continue;
        }
        add_heading(results, i, markdown, text);
        add_names(markdown, text);
        for (size_t k = i; k < count; k++) {
            parian_measurement m = parian_measurement_at(results, k);
            if (parian_measurements_comparable(results, i, k)) {
                add_line(&m, markdown, text);
            }
        }
    }
}

static void add_reading(const parian_results *results, const char *budget, size_t found,
                        int markdown, parian_text *text)
{
    char name[2 * PARIAN_RESULT_TEXT_MAX + 2] = "none", l2[16] = "-", ms[CELL] = "-", mb[16] = "-";
    if (found != SIZE_MAX) {
        parian_measurement m = parian_measurement_at(results, found);
        name_of(m.row, name, sizeof name);
        snprintf(l2, sizeof l2, "%.2f", 100 * m.l2);
        format_ms(m.row->relight_ms, ms);
        snprintf(mb, sizeof mb, "%.2f", (double)m.row->asset_bytes * 1e-6);
    }
    if (markdown) {
        parian_text_add(text, "| %s | `%s` | %s | %s | %s |\n", budget, name, l2, ms, mb);
    } else {
        parian_text_add(text, "%-16s %7s %9s %8s  %s\n", budget, l2, ms, mb, name);
    }
}

void parian_results_readings(const parian_results *results, int markdown, parian_text *text)
{
    char budget[CELL];
    for (size_t i = 0; i < parian_measurement_count(results); i++) {
        if (!parian_measurement_leads(results, i)) {
            continue;
        }
        add_heading(results, i, markdown, text);
        if (markdown) {
            parian_text_add(text,
                            "| budget | best | L2 %% | relight ms | MB |\n|---|---|---|---|---|\n");
        } else {
            parian_text_add(text, "%-16s %7s %9s %8s  %s\n", "budget", "L2 %", "ms", "MB", "best");
        }
        for (int b = 0; b < PARIAN_TIME_BUDGETS; b++) {
            snprintf(budget, sizeof budget, "within %g ms", parian_time_budget_ms[b]);
            add_reading(results, budget,
                        parian_results_best_within(results, i, parian_time_budget_ms[b]), markdown,
                        text);
        }
        for (int b = 0; b < PARIAN_ERROR_BUDGETS; b++) {
            snprintf(budget, sizeof budget, "L2 within %g %%", 100 * parian_error_budget[b]);
            add_reading(results, budget,
                        parian_results_cheapest_under(results, i, parian_error_budget[b]), markdown,
                        text);
        }
    }
}
