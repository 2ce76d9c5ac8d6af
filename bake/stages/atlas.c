/* atlas.c - the atlas stage: charts by normal deviation, flattened, and packed at one scale.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/atlas.h"

#include <math.h>
#include <string.h>

#include "bake/stages/atlas_pack.h"
#include "bake/stages/chart.h"
#include "core/memory.h"

enum {
    SIDE_MIN = 16,
    SIDE_MAX = 8192,
    PACK_SIDE = 512, /* packing grids have about this many cells a side, whatever the atlas has */
    SCALE_STEPS = 6,
    RELAXATION_ROUNDS = 3
};
static const double MERGE_WIDENING = 1.25, RELAX_WIDENING = 1.15; /* of the chart angle */
static const double CLIMB_FIRST = 0.03, CLIMB_LAST = 0.01;        /* steps of the occupancy */
static const double OCCUPANCY_MOST = 1.0;                         /* a square chart comes near it */
static const double OCCUPANCY_LEAST = 0.50;  /* tried first; where it fails, ever less */
static const double MEAN_CHART_TEXELS = 2.0; /* below it an atlas carries nothing but gutters */

typedef struct atlas_job {
    const parian_env *env;
    chart_set set;
    uint32_t gutter;
    double flat_area;    /* sum of the charts' projected areas, m^2 */
    uint32_t flat_count; /* charts with an area */
    chart_place *place;  /* [chart_count] of the best packing so far */
    chart_place *trial;  /* [chart_count] */
} atlas_job;

/* The packing grid of an atlas side: cells of `step` texels. */
static uint32_t grid_step(uint32_t side)
{
    uint32_t step = (side + PACK_SIDE / 2) / PACK_SIDE;
    return step ? step : 1;
}

static pack_grid make_grid(const atlas_job *job, uint32_t side, double occupancy)
{
    uint32_t step = grid_step(side);
    double texels_per_metre = sqrt(occupancy / job->flat_area) * side;
    return (pack_grid){side / step, (job->gutter + step - 1) / step, texels_per_metre / step};
}

/* Try to pack at an occupancy, by some tactics after each other; keep the packing when one fits. */
static parian_result try_pack(atlas_job *job, uint32_t side, double occupancy, unsigned tactics,
                              bool *fits)
{
    pack_grid grid = make_grid(job, side, occupancy);
    parian_result result = PARIAN_OK;
    *fits = false;
    for (unsigned tactic = 0; tactic < tactics && !*fits && result == PARIAN_OK; tactic++) {
        result = parian_cancelled(job->env)
                     ? PARIAN_E_INTERRUPTED
                     : chart_set_pack(job->env, &job->set, &grid, tactic, job->trial, fits);
    }
    if (result == PARIAN_OK && *fits) {
        chart_place *kept = job->trial;
        job->trial = job->place;
        job->place = kept;
    }
    return result;
}

static double occupancy_floor(const atlas_job *job, uint32_t side)
{
    return MEAN_CHART_TEXELS * job->flat_count / ((double)side * side);
}

/* Raise a scale that fits by ever smaller steps as long as any tactic follows. */
static parian_result climb_scale(atlas_job *job, uint32_t side, double *found)
{
    parian_result result = PARIAN_OK;
    for (double step = CLIMB_FIRST; step > CLIMB_LAST && result == PARIAN_OK; step *= 0.5) {
        bool fits = true;
        while (fits && result == PARIAN_OK && *found * (1.0 + step) < OCCUPANCY_MOST) {
            result = try_pack(job, side, *found * (1.0 + step), PACK_TACTICS, &fits);
            *found *= fits ? 1.0 + step : 1.0;
        }
    }
    return result;
}

/* Find about the largest scale that fits, by bisection of its logarithm; found is 0 when none does.
 */
static parian_result search_scale(atlas_job *job, uint32_t side, double *found)
{
    double floor = occupancy_floor(job, side), low = OCCUPANCY_LEAST, high = OCCUPANCY_MOST;
    bool fits = false;
    *found = 0.0;
    if (floor >= high) {
        return PARIAN_OK;
    }
    low = fmax(low, floor);
    parian_result result = try_pack(job, side, low, 1, &fits);
    while (result == PARIAN_OK && !fits && low > floor) {
        high = low;
        low = fmax(0.7 * low, floor);
        result = try_pack(job, side, low, 1, &fits);
    }
    if (result != PARIAN_OK || !fits) {
        return result;
    }
    *found = low;
    for (int step = 0; step < SCALE_STEPS && result == PARIAN_OK; step++) {
        double middle = sqrt(low * high);
        result = try_pack(job, side, middle, 1, &fits);
        if (fits) {
            *found = low = middle;
        } else {
            high = middle;
        }
        parian_progress(job->env, "atlas", 0.3 + 0.1 * step);
    }
    return result == PARIAN_OK ? climb_scale(job, side, found) : result;
}

