/* samples.c - the samples stage: finds the radius, puts the samples in order, gives them areas.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/samples.h"

#include <math.h>
#include <string.h>

#include "bake/stages/samples_parts.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { TRIES_MAX = 16, CELL_TRIES = 12 };
static const double DENSITY = 0.7, CLOSE_ENOUGH = 0.01, TOLERANCE = 0.02;

/* ---- the surface ---- */

static void measure_triangle(sampling *s, uint32_t t)
{
    const uint32_t *c = s->surface->triangle[t];
    const float(*p)[3] = s->surface->vertex;
    double edge[2][3], *n = s->normal[t];
    parian_sub3(p[c[1]], p[c[0]], edge[0]);
    parian_sub3(p[c[2]], p[c[0]], edge[1]);
    parian_cross3(edge[0], edge[1], n);
    double length = sqrt(parian_dot3(n, n));
    for (int k = 0; k < 3; k++) {
        n[k] = length > 0 ? n[k] / length : 0;
    }
    s->area += 0.5 * length;
    s->until[t] = s->area;
}

static void measure_box(sampling *s)
{
    double upper[3] = {-INFINITY, -INFINITY, -INFINITY}, squared = 0;
    for (int k = 0; k < 3; k++) {
        s->lower[k] = INFINITY;
    }
    for (uint32_t t = 0; t < s->surface->triangle_count; t++) {
        for (int i = 0; i < 9; i++) {
            double at = (double)s->surface->vertex[s->surface->triangle[t][i / 3]][i % 3];
            s->lower[i % 3] = fmin(s->lower[i % 3], at);
            upper[i % 3] = fmax(upper[i % 3], at);
        }
    }
    for (int k = 0; k < 3; k++) {
        s->extent[k] = upper[k] - s->lower[k];
        squared += s->extent[k] * s->extent[k];
    }
    s->diagonal = sqrt(squared);
}

static parian_result sampling_begin(const parian_env *env, const parian_sampled_surface *surface,
                                    uint64_t seed, sampling *s)
{
    *s = (sampling){.surface = surface, .seed = seed};
    parian_result r = parian_point_grid_create(env, 1, 0, &s->grid);
    if (r == PARIAN_OK && (!PARIAN_NEW(env, s->until, surface->triangle_count) ||
                           !PARIAN_NEW(env, s->normal, surface->triangle_count))) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory to sample %u triangles",
                        surface->triangle_count);
    }
    for (uint32_t t = 0; r == PARIAN_OK && t < surface->triangle_count; t++) {
        measure_triangle(s, t);
    }
    if (r == PARIAN_OK) {
        measure_box(s);
    }
    return r;
}

static void sampling_end(const parian_env *env, sampling *s)
{
    parian_free(env, s->until);
    parian_free(env, s->normal);
    parian_free(env, s->triangle);
    parian_free(env, s->barycentric);
    parian_point_grid_free(env, &s->grid);
    *s = (sampling){0};
}

/* ---- the radius ---- */

static double miss(const sampling *s, uint32_t count)
{
    return fabs((double)s->grid.count - count) / count;
}

/* The number of samples goes about as radius^-2. Where steps by that law no longer come nearer the
 * radius is sought between one that gave too many and one that gave too few. */
static parian_result find_count(const parian_env *env, sampling *s, uint32_t count,
                                parian_samples_report *report)
{
    /* Even on a thread of that length a third of a step each is too many. */
    double radius = fmax(sqrt(DENSITY * s->area / count), s->diagonal / (3.0 * count));
    double best = radius, best_miss = INFINITY;
    double many = 0, few = INFINITY; /* radii that gave too many and too few */
    parian_result r = PARIAN_OK;
    for (report->tries = 0; r == PARIAN_OK && report->tries < TRIES_MAX; report->tries++) {
        r = sampling_fill(env, s, radius);
        if (r != PARIAN_OK) {
            return r;
        }
        parian_progress(env, "samples", 0.6 * (report->tries + 1) / TRIES_MAX);
        double missed = miss(s, count);
        if (missed < best_miss) {
            best_miss = missed;
            best = radius;
        }
        if (missed <= CLOSE_ENOUGH) {
            report->tries++;
            return PARIAN_OK;
        }
        many = s->grid.count > count ? fmax(many, radius) : many;
        few = s->grid.count < count ? fmin(few, radius) : few;
        radius *= sqrt((double)s->grid.count / count);
        if (radius <= many || radius >= few) {
            radius = few < INFINITY && many > 0 ? sqrt(many * few) : radius;
        }
        if (radius > 4 * s->diagonal) {
            break; /* nothing changes any more */
        }
    }
    if (s->radius != best) {
        r = sampling_fill(env, s, best);
        report->tries++;
    }
    if (r == PARIAN_OK && best_miss > TOLERANCE) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "samples: %u wanted, %u is the nearest number found (radius %.4g mm)", count,
                   s->grid.count, 1e3 * best);
    }
    return r;
}

