/* measure_run.c - bakes, relights, asks for truth, and compares, one asset and light set after the
 * other.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/measure_run.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/reference/reference_scene.h"
#include "core/memory.h"
#include "tests/measure/transport_truth.h"
#include "tool/files.h"

bool parian_measure_path(const parian_measure_run *run, const char *name,
                         char path[PARIAN_MEASURE_PATH_MAX])
{
    return snprintf(path, PARIAN_MEASURE_PATH_MAX, "%s/%s", run->options->output, name) <
           PARIAN_MEASURE_PATH_MAX;
}

void parian_measure_slug(const char *label, const char *lights, char slug[2 * PARIAN_LABEL_MAX])
{
    snprintf(slug, 2 * PARIAN_LABEL_MAX, "%.300s-%.200s", label, lights);
    for (char *c = slug; *c; c++) {
        *c = isalnum((unsigned char)*c) || *c == '_' || *c == '.' ? *c : '-';
    }
}

/* ---- lights
 * --------------------------------------------------------------------------------------------------
 */
/* The file's name without folder and ending; the whole path where another set has that name
 * already. */
static void name_lights(parian_measure_run *run, const char *path, parian_named_lights *lights)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path,
               *dot = strrchr(name, '.');
    snprintf(lights->name, sizeof lights->name, "%.*s",
             dot > name ? (int)(dot - name) : (int)strlen(name), name);
    for (size_t i = 0; i < run->light_count; i++) {
        if (strcmp(run->lights[i].name, lights->name) == 0) {
            snprintf(lights->name, sizeof lights->name, "%s", path);
        }
    }
}

static parian_result read_lights(const parian_env *env, parian_measure_run *run)
{
    for (size_t i = 0; i < run->options->lights.count; i++) {
        const char *path = run->options->lights.item[i];
        parian_named_lights *lights = &run->lights[run->light_count];
        name_lights(run, path, lights);
        parian_result r = parian_lights_read_file(env, path, &lights->set);
        if (r != PARIAN_OK) {
            return r;
        }
        run->light_count++;
        if (lights->set.count == 0) {
            return parian_fail(env, PARIAN_E_FORMAT, "%s: no light in it, expected at least one",
                               path);
        }
    }
    return PARIAN_OK;
}

/* ---- one measurement
 * ----------------------------------------------------------------------------------------- */
/* B and E of a method at the chosen texels. */
typedef struct method_values {
    double (*radiosity)[3], (*irradiance)[3];
    double (*transported)[3]; /* what exact transport makes of the method's own E */
} method_values;

