/* view_timings.c - gathers times of passes over frames, for --timings.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_timings.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"

enum { SERIES_MAX = PARIAN_PASS_MAX + 2, PROCESSOR_MAX = 128 };

/* Series 0 is the relight, series 1 the draw, then the passes. */
struct parian_view_timings {
    size_t frames, frames_max, passes;
    parian_pass_time last[PARIAN_PASS_MAX];
    double *series[SERIES_MAX]; /* [frames_max] milliseconds */
};

parian_view_timings *parian_view_timings_create(const parian_env *env, size_t frames)
{
    parian_view_timings *timings = parian_zalloc(env, 1, sizeof *timings);
    double *room = parian_zalloc(env, frames, SERIES_MAX * sizeof *room);
    if (!timings || !room) {
        parian_free(env, room);
        parian_free(env, timings);
        return NULL;
    }
    timings->frames_max = frames;
    for (size_t i = 0; i < SERIES_MAX; i++) {
        timings->series[i] = room + i * frames;
    }
    return timings;
}

void parian_view_timings_destroy(const parian_env *env, parian_view_timings *timings)
{
    if (timings) {
        parian_free(env, timings->series[0]);
        parian_free(env, timings);
    }
}

void parian_view_timings_add(parian_view_timings *timings, const parian_renderer *renderer,
                             double relight_ms, double draw_ms)
{
    if (timings->frames >= timings->frames_max) {
        return;
    }
    timings->series[0][timings->frames] = relight_ms;
    timings->series[1][timings->frames] = draw_ms;
    timings->passes = parian_renderer_get_times(renderer, timings->last);
    for (size_t i = 0; i < timings->passes; i++) {
        timings->series[2 + i][timings->frames] = timings->last[i].ms;
    }
    timings->frames++;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

typedef struct summary {
    double median, minimum, maximum;
} summary;

/* Sorts the series in place: the order of frames is not needed any more. */
static summary summarize(const parian_view_timings *timings, size_t series)
{
    double *value = timings->series[series];
    const size_t n = timings->frames;
    if (n == 0) {
        return (summary){0};
    }
    qsort(value, n, sizeof *value, compare_doubles);
    return (summary){.median = n % 2 ? value[n / 2] : 0.5 * (value[n / 2 - 1] + value[n / 2]),
                     .minimum = value[0],
                     .maximum = value[n - 1]};
}

double parian_view_timings_relight_ms(const parian_view_timings *timings)
{
    return summarize(timings, 0).median;
}

double parian_view_timings_draw_ms(const parian_view_timings *timings)
{
    return summarize(timings, 1).median;
}

/* The processor's name as the system tells it. */
static void read_processor(char name[PROCESSOR_MAX])
{
    char line[256];
    FILE *file = fopen("/proc/cpuinfo", "r");
    snprintf(name, PROCESSOR_MAX, "unknown");
    while (file && fgets(line, sizeof line, file)) {
        const char *colon = strchr(line, ':');
        if (strncmp(line, "model name", 10) == 0 && colon) {
            snprintf(name, PROCESSOR_MAX, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
            break;
        }
    }
    if (file) {
        fclose(file);
    }
}

/* Tenths of a microsecond are more than clocks tell. */
static bool add_ms(cJSON *object, const char *key, double ms)
{
    return cJSON_AddNumberToObject(object, key, round(ms * 1e4) / 1e4) != NULL;
}

static bool add_summary(cJSON *object, const summary *s)
{
    return add_ms(object, "median_ms", s->median) && add_ms(object, "minimum_ms", s->minimum) &&
           add_ms(object, "maximum_ms", s->maximum);
}

static bool add_passes(cJSON *root, const parian_view_timings *timings)
{
    cJSON *list = cJSON_AddArrayToObject(root, "passes");
    for (size_t i = 0; i < timings->passes && list; i++) {
        const summary s = summarize(timings, 2 + i);
        cJSON *object = cJSON_CreateObject();
        if (!object || !cJSON_AddItemToArray(list, object)) {
            cJSON_Delete(object);
            return false;
        }
        if (!cJSON_AddStringToObject(object, "name", timings->last[i].name) ||
            !add_summary(object, &s) ||
            !cJSON_AddNumberToObject(object, "runs", (double)timings->last[i].runs)) {
            return false;
        }
    }
    return list != NULL;
}

static bool fill(cJSON *root, const parian_view_timings *timings, const parian_view_app *app,
                 const char *api)
{
    char processor[PROCESSOR_MAX];
    const parian_view_options *o = app->options;
    read_processor(processor);
    return root && cJSON_AddStringToObject(root, "asset", o->asset) &&
           cJSON_AddStringToObject(root, "renderer", parian_renderer_name(app->renderer)) &&
           cJSON_AddStringToObject(root, "api", api) &&
           cJSON_AddStringToObject(root, "processor", processor) &&
           cJSON_AddNumberToObject(root, "frames", (double)timings->frames) &&
           cJSON_AddNumberToObject(root, "width", o->width) &&
           cJSON_AddNumberToObject(root, "height", o->height) &&
           cJSON_AddNumberToObject(root, "texels", (double)app->info.texel_count) &&
           cJSON_AddNumberToObject(root, "vertices", (double)app->info.vertex_count) &&
           cJSON_AddNumberToObject(root, "gpu_bytes",
                                   (double)parian_renderer_memory(app->renderer)) &&
           add_ms(root, "relight_ms", summarize(timings, 0).median) &&
           add_ms(root, "draw_ms", summarize(timings, 1).median) && add_passes(root, timings);
}

parian_result parian_view_timings_write(const parian_view_timings *timings,
                                        const parian_view_app *app, const char *api,
                                        const char *path)
{
    cJSON *root = cJSON_CreateObject();
    char *text = fill(root, timings, app, api) ? cJSON_Print(root) : NULL;
    const parian_piece pieces[2] = {{text, text ? strlen(text) : 0}, {"\n", 1}};
    parian_result result = text
                               ? parian_file_write_pieces(app->env, path, pieces, 2)
                               : parian_fail(app->env, PARIAN_E_NOMEM, "no memory for the timings");
    cJSON_free(text);
    cJSON_Delete(root);
    return result;
}