/* The smallest side at which the charts fit, or 0: doubled until they do, then bisected. */
static parian_result find_smallest_side(atlas_job *job, uint32_t side, uint32_t *smallest)
{
    uint32_t low = side, high = side;
    bool fits = false;
    parian_result result = PARIAN_OK;
    *smallest = 0;
    while (result == PARIAN_OK && !fits && high < SIDE_MAX) {
        low = high;
        high = high < SIDE_MAX / 2 ? 2 * high : SIDE_MAX;
        double floor = occupancy_floor(job, high);
        result = floor < OCCUPANCY_MOST ? try_pack(job, high, floor, 1, &fits) : PARIAN_OK;
    }
    if (!fits) {
        return result;
    }
    while (result == PARIAN_OK && high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        double floor = occupancy_floor(job, middle);
        fits = false;
        result = floor < OCCUPANCY_MOST ? try_pack(job, middle, floor, 1, &fits) : PARIAN_OK;
        *(fits ? &high : &low) = middle;
    }
    *smallest = high;
    return result;
}

static parian_result refuse(atlas_job *job, uint32_t side, parian_atlas_report *report)
{
    parian_result result = find_smallest_side(job, side, &report->smallest_side);
    if (result != PARIAN_OK) {
        return result;
    }
    if (report->smallest_side == 0) {
        return parian_fail(
            job->env, PARIAN_E_COMPUTE,
            "the %u charts of the surface do not fit into an atlas of %u x %u texels, "
            "nor into the largest of %u",
            job->flat_count, side, side, (unsigned)SIDE_MAX);
    }
    return parian_fail(job->env, PARIAN_E_COMPUTE,
                       "the %u charts of the surface do not fit into an atlas of %u x %u texels; "
                       "the smallest side that fits is %u",
                       job->flat_count, side, side, report->smallest_side);
}

/* Texel coordinates of all corners; triangles of charts without area lie on one point. */
static void write_corners(const atlas_job *job, const pack_grid *grid, uint32_t step,
                          parian_body *body)
{
    const chart_set *set = &job->set;
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        uint32_t chart = set->chart[t];
        bool placed = set->extent[chart][0] > 0.0 && set->extent[chart][1] > 0.0;
        for (int k = 0; k < 3; k++) {
            double at[2] = {0.5, 0.5};
            if (placed) {
                chart_place_point(&job->place[chart], grid->scale, set->flat[t][k], at);
            }
            body->corner_uv[t][k][0] = (float)(at[0] * step);
            body->corner_uv[t][k][1] = (float)(at[1] * step);
        }
        body->triangle_chart[t] = chart;
    }
}

static double uv_area(const double uv[3][2])
{
    return 0.5 * fabs((uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) -
                      (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]));
}

/* Projected area of all charts, and how many have one. */
static void measure_flat(atlas_job *job)
{
    const chart_set *set = &job->set;
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        job->flat_area += uv_area((const double(*)[2])set->flat[t]);
    }
    for (uint32_t c = 0; c < set->chart_count; c++) {
        job->flat_count += set->extent[c][0] > 0.0 && set->extent[c][1] > 0.0;
    }
}

static void fill_report(const atlas_job *job, double occupancy, double texels_per_metre,
                        parian_atlas_report *report)
{
    const chart_set *set = &job->set;
    double mean = set->area_total / job->flat_area, most = 0.0;
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        double flat = uv_area((const double(*)[2])set->flat[t]);
        if (flat > 0.0 && dot3(set->normal[t], set->normal[t]) > 0.0) {
            most = fmax(most, set->area[t] / flat / mean);
        }
    }
    report->chart_count = set->chart_count;
    report->occupancy = occupancy;
    report->texel_edge_m = 1.0 / texels_per_metre;
    report->stretch_max = most;
}

/* Grow, then merge and relax in turns. A union's average normal differs from its parts', so the
 * limits of merging and relaxing are a little wider than that of growth. */
