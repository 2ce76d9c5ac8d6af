/* plan.c - decides which parts of the transport a body needs, and says why.
 *
 * A part is left out when that changes B by 0.5 % at most. Without the local part everything goes
 * through the vertices: the error grows with vertex edge over mean free path, and is calibrated
 * (docs/transfer.md) under a hard-edged checkerboard of 8 squares across. Without the global part
 * light stops at the rim of the window: the energy beyond is known in closed form.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/transport.h"
#include "core/dipole.h"
#include "core/memory.h"
#include "core/small_maths.h"

static const double CHANGE_MAX = 0.005;
/* error = GAIN x^2 / (1 + BEND x) sqrt(EDGES h / extent), x = h / mean free path, h the vertex
 * edge. */
static const double LOCAL_GAIN = 0.0166, LOCAL_BEND = 0.5, LOCAL_EDGES = 70;
static const double EDGE_PERCENTILE = 0.05; /* of texel areas: those that are not stretched */

/* Root mean square edge of the triangles, by area. */
static double measure_vertex_edge(const parian_body *body)
{
    double area = 0, squares = 0;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        const uint32_t *c = body->triangle[t];
        const float(*p)[3] = (const float(*)[3])body->vertex_position;
        double a = parian_triangle_area(p[c[0]], p[c[1]], p[c[2]]);
        area += a;
        for (int k = 0; k < 3; k++) {
            squares += a / 3 * (double)parian_distance2f(p[c[k]], p[c[(k + 1) % 3]]);
        }
    }
    return area > 0 ? sqrt(squares / area) : 0;
}

static double measure_extent(const parian_body *body)
{
    double extent = 0;
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t v = 0; v < body->vertex_count; v++) {
            low = fmin(low, body->vertex_position[v][k]);
            high = fmax(high, body->vertex_position[v][k]);
        }
        extent = fmax(extent, high - low);
    }
    return extent;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Side of an unstretched texel: a low percentile of the areas of interior texels (of all, where
 * there are none). */
static parian_result measure_texel_edge(const parian_env *env, const parian_body *body,
                                        double *edge)
{
    float *area;
    size_t count = 0;
    if (!PARIAN_NEW(env, area, body->texel_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u texel areas", body->texel_count);
    }
    for (int all = 0; all < 2 && count == 0; all++) {
        for (uint32_t i = 0; i < body->texel_count; i++) {
            if (all || !body->texel_border || body->texel_border[i] == PARIAN_NO_BORDER) {
                area[count++] = body->texel_area[i];
            }
        }
    }
    qsort(area, count, sizeof *area, compare_floats);
    *edge = count ? sqrt(area[(size_t)(EDGE_PERCENTILE * (double)count)]) : 0;
    parian_free(env, area);
    return PARIAN_OK;
}

static void estimate_errors(const parian_body *body, parian_plan *plan)
{
    double window = 0.5 * body->kernel_width * plan->texel_edge_m;
    double density =
        plan->extent_m > 0 ? sqrt(LOCAL_EDGES * plan->vertex_edge_m / plan->extent_m) : 1;
    plan->error_without_local = plan->error_without_global = 0;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        parian_dipole d = parian_dipole_make(&body->medium, c, body->fit_fdr);
        double total = parian_dipole_total(&d), x = plan->vertex_edge_m * d.sigma_t_prime;
        plan->mean_free_path_m[c] = 1 / d.sigma_t_prime;
        if (total <= 0) {
            continue;
        }
        double local = LOCAL_GAIN * x * x / (1 + LOCAL_BEND * x) * density;
        double global = 1 - parian_dipole_disc_energy(&d, window) / total;
        plan->error_without_local = fmin(1, fmax(plan->error_without_local, local));
        plan->error_without_global = fmax(plan->error_without_global, global);
    }
}

