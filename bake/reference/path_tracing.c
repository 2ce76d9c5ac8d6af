/* path_tracing.c - prepares a scene for paths, runs the rounds, and hands back what they amount to.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_tracing.h"

#include <string.h>
#include <unistd.h>

#include "bake/reference/path_pilot.h"
#include "bake/reference/path_rounds.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/vec3d.h"
#include "core/memory.h"
#include "tool/session.h"

enum {
    GRID_LEAST = 8, /* voxels along a body */
    GRID_MOST = 192,
    GRID_PER_FLIGHT = 4, /* voxels per mean free path */
    SAMPLES_DEFAULT = 1024,
    IRRADIANCE_SAMPLES = 1024, /* for E of a light of extent, as in a quadrature */
    PILOT_WALKS = 32,
    PILOT_FEWEST = 8,
    PILOT_SHARE = 16 /* walks of the run for each of the pilot, at least */
};
static const uint64_t SAMPLES_MAX = (uint64_t)1 << 40;
static const uint64_t IRRADIANCE_SEED = 0x4952524144494E43u;

/* ---- what can be traced ---- */

static parian_result check_scene(const parian_env *env, const parian_reference_scene *scene,
                                 const parian_receivers *receivers)
{
    if (!scene->rays || !scene->sampler || receivers->count == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "path tracing: %s",
                           receivers->count == 0 ? "no receivers"
                                                 : "a scene without rays or lights");
    }
    for (uint32_t b = 0; b < scene->body_count; b++) {
        const parian_reference_body *body = &scene->bodies[b];
        if (!body->closed) {
            return parian_fail(
                env, PARIAN_E_FORMAT,
                "body \"%s\" is open: path tracing needs a closed surface, for an open "
                "one has no inside",
                body->name);
        }
        parian_result r = parian_path_medium_check(env, body);
        if (r != PARIAN_OK) {
            return r;
        }
    }
    for (size_t i = 0; i < receivers->count; i++) {
        uint32_t b = receivers->body[i];
        if (b >= scene->body_count ||
            receivers->triangle[i] >= scene->bodies[b].mesh.triangle_count) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "receiver %zu: body %u of %u, triangle %u: there is no such place",
                               i, b, scene->body_count, receivers->triangle[i]);
        }
    }
    return PARIAN_OK;
}

static parian_result check_desc(const parian_env *env, const parian_path_desc *desc)
{
    if (!(desc->standard_error >= 0) || !(desc->patch >= 0) || desc->samples > SAMPLES_MAX ||
        !(desc->patch < INFINITY) || (int)desc->walk < 0 || desc->walk > PARIAN_WALK_FORWARD) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "path tracing: standard error %g, patch %g m, walk %d: expected numbers of 0 or "
            "more, and a kind of walk",
            desc->standard_error, desc->patch, (int)desc->walk);
    }
    return PARIAN_OK;
}

/* ---- the scene as paths see it ---- */

static void set_light_point(const path_scene *path, uint32_t l)
{
    const parian_light *light = parian_light_sampler_light(path->scene->sampler, l);
    parian_light_point *point = &path->light[l].point;
    if (light->type == PARIAN_LIGHT_DIRECTIONAL) {
        point->at_infinity = true;
        vec3d_from_float(point->direction, light->direction);
        vec3d_normalize(point->direction);
        vec3d_scale(point->direction, -1);
    } else {
        vec3d_from_float(point->position, light->position);
    }
}

/* Indices by the direction of a light from infinity, one for each body. */
static parian_result prepare_indices(path_scene *path, path_light *light)
{
    parian_result r = PARIAN_OK;
    if (light->meeting != PATH_BY_CONNECTION || !light->point.at_infinity) {
        return r;
    }
    if (!PARIAN_NEW0(path->env, light->index, path->scene->body_count)) {
        return parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %u bodies",
                           path->scene->body_count);
    }
    for (uint32_t b = 0; b < path->scene->body_count && r == PARIAN_OK; b++) {
        r = parian_refractor_prepare_direction(path->env, path->body[b].refractor,
                                               light->point.direction, path->body[b].index_length,
                                               &light->index[b]);
    }
    return r;
}

