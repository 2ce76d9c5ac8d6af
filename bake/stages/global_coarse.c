/* global_coarse.c - coarse points among the transfer vertices, and the interpolation from them.
 *
 * Weights are never negative, so that what coarse points carry is not either.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_coarse.h"

#include <math.h>
#include <string.h>

#include "bake/stages/surface_walk.h"
#include "core/half.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { CANDIDATES = 10, WEIGHT_STEPS = 2048 };
static const double SAME_PATCH = 0.5, SAME_SIDE = 0.2; /* cosines between normals */
static const double INTERPOLATION_REACH = 2.2;         /* in reaches of a coarse point */
static const uint32_t NONE = UINT32_MAX;

/* The nearest coarse points of one finer point, nearest first. */
typedef struct candidates {
    uint32_t count, point[CANDIDATES];
    float distance[CANDIDATES];
} candidates;

/* ---- choice of points ---- */

/* Every finer point that none of the points so far covers becomes one. */
static parian_result choose_points(const parian_env *env, parian_walk *walk, const uint32_t *fine,
                                   double reach, parian_coarse *coarse)
{
    uint8_t *covered;
    uint32_t vertices = walk->body->vertex_count;
    if (!PARIAN_NEW0(env, covered, vertices)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for coarse points");
    }
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        uint32_t v = fine ? fine[i] : i;
        if (covered[v]) {
            continue;
        }
        coarse->vertex[coarse->count++] = v;
        parian_walk_from(walk, v, reach, SAME_PATCH);
        for (uint32_t n = 0; n < walk->count; n++) {
            covered[walk->found[n].vertex] = 1;
        }
    }
    parian_free(env, covered);
    return PARIAN_OK;
}

static void add_candidate(candidates *list, uint32_t point, float distance)
{
    uint32_t at = list->count;
    for (; at > 0 && list->distance[at - 1] > distance; at--) {
        if (at < CANDIDATES) {
            list->distance[at] = list->distance[at - 1];
            list->point[at] = list->point[at - 1];
        }
    }
    if (at < CANDIDATES) {
        list->distance[at] = distance;
        list->point[at] = point;
        list->count += list->count < CANDIDATES;
    }
}

static parian_result find_candidates(const parian_env *env, parian_walk *walk, const uint32_t *fine,
                                     double reach, const parian_coarse *coarse, candidates *list)
{
    uint32_t *ordinal, vertices = walk->body->vertex_count;
    if (!PARIAN_NEW(env, ordinal, vertices)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u ordinals", vertices);
    }
    memset(ordinal, 0xff, vertices * sizeof *ordinal);
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        ordinal[fine ? fine[i] : i] = i;
    }
    for (uint32_t a = 0; a < coarse->count; a++) {
        parian_walk_from(walk, coarse->vertex[a], INTERPOLATION_REACH * reach, SAME_SIDE);
        for (uint32_t n = 0; n < walk->count; n++) {
            uint32_t i = ordinal[walk->found[n].vertex];
            if (i != NONE) {
                add_candidate(&list[i], a, walk->found[n].distance);
            }
        }
    }
    parian_free(env, ordinal);
    return PARIAN_OK;
}

/* ---- interpolation ---- */

/* Candidates in the tangent plane of a finer point, at their true distances. */
typedef struct plane_points {
    uint32_t count;
    double at[CANDIDATES][2], r2[CANDIDATES];
} plane_points;

static void flatten(const parian_body *body, const parian_vertex_frame *frame, uint32_t v,
                    const parian_coarse *coarse, const candidates *list, plane_points *plane)
{
    const float *up = frame->normal[v];
    double n[3] = {up[0], up[1], up[2]}, any[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0};
    double x[3], y[3];
    parian_cross3(n, any, x);
    double length = sqrt(parian_dot3(x, x));
    for (int k = 0; k < 3; k++) {
        x[k] /= length;
    }
    parian_cross3(n, x, y);
    plane->count = list->count;
    for (uint32_t i = 0; i < list->count; i++) {
        double d[3];
        parian_sub3(body->vertex_position[coarse->vertex[list->point[i]]], body->vertex_position[v],
                    d);
        double p = parian_dot3(d, x), q = parian_dot3(d, y), flat = sqrt(p * p + q * q);
        plane->r2[i] = parian_dot3(d, d);
        double stretch = flat > 0 ? sqrt(plane->r2[i]) / flat : 0;
        plane->at[i][0] = p * stretch;
        plane->at[i][1] = q * stretch;
    }
}

typedef struct choice {
    uint32_t point[3];
    double weight[3], moment;
} choice;

static double cross2(const double a[2], const double b[2])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Of the triangles around the origin, the one with the least mean squared distance is Delaunay's.
 */
