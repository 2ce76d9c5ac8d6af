/* texels_clip.c - areas, centroids and triangles of texels by exact clipping.
 *
 * Each triangle's atlas polygon is clipped against the squares of the texels [Sutherland and
 * Hodgman 1974]; a piece of atlas area a of a triangle adds a A_3D / A_uv to its texel, so that all
 * areas sum to the surface. The atlas is worked on in bands of rows: a band sees its triangles in
 * their order, so sums do not depend on the number of threads.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/texels_parts.h"
#include "core/memory.h"

enum { BAND_ROWS = 16, NOT_TOUCHED = 0xFFFFFFFFu };
static const double UV_AREA_MIN =
    1e-9; /* texels^2; thinner triangles are put into one texel whole */
static const double SLIVER_SHARE =
    1e-4; /* of the mean texel area; smaller pieces go to a neighbour */

/* What a texel gathers. */
typedef struct cell {
    double area;      /* surface, m^2 */
    double covered;   /* of its square */
    double moment[2]; /* area times atlas position relative to the square's corner */
    double distance2; /* of the centroid to the nearest piece, texels^2 */
    double beta[3];   /* barycentrics of the centroid there */
    uint32_t triangle;
    uint32_t chart;
    uint32_t index; /* v * side + u */
} cell;

typedef struct clip_job {
    const parian_body *body;
    uint32_t side, band_count;
    double *ratio;        /* [triangle_count] A_3D / A_uv; negative: minus A_3D of a lump */
    uint32_t *band_begin; /* [band_count + 1] into band_triangle */
    uint32_t *band_triangle;
    uint32_t *at;         /* [side^2] cell ordinal or NOT_TOUCHED */
    uint32_t *band_cells; /* [band_count + 1] number of cells in each band, then prefix sums */
    cell *cells;
    uint32_t cell_count;
} clip_job;

typedef struct polygon {
    int count;
    double point[8][2];
} polygon;

/* Keep the part of a convex polygon where sign * coordinate >= sign * limit. */
static void clip_half(const polygon *in, int axis, double limit, double sign, polygon *out)
{
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *p = in->point[i], *q = in->point[i + 1 < in->count ? i + 1 : 0];
        double dp = sign * (p[axis] - limit), dq = sign * (q[axis] - limit);
        if (dp >= 0.0) {
            out->point[out->count][0] = p[0];
            out->point[out->count++][1] = p[1];
        }
        if ((dp < 0.0) != (dq < 0.0)) {
            double s = dp / (dp - dq);
            out->point[out->count][1 - axis] = p[1 - axis] + s * (q[1 - axis] - p[1 - axis]);
            out->point[out->count++][axis] = limit;
        }
    }
}

/* Area of a polygon, and its first moments relative to an origin. */
static double measure(const polygon *poly, const double origin[2], double moment[2])
{
    double area = 0.0;
    moment[0] = moment[1] = 0.0;
    for (int i = 1; i + 1 < poly->count; i++) {
        const double *a = poly->point[0], *b = poly->point[i], *c = poly->point[i + 1];
        double part = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        area += part;
        for (int d = 0; d < 2; d++) {
            moment[d] += part * ((a[d] + b[d] + c[d]) / 3.0 - origin[d]);
        }
    }
    return area;
}

static void load_corners(const parian_body *body, uint32_t t, double uv[3][2])
{
    for (int k = 0; k < 6; k++) {
        uv[k / 2][k % 2] = (double)body->corner_uv[t][k / 2][k % 2];
    }
}

static uint32_t clamp_cell(double x, uint32_t side)
{
    return x >= side ? side - 1 : (uint32_t)x;
}

/* Rows or columns that a polygon touches. */
static void touched_range(const double (*point)[2], int count, int axis, uint32_t side,
                          uint32_t *first, uint32_t *last)
{
    double low = point[0][axis], high = point[0][axis];
    for (int i = 1; i < count; i++) {
        low = fmin(low, point[i][axis]);
        high = fmax(high, point[i][axis]);
    }
    *first = clamp_cell(low, side);
    *last = clamp_cell(fmax(ceil(high) - 1.0, low), side);
}

/* A_3D / A_uv of every triangle; lumps, whose atlas area vanishes, are marked by a negative number.
 */
