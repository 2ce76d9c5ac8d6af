/* samples_fill.c - fills a surface with samples: darts first, then gaps until none is left.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/samples.h"
#include "bake/stages/samples_parts.h"
#include "core/memory.h"
#include "core/random.h"

enum { BLOCK = 1024, DARTS_A_SAMPLE = 4, STREAM_DART = 1, STREAM_GAP = 2 };

/* Saturated random darts in the plane: N r^2 / A [Ebeida12]. */
static const double DENSITY = 0.7;
/* Gaps are not looked for in pieces with edges below this share of the radius, in those that
 * barycentrics, which are floats, hardly resolve, and in triangles of less area than this share of
 * radius^2 and of the surface. */
static const double EDGE_LEAST = 1e-4, BARYCENTRIC_LEAST = 0x1p-21, TRIANGLE_LEAST = 1e-8;

static parian_result make_room(const parian_env *env, sampling *s)
{
    uint32_t room = s->room ? 2 * s->room : 1024, *triangle = NULL;
    float(*barycentric)[2] = NULL;
    if (!PARIAN_NEW(env, triangle, room) || !PARIAN_NEW(env, barycentric, room)) {
        parian_free(env, triangle);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", room);
    }
    if (s->grid.count > 0) {
        memcpy(triangle, s->triangle, s->grid.count * sizeof *triangle);
        memcpy(barycentric, s->barycentric, s->grid.count * sizeof *barycentric);
    }
    parian_free(env, s->triangle);
    parian_free(env, s->barycentric);
    s->triangle = triangle;
    s->barycentric = barycentric;
    s->room = room;
    return PARIAN_OK;
}

static parian_point point_at(const sampling *s, uint32_t triangle, const float barycentric[2])
{
    parian_point point = parian_surface_point(s->surface, triangle, barycentric);
    memcpy(point.normal, s->normal[triangle], sizeof point.normal);
    return point;
}

parian_result sampling_put(const parian_env *env, sampling *s, uint32_t triangle,
                           const float barycentric[2])
{
    parian_point point = point_at(s, triangle, barycentric);
    if (parian_point_grid_has(&s->grid, &point, s->radius)) {
        return PARIAN_OK;
    }
    if (s->grid.count == PARIAN_SAMPLES_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "more than %d samples: the radius of %g m is too small",
                           PARIAN_SAMPLES_MAX, s->radius);
    }
    parian_result r = s->grid.count == s->room ? make_room(env, s) : PARIAN_OK;
    if (r == PARIAN_OK) {
        s->triangle[s->grid.count] = triangle;
        memcpy(s->barycentric[s->grid.count], barycentric, sizeof *s->barycentric);
        r = parian_point_grid_put(env, &s->grid, &point);
    }
    return r;
}

/* ---- darts ---- */

typedef struct dart {
    uint32_t triangle; /* PARIAN_NO_POINT: none */
    float barycentric[2];
} dart;

typedef struct dart_job {
    const sampling *s;
    uint64_t first, count;
    dart *dart;
} dart_job;

static uint32_t find_triangle(const sampling *s, double area)
{
    uint32_t low = 0, high = s->surface->triangle_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (s->until[middle] > area) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

/* Darts that a sample already forbids are dropped here; those that others of the same batch forbid
 * are found when they are put. */
static void aim_block(void *context, size_t block)
{
    const dart_job *job = context;
    uint64_t end = (block + 1) * BLOCK < job->count ? (block + 1) * BLOCK : job->count;
    for (uint64_t i = block * BLOCK; i < end; i++) {
        parian_random random = parian_random_stream(job->s->seed, STREAM_DART, job->first + i, 0);
        dart *d = &job->dart[i];
        d->triangle = find_triangle(job->s, parian_random_unit(&random) * job->s->area);
        double u = parian_random_unit(&random);
        sampling_place(u, parian_random_unit(&random), d->barycentric);
        parian_point point = point_at(job->s, d->triangle, d->barycentric);
        if (!sampling_has_area(job->s, d->triangle) ||
            parian_point_grid_has(&job->s->grid, &point, job->s->radius)) {
            d->triangle = PARIAN_NO_POINT;
        }
    }
}

static parian_result put_darts(const parian_env *env, sampling *s, const dart *darts,
                               uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        parian_result r = darts[i].triangle == PARIAN_NO_POINT
                              ? PARIAN_OK
                              : sampling_put(env, s, darts[i].triangle, darts[i].barycentric);
        if (r != PARIAN_OK) {
            return r;
        }
    }
    return PARIAN_OK;
}