static void try_triangle(const plane_points *plane, uint32_t i, uint32_t j, uint32_t k,
                         choice *best)
{
    const double *a = plane->at[i], *b = plane->at[j], *c = plane->at[k];
    double w[3] = {cross2(b, c), cross2(c, a), cross2(a, b)}, whole = w[0] + w[1] + w[2];
    double size = plane->r2[i] + plane->r2[j] + plane->r2[k];
    if (!(fabs(whole) > 1e-6 * size)) {
        return;
    }
    for (int n = 0; n < 3; n++) {
        w[n] /= whole;
        if (w[n] < -1e-9) {
            return;
        }
        w[n] = fmax(0, w[n]);
    }
    double moment = w[0] * plane->r2[i] + w[1] * plane->r2[j] + w[2] * plane->r2[k];
    if (moment < best->moment) {
        *best = (choice){{i, j, k}, {w[0], w[1], w[2]}, moment};
    }
}

/* Where nothing surrounds the origin: the two points whose segment comes nearest, or one. */
static void choose_segment(const plane_points *plane, choice *best)
{
    double least = plane->r2[0];
    *best = (choice){{0, 0, 0}, {1, 0, 0}, plane->r2[0]};
    for (uint32_t i = 0; i < plane->count; i++) {
        for (uint32_t j = 0; j < i; j++) {
            const double *a = plane->at[i], *b = plane->at[j];
            double e[2] = {b[0] - a[0], b[1] - a[1]}, length2 = e[0] * e[0] + e[1] * e[1];
            double t = length2 > 0 ? -(a[0] * e[0] + a[1] * e[1]) / length2 : 0;
            t = fmin(fmax(t, 0), 1);
            double off[2] = {a[0] + t * e[0], a[1] + t * e[1]};
            double moment = (1 - t) * plane->r2[i] + t * plane->r2[j];
            double cost = 4 * (off[0] * off[0] + off[1] * off[1]) + 0.25 * moment;
            if (cost < least) {
                least = cost;
                *best = (choice){{i, j, j}, {1 - t, t, 0}, moment};
            }
        }
    }
}

/* Round to multiples of 2^-11; the largest takes the rest. */
static void round_weights(const double weight[3], float rounded[3])
{
    int steps[3], most = 0, sum = 0;
    for (int k = 0; k < 3; k++) {
        steps[k] = (int)floor(weight[k] * WEIGHT_STEPS + 0.5);
        sum += steps[k];
        most = weight[k] > weight[most] ? k : most;
    }
    steps[most] += WEIGHT_STEPS - sum;
    for (int k = 0; k < 3; k++) {
        rounded[k] = (float)steps[k] / WEIGHT_STEPS;
    }
}

static void interpolate(const plane_points *plane, const candidates *list, uint32_t i,
                        parian_coarse *coarse)
{
    choice best = {{0, 0, 0}, {1, 0, 0}, INFINITY};
    if (plane->r2[0] > 0) {
        for (uint32_t c = 2; c < plane->count; c++) {
            for (uint32_t b = 1; b < c; b++) {
                for (uint32_t a = 0; a < b; a++) {
                    try_triangle(plane, a, b, c, &best);
                }
            }
        }
        if (!(best.moment < INFINITY)) {
            choose_segment(plane, &best);
        }
    } else {
        best.moment = 0;
    }
    round_weights(best.weight, coarse->weight[i]);
    coarse->moment[i] = (float)best.moment;
    for (int k = 0; k < 3; k++) {
        coarse->near[i][k] = list->point[best.point[k]];
    }
}

