/* measure_report.c - writes what a run found: tables, plots, and how it was measured.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "tests/measure/measure_run.h"
#include "tests/measure/plot.h"
#include "tool/files.h"

/* ---- results.json
 * -------------------------------------------------------------------------------------------- */
/* NaN has no JSON. */
static void add_number(cJSON *object, const char *key, double value)
{
    if (isfinite(value)) {
        cJSON_AddNumberToObject(object, key, value);
    } else {
        cJSON_AddNullToObject(object, key);
    }
}

static void add_channels(cJSON *object, const parian_measure_row *row)
{
    cJSON *list = cJSON_AddArrayToObject(object, "channels");
    for (int c = 0; c < 3; c++) {
        cJSON *o = cJSON_CreateObject();
        const parian_radiosity_metrics *e = &row[c].error;
        cJSON_AddStringToObject(o, "channel", parian_channel_names[c]);
        add_number(o, "l1", e->l1);
        add_number(o, "l2", e->l2);
        add_number(o, "energy_ratio", e->energy_ratio);
        add_number(o, "p999", e->p999);
        add_number(o, "minimum", e->minimum);
        add_number(o, "truth_standard_error", e->truth_error);
        add_number(o, "irradiance_l2", row[c].irradiance_l2);
        add_number(o, "transport_l2", row[c].transport_l2);
        cJSON_AddNumberToObject(o, "not_finite", (double)e->not_finite);
        cJSON_AddItemToArray(list, o);
    }
}

static void add_times(cJSON *object, const parian_relight_times *times)
{
    cJSON *o = cJSON_AddObjectToObject(object, "relight");
    cJSON_AddNumberToObject(o, "median_ms", times->median_ms);
    cJSON_AddNumberToObject(o, "minimum_ms", times->minimum_ms);
    cJSON_AddNumberToObject(o, "maximum_ms", times->maximum_ms);
    cJSON_AddNumberToObject(o, "repeats", times->repeats);
    cJSON *passes = cJSON_AddObjectToObject(o, "pass_ms");
    for (size_t p = 0; p < times->pass_count; p++) {
        cJSON_AddNumberToObject(passes, times->pass[p].name, times->pass[p].ms);
    }
}

static void add_truth(cJSON *object, const parian_measure_case *c,
                      const parian_reference_result *truth, bool cached)
{
    cJSON *o = cJSON_AddObjectToObject(object, "truth");
    cJSON_AddStringToObject(o, "model", parian_reference_model_name(c->truth.model));
    cJSON_AddStringToObject(o, "surface", c->asset->from_model ? "model" : "asset");
    cJSON_AddBoolToObject(o, "fit_fdr", c->truth.fit_fdr);
    cJSON_AddBoolToObject(o, "normalised", c->truth.normalise);
    cJSON_AddNumberToObject(o, "samples", (double)truth->samples);
    cJSON_AddNumberToObject(o, "seconds", truth->seconds);
    cJSON_AddBoolToObject(o, "from_cache", cached);
}

void parian_measure_note(parian_measure_run *run, const parian_measure_case *c, const char *method,
                         const parian_relight_times *times, const parian_reference_result *truth,
                         bool truth_cached)
{
    const parian_measure_row *row = &run->results.row[run->results.count - 3];
    cJSON *o = cJSON_CreateObject();
    cJSON_AddStringToObject(o, "asset", row->asset);
    cJSON_AddStringToObject(o, "model", row->model);
    cJSON_AddStringToObject(o, "bake", row->bake);
    cJSON_AddStringToObject(o, "method", method);
    cJSON_AddStringToObject(o, "lights", row->lights);
    cJSON_AddStringToObject(o, "medium", parian_relit_bodies(c->relit)[0].medium.name);
    cJSON_AddNumberToObject(o, "asset_bytes", (double)row->asset_bytes);
    add_number(o, "bake_s", row->bake_s);
    cJSON_AddBoolToObject(o, "bake_from_cache", c->asset->cached);
    cJSON_AddNumberToObject(o, "vertices", (double)row->vertices);
    cJSON_AddNumberToObject(o, "texels", (double)row->texels);
    cJSON_AddNumberToObject(o, "factors", (double)row->factors);
    cJSON_AddNumberToObject(o, "renderer_bytes",
                            (double)parian_renderer_memory(c->relit->renderer));
    cJSON_AddNumberToObject(o, "receivers", (double)row->receivers);
    add_times(o, times);
    add_truth(o, c, truth, truth_cached);
    add_channels(o, row);
    cJSON_AddItemToArray(run->measurements, o);
}

