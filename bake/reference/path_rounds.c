/* path_rounds.c - steps of a path tracing run: walks for a slice of receivers, photons, photons for
 * the books.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_rounds.h"

#include "core/memory.h"
#include "tool/session.h"

enum {
    SLICE = 768,          /* receivers times channels whose walks are one step */
    PASSES_MAX = 1024,    /* of photons in a round on the way to a wanted error */
    PASSES_FEW = 8,       /* the same where the count of walks was given */
    BOOK_PHOTONS = 100000 /* per channel: enough for totals to 0.3 % */
};
static const double CHECKPOINT_SECONDS = 20;
/* Photons are doubled while their variance is above this share of that of the walks. */
static const double PHOTON_VARIANCE_SHARE = 0.25;
/* Photons of the books stream from here, those that count from 0. */
static const uint64_t BOOK_FIRST = (uint64_t)1 << 48;

typedef struct path_job {
    const path_run *run;
    size_t first, count; /* adjoint: of receivers times channels */
    uint32_t walks;
    path_tally *tally;        /* [count] */
    double (*flux)[2];        /* [3 * PATH_BLOCKS][receivers] */
    parian_walk_books *books; /* [count] or [3 * PATH_BLOCKS] */
    uint32_t book_photons;    /* per block and light */
} path_job;

/* ---- walks ---- */

static uint32_t round_walks(const path_run *run)
{
    uint64_t left = run->samples - run->state.now.walks;
    return left < PATH_ROUND_WALKS ? (uint32_t)left : PATH_ROUND_WALKS;
}

static void walk_piece(void *context, size_t i)
{
    path_job *job = context;
    size_t item = job->first + i;
    if (!parian_cancelled(job->run->env)) {
        parian_path_adjoint(job->run->path, item / 3, (int)(item % 3), job->run->state.now.walks,
                            job->walks, &job->tally[i], &job->books[i]);
    }
}

static void count_walks(path_run *run, const parian_walk_books *books, double walks)
{
    run->state.now.events += books->events;
    run->state.now.lost += books->lost_walks;
    run->state.now.started += (uint64_t)walks;
}

static parian_result step_walks(path_run *run, size_t slice)
{
    path_job job = {.run = run, .first = slice * SLICE, .walks = round_walks(run)};
    size_t total = run->state.count * 3;
    job.count = total - job.first < SLICE ? total - job.first : SLICE;
    path_tally tally[SLICE] = {0};
    parian_walk_books books[SLICE] = {0};
    job.tally = tally;
    job.books = books;
    parian_par(run->env, job.count, walk_piece, &job);
    if (parian_cancelled(run->env)) {
        return PARIAN_E_INTERRUPTED;
    }
    for (size_t i = 0; i < job.count; i++) {
        parian_path_sums *sums = &run->state.adjoint[(job.first + i) / 3];
        int c = (int)((job.first + i) % 3);
        sums->sum[c] += tally[i].sum;
        sums->square[c] += tally[i].square;
        sums->unscattered[c] += tally[i].unscattered;
        count_walks(run, &books[i], books[i].started);
    }
    return PARIAN_OK;
}

/* ---- photons ---- */

static path_photons photons_of(const path_run *run, uint32_t light, size_t piece)
{
    bool all = run->path->light[light].meeting == PATH_BY_FORWARD;
    return (path_photons){.light = light,
                          .channel = (int)(piece / PATH_BLOCKS),
                          .share = all ? PATH_EVERYTHING : PATH_REMAINDER};
}

static void photon_piece(void *context, size_t piece)
{
    path_job *job = context;
    const path_run *run = job->run;
    uint64_t block = run->state.now.passes_done * PATH_BLOCKS + piece % PATH_BLOCKS;
    for (uint32_t l = 0; l < run->path->scene->light_count; l++) {
        path_photons photons = photons_of(run, l, piece);
        photons.first = block * PATH_BLOCK_PHOTONS;
        photons.count = PATH_BLOCK_PHOTONS;
        if (run->path->light[l].meeting != PATH_BY_EXIT && !parian_cancelled(run->env)) {
            parian_path_forward(run->path, &photons, job->flux + piece * run->state.count,
                                &job->books[piece]);
        }
    }
}