parian_result parian_coarse_make(const parian_env *env, const parian_body *body,
                                 const parian_vertex_frame *frame, const uint32_t *fine,
                                 uint32_t fine_count, double reach, parian_coarse *coarse)
{
    parian_walk walk = {0};
    candidates *list = NULL;
    parian_result result = parian_coarse_init(env, fine_count, coarse);
    if (result == PARIAN_OK) {
        result = parian_walk_make(env, body, frame, &walk);
    }
    if (result == PARIAN_OK) {
        result = choose_points(env, &walk, fine, reach, coarse);
    }
    if (result == PARIAN_OK && !PARIAN_NEW0(env, list, fine_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory to interpolate %u points", fine_count);
    }
    if (result == PARIAN_OK) {
        result = find_candidates(env, &walk, fine, reach, coarse, list);
    }
    for (uint32_t i = 0; i < fine_count && result == PARIAN_OK; i++) {
        plane_points plane = {0};
        flatten(body, frame, fine ? fine[i] : i, coarse, &list[i], &plane);
        interpolate(&plane, &list[i], i, coarse);
    }
    parian_walk_free(env, &walk);
    parian_free(env, list);
    if (result != PARIAN_OK) {
        parian_coarse_free(env, coarse);
    }
    return result;
}

/* ---- operators ---- */

enum { UNIT_EXPONENT = 14 }; /* weight 1 is the half 2^14 */

static parian_result make_operator(const parian_env *env, uint32_t rows, uint32_t columns,
                                   uint64_t factors, parian_operator *op)
{
    memset(op, 0, sizeof *op);
    op->row_count = rows;
    op->column_count = columns;
    if (!PARIAN_NEW0(env, op->run_offset, (size_t)rows + 1) ||
        !PARIAN_NEW(env, op->run_column, factors) || !PARIAN_NEW(env, op->run_count, factors) ||
        !PARIAN_NEW(env, op->run_factor, factors + 1) || !PARIAN_NEW(env, op->factor, factors) ||
        !PARIAN_NEW(env, op->scale, rows)) {
        parian_operator_free(env, op);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for an interpolation of %u rows", rows);
    }
    op->run_factor[0] = 0;
    for (uint32_t row = 0; row < rows; row++) {
        op->scale[row][0] = op->scale[row][1] = op->scale[row][2] = ldexpf(1, -UNIT_EXPONENT);
    }
    return PARIAN_OK;
}

/* Append a weight to the row that is being written; columns ascend. */
static void append(parian_operator *op, bool row_begins, uint32_t column, float weight)
{
    uint32_t run = op->run_total;
    bool joins = !row_begins && run > 0 && op->run_count[run - 1] < PARIAN_RUN_MAX &&
                 op->run_column[run - 1] + op->run_count[run - 1] == column;
    if (joins) {
        op->run_count[run - 1]++;
    } else {
        op->run_column[run] = column;
        op->run_count[run] = 1;
        op->run_total++;
    }
    op->run_factor[op->run_total] = ++op->factor_total;
    parian_half half = parian_half_from_float(ldexpf(weight, UNIT_EXPONENT));
    for (int c = 0; c < 3; c++) {
        op->factor[op->factor_total - 1][c] = half;
    }
}

parian_result parian_coarse_up(const parian_env *env, const parian_coarse *coarse,
                               parian_operator *op)
{
    parian_result result =
        make_operator(env, coarse->fine_count, coarse->count, 3 * (uint64_t)coarse->fine_count, op);
    for (uint32_t i = 0; i < coarse->fine_count && result == PARIAN_OK; i++) {
        bool taken[3] = {false};
        for (uint32_t begin = op->run_total, n = 0; n < 3; n++) {
            int next = -1;
            for (int k = 0; k < 3; k++) {
                if (!taken[k] && (next < 0 || coarse->near[i][k] < coarse->near[i][next])) {
                    next = k;
                }
            }
            taken[next] = true;
            if (coarse->weight[i][next] > 0) {
                append(op, op->run_total == begin, coarse->near[i][next], coarse->weight[i][next]);
            }
        }
        op->run_offset[i + 1] = op->run_total;
    }
    return result;
}

parian_result parian_coarse_down(const parian_env *env, const parian_coarse *coarse,
                                 parian_operator *op)
{
    uint64_t entries = 3 * (uint64_t)coarse->fine_count;
    uint32_t *offset = NULL, *entry = NULL;
    parian_result result = make_operator(env, coarse->count, coarse->fine_count, entries, op);
    if (result == PARIAN_OK && (!PARIAN_NEW0(env, offset, (size_t)coarse->count + 2) ||
                                !PARIAN_NEW(env, entry, entries))) {
        parian_operator_free(env, op);
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory to transpose an interpolation");
    }
    for (uint64_t e = 0; e < entries && result == PARIAN_OK; e++) {
        offset[coarse->near[e / 3][e % 3] + 2]++;
    }
    for (uint32_t a = 0; a < coarse->count && result == PARIAN_OK; a++) {
        offset[a + 2] += offset[a + 1];
    }
    for (uint64_t e = 0; e < entries && result == PARIAN_OK; e++) {
        entry[offset[coarse->near[e / 3][e % 3] + 1]++] = (uint32_t)e;
    }
    for (uint32_t a = 0; a < coarse->count && result == PARIAN_OK; a++) {
        uint32_t begin = op->run_total;
        for (uint32_t n = offset[a]; n < offset[a + 1]; n++) {
            float weight = coarse->weight[entry[n] / 3][entry[n] % 3];
            if (weight > 0) {
                append(op, op->run_total == begin, entry[n] / 3, weight);
            }
        }
        op->run_offset[a + 1] = op->run_total;
    }
    parian_free(env, offset);
    parian_free(env, entry);
    return result;
}
