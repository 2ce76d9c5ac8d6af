/* surface_quadrature.c - B at receivers as the integral of a BSSRDF over the surface, in
 * independent replicates.
 *
 * In each replicate every stratum of the surface gets one random place. Strata that are far from a
 * receiver share theirs, with its light, among all receivers; near ones are cut further for each
 * receiver and get fresh places. Which is which depends on geometry alone, so that every replicate
 * is an unbiased estimate of B, and the spread of the replicates is that of their mean.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/surface_quadrature.h"

#include <math.h>
#include <string.h>

#include "bake/reference/light_sampler.h"
#include "bake/reference/quadrature_parts.h"
#include "bake/reference/reference_scene.h"
#include "core/memory.h"
#include "tool/session.h"

enum {
    REPLICATES = 8,
    PLACES_DEFAULT = 8192, /* of a replicate */
    PLACES_MAX = 1 << 18,  /* beyond, there are more replicates */
    PLACES_MIN = 64,
    ARRIVALS_MAX = 1 << 24, /* of a replicate: half a gigabyte */
    REPLICATES_MAX = 1 << 20,
    RECEIVERS_PER_TASK = 8,
    TASKS_PER_BATCH = 32,
    IRRADIANCE_SAMPLES = 1024 /* of a light of extent at a receiver */
};

/* How the places of a receiver are dealt to replicates. */
typedef struct replicate_plan {
    uint64_t replicates, places;
} replicate_plan;

/* Places of a replicate are kept in memory, with every light's direction where directions count. */
static replicate_plan plan_replicates(const quadrature_job *job)
{
    bool directions = job->desc->bssrdf.model == PARIAN_REFERENCE_DIRECTIONAL;
    uint64_t samples = job->desc->samples ? job->desc->samples : REPLICATES * PLACES_DEFAULT;
    uint64_t arrivals = quadrature_count_arrivals(job->scene);
    uint64_t most = directions && arrivals ? ARRIVALS_MAX / arrivals : PLACES_MAX;
    replicate_plan plan = {REPLICATES, samples / REPLICATES};
    most = most < PLACES_MAX ? most : PLACES_MAX;
    if (plan.places > most) {
        plan.places = most;
        plan.replicates = samples / most;
        plan.replicates = plan.replicates < REPLICATES_MAX ? plan.replicates : REPLICATES_MAX;
    }
    plan.places = plan.places > PLACES_MIN ? plan.places : PLACES_MIN;
    return plan;
}

/* ---- E at the receivers ------------------------------------------------------------------------
 */
typedef struct irradiance_job {
    const parian_reference_scene *scene;
    const parian_receivers *receivers;
    uint64_t seed;
    double (*E)[3];
} irradiance_job;

static void light_receiver(void *context, size_t i)
{
    const irradiance_job *job = context;
    parian_place place;
    parian_random random = parian_random_stream(job->seed ^ QUADRATURE_SALT, UINT64_MAX, 0, i);
    parian_receiver_place(job->receivers, i, &place);
    for (uint32_t l = 0; l < job->scene->light_count; l++) {
        parian_reference_irradiance(job->scene, l, &place, IRRADIANCE_SAMPLES, &random, job->E[i]);
    }
}

/* ---- replicates --------------------------------------------------------------------------------
 */

/* Welford's update of mean and squared deviations by the next replicate. */
static void take_value(const quadrature_job *job, size_t at, const double B[3])
{
    uint32_t i = job->index[at];
    for (int c = 0; c < 3; c++) {
        double delta = B[c] - job->mean[i][c];
        job->mean[i][c] += delta / (double)(job->replicate + 1);
        job->square[i][c] += delta * (B[c] - job->mean[i][c]);
    }
}

static void run_task(void *context, size_t task)
{
    const quadrature_job *job = context;
    size_t from = job->batch_first + task * RECEIVERS_PER_TASK, to = from + RECEIVERS_PER_TASK;
    double B[RECEIVERS_PER_TASK][3] = {{0}};
    to = to < job->index_count ? to : job->index_count;
    if (from >= to || parian_cancelled(job->env)) {
        return;
    }
    quadrature_far(job, from, to, B);
    quadrature_near(job, from, to, B);
    for (size_t k = from; k < to; k++) {
        take_value(job, k, B[k - from]);
    }
}

/* One replicate of one body, with progress from `done` by `step`. */
static parian_result run_replicate(quadrature_job *job, double done, double step)
{
    size_t batch = RECEIVERS_PER_TASK * TASKS_PER_BATCH;
    quadrature_light_places(job);
    for (size_t first = 0; first < job->index_count; first += batch) {
        if (parian_cancelled(job->env)) {
            return PARIAN_E_INTERRUPTED;
        }
        job->batch_first = first;
        parian_par(job->env, TASKS_PER_BATCH, run_task, job);
        double share = (double)(first + batch) / (double)job->index_count;
        parian_progress(job->env, "quadrature", done + step * fmin(1, share));
    }
    return parian_cancelled(job->env) ? PARIAN_E_INTERRUPTED : PARIAN_OK;
}