static parian_result check_demands(const parian_env *env, const parian_plan_desc *desc)
{
    if ((desc->force_local && desc->no_local) || (desc->force_global && desc->no_global)) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "a part is both forced and left out");
    }
    if (desc->no_local && desc->no_global) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "neither a local nor a global part: nothing is left");
    }
    if (desc->paper_form && desc->local_form == PARIAN_LOCAL_SPLIT) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "the paper's form has no smooth split");
    }
    return PARIAN_OK;
}

static void decide(const parian_plan_desc *desc, parian_plan *plan)
{
    bool local_spare = plan->error_without_local <= CHANGE_MAX && !desc->paper_form;
    bool global_spare = plan->error_without_global <= CHANGE_MAX && !desc->paper_form;
    plan->local = !desc->no_local;
    plan->global = !desc->no_global;
    if (global_spare && plan->local && !desc->force_global) {
        plan->global = false;
    }
    if (local_spare && plan->global && !desc->force_local) {
        plan->local = false;
    }
}

static const char *verdict(bool has, bool forced, bool forbidden, bool spare)
{
    if (forbidden) {
        return spare ? "left out as asked, and not needed" : "left out as asked, though needed";
    }
    if (forced) {
        return spare ? "kept as asked, though not needed" : "kept as asked, and needed";
    }
    return has ? "needed" : "not needed";
}

static void explain(const parian_body *body, const parian_plan_desc *desc, parian_plan *plan)
{
    const double *l = plan->mean_free_path_m;
    double low = fmin(l[0], fmin(l[1], l[2])), high = fmax(l[0], fmax(l[1], l[2]));
    snprintf(
        plan->reason, sizeof plan->reason,
        "mean free path %.3g to %.3g mm against vertex edge %.3g mm, texel edge %.3g mm and extent "
        "%.3g "
        "mm. Local part %s: without it B would change by about %.2g %% under hard-edged light. "
        "Global "
        "part %s: %.2g %% of the light leaves beyond the %u x %u window. The limit is %.2g %%.",
        low * 1e3, high * 1e3, plan->vertex_edge_m * 1e3, plan->texel_edge_m * 1e3,
        plan->extent_m * 1e3,
        verdict(plan->local, desc->force_local, desc->no_local,
                plan->error_without_local <= CHANGE_MAX),
        100 * plan->error_without_local,
        verdict(plan->global, desc->force_global, desc->no_global,
                plan->error_without_global <= CHANGE_MAX),
        100 * plan->error_without_global, body->kernel_width, body->kernel_width, 100 * CHANGE_MAX);
}

parian_result parian_stage_plan(const parian_env *env, const parian_plan_desc *desc,
                                parian_body *body, parian_plan *plan)
{
    static const parian_plan_desc defaults = {.local_form = PARIAN_LOCAL_REBUILT};
    const parian_plan_desc *wanted = desc ? desc : &defaults;
    parian_local_form form = wanted->local_form;
    parian_result result = check_demands(env, wanted);
    memset(plan, 0, sizeof *plan);
    if (result == PARIAN_OK) {
        result = measure_texel_edge(env, body, &plan->texel_edge_m);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    plan->extent_m = measure_extent(body);
    plan->vertex_edge_m = measure_vertex_edge(body);
    estimate_errors(body, plan);
    decide(wanted, plan);
    explain(body, wanted, plan);
    if (form == PARIAN_LOCAL_NONE || form == PARIAN_LOCAL_ONLY) {
        form = PARIAN_LOCAL_REBUILT;
    }
    body->paper_form = wanted->paper_form;
    body->has_global = plan->global;
    body->local_form = !plan->local ? PARIAN_LOCAL_NONE : plan->global ? form : PARIAN_LOCAL_ONLY;
    body->split_radius_m = body->local_form == PARIAN_LOCAL_SPLIT
                               ? (float)(0.5 * body->kernel_width * plan->texel_edge_m)
                               : 0;
    return PARIAN_OK;
}
