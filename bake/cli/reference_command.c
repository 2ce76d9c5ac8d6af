/* reference_command.c - parian-bake reference: ground truth at receivers of a scene.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/cli/reference_command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bake/reference/medium_field.h"
#include "bake/reference/reference_output.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/surface_quadrature.h"
#include "core/memory.h"
#include "tool/files.h"
#include "tool/lights_file.h"
#include "tool/session.h"

/* Everything of one run. */
typedef struct reference_run {
    const parian_reference_options *options;
    parian_light_set lights; /* whose pictures the scene uses */
    parian_npy points, field;
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result;
    double (*scale)[3]; /* [bodies] */
} reference_run;

static void run_free(const parian_env *env, reference_run *run)
{
    parian_reference_result_free(env, &run->result);
    parian_receivers_free(env, &run->receivers);
    parian_reference_scene_free(env, &run->scene);
    parian_light_set_free(env, &run->lights);
    parian_npy_free(env, &run->points);
    parian_npy_free(env, &run->field);
    parian_free(env, run->scale);
}

/* ---- what the command line names ---------------------------------------------------------------
 */
static parian_result read_lights(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    parian_result r =
        o->lights_file ? parian_lights_read_file(env, o->lights_file, &run->lights) : PARIAN_OK;
    for (size_t i = 0; r == PARIAN_OK && i < o->light_specs.count; i++) {
        r = parian_lights_parse_spec(env, o->light_specs.item[i], &run->lights);
    }
    if (r == PARIAN_OK && o->lights_file && run->lights.count == 0) {
        r = parian_fail(env, PARIAN_E_FORMAT, "%s: holds no light", o->lights_file);
    }
    return r;
}

static parian_result read_points(const parian_env *env, const char *path, parian_npy *points)
{
    parian_result r = parian_npy_read(env, path, points);
    if (r == PARIAN_OK && (points->rank != 2 || points->shape[1] != 3 || points->shape[0] == 0)) {
        r = parian_fail(env, PARIAN_E_FORMAT,
                        "%s: %zu numbers in %u dimensions, expected points [n][3]", path,
                        points->count, points->rank);
    }
    for (size_t i = 0; r == PARIAN_OK && i < points->count; i++) {
        if (!(fabs(points->value[i]) < 1e12)) {
            r = parian_fail(env, PARIAN_E_FORMAT,
                            "%s: point %zu: %g is not finite or beyond 1e12 m", path, i / 3,
                            points->value[i]);
        }
    }
    return r;
}

static parian_result read_files(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    parian_result r = parian_check_outputs(env, &o->scene);
    if (r == PARIAN_OK) {
        r = read_lights(env, run);
    }
    if (r == PARIAN_OK && o->receiver_file) {
        r = read_points(env, o->receiver_file, &run->points);
    }
    if (r == PARIAN_OK && o->field_file) {
        r = parian_npy_read(env, o->field_file, &run->field);
        if (r == PARIAN_OK) {
            r = parian_medium_field_check(env, o->field_file, &run->field);
        }
    }
    return r;
}

static parian_result load_scene(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    parian_progress(env, "import", 0);
    parian_result r =
        parian_reference_scene_load(env, &o->scene, run->lights.count ? run->lights.light : NULL,
                                    (uint32_t)run->lights.count, &run->scene);
    if (r == PARIAN_OK && run->scene.light_count == 0) {
        r = parian_fail(env, PARIAN_E_ARGUMENT,
                        "%s: has no lights of its own: give --lights FILE or --light SPEC",
                        o->scene.input);
    }
    if (r == PARIAN_OK && o->field_file) {
        r = parian_medium_field_attach(env, o->field_file, &run->field, &run->scene);
    }
    if (r == PARIAN_OK) {
        r = o->receiver_file
                ? parian_receivers_nearest(env, &run->scene, (const double(*)[3])run->points.value,
                                           (size_t)run->points.shape[0], &run->receivers)
                : parian_receivers_spread(env, &run->scene, (size_t)o->receiver_count, o->seed,
                                          &run->receivers);
    }
    return r;
}

