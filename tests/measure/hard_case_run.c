/* hard_case_run.c - bakes, relights and judges one hard case.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/cli/bake_options.h"
#include "bake/reference/path_tracing.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/surface_quadrature.h"
#include "core/dipole.h"
#include "core/memory.h"
#include "tests/measure/hard_cases.h"
#include "tests/measure/radiosity_metrics.h"
#include "tests/measure/relight.h"
#include "tests/measure/results_table.h"
#include "tests/measure/truth.h"
#include "tool/session.h"

enum { RECEIVERS = 200, PATH_RECEIVERS = 24, PATH_SAMPLES_MAX = 1 << 16 };
static const double PATH_STANDARD_ERROR = 0.03, CREASE_DEG = 50;

/* ---- an env that keeps the first error, and says nothing of what is expected
 * ---------------------------------- */
typedef struct quiet_env {
    parian_env env;
    const parian_env *outer;
    char *note;
    size_t note_size;
} quiet_env;

static void *quiet_alloc(void *user, size_t size)
{
    return parian_alloc(((quiet_env *)user)->outer, 1, size);
}

static void quiet_free(void *user, void *ptr)
{
    parian_free(((quiet_env *)user)->outer, ptr);
}

static void quiet_log(void *user, parian_log_level level, const char *text)
{
    quiet_env *quiet = user;
    if (level == PARIAN_LOG_ERROR && !quiet->note[0]) {
        snprintf(quiet->note, quiet->note_size, "%s", text);
    } else if (level == PARIAN_LOG_WARNING) {
        parian_log(quiet->outer, PARIAN_LOG_DEBUG, "%s", text);
    }
}

static void quiet_par(void *user, size_t count, void (*body)(void *, size_t), void *context)
{
    parian_par(((quiet_env *)user)->outer, count, body, context);
}

static bool quiet_cancelled(void *user)
{
    return parian_cancelled(((quiet_env *)user)->outer);
}

static void quiet_init(quiet_env *quiet, const parian_env *outer, char *note, size_t note_size)
{
    *quiet = (quiet_env){.outer = outer, .note = note, .note_size = note_size};
    quiet->env = (parian_env){.alloc = quiet_alloc,
                              .free = quiet_free,
                              .log = quiet_log,
                              .par = quiet_par,
                              .cancelled = quiet_cancelled,
                              .user = quiet};
}

/* ---- one case
 * -------------------------------------------------------------------------------------------------
 */
typedef struct hard_run {
    const parian_env *env; /* quiet */
    const parian_hard_case *c;
    char model[4096], medium[4096], asset[4096];
    parian_bake_options bake;
    parian_light light[PARIAN_HARD_LIGHTS_MAX];
    size_t light_count;
    parian_relit relit;
    parian_reference_scene scene;
    parian_texel_choice choice;
    parian_receivers receivers;
    parian_reference_result truth;
    double (*value)[3]; /* [receivers.count] B of the method */
} hard_run;

static void free_run(hard_run *run)
{
    const parian_env *env = run->env;
    parian_relit_close(env, &run->relit);
    parian_reference_scene_free(env, &run->scene);
    parian_texel_choice_free(env, &run->choice);
    parian_receivers_free(env, &run->receivers);
    parian_reference_result_free(env, &run->truth);
    parian_free(env, run->value);
    parian_free(env, run);
}

static void fill_medium(const parian_hard_case *c, parian_medium *medium)
{
    *medium = (parian_medium){.eta = c->eta, .reduced_only = c->g == 0};
    snprintf(medium->name, sizeof medium->name, "%s", c->name);
    for (int k = 0; k < 3; k++) {
        medium->sigma_s_prime[k] = c->sigma_s_prime[k] / c->size_m;
        medium->sigma_a[k] = c->sigma_a[k] / c->size_m;
        medium->g[k] = c->g;
    }
}