/* Batches that grow, so that later ones know of earlier samples before they are aimed. */
static parian_result throw_darts(const parian_env *env, sampling *s, uint64_t total)
{
    enum { BATCH_MAX = 1 << 18 };
    uint64_t room = total < BATCH_MAX ? total : BATCH_MAX, batch = BLOCK;
    dart_job job = {.s = s};
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, job.dart, room)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu darts",
                           (unsigned long long)room);
    }
    for (job.first = 0; r == PARIAN_OK && job.first < total; job.first += job.count) {
        job.count = total - job.first < batch ? total - job.first : batch;
        job.count = job.count < room ? job.count : room;
        parian_par(env, (job.count + BLOCK - 1) / BLOCK, aim_block, &job);
        r = put_darts(env, s, job.dart, job.count);
        batch *= 2;
        if (r == PARIAN_OK && parian_cancelled(env)) {
            r = PARIAN_E_INTERRUPTED;
        }
    }
    parian_free(env, job.dart);
    return r;
}

/* ---- gaps ---- */

typedef struct gap_job {
    const sampling *s;
    uint32_t round;
    size_t count;
    sampling_piece *piece;
    dart *dart;     /* a try for each piece */
    int8_t *split;  /* the edge to split it at; -1: it is covered, or too small */
    double *missed; /* area of pieces that are too small, [blocks] */
} gap_job;

typedef struct cover_search {
    const parian_point_grid *grid;
    const double (*place)[3];
    double limit;
    bool covered;
} cover_search;

static void try_cover(void *context, uint32_t point, double squared)
{
    cover_search *search = context;
    const double *center = search->grid->point[point].position;
    (void)squared;
    for (int k = 1; k < 3; k++) {
        double x = search->place[k][0] - center[0], y = search->place[k][1] - center[1];
        double z = search->place[k][2] - center[2];
        if (x * x + y * y + z * z >= search->limit) {
            return;
        }
    }
    search->covered = true;
}

/* Whether a single sample has the whole piece within the radius: balls are convex. */
static bool is_covered(const sampling *s, uint32_t triangle, const double (*place)[3])
{
    cover_search search = {&s->grid, place, s->radius * s->radius, false};
    parian_point first;
    memcpy(first.position, place[0], sizeof first.position);
    memcpy(first.normal, s->normal[triangle], sizeof first.normal);
    parian_point_grid_visit(&s->grid, &first, s->radius, try_cover, &search);
    return search.covered;
}

/* A point of the piece. */
static void aim_at_piece(const gap_job *job, size_t i)
{
    const sampling *s = job->s;
    const sampling_piece *piece = &job->piece[i];
    parian_random random = parian_random_stream(s->seed, STREAM_GAP, job->round, i);
    double u = sqrt(parian_random_unit(&random)), v = parian_random_unit(&random);
    double share[3] = {1 - u, u * (1 - v), u * v}, at[2] = {0, 0};
    for (int k = 0; k < 3; k++) {
        at[0] += share[k] * piece->corner[k][0];
        at[1] += share[k] * piece->corner[k][1];
    }
    dart *d = &job->dart[i];
    d->triangle = piece->triangle;
    d->barycentric[0] = (float)at[0];
    d->barycentric[1] = fminf((float)at[1], 1.0f - d->barycentric[0]);
    parian_point point = point_at(s, d->triangle, d->barycentric);
    if (parian_point_grid_has(&s->grid, &point, s->radius)) {
        d->triangle = PARIAN_NO_POINT;
    }
}

static bool is_too_small(const sampling *s, const sampling_piece *piece, int longest, double edge)
{
    const double *a = piece->corner[longest], *b = piece->corner[(longest + 1) % 3];
    return edge < EDGE_LEAST * s->radius ||
           (fabs(a[0] - b[0]) < BARYCENTRIC_LEAST && fabs(a[1] - b[1]) < BARYCENTRIC_LEAST);
}