static void add_reading(cJSON *list, const parian_results *results, size_t like, const char *key,
                        double budget, size_t found)
{
    const parian_measure_row *row = parian_measurement_at(results, like).row;
    cJSON *o = cJSON_CreateObject();
    cJSON_AddStringToObject(o, "model", row->model);
    cJSON_AddStringToObject(o, "lights", row->lights);
    cJSON_AddStringToObject(o, "reference", row->reference);
    cJSON_AddNumberToObject(o, key, budget);
    if (found == SIZE_MAX) {
        cJSON_AddNullToObject(o, "asset");
    } else {
        parian_measurement m = parian_measurement_at(results, found);
        cJSON_AddStringToObject(o, "asset", m.row->asset);
        cJSON_AddStringToObject(o, "method", m.row->method);
        add_number(o, "l2", m.l2);
        cJSON_AddNumberToObject(o, "relight_ms", m.row->relight_ms);
        cJSON_AddNumberToObject(o, "asset_bytes", (double)m.row->asset_bytes);
    }
    cJSON_AddItemToArray(list, o);
}

static void add_readings(cJSON *root, const parian_results *results)
{
    cJSON *time = cJSON_AddArrayToObject(root, "equal_time"),
          *error = cJSON_AddArrayToObject(root, "equal_error");
    for (size_t i = 0; i < parian_measurement_count(results); i++) {
        for (int b = 0; parian_measurement_leads(results, i) && b < PARIAN_TIME_BUDGETS; b++) {
            add_reading(time, results, i, "within_ms", parian_time_budget_ms[b],
                        parian_results_best_within(results, i, parian_time_budget_ms[b]));
        }
        for (int b = 0; parian_measurement_leads(results, i) && b < PARIAN_ERROR_BUDGETS; b++) {
            add_reading(error, results, i, "l2_within", parian_error_budget[b],
                        parian_results_cheapest_under(results, i, parian_error_budget[b]));
        }
    }
}

static parian_result write_json(const parian_env *env, parian_measure_run *run,
                                const parian_machine *machine)
{
    char path[PARIAN_MEASURE_PATH_MAX], date[64] = "";
    time_t now = time(NULL);
    struct tm utc;
    cJSON *root = cJSON_CreateObject();
    if (gmtime_r(&now, &utc)) {
        strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    }
    cJSON_AddStringToObject(root, "tool", "parian-measure " PARIAN_VERSION);
    cJSON_AddStringToObject(root, "command", run->command);
    cJSON_AddStringToObject(root, "date", date);
    cJSON_AddItemToObject(root, "machine", parian_machine_json(machine));
    cJSON_AddStringToObject(root, "backend", parian_measure_backend_name(run->device.backend));
    cJSON_AddStringToObject(root, "renderer", run->renderer);
    cJSON_AddItemToObject(root, "measurements", run->measurements);
    run->measurements = NULL;
    add_readings(root, &run->results);
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    if (!text || !parian_measure_path(run, "results.json", path)) {
        cJSON_free(text);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for results.json");
    }
    parian_result r = parian_file_write(env, path, text, strlen(text));
    cJSON_free(text);
    return r;
}

/* ---- tables
 * --------------------------------------------------------------------------------------------------
 */
static void describe_run(const parian_measure_run *run, const parian_machine *machine,
                         parian_text *text)
{
    parian_text_add(
        text,
        "# Speed against error\n\n    %s\n\n%s, %u cores, %.0f GiB; %s; relit on %s. "
        "Errors are of B "
        "against the truth, the worst channel's: area-weighted relative L1 and L2, "
        "ratio of energies, "
        "99.9th percentile and smallest value over the mean of the truth; E: L2 of the irradiance; "
        "own E: L2 of B against exact transport of the irradiance that the method found. Times are "
        "medians of whole "
        "relights.\n",
        run->command, machine->processor, machine->cores,
        (double)machine->memory_bytes / (1024.0 * 1024 * 1024), machine->system, run->renderer);
}

static parian_result write_text(parian_measure_run *run, const char *name, parian_text *text)
{
    char path[PARIAN_MEASURE_PATH_MAX];
    parian_measure_path(run, name, path);
    return parian_text_write(text, path);
}

static parian_result write_tables(const parian_env *env, parian_measure_run *run,
                                  const parian_machine *machine)
{
    parian_text csv = {.env = env}, page = {.env = env};
    parian_results_csv(&run->results, &csv);
    describe_run(run, machine, &page);
    parian_results_summary(&run->results, 1, &page);
    parian_text_add(&page, "\n## Equal time, equal error\n");
    parian_results_readings(&run->results, 1, &page);
    parian_result r = write_text(run, "results.csv", &csv);
    parian_result page_result = write_text(run, "results.md", &page);
    return r == PARIAN_OK ? page_result : r;
}

static parian_result print_tables(const parian_env *env, const parian_measure_run *run)
{
    parian_text text = {.env = env};
    parian_results_summary(&run->results, 0, &text);
    parian_results_readings(&run->results, 0, &text);
    bool printed = text.text && fputs(text.text, stdout) >= 0 && fflush(stdout) == 0;
    parian_free(env, text.text);
    return printed ? PARIAN_OK : parian_fail(env, PARIAN_E_IO, "stdout cannot be written");
}