static parian_result prepare_lights(path_scene *path, parian_walk_kind walk)
{
    parian_result r = PARIAN_OK;
    uint32_t count = path->scene->light_count;
    if (!PARIAN_NEW0(path->env, path->light, count)) {
        return parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %u lights", count);
    }
    for (uint32_t l = 0; l < count && r == PARIAN_OK; l++) {
        bool delta = parian_light_is_delta(parian_light_sampler_light(path->scene->sampler, l));
        path_meeting meeting = delta ? PATH_BY_CONNECTION : PATH_BY_EXIT;
        path->light[l].meeting = walk == PARIAN_WALK_FORWARD ? PATH_BY_FORWARD : meeting;
        if (delta) {
            set_light_point(path, l);
        }
        r = parian_path_entries_make(path, l);
        r = r == PARIAN_OK ? prepare_indices(path, &path->light[l]) : r;
    }
    return r;
}

/* Twelve mean radii of the search in the clearest channel, or twice the body where that is less. */
static void set_index_length(path_body *body)
{
    double rate = INFINITY;
    for (int c = 0; c < 3; c++) {
        rate = fmin(rate, parian_path_connection_rate(&body->medium[c]));
    }
    double whole = body->extent > 0 ? 2 * body->extent : 1;
    body->index_length = rate * whole > 12 ? 12 / rate : whole;
}

/* Voxels as fine as the flights that they are to save rays of. */
static uint32_t grid_resolution(const path_body *body)
{
    double extinction = 0;
    for (int c = 0; c < 3; c++) {
        extinction = fmax(extinction, body->medium[c].majorant);
    }
    return (uint32_t)fmin(fmax(GRID_PER_FLIGHT * extinction * body->extent, GRID_LEAST), GRID_MOST);
}

static parian_result prepare_body(path_scene *path, uint32_t b)
{
    path_body *body = &path->body[b];
    double upper[3], lower[3];
    body->source = &path->scene->bodies[b];
    parian_mesh_bounds(&body->source->mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        body->extent = fmax(body->extent, upper[k] - lower[k]);
        body->medium[k] = parian_path_medium_make(body->source, k);
    }
    set_index_length(body);
    body->first_triangle = path->triangle_total;
    path->triangle_total += body->source->mesh.triangle_count;
    parian_result r =
        parian_path_grid_make(path->env, &body->source->mesh, grid_resolution(body), &body->grid);
    if (r == PARIAN_OK && path->any_connection) {
        r = parian_refractor_create(path->env, &body->source->mesh, body->source->medium.eta,
                                    &body->refractor);
    }
    return r;
}

static parian_result list_triangles(path_scene *path)
{
    if (path->triangle_total >= UINT32_MAX / 2) {
        return parian_fail(path->env, PARIAN_E_LIMIT, "path tracing: %u triangles are too many",
                           path->triangle_total);
    }
    if (!PARIAN_NEW(path->env, path->triangle_body, path->triangle_total)) {
        return parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %u triangles",
                           path->triangle_total);
    }
    for (uint32_t b = 0, t = 0; b < path->scene->body_count; b++) {
        for (uint32_t i = 0; i < path->body[b].source->mesh.triangle_count; i++) {
            path->triangle_body[t++] = b;
        }
    }
    return PARIAN_OK;
}

static bool any_light_without_extent(const parian_reference_scene *scene)
{
    for (uint32_t l = 0; l < scene->light_count; l++) {
        if (parian_light_is_delta(parian_light_sampler_light(scene->sampler, l))) {
            return true;
        }
    }
    return false;
}

static uint64_t resolve_samples(const parian_path_desc *desc)
{
    if (desc->samples > 0) {
        return desc->samples;
    }
    return desc->standard_error > 0 ? SAMPLES_MAX : SAMPLES_DEFAULT;
}

/* Half a transport mean free path, but never more than a hundredth of the body nor less than a
 * thousandth. */