static void look_block(void *context, size_t block)
{
    const gap_job *job = context;
    const sampling *s = job->s;
    size_t end = (block + 1) * BLOCK < job->count ? (block + 1) * BLOCK : job->count;
    job->missed[block] = 0;
    for (size_t i = block * BLOCK; i < end; i++) {
        const sampling_piece *piece = &job->piece[i];
        double place[3][3];
        int longest = 0;
        job->dart[i].triangle = PARIAN_NO_POINT;
        job->split[i] = -1;
        double edge = sampling_piece_places(s, piece, place, &longest);
        if (edge < 2 * s->radius && is_covered(s, piece->triangle, (const double(*)[3])place)) {
            continue;
        }
        if (is_too_small(s, piece, longest, edge)) {
            job->missed[block] +=
                sampling_piece_share(piece) * sampling_triangle_area(s, piece->triangle);
            continue;
        }
        aim_at_piece(job, i);
        job->split[i] = (int8_t)longest;
    }
}

static parian_result first_pieces(const parian_env *env, sampling *s, gap_job *job)
{
    double least = TRIANGLE_LEAST * fmin(s->area, s->radius * s->radius);
    if (!PARIAN_NEW(env, job->piece, s->surface->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to look for gaps in %u triangles",
                           s->surface->triangle_count);
    }
    for (uint32_t t = 0; t < s->surface->triangle_count; t++) {
        double area = sampling_triangle_area(s, t);
        if (sampling_has_area(s, t) && area >= least) {
            job->piece[job->count++] = (sampling_piece){t, {{1, 0}, {0, 1}, {0, 0}}};
        } else {
            s->uncovered += area;
        }
    }
    return PARIAN_OK;
}

/* Halves of the pieces that are not covered, in place of all pieces. */
static parian_result split_pieces(const parian_env *env, gap_job *job)
{
    size_t count = 0;
    sampling_piece *halves = NULL;
    for (size_t i = 0; i < job->count; i++) {
        count += job->split[i] >= 0 ? 2 : 0;
    }
    if (!PARIAN_NEW(env, halves, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to look for gaps in %zu pieces", count);
    }
    count = 0;
    for (size_t i = 0; i < job->count; i++) {
        if (job->split[i] >= 0) {
            sampling_piece_split(&job->piece[i], job->split[i], &halves[count]);
            count += 2;
        }
    }
    parian_free(env, job->piece);
    job->piece = halves;
    job->count = count;
    return PARIAN_OK;
}

static parian_result gap_round(const parian_env *env, sampling *s, gap_job *job)
{
    size_t blocks = (job->count + BLOCK - 1) / BLOCK;
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, job->dart, job->count) || !PARIAN_NEW(env, job->split, job->count) ||
        !PARIAN_NEW(env, job->missed, blocks)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory to look for gaps in %zu pieces",
                        job->count);
    }
    if (r == PARIAN_OK) {
        parian_par(env, blocks, look_block, job);
        r = put_darts(env, s, job->dart, job->count);
        for (size_t b = 0; b < blocks; b++) {
            s->uncovered += job->missed[b];
        }
    }
    r = r == PARIAN_OK ? split_pieces(env, job) : r;
    parian_free(env, job->dart);
    parian_free(env, job->split);
    parian_free(env, job->missed);
    job->dart = NULL;
    job->split = NULL;
    job->missed = NULL;
    job->round++;
    return r;
}

static parian_result fill_gaps(const parian_env *env, sampling *s)
{
    gap_job job = {.s = s};
    parian_result r = first_pieces(env, s, &job);
    while (r == PARIAN_OK && job.count > 0) {
        r = gap_round(env, s, &job);
        if (r == PARIAN_OK && parian_cancelled(env)) {
            r = PARIAN_E_INTERRUPTED;
        }
    }
    parian_free(env, job.piece);
    return r;
}

parian_result sampling_fill(const parian_env *env, sampling *s, double radius)
{
    double expected = DENSITY * s->area / (radius * radius);
    s->radius = radius;
    s->uncovered = 0;
    if (expected > 4.0 * PARIAN_SAMPLES_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "a radius of %g m would take about %.3g samples; at most %d are made",
                           radius, expected, PARIAN_SAMPLES_MAX);
    }
    parian_point_grid_clear(&s->grid, radius);
    parian_result r = throw_darts(env, s, (uint64_t)(DARTS_A_SAMPLE * expected) + 1);
    return r == PARIAN_OK ? fill_gaps(env, s) : r;
}