/* Flux that enters a body, as the present replicate has it. */
static void add_flux(const quadrature_surface *surface, double weight, double flux[3])
{
    for (int c = 0; c < 3; c++) {
        for (size_t i = 0; i < surface->stratum_count; i++) {
            flux[c] += weight * surface->flux[c][i];
        }
    }
}

static parian_result run_body(quadrature_job *job, const replicate_plan *plan, uint32_t body,
                              parian_reference_result *result)
{
    double bodies = job->scene->body_count, replicates = (double)plan->replicates;
    parian_result r = quadrature_surface_make(job, body, plan->places, &job->surface);
    for (int c = 0; r == PARIAN_OK && job->desc->scale && c < 3; c++) {
        job->desc->scale[body][c] = parian_bssrdf_scale(job->surface.bssrdf, c);
    }
    for (uint64_t k = 0; r == PARIAN_OK && k < plan->replicates; k++) {
        job->replicate = k;
        r = run_replicate(job, (body + (double)k / replicates) / bodies, 1 / (replicates * bodies));
        add_flux(&job->surface, 1 / replicates, result->in);
    }
    if (r == PARIAN_OK) {
        uint64_t most = plan->replicates * job->surface.stratum_count;
        result->samples = result->samples > most ? result->samples : most;
    }
    quadrature_surface_free(job->env, &job->surface);
    return r;
}

static parian_result run_bodies(quadrature_job *job, const replicate_plan *plan,
                                parian_reference_result *result)
{
    uint32_t *index;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(job->env, index, job->receivers->count)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %zu receivers",
                           job->receivers->count);
    }
    job->index = index;
    for (uint32_t b = 0; r == PARIAN_OK && b < job->scene->body_count; b++) {
        job->index_count = 0;
        for (size_t i = 0; i < job->receivers->count; i++) {
            if (job->receivers->body[i] == b) {
                index[job->index_count++] = (uint32_t)i;
            }
        }
        r = run_body(job, plan, b, result);
    }
    parian_free(job->env, index);
    return r;
}

/* ---- result ------------------------------------------------------------------------------------
 */

/* Standard errors from squared deviations; totals; places of the busiest receiver. */
static void finish(const quadrature_job *job, const replicate_plan *plan,
                   parian_reference_result *result)
{
    const parian_receivers *receivers = job->receivers;
    double n = (double)plan->replicates;
    uint64_t fresh = 0;
    for (size_t i = 0; i < receivers->count; i++) {
        fresh = fresh > job->near_count[i] ? fresh : job->near_count[i];
        for (int c = 0; c < 3; c++) {
            result->standard_error[i][c] = sqrt(job->square[i][c] / (n * (n - 1)));
            result->out[c] += receivers->area[i] * result->radiosity[i][c];
        }
    }
    result->samples += fresh;
    for (int c = 0; c < 3; c++) {
        result->absorbed[c] = result->in[c] - result->out[c];
    }
}

static parian_result check(const parian_env *env, const parian_reference_scene *scene,
                           const parian_receivers *receivers)
{
    for (size_t i = 0; i < receivers->count; i++) {
        if (receivers->body[i] >= scene->body_count) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "receiver %zu is on body %u of %u", i,
                               receivers->body[i], scene->body_count);
        }
    }
    return receivers->count <= UINT32_MAX
               ? PARIAN_OK
               : parian_fail(env, PARIAN_E_ARGUMENT, "%zu receivers", receivers->count);
}

static parian_result compute(quadrature_job *job, parian_reference_result *result)
{
    replicate_plan plan = plan_replicates(job);
    irradiance_job light = {job->scene, job->receivers, job->desc->seed, result->irradiance};
    job->mean = result->radiosity;
    job->square = result->standard_error;
    parian_progress(job->env, "irradiance", 0);
    parian_par(job->env, job->receivers->count, light_receiver, &light);
    parian_result r = run_bodies(job, &plan, result);
    if (r == PARIAN_OK) {
        finish(job, &plan, result);
    }
    return r;
}

parian_result parian_reference_quadrature(const parian_env *env,
                                          const parian_reference_scene *scene,
                                          const parian_receivers *receivers,
                                          const parian_reference_quadrature_desc *desc,
                                          parian_reference_result *result)
{
    quadrature_job job = {.env = env, .scene = scene, .receivers = receivers, .desc = desc};
    double start = parian_seconds();
    parian_result r = parian_reference_result_init(env, receivers->count, false, result);
    if (r == PARIAN_OK) {
        r = check(env, scene, receivers);
    }
    if (r == PARIAN_OK && !PARIAN_NEW0(env, job.near_count, receivers->count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", receivers->count);
    }
    if (r == PARIAN_OK) {
        r = compute(&job, result);
    }
    parian_free(env, job.near_count);
    result->seconds = parian_seconds() - start;
    return r;
}