/* Samples in the fullest cell of a grid over the surface's box. */
static parian_result fullest_cell(const parian_env *env, const sampling *s, uint32_t side,
                                  uint32_t *most)
{
    double longest = fmax(s->extent[0], fmax(s->extent[1], s->extent[2]));
    uint32_t *count = NULL;
    *most = 0;
    if (!PARIAN_NEW0(env, count, (size_t)side * side * side)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a grid of %u^3 cells", side);
    }
    for (uint32_t i = 0; i < s->grid.count; i++) {
        size_t cell = 0;
        for (int k = 0; k < 3; k++) {
            double at = (s->grid.point[i].position[k] - s->lower[k]) / longest * side;
            uint32_t step = at > 0 ? (uint32_t)fmin(at, side - 1.0) : 0;
            cell = cell * side + step;
        }
        count[cell]++;
        *most = count[cell] > *most ? count[cell] : *most;
    }
    parian_free(env, count);
    return PARIAN_OK;
}

/* The least radius, to 2 %, with at most so many samples in a cell. */
static parian_result find_cell_samples(const parian_env *env, sampling *s,
                                       const parian_samples_desc *desc, uint32_t side,
                                       parian_samples_report *report)
{
    double longest = fmax(s->extent[0], fmax(s->extent[1], s->extent[2]));
    double cell = longest / side, low = cell * sqrt(0.2 / desc->cell_samples), high = INFINITY;
    double radius = cell * sqrt(1.0 / desc->cell_samples);
    parian_result r = PARIAN_OK;
    for (report->tries = 0; r == PARIAN_OK && report->tries < CELL_TRIES; report->tries++) {
        r = sampling_fill(env, s, radius);
        r = r == PARIAN_OK ? fullest_cell(env, s, side, &report->cell_most) : r;
        if (r != PARIAN_OK) {
            return r;
        }
        parian_progress(env, "samples", 0.6 * (report->tries + 1) / CELL_TRIES);
        if (report->cell_most <= desc->cell_samples) {
            high = radius;
        } else {
            low = radius;
        }
        if (high < low * 1.02) {
            break;
        }
        radius = high < INFINITY ? sqrt(low * high) : 1.5 * radius;
    }
    if (high < INFINITY && s->radius != high) {
        report->tries++;
        r = sampling_fill(env, s, high);
        r = r == PARIAN_OK ? fullest_cell(env, s, side, &report->cell_most) : r;
    }
    return r;
}

/* ---- the set ---- */

static parian_result allocate(const parian_env *env, uint32_t count, parian_surface_samples *out)
{
    if (!PARIAN_NEW(env, out->triangle, count) || !PARIAN_NEW(env, out->barycentric, count) ||
        !PARIAN_NEW(env, out->area, count) || !PARIAN_NEW(env, out->radius, count)) {
        parian_surface_samples_free(env, out);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", count);
    }
    out->count = count;
    return PARIAN_OK;
}

/* Squared distance of a sample to the nearest that faces alike among those in the grid. */
static double nearest_before(const sampling *s, const parian_point_grid *grid,
                             const parian_point *point)
{
    double squared, least = s->diagonal * s->diagonal;
    if (parian_point_grid_nearest(grid, point, grid->cell, PARIAN_NO_POINT, &squared) !=
        PARIAN_NO_POINT) {
        return squared;
    }
    for (uint32_t i = 0; i < grid->count; i++) {
        if (parian_points_face_alike(point, &grid->point[i])) {
            least = fmin(least, parian_points_squared(point, &grid->point[i]));
        }
    }
    return least;
}

