/* cpu_raster.c - which points of which triangles are seen through which pixels.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_raster.h"

#include <math.h>
#include <stdbool.h>

#include "core/memory.h"

enum { BAND_COUNT = 32, SETUP_PIECE = 4096 };

/* Edge functions over pixel coordinates, divided by the determinant; and the pixels they may cover.
 */
typedef struct raster_setup {
    double edge[3][3];
    uint32_t x0, x1, y0, y1; /* half-open; empty for what cannot be seen */
} raster_setup;

typedef struct raster_job {
    const parian_raster_desc *desc;
    raster_setup *setup;
} raster_job;

static double apply_row(const float row[4], const float p[3])
{
    return (double)row[0] * p[0] + (double)row[1] * p[1] + (double)row[2] * p[2] + row[3];
}

/* Corners in homogeneous pixel coordinates, y downward. */
static void project(const parian_raster_desc *desc, uint32_t triangle, double corner[3][3])
{
    for (int k = 0; k < 3; k++) {
        const float *p = desc->position[desc->triangle[triangle][k]];
        double w = apply_row(desc->row_w, p);
        corner[k][0] = 0.5 * desc->width * (apply_row(desc->row_x, p) + w);
        corner[k][1] = 0.5 * desc->height * (w - apply_row(desc->row_y, p));
        corner[k][2] = w;
    }
}

static uint32_t clamp_pixel(double at, uint32_t side)
{
    return at <= 0.0 ? 0 : at >= side ? side : (uint32_t)at;
}

static void grow_box(double low[2], double high[2], double x, double y, double w)
{
    low[0] = fmin(low[0], x / w);
    high[0] = fmax(high[0], x / w);
    low[1] = fmin(low[1], y / w);
    high[1] = fmax(high[1], y / w);
}

/* The box of what is in front: corners, and the points where edges come to the front. */
static void find_box(const parian_raster_desc *desc, const double corner[3][3], raster_setup *setup)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    double most = fmax(corner[0][2], fmax(corner[1][2], corner[2][2]));
    double front = fmax((double)desc->near_w, 1e-6 * most);
    *setup = (raster_setup){.x0 = 0};
    if (most < front || most <= 0.0) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        const double *a = corner[k], *b = corner[(k + 1) % 3];
        if (a[2] >= front) {
            grow_box(low, high, a[0], a[1], a[2]);
        }
        if ((a[2] >= front) != (b[2] >= front)) {
            double t = (front - a[2]) / (b[2] - a[2]);
            grow_box(low, high, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), front);
        }
    }
    setup->x0 = clamp_pixel(low[0] - 0.5, desc->width);
    setup->y0 = clamp_pixel(low[1] - 0.5, desc->height);
    setup->x1 = clamp_pixel(high[0] + 1.5, desc->width);
    setup->y1 = clamp_pixel(high[1] + 1.5, desc->height);
}

static void set_up(const parian_raster_desc *desc, uint32_t triangle, raster_setup *setup)
{
    double corner[3][3], det = 0.0;
    project(desc, triangle, corner);
    find_box(desc, (const double(*)[3])corner, setup);
    for (int k = 0; k < 3; k++) {
        const double *a = corner[(k + 1) % 3], *b = corner[(k + 2) % 3];
        setup->edge[k][0] = a[1] * b[2] - a[2] * b[1];
        setup->edge[k][1] = a[2] * b[0] - a[0] * b[2];
        setup->edge[k][2] = a[0] * b[1] - a[1] * b[0];
    }
    for (int axis = 0; axis < 3; axis++) {
        det += corner[0][axis] * setup->edge[0][axis];
    }
    if (det == 0.0 || !isfinite(1.0 / det)) {
        setup->x1 = setup->x0; /* seen edge-on */
        return;
    }
    for (int k = 0; k < 3; k++) {
        for (int axis = 0; axis < 3; axis++) {
            setup->edge[k][axis] /= det;
        }
    }
}

static void set_up_piece(void *context, size_t piece)
{
    raster_job *job = context;
    uint32_t first = (uint32_t)piece * SETUP_PIECE, last = first + SETUP_PIECE;
    for (uint32_t t = first; t < last && t < job->desc->triangle_count; t++) {
        set_up(job->desc, t, &job->setup[t]);
    }
}

static void fill_row(const parian_raster_desc *desc, const raster_setup *s, uint32_t triangle,
                     uint32_t y)
{
    for (uint32_t x = s->x0; x < s->x1; x++) {
        float share[3];
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            double value = s->edge[k][0] * (x + 0.5) + s->edge[k][1] * (y + 0.5) + s->edge[k][2];
            inside &= value >= 0.0;
            share[k] = (float)value;
        }
        if (inside && share[0] + share[1] + share[2] > 0.0f) {
            desc->fragment(desc->context, y * desc->width + x, triangle, share);
        }
    }
}

static void fill_band(void *context, size_t band)
{
    raster_job *job = context;
    const parian_raster_desc *desc = job->desc;
    uint32_t first = (uint32_t)((uint64_t)desc->height * band / BAND_COUNT);
    uint32_t last = (uint32_t)((uint64_t)desc->height * (band + 1) / BAND_COUNT);
    for (uint32_t t = 0; t < desc->triangle_count; t++) {
        const raster_setup *s = &job->setup[t];
        for (uint32_t y = s->y0 > first ? s->y0 : first; y < s->y1 && y < last; y++) {
            fill_row(desc, s, t, y);
        }
    }
}

parian_result parian_raster_run(const parian_env *env, const parian_raster_desc *desc)
{
    raster_job job = {desc, NULL};
    if (!PARIAN_NEW(env, job.setup, desc->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to draw %u triangles",
                           desc->triangle_count);
    }
    parian_par(env, (desc->triangle_count + SETUP_PIECE - 1) / SETUP_PIECE, set_up_piece, &job);
    parian_par(env, BAND_COUNT, fill_band, &job);
    parian_free(env, job.setup);
    return PARIAN_OK;
}