/* ---- plots
 * ---------------------------------------------------------------------------------------------------
 */
typedef enum plot_cost { COST_MS, COST_MB, COST_BAKE } plot_cost;

static double cost_of(const parian_measure_row *row, plot_cost cost)
{
    return cost == COST_MS   ? row->relight_ms
           : cost == COST_MB ? (double)row->asset_bytes * 1e-6
                             : row->bake_s;
}

static int by_cost(const void *a, const void *b)
{
    double x = ((const parian_plot_point *)a)->x, y = ((const parian_plot_point *)b)->x;
    return (x > y) - (x < y);
}

/* Room for all points and names of a plot. */
typedef struct plot_room {
    parian_plot_point *point;   /* [measurements] */
    parian_plot_series *series; /* [measurements] */
    char (*name)[PARIAN_RESULT_TEXT_MAX];
    size_t series_count;
} plot_room;

/* Whether two measurements are points of one line of a plot. */
static bool same_line(const parian_results *results, size_t a, size_t b)
{
    return parian_measurements_comparable(results, a, b) &&
           strcmp(results->row[3 * a].method, results->row[3 * b].method) == 0;
}

static bool begins_line(const parian_results *results, size_t index)
{
    for (size_t i = 0; i < index; i++) {
        if (same_line(results, i, index)) {
            return false;
        }
    }
    return true;
}

/* One line for each model, light set, truth and method, its points by cost; points without a cost
 * are left out. */
static void fill_series(const parian_results *results, plot_cost cost, plot_room *room)
{
    size_t used = 0, count = parian_measurement_count(results);
    room->series_count = 0;
    for (size_t i = 0; i < count; i++) {
        size_t first = used;
        for (size_t k = i; begins_line(results, i) && k < count; k++) {
            parian_measurement m = parian_measurement_at(results, k);
            double x = cost_of(m.row, cost);
            if (same_line(results, i, k) && isfinite(x) && isfinite(m.l2)) {
                room->point[used++] =
                    (parian_plot_point){x, 100 * m.l2, *m.row->bake ? m.row->bake : m.row->method};
            }
        }
        if (used > first) {
            const parian_measure_row *row = parian_measurement_at(results, i).row;
            size_t s = room->series_count++;
            snprintf(room->name[s], sizeof room->name[s], "%.200s, %.100s, %.100s (%s)", row->model,
                     row->lights, row->method, row->reference);
            qsort(room->point + first, used - first, sizeof *room->point, by_cost);
            room->series[s] =
                (parian_plot_series){room->name[s], room->point + first, used - first};
        }
    }
}

static parian_result write_plot(const parian_env *env, parian_measure_run *run, plot_cost cost,
                                plot_room *room)
{
    static const char *const names[] = {"speed-vs-error", "size-vs-error", "bake-vs-error"};
    static const char *const labels[] = {"milliseconds per relight", "asset, MB", "bake, seconds"};
    fill_series(&run->results, cost, room);
    if (room->series_count == 0) {
        return PARIAN_OK;
    }
    const parian_plot plot = {.title = "Error of B against the truth",
                              .x_label = labels[cost],
                              .y_label = "relative L2 error of B, worst channel, %",
                              .log_x = true,
                              .log_y = true,
                              .series = room->series,
                              .series_count = room->series_count};
    parian_result r = parian_plot_write(env, run->options->output, names[cost], &plot);
    if (r == PARIAN_E_UNSUPPORTED) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "%s: there is no gnuplot to draw it; script and data are written", names[cost]);
        return PARIAN_OK;
    }
    return r;
}

static parian_result write_plots(const parian_env *env, parian_measure_run *run)
{
    size_t count = parian_measurement_count(&run->results);
    plot_room room = {0};
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, room.point, count) || !PARIAN_NEW(env, room.series, count) ||
        !PARIAN_NEW(env, room.name, count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for the plots");
    }
    for (int cost = COST_MS; r == PARIAN_OK && cost <= COST_BAKE; cost++) {
        r = write_plot(env, run, (plot_cost)cost, &room);
    }
    parian_free(env, room.point);
    parian_free(env, room.series);
    parian_free(env, room.name);
    return r;
}

parian_result parian_measure_report(const parian_env *env, parian_measure_run *run)
{
    parian_machine machine;
    parian_machine_read(&machine);
    parian_result r = write_tables(env, run, &machine);
    r = r == PARIAN_OK ? write_json(env, run, &machine) : r;
    if (r == PARIAN_OK && run->images.length > 0) {
        r = write_text(run, "images.csv", &run->images);
    }
    r = r == PARIAN_OK ? write_plots(env, run) : r;
    return r == PARIAN_OK ? print_tables(env, run) : r;
}
