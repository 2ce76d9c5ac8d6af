/* renderer_medium.c - gives bodies other media, sizes and colours than they were baked of, and
 * tells what could not follow.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "cpu/transport_probe.h"
#include "lights/relief.h"
#include "renderer_internal.h"

static const double TINT_MAX = 10, SIZE_MIN = 1e-3, SIZE_MAX_FACTOR = 1e3;
static const double EXTINCTION_MIN = 1e-6, EXTINCTION_MAX = 1e9; /* m^-1 */

/* Shares of B: what a bake's default threshold and plan allow; from where on a part counts as
 * missing. */
static const double BEYOND_ALLOWED = 0.002, ENERGY_ALLOWED = 0.005, HARD_ALLOWED = 0.02,
                    WRONG = 0.05;

static const parian_medium_report AS_BAKED = {.energy = 1, .text = "as baked"};

parian_result parian_renderer_start_media(parian_renderer *renderer)
{
    const parian_scene_data *data = &renderer->scene->data;
    if (!PARIAN_NEW(&renderer->env, renderer->optics, data->body_count) ||
        !PARIAN_NEW(&renderer->env, renderer->relief_reach, data->body_count) ||
        !PARIAN_NEW0(&renderer->env, renderer->medium, data->body_count)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for %u bodies",
                           data->body_count);
    }
    for (uint32_t b = 0; b < data->body_count; b++) {
        renderer->optics[b] =
            parian_body_optics_make(&data->bodies[b].medium, data->bodies[b].fit_fdr);
        renderer->relief_reach[b] = parian_relief_reach(&data->bodies[b]);
        renderer->medium[b].medium = data->bodies[b].medium;
        renderer->medium[b].report = AS_BAKED;
    }
    return PARIAN_OK;
}

/* ---- what is asked for ---- */

static parian_result check_tint(const parian_env *env, const float tint[3])
{
    for (int c = 0; c < 3; c++) {
        if (!(tint[c] >= 0 && tint[c] <= TINT_MAX)) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "the tint's %c is %g, expected 0 to %g",
                               "rgb"[c], tint[c], TINT_MAX);
        }
    }
    return PARIAN_OK;
}

static parian_result check_extinction(const parian_env *env, const parian_medium *medium)
{
    for (int c = 0; c < 3; c++) {
        double sum = medium->sigma_s_prime[c] + medium->sigma_a[c];
        if (!(sum >= EXTINCTION_MIN && sum <= EXTINCTION_MAX)) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "medium '%s': sigma_s' + sigma_a is %g per m in %c, size factor "
                               "included; expected %g "
                               "to %g",
                               medium->name, sum, "rgb"[c], EXTINCTION_MIN, EXTINCTION_MAX);
        }
    }
    return PARIAN_OK;
}

/* The medium that an edit makes of the baked one. R_d of a body that is s times as large is that of
 * one of the old size whose coefficients are s times as large, over s^2, which areas take back. */
static parian_result resolve(const parian_env *env, const parian_medium *baked,
                             const parian_medium_edit *edit, parian_medium *medium)
{
    double size = edit->size_factor == 0 ? 1 : edit->size_factor;
    *medium = *baked;
    if (!(size >= SIZE_MIN && size <= SIZE_MAX_FACTOR)) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "the size factor is %g, expected %g to %g", size,
                           SIZE_MIN, SIZE_MAX_FACTOR);
    }
    if (edit->change_medium) {
        snprintf(medium->name, sizeof medium->name, "%s", "edited");
        memcpy(medium->sigma_s_prime, edit->sigma_s_prime, sizeof medium->sigma_s_prime);
        memcpy(medium->sigma_a, edit->sigma_a, sizeof medium->sigma_a);
        medium->eta = edit->eta == 0 ? baked->eta : edit->eta;
        parian_result result = parian_medium_check(env, medium);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    for (int c = 0; c < 3; c++) {
        medium->sigma_s_prime[c] *= size;
        medium->sigma_a[c] *= size;
    }
    return check_extinction(env, medium);
}

static bool same_medium(const parian_medium *a, const parian_medium *b)
{
    bool same = a->eta == b->eta;
    for (int c = 0; c < 3; c++) {
        same = same && a->sigma_s_prime[c] == b->sigma_s_prime[c] && a->sigma_a[c] == b->sigma_a[c];
    }
    return same;
}