static void measure_ratios(clip_job *job)
{
    const parian_body *body = job->body;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        double uv[3][2], u[3], v[3];
        const float *a = body->vertex_position[body->triangle[t][0]];
        const float *b = body->vertex_position[body->triangle[t][1]];
        const float *c = body->vertex_position[body->triangle[t][2]];
        for (int d = 0; d < 3; d++) {
            u[d] = (double)b[d] - (double)a[d];
            v[d] = (double)c[d] - (double)a[d];
        }
        double x = u[1] * v[2] - u[2] * v[1], y = u[2] * v[0] - u[0] * v[2],
               z = u[0] * v[1] - u[1] * v[0];
        double area = 0.5 * sqrt(x * x + y * y + z * z);
        load_corners(body, t, uv);
        double flat = 0.5 * ((uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) -
                             (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]));
        job->ratio[t] = fabs(flat) > UV_AREA_MIN ? area / fabs(flat) : -area;
    }
}

/* File the triangles under the bands that they touch, in their order. */
static parian_result fill_bands(const parian_env *env, clip_job *job)
{
    const parian_body *body = job->body;
    uint64_t total = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t t = 0; t < body->triangle_count; t++) {
            double uv[3][2];
            uint32_t first, last;
            load_corners(body, t, uv);
            touched_range((const double(*)[2])uv, 3, 1, job->side, &first, &last);
            for (uint32_t band = first / BAND_ROWS; band <= last / BAND_ROWS; band++) {
                if (pass == 0) {
                    job->band_begin[band + 2]++;
                    total++;
                } else {
                    job->band_triangle[job->band_begin[band + 1]++] = t;
                }
            }
        }
        if (pass == 0) {
            for (uint32_t band = 0; band < job->band_count; band++) {
                job->band_begin[band + 1] += job->band_begin[band];
            }
            if (total > UINT32_MAX || !PARIAN_NEW(env, job->band_triangle, total)) {
                return PARIAN_E_NOMEM;
            }
        }
    }
    return PARIAN_OK;
}

/* Call visit for every cell of a band that a triangle touches, with the polygon of the triangle in
 * the cell's row. */
typedef void cell_visitor(clip_job *job, uint32_t triangle, uint32_t index, const polygon *row);

static void visit_triangle(clip_job *job, size_t band, uint32_t t, cell_visitor *visit)
{
    polygon whole = {.count = 3}, part, row;
    uint32_t first, last, begin = (uint32_t)band * BAND_ROWS, end = begin + BAND_ROWS - 1;
    load_corners(job->body, t, whole.point);
    if (job->ratio[t] < 0.0) {
        /* A lump: the cell of the centroid takes all of it. */
        double centre[2];
        for (int d = 0; d < 2; d++) {
            centre[d] = (whole.point[0][d] + whole.point[1][d] + whole.point[2][d]) / 3.0;
        }
        uint32_t v = clamp_cell(centre[1], job->side);
        if (v >= begin && v <= end) {
            visit(job, t, v * job->side + clamp_cell(centre[0], job->side), NULL);
        }
        return;
    }
    touched_range((const double(*)[2])whole.point, 3, 1, job->side, &first, &last);
    first = first > begin ? first : begin;
    last = last < end ? last : end;
    for (uint32_t v = first; v <= last; v++) {
        uint32_t left, right;
        clip_half(&whole, 1, v, 1.0, &part);
        clip_half(&part, 1, v + 1.0, -1.0, &row);
        if (row.count < 3) {
            continue;
        }
        touched_range((const double(*)[2])row.point, row.count, 0, job->side, &left, &right);
        for (uint32_t u = left; u <= right; u++) {
            visit(job, t, v * job->side + u, &row);
        }
    }
}

static void visit_band(clip_job *job, size_t band, cell_visitor *visit)
{
    for (uint32_t i = job->band_begin[band]; i < job->band_begin[band + 1]; i++) {
        visit_triangle(job, band, job->band_triangle[i], visit);
    }
}

static void mark_cell(clip_job *job, uint32_t triangle, uint32_t index, const polygon *row)
{
    (void)triangle;
    (void)row;
    job->at[index] = 0;
}

static uint32_t band_end(const clip_job *job, size_t band)
{
    uint32_t row = (uint32_t)(band + 1) * BAND_ROWS;
    return (row < job->side ? row : job->side) * job->side;
}

static void mark_band(void *context, size_t band)
{
    clip_job *job = context;
    uint32_t begin = (uint32_t)band * BAND_ROWS * job->side, count = 0;
    memset(job->at + begin, 0xFF, (size_t)(band_end(job, band) - begin) * sizeof *job->at);
    visit_band(job, band, mark_cell);
    for (uint32_t i = begin; i < band_end(job, band); i++) {
        count += job->at[i] != NOT_TOUCHED;
    }
    job->band_cells[band + 1] = count;
}

