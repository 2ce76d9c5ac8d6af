/* results_table.c - rows of measurements as CSV, and the choices that they allow.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/results_table.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"

const double parian_time_budget_ms[PARIAN_TIME_BUDGETS] = {1, 10, 100, 1000};
const double parian_error_budget[PARIAN_ERROR_BUDGETS] = {0.005, 0.01, 0.02, 0.05, 0.10};
const char *const parian_channel_names[3] = {"r", "g", "b"};

/* ---- rows
 * ----------------------------------------------------------------------------------------------------
 */
void parian_results_free(const parian_env *env, parian_results *results)
{
    parian_free(env, results->row);
    *results = (parian_results){0};
}

parian_result parian_results_add(const parian_env *env, parian_results *results,
                                 const parian_measure_row *row)
{
    if (results->count == results->capacity) {
        size_t capacity = 2 * results->capacity + 48;
        parian_measure_row *grown = parian_alloc(env, capacity, sizeof *grown);
        if (!grown) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu results", capacity);
        }
        if (results->count > 0) {
            memcpy(grown, results->row, results->count * sizeof *grown);
        }
        parian_free(env, results->row);
        results->row = grown;
        results->capacity = capacity;
    }
    results->row[results->count++] = *row;
    return PARIAN_OK;
}

/* ---- text
 * ----------------------------------------------------------------------------------------------------
 */
static bool reserve(parian_text *text, size_t more)
{
    if (text->failed) {
        return false;
    }
    if (text->length + more + 1 > text->capacity) {
        size_t capacity = 2 * text->capacity + more + 1024;
        char *grown = parian_alloc(text->env, capacity, 1);
        if (!grown) {
            text->failed = 1;
            return false;
        }
        memcpy(grown, text->text ? text->text : "", text->length + (text->text != NULL));
        parian_free(text->env, text->text);
        text->text = grown;
        text->capacity = capacity;
    }
    return true;
}

void parian_text_add(parian_text *text, const char *format, ...)
{
    va_list list, again;
    va_start(list, format);
    va_copy(again, list);
    int size = vsnprintf(NULL, 0, format, list);
    if (size >= 0 && reserve(text, (size_t)size)) {
        vsnprintf(text->text + text->length, (size_t)size + 1, format, again);
        text->length += (size_t)size;
    }
    va_end(again);
    va_end(list);
}

void parian_text_add_field(parian_text *text, const char *field)
{
    if (!strpbrk(field, ",\"\n\r")) {
        parian_text_add(text, "%s", field);
        return;
    }
    parian_text_add(text, "\"");
    for (; *field; field++) {
        if (*field == '"') {
            parian_text_add(text, "\"\"");
        } else {
            parian_text_add(text, "%c", *field);
        }
    }
    parian_text_add(text, "\"");
}

parian_result parian_text_write(parian_text *text, const char *path)
{
    parian_result r =
        text->failed
            ? parian_fail(text->env, PARIAN_E_NOMEM, "%s: no memory for its text", path)
            : parian_file_write(text->env, path, text->text ? text->text : "", text->length);
    parian_free(text->env, text->text);
    *text = (parian_text){.env = text->env};
    return r;
}

/* ---- results.csv
 * --------------------------------------------------------------------------------------------- */
/* A number, or an empty field where it is not known. */
static void add_number(parian_text *text, double value)
{
    if (isnan(value)) {
        parian_text_add(text, ",");
    } else {
        parian_text_add(text, ",%.9g", value);
    }
}

static void add_text(parian_text *text, const char *field)
{
    parian_text_add(text, ",");
    parian_text_add_field(text, field);
}

static void add_count(parian_text *text, uint64_t count)
{
    parian_text_add(text, ",%llu", (unsigned long long)count);
}

