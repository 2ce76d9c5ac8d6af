/* gutter.c - where unowned texels beside a chart take their values from: the surface across the
 * seam.
 *
 * The centre of a gutter texel is carried beyond its chart: the plane of the triangle at the
 * nearest point of the chart's outline is extended to it, and the segment from the outline to it is
 * walked over the triangles across the seam, unfolding each rigidly (design: gutter redirection).
 * Where the walk ends, the owned texels around that point of the other chart are the sources, with
 * bilinear weights. At open boundaries the surface ends, and the value there is continued.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/texels_parts.h"
#include "core/memory.h"

enum { RINGS = 2, SLICE = 1024, WALK_MAX = 64, NO_EDGE = 0xFFFFFFFFu };
static const double REACH = 4.0; /* texels; outlines farther off are not looked at */

/* The outline point nearest to an unowned cell. */
typedef struct candidate {
    uint32_t index;   /* v * side + u */
    uint32_t half;    /* half-edge of the outline, or NO_EDGE */
    double along;     /* parameter of the nearest point on it, 0 to 1 */
    double distance2; /* texels^2 */
    double outward;   /* distance on the outer side of the edge's line */
} candidate;

typedef struct gutter_job {
    const parian_body *body;
    uint32_t (*neighbour)[3];
    uint32_t side, count;
    uint32_t *at;          /* [side^2] candidate ordinal or NO_EDGE */
    candidate *candidates; /* [count] */
    uint32_t (*source)[PARIAN_GUTTER_SOURCES];
    float (*weight)[PARIAN_GUTTER_SOURCES];
} gutter_job;

/* A point of the surface. */
typedef struct surface_point {
    uint32_t triangle;
    double beta[3];
} surface_point;

static bool near_owned(const gutter_job *job, uint32_t u, uint32_t v)
{
    for (int64_t y = (int64_t)v - RINGS; y <= (int64_t)v + RINGS; y++) {
        for (int64_t x = (int64_t)u - RINGS; x <= (int64_t)u + RINGS; x++) {
            if (x >= 0 && y >= 0 && x < job->side && y < job->side &&
                job->body->texel_at[y * job->side + x] != UINT32_MAX) {
                return true;
            }
        }
    }
    return false;
}

/* Mark the unowned cells within two rings of an owned one. */
static void mark_row(void *context, size_t row)
{
    gutter_job *job = context;
    for (uint32_t u = 0; u < job->side; u++) {
        size_t index = row * job->side + u;
        bool gutter = job->body->texel_at[index] == UINT32_MAX && near_owned(job, u, (uint32_t)row);
        job->at[index] = gutter ? 0 : NO_EDGE;
    }
}

static parian_result list_candidates(const parian_env *env, gutter_job *job)
{
    size_t cells = (size_t)job->side * job->side;
    if (!PARIAN_NEW(env, job->at, cells)) {
        return PARIAN_E_NOMEM;
    }
    parian_par(env, job->side, mark_row, job);
    for (size_t i = 0; i < cells; i++) {
        if (job->at[i] != NO_EDGE) {
            job->at[i] = job->count++;
        }
    }
    if (!PARIAN_NEW(env, job->candidates, job->count)) {
        return PARIAN_E_NOMEM;
    }
    for (size_t i = 0; i < cells; i++) {
        if (job->at[i] != NO_EDGE) {
            job->candidates[job->at[i]] =
                (candidate){(uint32_t)i, NO_EDGE, 0.0, INFINITY, -INFINITY};
        }
    }
    return PARIAN_OK;
}

static void load_edge(const parian_body *body, uint32_t half, double a[2], double b[2])
{
    for (int d = 0; d < 2; d++) {
        a[d] = (double)body->corner_uv[half / 3][half % 3][d];
        b[d] = (double)body->corner_uv[half / 3][(half % 3 + 1) % 3][d];
    }
}

/* Offer an outline edge to the gutter cells within reach. Where two edges are equally near, at a
 * corner of the outline, the one whose outer side the cell lies on more is taken. */
