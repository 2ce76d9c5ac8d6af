/* results_table.h - the rows of results.csv, and what can be read from them: equal time, equal
 * error.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_RESULTS_TABLE_H
#define PARIAN_MEASURE_RESULTS_TABLE_H

#include <stdint.h>

#include "tests/measure/radiosity_metrics.h"

enum { PARIAN_RESULT_TEXT_MAX = 512 };

/* One asset, method, light set and channel. */
typedef struct parian_measure_row {
    char asset[PARIAN_RESULT_TEXT_MAX]; /* model and settings of the bake: unique in a run */
    char model[PARIAN_RESULT_TEXT_MAX], bake[PARIAN_RESULT_TEXT_MAX];
    char method[PARIAN_RESULT_TEXT_MAX], lights[PARIAN_RESULT_TEXT_MAX];
    char reference[64], backend[64];
    int channel; /* 0 to 2 */
    parian_radiosity_metrics error;
    double irradiance_l2; /* of E against the truth's E */
    double transport_l2;  /* of B against exact transport of the method's own E, on the asset */
    double relight_ms, bake_s; /* NaN where not known */
    uint64_t asset_bytes, vertices, texels, factors, receivers;
} parian_measure_row;

/* Rows that follow each other, three channels for each measurement. */
typedef struct parian_results {
    parian_measure_row *row;
    size_t count, capacity;
} parian_results;

void parian_results_free(const parian_env *env, parian_results *results);
/* Append a copy. Errors: PARIAN_E_NOMEM. */
parian_result parian_results_add(const parian_env *env, parian_results *results,
                                 const parian_measure_row *row);

/* Text made as it grows; free with parian_free. */
typedef struct parian_text {
    const parian_env *env;
    char *text; /* NUL-terminated, or NULL while empty */
    size_t length, capacity;
    int failed; /* no memory */
} parian_text;
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void parian_text_add(parian_text *text, const char *format, ...);
/* A field of a CSV line: quoted where it holds a comma, a quote or a line end. */
void parian_text_add_field(parian_text *text, const char *field);
/* Write a text to a file, and free it. Errors: PARIAN_E_NOMEM, PARIAN_E_IO. */
parian_result parian_text_write(parian_text *text, const char *path);

/* results.csv: a line of names and a line for each row. */
void parian_results_csv(const parian_results *results, parian_text *text);
extern const char *const parian_channel_names[3];

/* A measurement: its three channels as one, with the worst of each error. */
typedef struct parian_measurement {
    const parian_measure_row *row;              /* the first channel's */
    double l1, l2, p999, minimum, energy_ratio; /* energy_ratio: the one farthest from 1 */
    double truth_error, irradiance_l2, transport_l2;
    size_t not_finite;
} parian_measurement;
size_t parian_measurement_count(const parian_results *results);
parian_measurement parian_measurement_at(const parian_results *results, size_t index);

/* Budgets of the readings: milliseconds, and shares of error. */
enum { PARIAN_TIME_BUDGETS = 4, PARIAN_ERROR_BUDGETS = 5 };
extern const double parian_time_budget_ms[PARIAN_TIME_BUDGETS];
extern const double parian_error_budget[PARIAN_ERROR_BUDGETS];

/* Among the measurements of one model, light set and truth (those that agree with measurement
 * `like`): the one of least l2 that relights within ms, and the one that relights soonest with l2
 * within error. SIZE_MAX: none. */
size_t parian_results_best_within(const parian_results *results, size_t like, double ms);
size_t parian_results_cheapest_under(const parian_results *results, size_t like, double error);
/* Whether measurement b is of the same model, light set and truth as a. */
int parian_measurements_comparable(const parian_results *results, size_t a, size_t b);
/* Whether measurement `index` is the first of its kind in that sense. */
int parian_measurement_leads(const parian_results *results, size_t index);

/* The table for people, in lines of up to 100 columns; markdown: with bars between the columns. */
void parian_results_summary(const parian_results *results, int markdown, parian_text *text);
void parian_results_readings(const parian_results *results, int markdown, parian_text *text);

#endif