static void add_blocks(path_run *run, double (*flux)[2])
{
    size_t count = run->state.count;
    for (size_t i = 0; i < count; i++) {
        parian_path_sums *sums = &run->state.forward[i];
        for (size_t piece = 0; piece < 3 * PATH_BLOCKS; piece++) {
            size_t c = piece / PATH_BLOCKS;
            double value = flux[piece * count + i][0] / PATH_BLOCK_PHOTONS;
            sums->sum[c] += value;
            sums->square[c] += value * value;
            sums->unscattered[c] += flux[piece * count + i][1] / PATH_BLOCK_PHOTONS;
        }
    }
}

static parian_result step_photons(path_run *run)
{
    parian_walk_books books[3 * PATH_BLOCKS] = {0};
    path_job job = {.run = run, .books = books};
    if (!PARIAN_NEW0(run->env, job.flux, run->state.count * 3 * PATH_BLOCKS)) {
        return parian_fail(run->env, PARIAN_E_NOMEM, "no memory for the photons of %zu receivers",
                           run->state.count);
    }
    parian_par(run->env, 3 * PATH_BLOCKS, photon_piece, &job);
    bool cancelled = parian_cancelled(run->env);
    if (!cancelled) {
        add_blocks(run, job.flux);
        run->state.now.passes_done++;
        for (int piece = 0; piece < 3 * PATH_BLOCKS; piece++) {
            count_walks(run, &books[piece], PATH_BLOCK_PHOTONS);
        }
    }
    parian_free(run->env, job.flux);
    return cancelled ? PARIAN_E_INTERRUPTED : PARIAN_OK;
}

/* ---- the books ---- */

/* A quarter of what the walks cost, until there are enough. */
static uint32_t book_photons(const path_run *run)
{
    uint64_t lights = run->path->scene->light_count;
    uint64_t wanted = (uint64_t)run->state.count * PATH_ROUND_WALKS / 4;
    wanted = wanted < 2048 ? 2048 : wanted > BOOK_PHOTONS ? BOOK_PHOTONS : wanted;
    return (uint32_t)(wanted / (PATH_BLOCKS * (lights > 0 ? lights : 1)) + 1);
}

uint64_t parian_path_book_photons(const path_run *run)
{
    return run->state.now.book_passes * PATH_BLOCKS * book_photons(run);
}

static void book_piece(void *context, size_t piece)
{
    path_job *job = context;
    const path_run *run = job->run;
    uint64_t block = run->state.now.book_passes * PATH_BLOCKS + piece % PATH_BLOCKS;
    for (uint32_t l = 0; l < run->path->scene->light_count; l++) {
        path_photons photons = {.light = l,
                                .channel = (int)(piece / PATH_BLOCKS),
                                .share = PATH_EVERYTHING,
                                .first = BOOK_FIRST + block * job->book_photons,
                                .count = job->book_photons};
        if (!parian_cancelled(run->env)) {
            parian_path_forward(run->path, &photons, NULL, &job->books[piece]);
        }
    }
}

static parian_result step_books(path_run *run)
{
    parian_walk_books books[3 * PATH_BLOCKS] = {0};
    path_job job = {.run = run, .books = books, .book_photons = book_photons(run)};
    if (parian_path_book_photons(run) * run->path->scene->light_count >= BOOK_PHOTONS) {
        return PARIAN_OK;
    }
    parian_par(run->env, 3 * PATH_BLOCKS, book_piece, &job);
    if (parian_cancelled(run->env)) {
        return PARIAN_E_INTERRUPTED;
    }
    for (int piece = 0; piece < 3 * PATH_BLOCKS; piece++) {
        parian_walk_books_add(&run->state.now.books[piece / PATH_BLOCKS], &books[piece]);
        count_walks(run, &books[piece], job.book_photons);
    }
    run->state.now.book_passes++;
    return PARIAN_OK;
}

/* ---- what it amounts to ---- */

/* Variance of the mean of n values; INFINITY for one value. */
static double variance_of_mean(double sum, double square, double n)
{
    return n > 1 ? fmax(0, square - sum * sum / n) / (n * (n - 1)) : INFINITY;
}

static void variances(const path_run *run, size_t receiver, int c, double *walks, double *photons)
{
    const parian_path_sums *a = &run->state.adjoint[receiver], *f = &run->state.forward[receiver];
    double blocks = (double)(run->state.now.passes_done * PATH_BLOCKS);
    *walks =
        run->any_walk ? variance_of_mean(a->sum[c], a->square[c], (double)run->state.now.walks) : 0;
    *photons = run->path->any_forward ? variance_of_mean(f->sum[c], f->square[c], blocks) : 0;
}