/* Distance of each sample to the nearest before it, in ranges of 1, 1, 2, 4, ... samples: cells are
 * as wide as samples of a range lie apart. */
static parian_result find_distances(const parian_env *env, const sampling *s, const uint32_t *order,
                                    float *radius)
{
    parian_point_grid grid;
    parian_result r = parian_point_grid_create(env, 1, s->grid.count, &grid);
    for (uint32_t first = 0, end = 1; r == PARIAN_OK && first < s->grid.count;) {
        parian_point_grid_clear(&grid, 2 * sqrt(s->area / end));
        for (uint32_t i = 0; r == PARIAN_OK && i < end; i++) {
            const parian_point *point = &s->grid.point[order[i]];
            if (i >= first) {
                radius[i] = (float)sqrt(nearest_before(s, &grid, point));
            }
            r = parian_point_grid_put(env, &grid, point);
        }
        first = end;
        end = s->grid.count - end < end ? s->grid.count : 2 * end;
    }
    parian_point_grid_free(env, &grid);
    return r;
}

/* Write the samples in their order. */
static parian_result hand_out(const parian_env *env, const sampling *s, parian_surface_samples *out)
{
    uint32_t *order = NULL, count = s->grid.count;
    double *area = NULL;
    parian_result r = allocate(env, count, out);
    if (r == PARIAN_OK && (!PARIAN_NEW(env, order, count) || !PARIAN_NEW(env, area, count))) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", count);
    }
    r = r == PARIAN_OK ? sampling_order(env, s, order) : r;
    parian_progress(env, "samples", 0.8);
    r = r == PARIAN_OK ? sampling_areas(env, s, area) : r;
    for (uint32_t i = 0; r == PARIAN_OK && i < count; i++) {
        out->triangle[i] = s->triangle[order[i]];
        memcpy(out->barycentric[i], s->barycentric[order[i]], sizeof *out->barycentric);
        out->area[i] = (float)area[order[i]];
    }
    r = r == PARIAN_OK ? find_distances(env, s, order, out->radius) : r;
    out->radius_m = s->radius;
    parian_free(env, order);
    parian_free(env, area);
    if (r != PARIAN_OK) {
        parian_surface_samples_free(env, out);
    }
    return r;
}

static parian_result check_desc(const parian_env *env, const parian_samples_desc *desc)
{
    int given = (desc->radius_m > 0) + (desc->count > 0) + (desc->cell_samples > 0);
    if (given != 1 || !isfinite(desc->radius_m) || desc->count > PARIAN_SAMPLES_MAX ||
        desc->grid_side > 1024) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "samples need a radius, a count up to %d or a number for each cell of a "
                           "grid of at most 1024^3, and just one of them",
                           PARIAN_SAMPLES_MAX);
    }
    return PARIAN_OK;
}

static parian_result find_set(const parian_env *env, sampling *s, const parian_samples_desc *desc,
                              parian_samples_report *report)
{
    uint32_t side = desc->grid_side ? desc->grid_side : PARIAN_SAMPLES_GRID;
    parian_result r = PARIAN_OK;
    if (desc->cell_samples > 0) {
        return find_cell_samples(env, s, desc, side, report);
    }
    if (desc->count > 0) {
        r = find_count(env, s, desc->count, report);
    } else {
        r = sampling_fill(env, s, desc->radius_m);
        report->tries = 1;
    }
    return r == PARIAN_OK ? fullest_cell(env, s, side, &report->cell_most) : r;
}

parian_result parian_stage_samples(const parian_env *env, const parian_sampled_surface *surface,
                                   const parian_samples_desc *desc, parian_surface_samples *samples,
                                   parian_samples_report *report)
{
    sampling s = {0};
    *samples = (parian_surface_samples){0};
    *report = (parian_samples_report){0};
    parian_result r = check_desc(env, desc);
    r = r == PARIAN_OK ? sampling_begin(env, surface, desc->seed, &s) : r;
    report->area_m2 = s.area;
    if (r == PARIAN_OK && s.area > 0) {
        r = find_set(env, &s, desc, report);
        report->uncovered_m2 = s.uncovered;
        r = r == PARIAN_OK ? hand_out(env, &s, samples) : r;
        parian_progress(env, "samples", 1.0);
    }
    sampling_end(env, &s);
    return r;
}