static void offer_edge(gutter_job *job, uint32_t half)
{
    double a[2], b[2];
    load_edge(job->body, half, a, b);
    double e[2] = {b[0] - a[0], b[1] - a[1]}, length2 = e[0] * e[0] + e[1] * e[1];
    if (!(length2 > 0.0)) {
        return;
    }
    double limit = job->side - 1.0;
    uint32_t low[2], high[2];
    for (int d = 0; d < 2; d++) {
        low[d] = (uint32_t)fmax(fmin(a[d], b[d]) - REACH, 0.0);
        high[d] = (uint32_t)fmin(fmax(a[d], b[d]) + REACH, limit);
    }
    for (uint32_t v = low[1]; v <= high[1]; v++) {
        for (uint32_t u = low[0]; u <= high[0]; u++) {
            uint32_t ordinal = job->at[(size_t)v * job->side + u];
            if (ordinal == NO_EDGE) {
                continue;
            }
            candidate *c = &job->candidates[ordinal];
            double w[2] = {u + 0.5 - a[0], v + 0.5 - a[1]};
            double along = fmin(1.0, fmax(0.0, (w[0] * e[0] + w[1] * e[1]) / length2));
            double x = w[0] - along * e[0], y = w[1] - along * e[1], distance2 = x * x + y * y;
            double outward = (w[0] * e[1] - w[1] * e[0]) / sqrt(length2);
            if (distance2 < c->distance2 - 1e-9 ||
                (distance2 < c->distance2 + 1e-9 && outward > c->outward)) {
                *c = (candidate){c->index, half, along, distance2, outward};
            }
        }
    }
}

static void offer_outlines(gutter_job *job)
{
    const parian_body *body = job->body;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t across = job->neighbour[t][k];
            if (across == PARIAN_NO_NEIGHBOUR ||
                body->triangle_chart[across / 3] != body->triangle_chart[t]) {
                offer_edge(job, 3 * t + k);
            }
        }
    }
}

/* Corners of a triangle in its own plane: corner `first` at the origin, the next one on the x axis.
 */
static bool lay_flat(const parian_body *body, uint32_t triangle, uint32_t first, double flat[3][2])
{
    double e[2][3], length2 = 0.0, dot = 0.0, other2 = 0.0;
    const float *a = body->vertex_position[body->triangle[triangle][first]];
    for (uint32_t i = 0; i < 2; i++) {
        const float *p = body->vertex_position[body->triangle[triangle][(first + 1 + i) % 3]];
        for (int d = 0; d < 3; d++) {
            e[i][d] = (double)p[d] - (double)a[d];
        }
    }
    for (int d = 0; d < 3; d++) {
        length2 += e[0][d] * e[0][d];
        dot += e[0][d] * e[1][d];
        other2 += e[1][d] * e[1][d];
    }
    if (!(length2 > 0.0)) {
        return false;
    }
    double length = sqrt(length2), x = dot / length;
    double y2 = other2 - x * x;
    flat[first][0] = flat[first][1] = flat[(first + 1) % 3][1] = 0.0;
    flat[(first + 1) % 3][0] = length;
    flat[(first + 2) % 3][0] = x;
    flat[(first + 2) % 3][1] = sqrt(fmax(y2, 0.0));
    return y2 > 1e-14 * other2;
}

