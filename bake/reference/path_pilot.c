/* path_pilot.c - compares walks against a light with photons from it: variance times work.
 *
 * With n walks from each of R receivers the variances sum to V_w / n and the work is n R events_w;
 * with m photons they sum to V_p / m and the work is m events_p. The products V_w R events_w and
 * V_p events_p therefore are the work that a given error costs. Photons must win clearly, for their
 * patches blur.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_pilot.h"

#include "bake/reference/path_rounds.h"
#include "core/memory.h"
#include "tool/session.h"

enum { PILOT_RECEIVERS = 128 };
/* What an event of a walk costs that searches connections, in events of a photon
 * (bench_path_tracing lights). */
static const double CONNECTION_WORK = 1.6;
static const double PHOTONS_MUST_SAVE = 2;
/* Draws of the pilot are apart from those that count. */
static const uint64_t PILOT_FIRST = (uint64_t)1 << 49;

typedef struct pilot_job {
    const path_scene *path;
    uint32_t light, walks;
    size_t stride;
    path_tally *tally;        /* [receivers of the pilot * 3] */
    double (*flux)[2];        /* [3 * PATH_BLOCKS][receivers] */
    parian_walk_books *books; /* [the larger of both counts] */
} pilot_job;

static size_t pilot_receivers(const path_scene *path, size_t *stride)
{
    *stride = (path->receivers->count + PILOT_RECEIVERS - 1) / PILOT_RECEIVERS;
    return (path->receivers->count + *stride - 1) / *stride;
}

static void walk_piece(void *context, size_t i)
{
    pilot_job *job = context;
    if (!parian_cancelled(job->path->env)) {
        parian_path_adjoint(job->path, i / 3 * job->stride, (int)(i % 3), PILOT_FIRST, job->walks,
                            &job->tally[i], &job->books[i]);
    }
}

static void photon_piece(void *context, size_t piece)
{
    pilot_job *job = context;
    path_photons photons = {.light = job->light,
                            .channel = (int)(piece / PATH_BLOCKS),
                            .share = PATH_EVERYTHING,
                            .first = PILOT_FIRST + piece % PATH_BLOCKS * PATH_BLOCK_PHOTONS,
                            .count = PATH_BLOCK_PHOTONS};
    if (!parian_cancelled(job->path->env)) {
        parian_path_forward(job->path, &photons, job->flux + piece * job->path->receivers->count,
                            &job->books[piece]);
    }
}

/* Variance of one value, from n of them. */
static double variance(double sum, double square, double n)
{
    return fmax(0, square - sum * sum / n) / (n - 1);
}

static double work_of_walks(pilot_job *job, size_t count)
{
    double spread = 0, events = 0, receivers = (double)job->path->receivers->count;
    bool searches = job->path->light[job->light].meeting == PATH_BY_CONNECTION;
    parian_par(job->path->env, count * 3, walk_piece, job);
    for (size_t i = 0; i < count * 3; i++) {
        spread += variance(job->tally[i].sum, job->tally[i].square, job->walks);
        events += (double)job->books[i].events + job->walks;
    }
    double per_walk = events / ((double)count * 3 * job->walks);
    return spread / (double)count * receivers * receivers * per_walk *
           (searches ? CONNECTION_WORK : 1);
}

static double work_of_photons(pilot_job *job)
{
    size_t count = job->path->receivers->count;
    double spread = 0, events = 0;
    parian_par(job->path->env, 3 * PATH_BLOCKS, photon_piece, job);
    for (size_t i = 0; i < count * 3; i++) {
        double sum = 0, square = 0;
        for (size_t block = 0; block < PATH_BLOCKS; block++) {
            size_t piece = i % 3 * PATH_BLOCKS + block;
            double value = job->flux[piece * count + i / 3][0] / PATH_BLOCK_PHOTONS;
            sum += value;
            square += value * value;
        }
        spread += variance(sum, square, PATH_BLOCKS);
    }
    for (size_t piece = 0; piece < 3 * PATH_BLOCKS; piece++) {
        events += (double)job->books[piece].events + PATH_BLOCK_PHOTONS;
    }
    return spread * events / (3.0 * PATH_BLOCKS); /* of a block: photons cancel */
}

/* A light of extent that the walks never found is one for photons, if these found it. Connections
 * that find nothing are right: nothing scatters. */
static bool photons_win(path_meeting usual, double walks, double photons)
{
    if (!(walks > 0)) {
        return usual == PATH_BY_EXIT && photons > 0;
    }
    return photons > 0 && photons * PHOTONS_MUST_SAVE < walks;
}

static parian_result try_light(path_scene *path, uint32_t l, uint32_t walks, bool *forward)
{
    pilot_job job = {.path = path, .light = l, .walks = walks};
    size_t count = pilot_receivers(path, &job.stride), most = 3 * PILOT_RECEIVERS;
    bool made = PARIAN_NEW0(path->env, job.tally, count * 3) &&
                PARIAN_NEW0(path->env, job.books, 2 * most) &&
                PARIAN_NEW0(path->env, job.flux, path->receivers->count * 3 * PATH_BLOCKS);
    parian_result r =
        made ? PARIAN_OK
             : parian_fail(path->env, PARIAN_E_NOMEM,
                           "no memory to try the lights on %zu receivers", path->receivers->count);
    if (made) {
        double of_walks = work_of_walks(&job, count);
        job.books += most;
        double of_photons = work_of_photons(&job);
        job.books -= most;
        *forward = photons_win(path->light[l].meeting, of_walks, of_photons);
        parian_log(
            path->env, PARIAN_LOG_INFO,
            "path tracing: light %u by %s; for the same error photons take %.3g times the work "
            "of walks",
            l, *forward ? "photons" : "walks", of_walks > 0 ? of_photons / of_walks : 0);
    }
    parian_free(path->env, job.tally);
    parian_free(path->env, job.books);
    parian_free(path->env, job.flux);
    return r == PARIAN_OK && parian_cancelled(path->env) ? PARIAN_E_INTERRUPTED : r;
}

/* Try one light while the others are met by nothing. */
static parian_result try_alone(path_scene *path, const path_meeting *usual, uint32_t l,
                               uint32_t walks, bool *forward)
{
    for (uint32_t k = 0; k < path->scene->light_count; k++) {
        path->light[k].meeting = k == l ? usual[k] : PATH_BY_FORWARD;
    }
    return try_light(path, l, walks, forward);
}

parian_result parian_path_choose_meetings(path_scene *path, uint32_t walks)
{
    uint32_t count = path->scene->light_count;
    path_meeting *usual = NULL, *chosen = NULL;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW0(path->env, usual, count) || !PARIAN_NEW0(path->env, chosen, count)) {
        r = parian_fail(path->env, PARIAN_E_NOMEM, "no memory for %u lights", count);
    }
    for (uint32_t l = 0; l < count && r == PARIAN_OK; l++) {
        usual[l] = chosen[l] = path->light[l].meeting;
    }
    for (uint32_t l = 0; l < count && r == PARIAN_OK; l++) {
        bool forward = false;
        r = path->light[l].cumulative ? try_alone(path, usual, l, walks, &forward) : r;
        chosen[l] = forward ? PATH_BY_FORWARD : usual[l];
    }
    for (uint32_t l = 0; l < count && r == PARIAN_OK; l++) {
        path->light[l].meeting = chosen[l];
    }
    parian_free(path->env, usual);
    parian_free(path->env, chosen);
    return r;
}