void parian_path_outcome(const path_run *run, size_t receiver, int c, double *radiosity,
                         double *standard_error, double *unscattered)
{
    const parian_path_sums *a = &run->state.adjoint[receiver], *f = &run->state.forward[receiver];
    double n = fmax((double)run->state.now.walks, 1), walks, photons;
    double blocks = fmax((double)(run->state.now.passes_done * PATH_BLOCKS), 1);
    variances(run, receiver, c, &walks, &photons);
    *radiosity = run->straight[receiver][c] + a->sum[c] / n + f->sum[c] / blocks;
    *standard_error = sqrt(walks + photons);
    *unscattered = run->straight[receiver][c] + a->unscattered[c] / n + f->unscattered[c] / blocks;
}

/* Root mean square standard error over the mean of B, of the worst channel. */
static double relative_error(const path_run *run)
{
    double worst = 0;
    for (int c = 0; c < 3; c++) {
        double mean = 0, square = 0;
        for (size_t i = 0; i < run->state.count; i++) {
            double b, se, unscattered;
            parian_path_outcome(run, i, c, &b, &se, &unscattered);
            mean += b / (double)run->state.count;
            square += se * se / (double)run->state.count;
        }
        worst = fmax(worst, square > 0 ? sqrt(square) / mean : 0);
    }
    return worst;
}

/* Double the photons of a round while they are what errs most. */
static void plan_passes(path_run *run)
{
    uint64_t most = run->desc->standard_error > 0 ? PASSES_MAX : PASSES_FEW;
    double sum[2] = {0};
    for (size_t i = 0; i < run->state.count * 3; i++) {
        double walks, photons;
        variances(run, i / 3, (int)(i % 3), &walks, &photons);
        sum[0] += walks;
        sum[1] += photons;
    }
    if (run->any_walk && run->path->any_forward && sum[1] > PHOTON_VARIANCE_SHARE * sum[0] &&
        run->state.now.passes < most) {
        run->state.now.passes *= 2;
    }
}

/* ---- rounds ---- */

static parian_result keep_checkpoint(path_run *run, bool now)
{
    double clock = parian_seconds();
    if (!run->desc->checkpoint || (!now && clock - run->written < CHECKPOINT_SECONDS)) {
        return PARIAN_OK;
    }
    parian_path_state state = run->state;
    state.now.seconds += clock - run->started;
    run->written = clock;
    return parian_path_checkpoint_write(run->env, run->desc->checkpoint, run->hash, &state);
}

static parian_result take_step(path_run *run, uint64_t step, uint64_t slices)
{
    if (step < slices) {
        return step_walks(run, step);
    }
    return step < slices + run->state.now.passes ? step_photons(run) : step_books(run);
}

/* Steps of the round from where the state is; the passes of a round are fixed when it begins. */
static parian_result run_round(path_run *run)
{
    parian_path_counters *now = &run->state.now;
    uint64_t slices = run->any_walk ? (run->state.count * 3 + SLICE - 1) / SLICE : 0;
    uint64_t steps = slices + now->passes + 1;
    while (now->step < steps) {
        parian_result r =
            parian_cancelled(run->env) ? PARIAN_E_INTERRUPTED : take_step(run, now->step, slices);
        if (r == PARIAN_E_INTERRUPTED) {
            parian_result written = keep_checkpoint(run, true);
            return written == PARIAN_OK ? r : written;
        }
        if (r != PARIAN_OK) {
            return r;
        }
        now->step++;
        r = keep_checkpoint(run, false);
        if (r != PARIAN_OK) {
            return r;
        }
        double part = (double)now->step / (double)steps * round_walks(run);
        double share = ((double)now->walks + part) / (double)run->samples;
        parian_progress(run->env, "path tracing", fmin(fmax(share, run->progress), 1));
    }
    now->walks += round_walks(run);
    plan_passes(run);
    now->step = 0;
    now->round++;
    return PARIAN_OK;
}

/* Whether the wanted error is reached; the share of the work that is done goes by its square. */
static bool is_good_enough(path_run *run)
{
    double wanted = run->desc->standard_error;
    if (!(wanted > 0) || run->state.now.round < 2) {
        return false;
    }
    double error = relative_error(run);
    run->progress = error > wanted ? wanted * wanted / (error * error) : 1;
    return error <= wanted;
}

parian_result parian_path_rounds(path_run *run)
{
    parian_result r = PARIAN_OK;
    run->written = parian_seconds();
    while (r == PARIAN_OK && run->state.now.walks < run->samples && !is_good_enough(run)) {
        r = run_round(run);
    }
    return r;
}