/* Barycentrics of a point with respect to a triangle of the plane; false without area. */
static bool barycentrics(const double corner[3][2], const double p[2], double beta[3])
{
    double cross[3];
    for (int k = 0; k < 3; k++) {
        const double *a = corner[(k + 1) % 3], *b = corner[(k + 2) % 3];
        cross[k] = (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
    }
    double sum = cross[0] + cross[1] + cross[2];
    for (int k = 0; k < 3; k++) {
        beta[k] = cross[k] / sum;
    }
    return sum != 0.0;
}

/* Move barycentrics that lie outside into the triangle. */
static void clamp_barycentrics(double beta[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        beta[k] = fmax(beta[k], 0.0);
        sum += beta[k];
    }
    for (int k = 0; k < 3; k++) {
        beta[k] /= sum;
    }
}

/* Which edge the segment from start to goal leaves a triangle of the plane through, other than
 * `entered`; the parameter along that edge is returned in s. 3 where it ends inside. */
static uint32_t leave_edge(const double corner[3][2], const double start[2], const double goal[2],
                           uint32_t entered, double *s)
{
    double beta[3], best = -1e-12;
    uint32_t leave = 3;
    if (!barycentrics(corner, goal, beta)) {
        return 3;
    }
    for (uint32_t k = 0; k < 3; k++) {
        /* Edge k is opposite of corner k + 2. */
        if (k == entered || beta[(k + 2) % 3] >= best) {
            continue;
        }
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        double d[2] = {goal[0] - start[0], goal[1] - start[1]}, e[2] = {b[0] - a[0], b[1] - a[1]};
        double denominator = d[0] * e[1] - d[1] * e[0];
        double t = denominator != 0.0
                       ? ((a[0] - start[0]) * d[1] - (a[1] - start[1]) * d[0]) / denominator
                       : -1.0;
        if (t >= 0.0 && t <= 1.0) {
            *s = t;
            return k;
        }
        leave = leave == 3 ? k : leave;
        *s = fmin(1.0, fmax(0.0, t));
    }
    return leave;
}

/* Walk from a point of a seam edge over the far side. goal is given in the frame of that edge seen
 * from the near side: x along it, y inward; so the far side lies at negative y. False where the
 * surface ends at once. */
static bool walk(const gutter_job *job, uint32_t half, double along, const double goal_near[2],
                 surface_point *end)
{
    const parian_body *body = job->body;
    uint32_t across = job->neighbour[half / 3][half % 3];
    double flat[3][2], start[2], goal[2], length;
    if (across == PARIAN_NO_NEIGHBOUR || !lay_flat(body, across / 3, across % 3, flat)) {
        return false;
    }
    /* The far triangle sees the edge from its other end, and its inside at positive y. */
    length = flat[(across % 3 + 1) % 3][0];
    start[0] = (1.0 - along) * length;
    start[1] = 0.0;
    goal[0] = length - goal_near[0];
    goal[1] = -goal_near[1];
    for (int step = 0; step < WALK_MAX; step++) {
        double s = 0.0;
        uint32_t t = across / 3,
                 leave = leave_edge((const double(*)[2])flat, start, goal, across % 3, &s);
        uint32_t next = leave < 3 ? job->neighbour[t][leave] : PARIAN_NO_NEIGHBOUR;
        double next_flat[3][2];
        end->triangle = t;
        if (leave == 3 || next == PARIAN_NO_NEIGHBOUR ||
            !lay_flat(body, next / 3, next % 3, next_flat)) {
            if (!barycentrics((const double(*)[2])flat, goal, end->beta)) {
                return false;
            }
            clamp_barycentrics(end->beta);
            return true;
        }
        /* Into the frame of the edge that is left: x along it, y inward; then seen from the far
         * side. */
        const double *a = flat[leave], *b = flat[(leave + 1) % 3];
        double e[2] = {b[0] - a[0], b[1] - a[1]}, w[2] = {goal[0] - a[0], goal[1] - a[1]};
        double edge = sqrt(e[0] * e[0] + e[1] * e[1]);
        double x = (w[0] * e[0] + w[1] * e[1]) / edge, y = (e[0] * w[1] - e[1] * w[0]) / edge;
        start[0] = (1.0 - s) * edge;
        start[1] = 0.0;
        goal[0] = edge - x;
        goal[1] = -y;
        memcpy(flat, next_flat, sizeof flat);
        across = next;
    }
    return false;
}

/* The surface point that a gutter cell stands for. */
static bool continue_surface(const gutter_job *job, const candidate *c, surface_point *end)
{
    const parian_body *body = job->body;
    uint32_t t = c->half / 3, k = c->half % 3;
    double uv[3][2], flat[3][2], beta[3], goal[2] = {0.0, 0.0};
    double centre[2] = {c->index % job->side + 0.5, c->index / job->side + 0.5};
    for (int i = 0; i < 6; i++) {
        uv[i / 2][i % 2] = (double)body->corner_uv[t][i / 2][i % 2];
    }
    if (c->outward <= 0.0 || !lay_flat(body, t, k, flat) ||
        !barycentrics((const double(*)[2])uv, centre, beta)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        goal[0] += beta[i] * flat[i][0];
        goal[1] += beta[i] * flat[i][1];
    }
    /* Not through a vertex, where more than one triangle could come next. */
    double along = fmin(0.98, fmax(0.02, c->along));
    return walk(job, c->half, along, goal, end);
}

/* Owned texels of a chart around an atlas point, with bilinear weights; their number. */
static int gather(const gutter_job *job, const double at[2], uint32_t chart, uint32_t *source,
                  double *weight)
{
    const parian_body *body = job->body;
    int64_t u = (int64_t)floor(at[0] - 0.5), v = (int64_t)floor(at[1] - 0.5), side = job->side;
    double fu = at[0] - 0.5 - (double)u, fv = at[1] - 0.5 - (double)v, sum = 0.0;
    int count = 0;
    for (int i = 0; i < 4; i++) {
        int64_t x = u + i % 2, y = v + i / 2;
        uint32_t texel =
            x >= 0 && y >= 0 && x < side && y < side ? body->texel_at[y * side + x] : UINT32_MAX;
        double w = (i % 2 ? fu : 1.0 - fu) * (i / 2 ? fv : 1.0 - fv);
        if (texel != UINT32_MAX && texel_chart(body, texel) == chart && w > 1e-4) {
            source[count] = texel;
            weight[count++] = w;
            sum += w;
        }
    }
    for (int i = 0; i < count; i++) {
        weight[i] /= sum;
    }
    return count;
}

/* The owned texel nearest to an atlas point, of the given chart if one is within three texels. */
static uint32_t nearest_owned(const gutter_job *job, const double at[2], uint32_t chart)
{
    const parian_body *body = job->body;
    int64_t u = (int64_t)at[0], v = (int64_t)at[1], side = job->side;
    double best = INFINITY;
    uint32_t found = UINT32_MAX;
    for (int64_t y = v - 3; y <= v + 3; y++) {
        for (int64_t x = u - 3; x <= u + 3; x++) {
            uint32_t texel = x >= 0 && y >= 0 && x < side && y < side ? body->texel_at[y * side + x]
                                                                      : UINT32_MAX;
            if (texel == UINT32_MAX) {
                continue;
            }
            double du = (double)x + 0.5 - at[0], dv = (double)y + 0.5 - at[1];
            double away = du * du + dv * dv + (texel_chart(body, texel) == chart ? 0.0 : 100.0);
            if (away < best) {
                best = away;
                found = texel;
            }
        }
    }
    return found;
}

static void fill_cell(gutter_job *job, uint32_t ordinal)
{
    const parian_body *body = job->body;
    const candidate *c = &job->candidates[ordinal];
    double at[2] = {c->index % job->side + 0.5, c->index / job->side + 0.5};
    double weight[PARIAN_GUTTER_SOURCES] = {1.0, 0.0, 0.0, 0.0};
    uint32_t source[PARIAN_GUTTER_SOURCES], chart = UINT32_MAX;
    surface_point end;
    int count = 0;
    if (c->half != NO_EDGE && continue_surface(job, c, &end)) {
        double there[2] = {0.0, 0.0};
        for (int k = 0; k < 6; k++) {
            there[k % 2] += end.beta[k / 2] * (double)body->corner_uv[end.triangle][k / 2][k % 2];
        }
        count = gather(job, there, body->triangle_chart[end.triangle], source, weight);
    }
    if (count == 0 && c->half != NO_EDGE) {
        double a[2], b[2];
        load_edge(body, c->half, a, b);
        chart = body->triangle_chart[c->half / 3];
        for (int d = 0; d < 2; d++) {
            at[d] = a[d] + c->along * (b[d] - a[d]);
        }
        count = gather(job, at, chart, source, weight);
    }
    if (count == 0) {
        source[0] = nearest_owned(job, at, chart);
        weight[0] = 1.0;
        count = 1;
    }
    for (int i = 0; i < PARIAN_GUTTER_SOURCES; i++) {
        job->source[ordinal][i] = source[i < count ? i : 0];
        job->weight[ordinal][i] = i < count ? (float)weight[i] : 0.0f;
    }
}

static void fill_slice(void *context, size_t slice)
{
    gutter_job *job = context;
    uint32_t first = (uint32_t)slice * SLICE;
    uint32_t end = job->count - first < SLICE ? job->count : first + SLICE;
    for (uint32_t i = first; i < end; i++) {
        fill_cell(job, i);
    }
}

static parian_result fill_gutter(const parian_env *env, gutter_job *job, parian_body *body)
{
    uint32_t *index = NULL;
    if (!PARIAN_NEW(env, job->source, job->count) || !PARIAN_NEW(env, job->weight, job->count) ||
        !PARIAN_NEW(env, index, job->count)) {
        parian_free(env, index);
        return PARIAN_E_NOMEM;
    }
    offer_outlines(job);
    parian_par(env, (job->count + SLICE - 1) / SLICE, fill_slice, job);
    for (uint32_t i = 0; i < job->count; i++) {
        index[i] = job->candidates[i].index;
    }
    body->gutter_count = job->count;
    body->gutter_index = index;
    body->gutter_source = job->source;
    body->gutter_weight = job->weight;
    job->source = NULL;
    job->weight = NULL;
    return PARIAN_OK;
}

parian_result texels_gutter(const parian_env *env, parian_body *body)
{
    gutter_job job = {.body = body, .side = body->atlas_size};
    parian_result result = PARIAN_E_NOMEM;
    if (PARIAN_NEW(env, job.neighbour, body->triangle_count)) {
        result = parian_triangle_neighbours(env, body->vertex_count, body->triangle_count,
                                            (const uint32_t(*)[3])body->triangle, job.neighbour);
    }
    if (result == PARIAN_OK) {
        result = list_candidates(env, &job);
    }
    if (result == PARIAN_OK) {
        result = fill_gutter(env, &job, body);
    }
    if (result == PARIAN_E_NOMEM) {
        parian_fail(env, result, "no memory for %u gutter texels", job.count);
    }
    parian_free(env, job.weight);
    parian_free(env, job.source);
    parian_free(env, job.candidates);
    parian_free(env, job.at);
    parian_free(env, job.neighbour);
    return result;
}