static parian_result write_medium(const parian_env *env, const parian_hard_case *c,
                                  const char *path)
{
    parian_text text = {.env = env};
    parian_medium m;
    double full = 1 / (1 - c->g); /* sigma_s over sigma_s' */
    fill_medium(c, &m);
    parian_text_add(&text, "{\"name\":\"%s\",\"%s\":[%.12g,%.12g,%.12g],", c->name,
                    c->g == 0 ? "sigma_s_prime" : "sigma_s", full * m.sigma_s_prime[0],
                    full * m.sigma_s_prime[1], full * m.sigma_s_prime[2]);
    parian_text_add(&text,
                    "\"sigma_a\":[%.12g,%.12g,%.12g],\"g\":%.12g,\"eta\":%.12g,\"unit\":\"1/m\"}\n",
                    m.sigma_a[0], m.sigma_a[1], m.sigma_a[2], c->g, c->eta);
    return parian_text_write(&text, path);
}

/* Write model and medium, and resolve the settings of their bake. */
static parian_result prepare(hard_run *run, const char *folder)
{
    parian_mesh mesh = {0};
    parian_result r = parian_hard_mesh(run->env, run->c->shape, run->c->size_m, &mesh);
    snprintf(run->model, sizeof run->model, "%.3900s/%s.off", folder, run->c->name);
    snprintf(run->medium, sizeof run->medium, "%.3900s/%s.json", folder, run->c->name);
    snprintf(run->asset, sizeof run->asset, "%.3900s/%s.parian", folder, run->c->name);
    r = r == PARIAN_OK ? parian_hard_mesh_write(run->env, &mesh, run->model) : r;
    r = r == PARIAN_OK ? write_medium(run->env, run->c, run->medium) : r;
    parian_mesh_free(run->env, &mesh);
    if (r != PARIAN_OK) {
        return r;
    }
    char *words[] = {"parian-bake",
                     "--unit",
                     "m",
                     "--keep-origin",
                     "--material",
                     run->medium,
                     "--transfer-vertices",
                     "1500",
                     "--atlas",
                     "160",
                     "--bssrdf",
                     run->c->flux ? "dipole-flux" : "dipole",
                     "-o",
                     run->asset,
                     run->model};
    run->light_count = parian_hard_lights(run->c->light, run->c->size_m, run->light);
    return parian_bake_options_parse((int)(sizeof words / sizeof *words), words, &run->bake);
}

static parian_result load_scene(hard_run *run)
{
    return parian_reference_scene_load(run->env, &run->bake.desc, run->light,
                                       (uint32_t)run->light_count, &run->scene);
}

/* Bake and relight; B at texels spread over the surface. */
static parian_result evaluate(hard_run *run)
{
    static const parian_measure_device cpu = {.backend = PARIAN_MEASURE_CPU, .shadow_size = 512};
    parian_relit *relit = &run->relit;
    parian_result r = parian_bake_run(run->env, &run->bake.desc);
    r = r == PARIAN_OK ? parian_relit_open(run->env, run->asset, &cpu, relit) : r;
    r = r == PARIAN_OK ? parian_relit_light(relit, run->light, run->light_count) : r;
    r = r == PARIAN_OK ? load_scene(run) : r;
    if (r == PARIAN_OK) {
        r = parian_texels_choose(
            run->env, (const float(*)[3])relit->position, relit->area, relit->info.texel_count,
            run->c->truth == PARIAN_HARD_PATH ? PATH_RECEIVERS : RECEIVERS, 0, &run->choice);
    }
    if (r == PARIAN_OK) {
        r = parian_truth_receivers(run->env, &run->scene, (const float(*)[3])relit->position,
                                   (const float(*)[3])relit->normal, &run->choice, &run->receivers);
    }
    if (r == PARIAN_OK && !PARIAN_NEW(run->env, run->value, run->choice.count)) {
        r = parian_fail(run->env, PARIAN_E_NOMEM, "no memory for %zu receivers", run->choice.count);
    }
    for (size_t i = 0; r == PARIAN_OK && i < 3 * run->choice.count; i++) {
        run->value[i / 3][i % 3] = relit->radiosity[run->choice.texel[i / 3]][i % 3];
    }
    return r;
}