static parian_result cut_charts(const parian_env *env, chart_set *set, double angle_deg)
{
    parian_result result = chart_set_grow(env, set, angle_deg);
    for (int round = 0; round < RELAXATION_ROUNDS && result == PARIAN_OK; round++) {
        result = chart_set_merge(env, set, MERGE_WIDENING * angle_deg);
        if (result == PARIAN_OK) {
            result = chart_set_relax(env, set, RELAX_WIDENING * angle_deg);
        }
        if (result == PARIAN_OK && parian_cancelled(env)) {
            result = PARIAN_E_INTERRUPTED;
        }
    }
    if (result == PARIAN_OK) {
        result = chart_set_merge(env, set, MERGE_WIDENING * angle_deg);
    }
    return result == PARIAN_OK ? chart_set_split(env, set) : result;
}

static parian_result make_charts(atlas_job *job, const parian_body *body, double angle_deg)
{
    parian_result result = chart_set_create(job->env, body, &job->set);
    if (result == PARIAN_OK) {
        result = cut_charts(job->env, &job->set, angle_deg);
    }
    if (result == PARIAN_OK) {
        result = chart_set_flatten(job->env, &job->set);
    }
    if (result == PARIAN_OK) {
        measure_flat(job);
        if (!(job->flat_area > 0.0)) {
            result = parian_fail(job->env, PARIAN_E_COMPUTE,
                                 "the surface has no area to make an atlas of");
        }
    }
    return result;
}

static parian_result store_atlas(atlas_job *job, uint32_t side, double occupancy, parian_body *body)
{
    pack_grid grid = make_grid(job, side, occupancy);
    float(*corner_uv)[3][2] = NULL;
    uint32_t *triangle_chart = NULL;
    if (!PARIAN_NEW(job->env, corner_uv, body->triangle_count) ||
        !PARIAN_NEW(job->env, triangle_chart, body->triangle_count)) {
        parian_free(job->env, corner_uv);
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for the atlas of %u triangles",
                           body->triangle_count);
    }
    parian_free(job->env, body->corner_uv);
    parian_free(job->env, body->triangle_chart);
    body->corner_uv = corner_uv;
    body->triangle_chart = triangle_chart;
    body->atlas_size = side;
    body->chart_count = job->set.chart_count;
    write_corners(job, &grid, grid_step(side), body);
    return PARIAN_OK;
}

parian_result parian_stage_atlas(const parian_env *env, const parian_atlas_desc *desc,
                                 parian_body *body, parian_atlas_report *report)
{
    parian_atlas_desc zero = {0, 0.0, 0};
    desc = desc ? desc : &zero;
    uint32_t side = desc->atlas_size ? desc->atlas_size : 512;
    double angle = desc->chart_angle_deg > 0.0 ? desc->chart_angle_deg : 30.0;
    atlas_job job = {.env = env, .gutter = desc->gutter ? desc->gutter : 2};
    parian_atlas_report local;
    report = report ? report : &local;
    memset(report, 0, sizeof *report);
    if (side < SIDE_MIN || side > SIDE_MAX || !(angle <= 75.0) || job.gutter > 64) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "atlas of %u texels, chart angle %g degrees, gutter %u: expected %u to %u "
            "texels, at most 75 degrees, a gutter of at most 64",
            side, angle, job.gutter, (unsigned)SIDE_MIN, (unsigned)SIDE_MAX);
    }
    parian_progress(env, "atlas", 0.0);
    double occupancy = 0.0;
    parian_result result = make_charts(&job, body, angle);
    if (result == PARIAN_OK && (!PARIAN_NEW(env, job.place, job.set.chart_count) ||
                                !PARIAN_NEW(env, job.trial, job.set.chart_count))) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for placing %u charts",
                             job.set.chart_count);
    }
    if (result == PARIAN_OK) {
        result = search_scale(&job, side, &occupancy);
    }
    if (result == PARIAN_OK && occupancy == 0.0) {
        result = refuse(&job, side, report);
    }
    if (result == PARIAN_OK) {
        fill_report(&job, occupancy, sqrt(occupancy / job.flat_area) * side, report);
        result = store_atlas(&job, side, occupancy, body);
    }
    parian_progress(env, "atlas", 1.0);
    parian_free(env, job.trial);
    parian_free(env, job.place);
    chart_set_free(env, &job.set);
    return result;
}
