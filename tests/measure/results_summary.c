/* results_summary.c - measurements as tables for people.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/results_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NAME_WIDTH = 34, CELL = 64 };

/* The end of a long name carries what tells it from others: keep it, behind dots. */
static void shorten(const char *name, size_t width, char out[CELL])
{
    size_t n = strlen(name);
    if (n <= width) {
        snprintf(out, CELL, "%s", name);
    } else {
        snprintf(out, CELL, "..%s", name + n - (width - 2));
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
    char name[2 * PARIAN_RESULT_TEXT_MAX + 2], cell[CELL], seconds[16] = "-";
    const parian_measure_row *row = m->row;
    name_of(row, name, sizeof name);
    if (!isnan(row->bake_s)) {
        snprintf(seconds, sizeof seconds, "%.1f", row->bake_s);
    }
    if (markdown) {
        parian_text_add(
            text, "| `%s` | %s | %.2f | %.2f | %.4f | %.2f | %.3f | %.3g | %.2f | %s |\n", name,
            row->backend, 100 * m->l1, 100 * m->l2, m->energy_ratio, 100 * m->p999, m->minimum,
            row->relight_ms, (double)row->asset_bytes * 1e-6, seconds);
        return;
    }
    shorten(name, NAME_WIDTH, cell);
    parian_text_add(text, "%-*s %6.2f %6.2f %7.4f %7.2f %6.3f %9.3g %7.2f %7s\n", NAME_WIDTH, cell,
                    100 * m->l1, 100 * m->l2, m->energy_ratio, 100 * m->p999, m->minimum,
                    row->relight_ms, (double)row->asset_bytes * 1e-6, seconds);
}

static void add_names(int markdown, parian_text *text)
{
    if (markdown) {
        parian_text_add(text, "| method, bake | backend | L1 %% | L2 %% | energy | p99.9 %% | "
                              "least | relight ms | MB | "
                              "bake s |\n|---|---|---|---|---|---|---|---|---|---|\n");
    } else {
        parian_text_add(text, "%-*s %6s %6s %7s %7s %6s %9s %7s %7s\n", NAME_WIDTH, "method, bake",
                        "L1 %", "L2 %", "energy", "p99.9%", "least", "ms", "MB", "bake s");
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
    char name[2 * PARIAN_RESULT_TEXT_MAX + 2] = "none", cell[CELL], l2[16] = "-", ms[16] = "-",
                                           mb[16] = "-";
    if (found != SIZE_MAX) {
        parian_measurement m = parian_measurement_at(results, found);
        name_of(m.row, name, sizeof name);
        snprintf(l2, sizeof l2, "%.2f", 100 * m.l2);
        snprintf(ms, sizeof ms, "%.3g", m.row->relight_ms);
        snprintf(mb, sizeof mb, "%.2f", (double)m.row->asset_bytes * 1e-6);
    }
    if (markdown) {
        parian_text_add(text, "| %s | `%s` | %s | %s | %s |\n", budget, name, l2, ms, mb);
    } else {
        shorten(name, NAME_WIDTH, cell);
        parian_text_add(text, "%-22s %-*s %8s %9s %8s\n", budget, NAME_WIDTH, cell, l2, ms, mb);
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
            parian_text_add(text, "%-22s %-*s %8s %9s %8s\n", "budget", NAME_WIDTH, "best", "L2 %",
                            "ms", "MB");
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