static double default_patch(const path_scene *path)
{
    double patch = INFINITY;
    for (uint32_t b = 0; b < path->scene->body_count; b++) {
        const path_body *body = &path->body[b];
        double extinction = 0;
        for (int c = 0; c < 3; c++) {
            const parian_path_medium *m = &body->medium[c];
            extinction = fmax(extinction, m->mean * (1 - m->walk.g));
        }
        double half = extinction > 0 ? 0.5 / extinction : INFINITY;
        patch = fmin(patch, fmin(fmax(half, 1e-3 * body->extent), 1e-2 * body->extent));
    }
    return patch > 0 ? patch : 1e-3;
}

/* Walks of the pilot: none where the run itself has hardly more. */
static uint32_t pilot_walks(const parian_path_desc *desc)
{
    uint64_t samples = resolve_samples(desc) / PILOT_SHARE;
    return samples >= PILOT_WALKS ? PILOT_WALKS : samples >= PILOT_FEWEST ? (uint32_t)samples : 0;
}

/* Patches where photons may be needed; then each light's kind, where that is left open. */
static parian_result settle_meetings(path_scene *path, const parian_path_desc *desc)
{
    uint32_t walks = desc->walk == PARIAN_WALK_AUTO ? pilot_walks(desc) : 0;
    bool any = walks > 0;
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        any |= path->light[l].meeting != PATH_BY_EXIT;
    }
    parian_result r = PARIAN_OK;
    if (any) {
        r = parian_path_patches_make(path, desc->patch > 0 ? desc->patch : default_patch(path));
    }
    if (r == PARIAN_OK && walks > 0) {
        r = parian_path_choose_meetings(path, walks);
    }
    path->any_connection = false;
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        path->any_connection |= path->light[l].meeting == PATH_BY_CONNECTION;
        path->any_forward |= path->light[l].meeting != PATH_BY_EXIT;
    }
    return r;
}

static parian_result prepare(path_scene *path, const parian_path_desc *desc)
{
    parian_result r = PARIAN_OK;
    path->any_connection =
        desc->walk != PARIAN_WALK_FORWARD && any_light_without_extent(path->scene);
    if (!PARIAN_NEW0(path->env, path->body, path->scene->body_count)) {
        return parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %u bodies",
                           path->scene->body_count);
    }
    for (uint32_t b = 0; b < path->scene->body_count && r == PARIAN_OK; b++) {
        r = prepare_body(path, b);
    }
    r = r == PARIAN_OK ? list_triangles(path) : r;
    r = r == PARIAN_OK ? prepare_lights(path, desc->walk) : r;
    return r == PARIAN_OK ? settle_meetings(path, desc) : r;
}

static void unprepare(path_scene *path)
{
    for (uint32_t b = 0; path->body && b < path->scene->body_count; b++) {
        parian_path_grid_free(path->env, &path->body[b].grid);
        parian_refractor_destroy(path->body[b].refractor);
    }
    for (uint32_t l = 0; path->light && l < path->scene->light_count; l++) {
        path_light *light = &path->light[l];
        for (uint32_t b = 0; light->index && b < path->scene->body_count; b++) {
            parian_refractor_index_destroy(light->index[b]);
        }
        parian_free(path->env, light->index);
        parian_free(path->env, light->cumulative);
    }
    parian_path_patches_free(path);
    parian_free(path->env, path->body);
    parian_free(path->env, path->light);
    parian_free(path->env, path->triangle_body);
}

/* ---- what needs no walk ---- */

typedef struct straight_job {
    const path_scene *path;
    double (*straight)[3], (*irradiance)[3];
} straight_job;

static void straight_piece(void *context, size_t i)
{
    straight_job *job = context;
    const path_scene *path = job->path;
    parian_random random = parian_random_stream(path->seed ^ IRRADIANCE_SEED, i, 0, 0);
    parian_place place;
    if (parian_cancelled(path->env)) {
        return;
    }
    parian_receiver_place(path->receivers, i, &place);
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        parian_reference_irradiance(path->scene, l, &place, IRRADIANCE_SAMPLES, &random,
                                    job->irradiance[i]);
    }
    for (int c = 0; c < 3 && path->any_connection; c++) {
        job->straight[i][c] = parian_path_straight(path, c, i);
    }
}

/* ---- the whole ---- */