static parian_result trace(hard_run *run, parian_reference_result *result)
{
    const parian_path_desc desc = {.samples = PATH_SAMPLES_MAX,
                                   .standard_error = PATH_STANDARD_ERROR};
    return parian_reference_path(run->env, &run->scene, &run->receivers, &desc, result);
}

static parian_result integrate(hard_run *run, parian_reference_result *result)
{
    const parian_reference_quadrature_desc desc = {
        .bssrdf = {.model = run->c->flux ? PARIAN_REFERENCE_DIPOLE_FLUX : PARIAN_REFERENCE_DIPOLE}};
    return parian_reference_quadrature(run->env, &run->scene, &run->receivers, &desc, result);
}

/* B = C(infinity) E at each receiver. */
static parian_result reflect(hard_run *run, parian_reference_result *result)
{
    parian_result r = parian_reference_result_init(run->env, run->receivers.count, false, result);
    for (size_t i = 0; r == PARIAN_OK && i < run->receivers.count; i++) {
        parian_place place;
        parian_receiver_place(&run->receivers, i, &place);
        for (uint32_t l = 0; l < run->scene.light_count; l++) {
            parian_random random = parian_random_stream(0, i, l, 0);
            parian_reference_irradiance(&run->scene, l, &place, 4096, &random,
                                        result->irradiance[i]);
        }
        for (int c = 0; c < 3; c++) {
            parian_dipole dipole = parian_dipole_make(&run->scene.bodies[0].medium, c, false);
            result->radiosity[i][c] = parian_dipole_total(&dipole) * result->irradiance[i][c];
        }
    }
    return r;
}

static parian_result find_truth(hard_run *run)
{
    switch (run->c->truth) {
    case PARIAN_HARD_PATH:
        return trace(run, &run->truth);
    case PARIAN_HARD_LAMBERT:
        return reflect(run, &run->truth);
    default:
        return integrate(run, &run->truth);
    }
}

/* Quadrature against path tracing on a medium that the bake refuses: the surface is made by hand.
 */
static parian_result evaluate_refused(hard_run *run)
{
    parian_reference_body *body = NULL;
    parian_reference_result quadrature = {0};
    if (!PARIAN_NEW0(run->env, body, 1)) {
        return parian_fail(run->env, PARIAN_E_NOMEM, "no memory for a body");
    }
    parian_result r = parian_hard_mesh(run->env, run->c->shape, run->c->size_m, &body->mesh);
    r = r == PARIAN_OK ? parian_mesh_make_corner_normals(run->env, &body->mesh, CREASE_DEG) : r;
    if (r != PARIAN_OK) {
        parian_mesh_free(run->env, &body->mesh);
        parian_free(run->env, body);
        return r;
    }
    body->closed = true;
    fill_medium(run->c, &body->medium);
    r = parian_reference_scene_make(run->env, body, 1, NULL, 0, run->light,
                                    (uint32_t)run->light_count, &run->scene);
    r = r == PARIAN_OK
            ? parian_receivers_spread(run->env, &run->scene, PATH_RECEIVERS, 0, &run->receivers)
            : r;
    r = r == PARIAN_OK ? integrate(run, &quadrature) : r;
    r = r == PARIAN_OK ? trace(run, &run->truth) : r;
    if (r == PARIAN_OK) {
        run->value = quadrature.radiosity;
        quadrature.radiosity = NULL;
    }
    parian_reference_result_free(run->env, &quadrature);
    return r;
}

/* ---- the verdict
 * ---------------------------------------------------------------------------------------------- */