static void add_piece(clip_job *job, uint32_t triangle, uint32_t index, const polygon *row)
{
    cell *c = &job->cells[job->at[index]];
    double corner[2] = {index % job->side, (double)(index / job->side)}, moment[2];
    if (c->chart == NOT_TOUCHED) {
        c->chart = job->body->triangle_chart[triangle];
    }
    if (!row) {
        c->area -= job->ratio[triangle];
        for (int d = 0; d < 2; d++) {
            double centre = 0.0;
            for (int k = 0; k < 3; k++) {
                centre += (double)job->body->corner_uv[triangle][k][d] / 3.0;
            }
            c->moment[d] -= job->ratio[triangle] * (centre - corner[d]);
        }
        return;
    }
    polygon part, piece;
    clip_half(row, 0, corner[0], 1.0, &part);
    clip_half(&part, 0, corner[0] + 1.0, -1.0, &piece);
    double area = measure(&piece, corner, moment);
    double sign = area < 0.0 ? -1.0 : 1.0;
    c->covered += sign * area;
    c->area += sign * area * job->ratio[triangle];
    c->moment[0] += sign * moment[0] * job->ratio[triangle];
    c->moment[1] += sign * moment[1] * job->ratio[triangle];
}

/* Barycentrics of the point of a triangle nearest to p, and the squared distance to it. */
static double nearest_in_triangle(const double uv[3][2], const double p[2], double beta[3])
{
    double cross[3], best = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double *a = uv[(k + 1) % 3], *b = uv[(k + 2) % 3];
        cross[k] = (a[0] - p[0]) * (b[1] - p[1]) - (a[1] - p[1]) * (b[0] - p[0]);
    }
    double sum = cross[0] + cross[1] + cross[2];
    if (sum != 0.0 && cross[0] / sum >= 0.0 && cross[1] / sum >= 0.0 && cross[2] / sum >= 0.0) {
        for (int k = 0; k < 3; k++) {
            beta[k] = cross[k] / sum;
        }
        return 0.0;
    }
    for (int k = 0; k < 3; k++) {
        const double *a = uv[k], *b = uv[(k + 1) % 3];
        double e[2] = {b[0] - a[0], b[1] - a[1]}, w[2] = {p[0] - a[0], p[1] - a[1]};
        double length2 = e[0] * e[0] + e[1] * e[1];
        double s = length2 > 0.0 ? (e[0] * w[0] + e[1] * w[1]) / length2 : 0.0;
        s = fmin(1.0, fmax(0.0, s));
        double x = w[0] - s * e[0], y = w[1] - s * e[1], distance2 = x * x + y * y;
        if (distance2 < best) {
            best = distance2;
            beta[k] = 1.0 - s;
            beta[(k + 1) % 3] = s;
            beta[(k + 2) % 3] = 0.0;
        }
    }
    return best;
}

static void locate_piece(clip_job *job, uint32_t triangle, uint32_t index, const polygon *row)
{
    cell *c = &job->cells[job->at[index]];
    double uv[3][2], beta[3], p[2];
    (void)row;
    if (c->distance2 == 0.0 || c->chart != job->body->triangle_chart[triangle]) {
        return;
    }
    double share = c->area > 0.0 ? 1.0 / c->area : 0.0;
    p[0] = index % job->side + (c->area > 0.0 ? c->moment[0] * share : 0.5);
    p[1] = index / job->side + (c->area > 0.0 ? c->moment[1] * share : 0.5);
    load_corners(job->body, triangle, uv);
    double distance2 = nearest_in_triangle((const double(*)[2])uv, p, beta);
    if (distance2 < c->distance2) {
        c->distance2 = distance2;
        c->triangle = triangle;
        memcpy(c->beta, beta, sizeof beta);
    }
}

static void clip_band(void *context, size_t band)
{
    clip_job *job = context;
    uint32_t next = job->band_cells[band];
    for (uint32_t i = (uint32_t)band * BAND_ROWS * job->side; i < band_end(job, band); i++) {
        if (job->at[i] != NOT_TOUCHED) {
            cell *c = &job->cells[next];
            memset(c, 0, sizeof *c);
            c->index = i;
            c->chart = c->triangle = NOT_TOUCHED;
            c->distance2 = INFINITY;
            job->at[i] = next++;
        }
    }
    visit_band(job, band, add_piece);
    visit_band(job, band, locate_piece);
}

/* The nearest cell of the same chart within two texels that is no sliver; NOT_TOUCHED where none
 * is. */
static uint32_t find_receiver(const clip_job *job, const cell *c, double sliver)
{
    int64_t u = c->index % job->side, v = c->index / job->side, side = job->side;
    int64_t best_distance = 9;
    uint32_t best = NOT_TOUCHED;
    for (int64_t y = v - 2; y <= v + 2; y++) {
        for (int64_t x = u - 2; x <= u + 2; x++) {
            int64_t away = (x - u) * (x - u) + (y - v) * (y - v);
            if (x < 0 || y < 0 || x >= side || y >= side || away >= best_distance) {
                continue;
            }
            uint32_t other = job->at[y * side + x];
            if (other != NOT_TOUCHED && job->cells[other].chart == c->chart &&
                job->cells[other].area >= sliver) {
                best_distance = away;
                best = other;
            }
        }
    }
    return best;
}