static void add_row(parian_text *text, const parian_measure_row *row)
{
    parian_text_add_field(text, row->asset);
    add_text(text, row->method);
    add_text(text, row->lights);
    add_text(text, row->reference);
    add_text(text, parian_channel_names[row->channel]);
    add_number(text, row->error.l1);
    add_number(text, row->error.l2);
    add_number(text, row->error.energy_ratio);
    add_number(text, row->error.p999);
    add_number(text, row->error.minimum);
    add_number(text, row->relight_ms);
    add_count(text, row->asset_bytes);
    add_number(text, row->bake_s);
    add_text(text, row->model);
    add_text(text, row->bake);
    add_text(text, row->backend);
    add_count(text, row->vertices);
    add_count(text, row->texels);
    add_count(text, row->factors);
    add_count(text, row->receivers);
    add_number(text, row->error.truth_error);
    add_number(text, row->irradiance_l2);
    add_number(text, row->transport_l2);
    add_count(text, row->error.not_finite);
    parian_text_add(text, "\n");
}

void parian_results_csv(const parian_results *results, parian_text *text)
{
    parian_text_add(
        text, "asset,method,lights,reference,channel,l1,l2,energy_ratio,p999,minimum,relight_ms,"
              "asset_bytes,bake_s,model,bake,backend,vertices,texels,factors,receivers,"
              "truth_standard_error,irradiance_l2,transport_l2,not_finite\n");
    for (size_t i = 0; i < results->count; i++) {
        add_row(text, &results->row[i]);
    }
}

/* ---- measurements
 * -------------------------------------------------------------------------------------------- */
size_t parian_measurement_count(const parian_results *results)
{
    return results->count / 3;
}

static double worse(double a, double b)
{
    return isnan(a) || a > b ? a : b; /* NaN is the worst of all */
}

parian_measurement parian_measurement_at(const parian_results *results, size_t index)
{
    const parian_measure_row *row = &results->row[3 * index];
    parian_measurement m = {.row = row, .energy_ratio = 1, .minimum = INFINITY};
    for (int c = 0; c < 3; c++) {
        const parian_radiosity_metrics *e = &row[c].error;
        m.l1 = worse(e->l1, m.l1);
        m.l2 = worse(e->l2, m.l2);
        m.p999 = worse(e->p999, m.p999);
        m.truth_error = worse(e->truth_error, m.truth_error);
        m.irradiance_l2 = worse(row[c].irradiance_l2, m.irradiance_l2);
        m.transport_l2 = worse(row[c].transport_l2, m.transport_l2);
        m.minimum = fmin(m.minimum, e->minimum);
        m.not_finite += e->not_finite;
        if (!(fabs(e->energy_ratio - 1) <= fabs(m.energy_ratio - 1))) {
            m.energy_ratio = e->energy_ratio;
        }
    }
    return m;
}

int parian_measurements_comparable(const parian_results *results, size_t a, size_t b)
{
    const parian_measure_row *x = &results->row[3 * a], *y = &results->row[3 * b];
    return strcmp(x->model, y->model) == 0 && strcmp(x->lights, y->lights) == 0 &&
           strcmp(x->reference, y->reference) == 0;
}

int parian_measurement_leads(const parian_results *results, size_t index)
{
    for (size_t i = 0; i < index; i++) {
        if (parian_measurements_comparable(results, i, index)) {
            return 0;
        }
    }
    return 1;
}

size_t parian_results_best_within(const parian_results *results, size_t like, double ms)
{
    size_t best = SIZE_MAX;
    double least = INFINITY;
    for (size_t i = 0; i < parian_measurement_count(results); i++) {
        parian_measurement m = parian_measurement_at(results, i);
        bool in = parian_measurements_comparable(results, like, i) && m.row->relight_ms <= ms &&
                  m.not_finite == 0;
        if (in && m.l2 < least) {
            least = m.l2;
            best = i;
        }
    }
    return best;
}

size_t parian_results_cheapest_under(const parian_results *results, size_t like, double error)
{
    size_t best = SIZE_MAX;
    double least = INFINITY;
    for (size_t i = 0; i < parian_measurement_count(results); i++) {
        parian_measurement m = parian_measurement_at(results, i);
        bool in =
            parian_measurements_comparable(results, like, i) && m.l2 <= error && m.not_finite == 0;
        if (in && m.row->relight_ms < least) {
            least = m.row->relight_ms;
            best = i;
        }
    }
    return best;
}