/* ---- what became of it ---- */

static double largest(const double value[3])
{
    return fmax(value[0], fmax(value[1], value[2]));
}

static double worst_energy(const double energy[3])
{
    double worst = energy[0];
    for (int c = 1; c < 3; c++) {
        worst = fabs(energy[c] - 1) > fabs(worst - 1) ? energy[c] : worst;
    }
    return worst;
}

static void rate(parian_medium_report *report, parian_edit_part part, double value, double allowed)
{
    report->missing |= value > WRONG ? (uint32_t)part : 0;
    report->approximate |= value > allowed && !(value > WRONG) ? (uint32_t)part : 0;
}

static void judge(const parian_edited_body *edited, const parian_probe_error *error,
                  parian_medium_report *report)
{
    const parian_body *body = &edited->body;
    report->exact = PARIAN_EDIT_OPTICS;
    report->exact |= body->operator_count ? PARIAN_EDIT_FACTORS : 0;
    report->exact |= body->blend_weight ? PARIAN_EDIT_WEIGHTS : 0;
    report->exact |= body->local_form != PARIAN_LOCAL_NONE ? PARIAN_EDIT_KERNELS : 0;
    report->beyond_mean = largest(edited->beyond_mean);
    report->beyond_max = edited->beyond_max;
    report->error_smooth = largest(error->l2[PARIAN_PROBE_SMOOTH]);
    report->error_hard = largest(error->l2[PARIAN_PROBE_HARD]);
    report->energy = worst_energy(error->energy[PARIAN_PROBE_SMOOTH]);
    if (body->operator_count) {
        rate(report, PARIAN_EDIT_REACH, report->beyond_mean, BEYOND_ALLOWED);
    } else {
        rate(report, PARIAN_EDIT_GLOBAL_PART, 1 - report->energy, ENERGY_ALLOWED);
    }
    if (!(report->missing & PARIAN_EDIT_GLOBAL_PART)) {
        rate(report, PARIAN_EDIT_RESOLUTION, report->error_smooth - report->beyond_mean,
             HARD_ALLOWED);
    }
    if (body->local_form == PARIAN_LOCAL_NONE) {
        rate(report, PARIAN_EDIT_LOCAL_PART, report->error_hard, HARD_ALLOWED);
    }
}

static void add_text(parian_medium_report *report, const char *format, double value)
{
    size_t length = strlen(report->text);
    snprintf(report->text + length, sizeof report->text - length, format, value);
}

static void describe(parian_medium_report *report)
{
    uint32_t off = report->approximate | report->missing;
    snprintf(report->text, sizeof report->text, "optics%s%s%s follow the medium",
             report->exact & PARIAN_EDIT_FACTORS ? ", factors" : "",
             report->exact & PARIAN_EDIT_WEIGHTS ? ", weights" : "",
             report->exact & PARIAN_EDIT_KERNELS ? ", kernels" : "");
    if (off & PARIAN_EDIT_REACH) {
        add_text(
            report,
            "; %.2g %% of the light reaches farther than the pairs in the file and goes to those",
            100 * report->beyond_mean);
    }
    if (off & PARIAN_EDIT_GLOBAL_PART) {
        add_text(report, "; %.2g %% of the light is lost, for there is no global part",
                 100 * (1 - report->energy));
    }
    if (off & PARIAN_EDIT_LOCAL_PART) {
        add_text(report, "; hard edges blur, for there is no local part", 0);
    }
    if (off & PARIAN_EDIT_RESOLUTION) {
        add_text(report, "; vertices and texels are coarse for this medium", 0);
    }
    add_text(report, "; error of B %.2g %% under smooth light", 100 * report->error_smooth);
    add_text(report, ", %.2g %% at hard edges", 100 * report->error_hard);
    if (report->missing) {
        add_text(report, "; bake anew for this medium", 0);
    }
}

/* ---- doing it ---- */

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* First pass that another medium makes stale: E knows the index alone; without operators the
 * register that the restriction fills stays as it is. */
static parian_pass first_stale(const parian_body *body, const parian_medium *old,
                               const parian_medium *medium)
{
    return old->eta != medium->eta                      ? PARIAN_PASS_IRRADIANCE
           : body->operator_count || body->blend_weight ? PARIAN_PASS_RESTRICT
                                                        : PARIAN_PASS_FILTER;
}