/* Hand the area of slivers over. A sliver without a receiver stays a texel if it is all its chart
 * has, and a lump of no size goes to the largest texel. */
static void hand_over_slivers(clip_job *job)
{
    double total = 0.0;
    uint32_t largest = 0;
    for (uint32_t i = 0; i < job->cell_count; i++) {
        total += job->cells[i].area;
        largest = job->cells[i].area > job->cells[largest].area ? i : largest;
    }
    double sliver = SLIVER_SHARE * total / (job->cell_count ? job->cell_count : 1);
    for (uint32_t i = 0; i < job->cell_count; i++) {
        cell *c = &job->cells[i];
        if (c->area >= sliver || i == largest) {
            continue;
        }
        uint32_t receiver = find_receiver(job, c, sliver);
        if (receiver == NOT_TOUCHED && (c->covered == 0.0 || c->area == 0.0)) {
            receiver = largest;
        }
        if (receiver != NOT_TOUCHED) {
            job->cells[receiver].area += c->area;
            c->area = -1.0; /* no longer a texel */
        }
    }
}

/* Barycentrics as stored: in [0, 1] and summing to at most 1 after rounding to single precision. */
static void store_barycentric(const double beta[3], float out[2])
{
    float a = (float)fmin(1.0, fmax(0.0, beta[0])), b = (float)fmin(1.0, fmax(0.0, beta[1]));
    out[0] = a;
    out[1] = a + b > 1.0f ? 1.0f - a : b;
}

static parian_result store_texels(const parian_env *env, const clip_job *job, parian_body *body,
                                  float **covered)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < job->cell_count; i++) {
        count += job->cells[i].area >= 0.0;
    }
    if (!PARIAN_NEW(env, body->texel_index, count) ||
        !PARIAN_NEW(env, body->texel_triangle, count) ||
        !PARIAN_NEW(env, body->texel_barycentric, count) ||
        !PARIAN_NEW(env, body->texel_area, count) || !PARIAN_NEW(env, *covered, count)) {
        return PARIAN_E_NOMEM;
    }
    for (uint32_t i = 0; i < job->cell_count; i++) {
        const cell *c = &job->cells[i];
        if (c->area >= 0.0) {
            uint32_t n = body->texel_count++;
            body->texel_index[n] = c->index;
            body->texel_triangle[n] = c->triangle;
            body->texel_area[n] = (float)c->area;
            (*covered)[n] = (float)c->covered;
            store_barycentric(c->beta, body->texel_barycentric[n]);
        }
    }
    return PARIAN_OK;
}

parian_result texels_clip(const parian_env *env, parian_body *body, float **covered)
{
    clip_job job = {.body = body, .side = body->atlas_size};
    parian_result result = PARIAN_E_NOMEM;
    job.band_count = (job.side + BAND_ROWS - 1) / BAND_ROWS;
    if (PARIAN_NEW(env, job.ratio, body->triangle_count) &&
        PARIAN_NEW0(env, job.band_begin, (size_t)job.band_count + 2) &&
        PARIAN_NEW0(env, job.band_cells, (size_t)job.band_count + 1) &&
        PARIAN_NEW(env, job.at, (size_t)job.side * job.side)) {
        measure_ratios(&job);
        result = fill_bands(env, &job);
    }
    if (result == PARIAN_OK) {
        parian_par(env, job.band_count, mark_band, &job);
        for (uint32_t band = 0; band < job.band_count; band++) {
            job.band_cells[band + 1] += job.band_cells[band];
        }
        job.cell_count = job.band_cells[job.band_count];
        result = PARIAN_NEW(env, job.cells, job.cell_count) ? PARIAN_OK : PARIAN_E_NOMEM;
    }
    if (result == PARIAN_OK) {
        parian_par(env, job.band_count, clip_band, &job);
        hand_over_slivers(&job);
        result = store_texels(env, &job, body, covered);
    }
    if (result == PARIAN_E_NOMEM) {
        parian_fail(env, result, "no memory for the texels of a %u x %u atlas", job.side, job.side);
    }
    parian_free(env, job.cells);
    parian_free(env, job.at);
    parian_free(env, job.band_cells);
    parian_free(env, job.band_triangle);
    parian_free(env, job.band_begin);
    parian_free(env, job.ratio);
    return result;
}