static parian_result gather(const parian_env *env, const parian_relit *relit,
                            const parian_texel_choice *choice, method_values *values)
{
    if (!PARIAN_NEW(env, values->radiosity, choice->count) ||
        !PARIAN_NEW(env, values->irradiance, choice->count) ||
        !PARIAN_NEW(env, values->transported, choice->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", choice->count);
    }
    for (size_t i = 0; i < choice->count; i++) {
        for (int c = 0; c < 3; c++) {
            values->radiosity[i][c] = relit->radiosity[choice->texel[i]][c];
            values->irradiance[i][c] = relit->irradiance[choice->texel[i]][c];
        }
    }
    return parian_transport_truth(env, parian_relit_bodies(relit), relit->info.body_count,
                                  (const float(*)[3])relit->irradiance, choice,
                                  values->transported);
}

static void copy_text(char out[PARIAN_RESULT_TEXT_MAX], const char *text)
{
    snprintf(out, PARIAN_RESULT_TEXT_MAX, "%s", text);
}

static void fill_row(const parian_measure_case *c, const char *method,
                     const parian_relight_times *times, parian_measure_row *row)
{
    *row = (parian_measure_row){.relight_ms = times->median_ms,
                                .bake_s = c->asset->bake_s,
                                .asset_bytes = c->asset->bytes,
                                .vertices = c->relit->info.vertex_count,
                                .texels = c->relit->info.texel_count,
                                .factors = c->relit->factors};
    copy_text(row->asset, c->asset->label);
    copy_text(row->model, c->asset->model);
    copy_text(row->bake, c->asset->bake);
    copy_text(row->method, method);
    copy_text(row->lights, c->lights->name);
    snprintf(row->reference, sizeof row->reference, "%s",
             parian_reference_model_name(c->truth.model));
    snprintf(row->backend, sizeof row->backend, "%s",
             parian_measure_backend_name(c->relit->device->backend));
}

static parian_result add_rows(const parian_env *env, parian_measure_run *run,
                              const parian_measure_row *like, const method_values *values,
                              const parian_reference_result *truth, const double *area,
                              size_t count)
{
    parian_result r = PARIAN_OK;
    for (int c = 0; c < 3 && r == PARIAN_OK; c++) {
        parian_measure_row row = *like;
        parian_radiosity_metrics e;
        row.channel = c;
        row.receivers = count;
        r = parian_radiosity_measure(env, count, c, (const double(*)[3])values->radiosity,
                                     (const double(*)[3])truth->radiosity,
                                     (const double(*)[3])truth->standard_error, area, &row.error);
        if (r == PARIAN_OK) {
            r = parian_radiosity_measure(env, count, c, (const double(*)[3])values->irradiance,
                                         (const double(*)[3])truth->irradiance, NULL, area, &e);
            row.irradiance_l2 = e.l2;
        }
        if (r == PARIAN_OK) {
            r = parian_radiosity_measure(env, count, c, (const double(*)[3])values->radiosity,
                                         (const double(*)[3])values->transported, NULL, area, &e);
            row.transport_l2 = e.l2;
        }
        r = r == PARIAN_OK ? parian_results_add(env, &run->results, &row) : r;
    }
    return r;
}

/* Run a method, time it, and compare it with the truth. There is one so far: the transfer of the
 * asset. */
static parian_result measure_method(const parian_env *env, parian_measure_run *run,
                                    const parian_measure_case *c, const char *method,
                                    const parian_texel_choice *choice,
                                    const parian_reference_result *truth, bool truth_cached)
{
    const parian_light_set *set = &c->lights->set;
    method_values values = {0};
    parian_relight_times times;
    parian_measure_row row;
    parian_result r = parian_relit_time(env, c->relit, set->light, set->count,
                                        run->options->relight_seconds, &times);
    r = r == PARIAN_OK ? parian_relit_light(c->relit, set->light, set->count) : r;
    r = r == PARIAN_OK ? gather(env, c->relit, choice, &values) : r;
    if (r == PARIAN_OK) {
        fill_row(c, method, &times, &row);
        r = add_rows(env, run, &row, &values, truth, choice->area, choice->count);
    }
    if (r == PARIAN_OK) {
        parian_measure_note(run, c, method, &times, truth, truth_cached);
    }
    parian_free(env, values.radiosity);
    parian_free(env, values.irradiance);
    parian_free(env, values.transported);
    return r;
}

static parian_result measure_methods(const parian_env *env, parian_measure_run *run,
                                     const parian_measure_case *c)
{
    const parian_measure_options *o = run->options;
    parian_texel_choice choice = {0};
    parian_receivers receivers = {0};
    parian_reference_result truth = {0};
    bool cached = false;
    parian_result r =
        parian_texels_choose(env, (const float(*)[3])c->relit->position, c->relit->area,
                             c->relit->info.texel_count, o->receivers, o->seed, &choice);
    if (r == PARIAN_OK) {
        r = parian_truth_receivers(env, c->scene, (const float(*)[3])c->relit->position,
                                   (const float(*)[3])c->relit->normal, &choice, &receivers);
    }
    r = r == PARIAN_OK ? parian_truth_get(env, c->scene, &receivers, &c->truth, &truth, &cached)
                       : r;
    for (size_t m = 0; r == PARIAN_OK && m < o->method_count; m++) {
        r = measure_method(env, run, c, o->method[m].text, &choice, &truth, cached);
    }
    parian_reference_result_free(env, &truth);
    parian_receivers_free(env, &receivers);
    parian_texel_choice_free(env, &choice);
    return r;
}

static void describe_truth(const parian_measure_options *o, const parian_relit *relit,
                           parian_truth_desc *truth)
{
    const parian_body *body = &parian_relit_bodies(relit)[0];
    *truth = (parian_truth_desc){.model = (parian_reference_model)o->reference,
                                 .fit_fdr = body->fit_fdr,
                                 .normalise = o->normalise == 0,
                                 .samples = o->samples,
                                 .standard_error = o->standard_error,
                                 .seed = o->seed,
                                 .cache = o->cache};
    if (!o->reference_given) {
        truth->model = body->bssrdf == PARIAN_BSSRDF_DIPOLE_FLUX ? PARIAN_REFERENCE_DIPOLE_FLUX
                                                                 : PARIAN_REFERENCE_DIPOLE;
    }
}

static parian_result measure_lights(const parian_env *env, parian_measure_run *run,
                                    const parian_baked_asset *asset, parian_relit *relit,
                                    const parian_named_lights *lights)
{
    parian_reference_scene scene = {0};
    parian_measure_case c = {.asset = asset, .lights = lights, .relit = relit, .scene = &scene};
    describe_truth(run->options, relit, &c.truth);
    parian_result r = parian_reference_scene_load(
        env, &asset->bake_options->desc, lights->set.light, (uint32_t)lights->set.count, &scene);
    r = r == PARIAN_OK ? measure_methods(env, run, &c) : r;
    if (r == PARIAN_OK && run->options->map_receivers > 0) {
        r = parian_measure_maps(env, run, &c);
    }
    if (r == PARIAN_OK && run->options->images) {
        r = parian_measure_image(env, run, &c);
    }
    parian_reference_scene_free(env, &scene);
    return r;
}

static parian_result measure_asset(const parian_env *env, parian_measure_run *run,
                                   parian_baked_asset *asset)
{
    parian_relit relit = {0};
    parian_result r = parian_baked_asset_make(env, run->options->cache, asset);
    r = r == PARIAN_OK ? parian_relit_open(env, asset->path, &run->device, &relit) : r;
    if (r == PARIAN_OK) {
        snprintf(run->renderer, sizeof run->renderer, "%s", parian_renderer_name(relit.renderer));
    }
    for (size_t i = 0; r == PARIAN_OK && i < run->light_count; i++) {
        r = parian_cancelled(env) ? PARIAN_E_INTERRUPTED
                                  : measure_lights(env, run, asset, &relit, &run->lights[i]);
    }
    parian_relit_close(env, &relit);
    return r;
}

static void run_free(const parian_env *env, parian_measure_run *run)
{
    for (size_t i = 0; i < PARIAN_STRING_LIST_MAX; i++) {
        parian_light_set_free(env, &run->lights[i].set);
    }
    parian_measure_device_close(env, &run->device);
    parian_results_free(env, &run->results);
    parian_free(env, run->images.text);
    cJSON_Delete(run->measurements);
    parian_free(env, run);
}

parian_result parian_measure_run_all(const parian_env *env, const parian_measure_options *options,
                                     parian_baked_asset *assets, size_t asset_count,
                                     const char *command)
{
    parian_measure_run *run = NULL;
    if (!PARIAN_NEW0(env, run, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a run");
    }
    *run = (parian_measure_run){.options = options,
                                .command = command,
                                .asset = assets,
                                .asset_count = asset_count,
                                .images = {.env = env},
                                .measurements = cJSON_CreateArray()};
    parian_result r = read_lights(env, run);
    if (r == PARIAN_OK) {
        r = parian_folder_create(env, options->output);
    }
    if (r == PARIAN_OK) {
        parian_measure_device_open(env, (parian_measure_backend)options->backend, &run->device);
    }
    for (size_t i = 0; r == PARIAN_OK && i < asset_count; i++) {
        r = measure_asset(env, run, &assets[i]);
    }
    r = r == PARIAN_OK ? parian_measure_report(env, run) : r;
    run_free(env, run);
    return r;
}