static parian_result make_edited(const parian_renderer *renderer, uint32_t b,
                                 const parian_medium *medium, parian_edited_body *edited,
                                 parian_medium_report *report)
{
    const parian_body *baked = &renderer->scene->data.bodies[b];
    *report = AS_BAKED;
    if (same_medium(medium, &baked->medium)) {
        return parian_edited_body_restore(&renderer->env, baked, edited);
    }
    parian_result result = parian_edited_body_make(&renderer->env, baked, medium, edited);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_probe_error error;
    result = parian_transport_probe(&renderer->env, &edited->body, &edited->kernels, &error);
    if (result == PARIAN_OK) {
        judge(edited, &error, report);
        describe(report);
    } else {
        parian_edited_body_free(&renderer->env, edited);
    }
    return result;
}

static parian_result change_medium(parian_renderer *renderer, uint32_t b,
                                   const parian_medium *medium)
{
    const parian_body *baked = &renderer->scene->data.bodies[b];
    parian_body_medium *now = &renderer->medium[b];
    parian_edited_body edited = {.owned = false};
    parian_medium_report report;
    double start = seconds_now();
    parian_result result = make_edited(renderer, b, medium, &edited, &report);
    if (result == PARIAN_OK) {
        result = renderer->backend->edit(renderer, b, &edited);
        parian_edited_body_free(&renderer->env, &edited);
        now->broken = result == PARIAN_E_DEVICE || (now->broken && result != PARIAN_OK);
    }
    parian_frame_memory_trim(&renderer->frame_memory); /* much was needed that no frame needs */
    if (result != PARIAN_OK) {
        return result;
    }
    parian_pass from = first_stale(baked, &now->medium, medium);
    renderer->edited_from = from < renderer->edited_from ? from : renderer->edited_from;
    parian_body_optics optics = parian_body_optics_make(medium, baked->fit_fdr);
    memcpy(optics.tint, renderer->optics[b].tint, sizeof optics.tint);
    renderer->optics[b] = optics;
    now->medium = *medium;
    now->report = report;
    now->report.seconds = seconds_now() - start;
    parian_log(&renderer->env, report.missing ? PARIAN_LOG_WARNING : PARIAN_LOG_INFO,
               "medium of body '%s': %s", baked->name, report.text);
    return PARIAN_OK;
}

/* True when the tint is another than before. */
static bool change_tint(parian_renderer *renderer, uint32_t b, const float asked[3])
{
    static const float white[3] = {1, 1, 1};
    bool none = asked[0] == 0 && asked[1] == 0 && asked[2] == 0;
    const float *tint = none ? white : asked;
    float *now = renderer->optics[b].tint;
    bool changed = memcmp(now, tint, sizeof white) != 0;
    memcpy(now, tint, sizeof white);
    return changed;
}

parian_result parian_renderer_set_medium(parian_renderer *renderer, uint32_t body,
                                         const parian_medium_edit *edit,
                                         parian_medium_report *report)
{
    static const parian_medium_edit nothing = {.change_medium = false};
    const parian_medium_edit *wanted = edit ? edit : &nothing;
    parian_medium medium;
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    const parian_env *env = &renderer->env;
    if (body >= renderer->scene->data.body_count) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "there is no body %u, the scene has %u", body,
                           renderer->scene->data.body_count);
    }
    parian_result result = parian_renderer_check_uploaded(renderer);
    if (result == PARIAN_OK) {
        result = check_tint(env, wanted->tint);
    }
    if (result == PARIAN_OK) {
        result = resolve(env, &renderer->scene->data.bodies[body].medium, wanted, &medium);
    }
    parian_body_medium *now = &renderer->medium[body];
    bool same = result == PARIAN_OK && same_medium(&medium, &now->medium) && !now->broken;
    if (result == PARIAN_OK && !same) {
        result = change_medium(renderer, body, &medium);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    bool tinted = change_tint(renderer, body, wanted->tint);
    renderer->picture_stale = renderer->picture_stale || tinted || !same;
    if (report) {
        *report = now->report;
        report->exact |= tinted ? PARIAN_EDIT_TINT : 0;
        report->seconds = same ? 0 : report->seconds;
    }
    return PARIAN_OK;
}