static void fill_result(const path_run *run, parian_reference_result *result)
{
    const parian_path_counters *now = &run->state.now;
    double photons = fmax((double)parian_path_book_photons(run), 1);
    for (size_t i = 0; i < run->state.count * 3; i++) {
        size_t r = i / 3, c = i % 3;
        parian_path_outcome(run, r, (int)c, &result->radiosity[r][c], &result->standard_error[r][c],
                            &result->unscattered[r][c]);
    }
    for (int c = 0; c < 3; c++) {
        const parian_walk_books *books = &now->books[c];
        result->in[c] = books->started / photons;
        result->out[c] = books->left / photons;
        result->absorbed[c] = books->absorbed / photons;
        result->roulette_added[c] = books->roulette_added / photons;
        result->roulette_removed[c] = books->roulette_removed / photons;
        result->lost[c] = books->lost / photons;
    }
    result->samples = now->walks;
    result->scattering_events = now->events;
    result->seconds = now->seconds + parian_seconds() - run->started;
    if (now->lost > 0) {
        parian_log(run->env, PARIAN_LOG_INFO,
                   "path tracing: %llu of %llu walks and photons were lost",
                   (unsigned long long)now->lost, (unsigned long long)now->started);
    }
}

static parian_result trace(path_run *run, parian_reference_result *result)
{
    straight_job job = {run->path, run->straight, result->irradiance};
    parian_par(run->env, run->state.count, straight_piece, &job);
    if (parian_cancelled(run->env)) {
        return PARIAN_E_INTERRUPTED; /* no step was taken: the checkpoint, if any, stays */
    }
    parian_result r = parian_path_rounds(run);
    if (r != PARIAN_OK) {
        return r;
    }
    fill_result(run, result);
    if (run->desc->checkpoint) {
        unlink(run->desc->checkpoint);
    }
    return PARIAN_OK;
}

static parian_result start_run(path_run *run, const path_scene *path)
{
    size_t count = path->receivers->count;
    for (uint32_t l = 0; l < path->scene->light_count; l++) {
        run->any_walk |= path->light[l].meeting != PATH_BY_FORWARD;
    }
    parian_result r = parian_path_state_make(run->env, count, &run->state);
    if (r == PARIAN_OK && !PARIAN_NEW0(run->env, run->straight, count)) {
        r = parian_fail(run->env, PARIAN_E_NOMEM, "no memory for %zu receivers", count);
    }
    run->state.now.passes = path->any_forward ? 1 : 0;
    if (!run->any_walk && path->any_forward) { /* as many photons as walks would be */
        run->state.now.passes += count * PATH_ROUND_WALKS / (PATH_BLOCKS * PATH_BLOCK_PHOTONS);
    }
    r = r == PARIAN_OK
            ? parian_path_hash(run->env, path->scene, path->receivers, run->desc, &run->hash)
            : r;
    if (r == PARIAN_OK && run->desc->checkpoint) {
        r = parian_path_checkpoint_read(run->env, run->desc->checkpoint, run->hash, &run->state);
    }
    return r;
}

parian_result parian_reference_path(const parian_env *env, const parian_reference_scene *scene,
                                    const parian_receivers *receivers, const parian_path_desc *desc,
                                    parian_reference_result *result)
{
    path_scene path = {.env = env, .scene = scene, .receivers = receivers, .seed = desc->seed};
    path_run run = {.env = env, .path = &path, .desc = desc, .samples = resolve_samples(desc)};
    run.started = parian_seconds();
    *result = (parian_reference_result){0};
    parian_result r = check_desc(env, desc);
    r = r == PARIAN_OK ? check_scene(env, scene, receivers) : r;
    if (r != PARIAN_OK) {
        return r;
    }
    r = parian_reference_result_init(env, receivers->count, true, result);
    r = r == PARIAN_OK ? prepare(&path, desc) : r;
    r = r == PARIAN_OK ? start_run(&run, &path) : r;
    r = r == PARIAN_OK ? trace(&run, result) : r;
    parian_path_state_free(env, &run.state);
    parian_free(env, run.straight);
    unprepare(&path);
    return r;
}