static bool all_finite(const hard_run *run)
{
    bool finite = true;
    for (size_t i = 0; i < 3 * run->receivers.count; i++) {
        finite = finite && isfinite(run->value[i / 3][i % 3]) &&
                 isfinite(run->truth.radiosity[i / 3][i % 3]);
    }
    for (size_t i = 0; i < 3 * run->relit.info.texel_count;
         i++) { /* and every texel, not the chosen ones alone */
        finite = finite && isfinite(run->relit.radiosity[i / 3][i % 3]);
    }
    return finite;
}

static parian_result judge(const hard_run *run, parian_hard_outcome *outcome)
{
    const parian_hard_case *c = run->c;
    *outcome =
        (parian_hard_outcome){.finite = all_finite(run), .energy_ratio = 1, .minimum = INFINITY};
    for (int k = 0; outcome->finite && k < 3; k++) {
        parian_radiosity_metrics m;
        parian_result r = parian_radiosity_measure(
            run->env, run->receivers.count, k, (const double(*)[3])run->value,
            (const double(*)[3])run->truth.radiosity, (const double(*)[3])run->truth.standard_error,
            run->receivers.area, &m);
        if (r != PARIAN_OK) {
            return r;
        }
        outcome->error = fmax(outcome->error, m.l2);
        outcome->minimum = fmin(outcome->minimum, m.minimum);
        outcome->standard_error = fmax(outcome->standard_error, m.truth_error);
        if (fabs(m.energy_ratio - 1) > fabs(outcome->energy_ratio - 1)) {
            outcome->energy_ratio = m.energy_ratio;
        }
    }
    outcome->measured = outcome->finite;
    outcome->receivers = run->receivers.count;
    outcome->texels = run->relit.info.texel_count;
    outcome->pass = outcome->finite && outcome->error <= c->error_max &&
                    fabs(outcome->energy_ratio - 1) <= c->energy_max &&
                    outcome->minimum >= c->minimum;
    return PARIAN_OK;
}

/* The bake must end with a line about eta; everything else is a finding of its own. */
static parian_result run_refused(hard_run *run, parian_hard_outcome *outcome, char *note)
{
    parian_result baked = parian_bake_run(run->env, &run->bake.desc);
    bool refused = (baked == PARIAN_E_ARGUMENT || baked == PARIAN_E_FORMAT) && strstr(note, "eta");
    if (baked == PARIAN_E_INTERRUPTED || baked == PARIAN_E_IO || baked == PARIAN_E_NOMEM) {
        return baked;
    }
    parian_result r = evaluate_refused(run);
    r = r == PARIAN_OK ? judge(run, outcome) : r;
    outcome->pass = outcome->pass && refused;
    return r;
}

static parian_result run_case(hard_run *run, parian_hard_outcome *outcome, char *note)
{
    if (run->c->truth == PARIAN_HARD_REFUSED) {
        return run_refused(run, outcome, note);
    }
    parian_result r = evaluate(run);
    r = r == PARIAN_OK ? find_truth(run) : r;
    return r == PARIAN_OK ? judge(run, outcome) : r;
}

parian_result parian_hard_case_run(const parian_env *env, const parian_hard_case *c,
                                   const char *folder, parian_hard_outcome *outcome)
{
    char note[sizeof outcome->note] = "";
    double start = parian_seconds();
    quiet_env quiet;
    hard_run *run = NULL;
    *outcome = (parian_hard_outcome){.finite = false};
    quiet_init(&quiet, env, note, sizeof note);
    if (!PARIAN_NEW0(&quiet.env, run, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a hard case");
    }
    run->env = &quiet.env;
    run->c = c;
    parian_result r = prepare(run, folder);
    r = r == PARIAN_OK ? run_case(run, outcome, note) : r;
    free_run(run);
    memcpy(outcome->note, note, sizeof note);
    outcome->seconds = parian_seconds() - start;
    if (r == PARIAN_E_IO || r == PARIAN_E_NOMEM) {
        return parian_fail(env, r, "hard case %s: %s", c->name, note);
    }
    return r == PARIAN_E_INTERRUPTED ? r : PARIAN_OK; /* any other failure is what the case found */
}