/* ---- computing ---------------------------------------------------------------------------------
 */
static parian_result integrate(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    if (!PARIAN_NEW0(env, run->scale, run->scene.body_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", run->scene.body_count);
    }
    const parian_reference_quadrature_desc desc = {
        .bssrdf = {.model = o->model, .fit_fdr = o->fit_fdr, .normalise = o->normalise},
        .samples = o->samples,
        .seed = o->seed,
        .scale = run->scale};
    return parian_reference_quadrature(env, &run->scene, &run->receivers, &desc, &run->result);
}

static parian_result trace(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    char *checkpoint = parian_path_join(env, o->output, "checkpoint.bin");
    if (!checkpoint) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a path");
    }
    const parian_path_desc desc = {.samples = o->samples,
                                   .standard_error = o->standard_error,
                                   .seed = o->seed,
                                   .walk = o->walk,
                                   .patch = o->patch,
                                   .checkpoint = checkpoint};
    parian_result r = parian_reference_path(env, &run->scene, &run->receivers, &desc, &run->result);
    if (r == PARIAN_E_INTERRUPTED && access(checkpoint, F_OK) == 0) {
        parian_log(env, PARIAN_LOG_INFO, "%s is kept: the same command goes on from there",
                   checkpoint);
    }
    parian_free(env, checkpoint);
    return r;
}

/* One line of what was reached. */
static void log_result(const parian_env *env, const reference_run *run)
{
    double mean = 0, square = 0;
    size_t n = run->receivers.count;
    for (size_t i = 0; i < 3 * n; i++) {
        double e = run->result.standard_error[i / 3][i % 3];
        mean += run->result.radiosity[i / 3][i % 3] / (3 * (double)n);
        square += e * e / (3 * (double)n);
    }
    parian_log(env, PARIAN_LOG_INFO,
               "%zu receivers, mean B %.6g W/m^2, rms standard error %.3g %%, %llu samples a "
               "receiver, %.2f s",
               n, mean, mean > 0 ? 100 * sqrt(square) / mean : 0,
               (unsigned long long)run->result.samples, run->result.seconds);
}

static parian_result run_scene(const parian_env *env, reference_run *run)
{
    const parian_reference_options *o = run->options;
    parian_result r = read_files(env, run);
    if (r == PARIAN_OK) {
        r = load_scene(env, run);
    }
    if (r == PARIAN_OK) {
        r = o->model == PARIAN_REFERENCE_PATH ? trace(env, run) : integrate(env, run);
    }
    if (r == PARIAN_OK) {
        const parian_reference_about about = {.model = o->model,
                                              .spread = !o->receiver_file,
                                              .fit_fdr = o->fit_fdr,
                                              .scale = (const double(*)[3])run->scale,
                                              .seed = o->seed};
        r = parian_reference_write(env, o->output, &run->scene, &run->receivers, &run->result,
                                   &about);
    }
    if (r == PARIAN_OK) {
        log_result(env, run);
    }
    return r;
}

int parian_reference_command(int argc, char **argv)
{
    static parian_reference_options options;
    parian_session *session = NULL;
    reference_run run = {.options = &options};
    parian_result r = parian_reference_options_parse(argc, argv, &options);
    if (r != PARIAN_OK || options.common.help || options.common.version) {
        return parian_result_exit_status(r);
    }
    r = parian_session_create("parian-bake", &options.common, &session);
    if (r != PARIAN_OK) {
        return parian_result_exit_status(r);
    }
    const parian_env *env = parian_session_env(session);
    bool is_new = access(options.output, F_OK) != 0;
    r = options.planar ? parian_planar_command(env, &options) : run_scene(env, &run);
    if (r != PARIAN_OK && is_new) {
        rmdir(options.output); /* if it is empty: a checkpoint stays */
    }
    run_free(env, &run);
    parian_session_end_progress(session);
    int status = parian_session_exit(session, r);
    parian_session_destroy(session);
    return status;
}
