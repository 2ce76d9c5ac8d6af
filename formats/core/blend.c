/* blend.c - weights by which a texel's light adds to its triangle's vertices, so that what the
 * local window leaves to the global part joins on smoothly and carries the right energy.
 *
 * Per texel i and channel, with q = w / A_i the weights per unit of flux:
 *   min over q of  sum over texels o around the window of
 *                  ( R_d(i, o) - G(i, o) - sum over corners k of psi_k(o) q_k )^2
 *   so that        sum over k of c_k q_k = e,   psi_k-weighted: no response below zero at a corner
 *   and            q_k <= a few R_d(i, i), where hats hardly leave the window (slivers)
 * G is the response of the stored factors, e the energy that is still missing outside the window,
 * c_k the part of corner k's hat outside the window.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/blend.h"
#include "core/blend_solve.h"
#include "core/half.h"
#include "core/memory.h"
#include "core/near_factors.h"
#include "core/operator.h"
#include "core/texel_response.h"
#include "core/vertex_frame.h"

/* A vertex of the global part radiates at most this many times what R_d has at its peak. */
static const double CEILING = 2;

enum { TRIANGLES_PER_BLOCK = 128, STEPS = 16, RING_MIN = 8 };

typedef struct blend_job {
    const parian_env *env;
    parian_body *body;
    parian_transport_model model;
    parian_texel_response response;
    parian_texel_lists lists;
    float (*total)[3];   /* [vertex_count] integral of R_d from each vertex */
    float *hat_area;     /* [vertex_count] sum over texels of beta A */
    double (*column)[3]; /* [vertex_count] energy that flux entering at a vertex brings about */
    uint32_t ring_width; /* texels beyond the window that are fitted */
    size_t first_block;
    atomic_uint fitted, fallback;
    double *block_error; /* [block count] largest relative energy error */
    atomic_int result;
} blend_job;

/* The texels of window and ring of one texel. */
typedef struct surroundings {
    uint32_t *texel, window_count, count, capacity;
} surroundings;

typedef struct blend_work {
    parian_patch patch;
    surroundings around;
    uint32_t *mark; /* [texel_count] token of the collection that last took it */
    uint32_t token;
} blend_work;

static parian_result collect(const parian_env *env, blend_work *work, uint32_t texel)
{
    surroundings *around = &work->around;
    if (work->mark[texel] == work->token) {
        return PARIAN_OK;
    }
    if (around->count == around->capacity) {
        uint32_t *more, capacity = around->capacity ? 2 * around->capacity : 256;
        if (!PARIAN_NEW(env, more, capacity)) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u texels of a window",
                               capacity);
        }
        if (around->count) {
            memcpy(more, around->texel, around->count * sizeof *more);
        }
        parian_free(env, around->texel);
        around->texel = more;
        around->capacity = capacity;
    }
    work->mark[texel] = work->token;
    around->texel[around->count++] = texel;
    return PARIAN_OK;
}

/* Texels of the square of half width `reach` around texel i that belong to its chart. */
static parian_result collect_square(const blend_job *job, blend_work *work, uint32_t i,
                                    int32_t reach)
{
    const parian_body *body = job->body;
    int32_t size = (int32_t)body->atlas_size,
            u = (int32_t)(body->texel_index[i] % body->atlas_size);
    int32_t v = (int32_t)(body->texel_index[i] / body->atlas_size);
    uint32_t chart = body->triangle_chart ? body->triangle_chart[body->texel_triangle[i]] : 0;
    parian_result result = PARIAN_OK;
    for (int32_t y = v - reach; y <= v + reach && result == PARIAN_OK; y++) {
        for (int32_t x = u - reach; x <= u + reach && result == PARIAN_OK; x++) {
            uint32_t o = x >= 0 && x < size && y >= 0 && y < size ? body->texel_at[y * size + x]
                                                                  : PARIAN_NO_BORDER;
            if (o != PARIAN_NO_BORDER &&
                (!body->triangle_chart || body->triangle_chart[body->texel_triangle[o]] == chart)) {
                result = collect(job->env, work, o);
            }
        }
    }
    return result;
}

/* Fill the window first, then the ring. */
static parian_result collect_around(const blend_job *job, blend_work *work, uint32_t i)
{
    const parian_body *body = job->body;
    int32_t half = (int32_t)body->kernel_width / 2;
    uint32_t border = body->texel_border[i];
    parian_result result = PARIAN_OK;
    work->around.count = 0;
    work->token++;
    if (border == PARIAN_NO_BORDER) {
        result = collect_square(job, work, i, half);
    } else {
        for (uint32_t k = body->border_offset[border];
             k < body->border_offset[border + 1] && result == PARIAN_OK; k++) {
            result = collect(job->env, work, body->border_neighbour[k]);
        }
    }
    work->around.window_count = work->around.count;
    if (result == PARIAN_OK) {
        result = collect_square(job, work, i, half + (int32_t)job->ring_width);
    }
    return result;
}

/* The hats of triangle t's corners at texel o: zero unless o's triangle has that corner. */
static void corner_hats(const parian_body *body, uint32_t t, uint32_t o, float psi[3])
{
    const uint32_t *corner = body->triangle[t], *other = body->triangle[body->texel_triangle[o]];
    float beta[3];
    parian_texel_hats(body, o, beta);
    for (int k = 0; k < 3; k++) {
        psi[k] = 0;
        for (int j = 0; j < 3; j++) {
            psi[k] += other[j] == corner[k] ? beta[j] : 0;
        }
    }
}

/* Put one texel of window or ring into the system. */
static void add_texel(const blend_job *job, const parian_patch *patch, uint32_t i, uint32_t o,
                      bool in_window, parian_blend_system *system)
{
    const parian_body *body = job->body;
    float beta[3], psi[3], direct[3], carried[3];
    parian_texel_hats(body, o, beta);
    corner_hats(body, patch->triangle, o, psi);
    if (!in_window && psi[0] + psi[1] + psi[2] <= 0) {
        return;
    }
    parian_texel_response_eval(&job->response, i, o, direct);
    parian_patch_response(patch, o, beta, carried);
    if (!in_window) {
        parian_blend_add(system, psi, direct, carried);
        return;
    }
    double area = body->texel_area[o];
    for (int k = 0; k < 3; k++) {
        system->reach[k] -= area * psi[k];
        system->missing[k] -= area * (direct[k] - (double)carried[k]); /* k: channel */
    }
}

static void begin_system(const blend_job *job, const parian_patch *patch, uint32_t i,
                         parian_blend_system *system)
{
    const parian_body *body = job->body;
    const uint32_t *corner = body->triangle[patch->triangle];
    float entry[3];
    memset(system, 0, sizeof *system);
    parian_texel_hats(body, i, system->beta);
    parian_texel_entry(body, i, entry);
    for (int k = 0; k < 3; k++) {
        system->reach[k] = job->hat_area[corner[k]];
        for (int c = 0; c < 3; c++) {
            system->missing[c] += system->beta[k] * job->total[corner[k]][c];
            system->missing[c] -= entry[k] * job->column[corner[k]][c];
            system->floor[k][c] = -patch->mix[patch->slot[corner[k]]][c];
        }
    }
    for (int c = 0; c < 3; c++) {
        system->ceiling[c] = CEILING * parian_dipole_rd(&job->model.dipole[c], 0);
        system->whole[c] = fmax(1e-30, system->beta[0] * job->total[corner[0]][c] +
                                           system->beta[1] * job->total[corner[1]][c] +
                                           system->beta[2] * job->total[corner[2]][c]);
    }
}

static void blend_texel(blend_job *job, blend_work *work, uint32_t i, double *error)
{
    parian_body *body = job->body;
    parian_blend_system system;
    float entry[3];
    double q[3][3];
    parian_texel_entry(body, i, entry);
    parian_patch_mix(&work->patch, entry);
    begin_system(job, &work->patch, i, &system);
    for (uint32_t k = 0; k < work->around.count; k++) {
        add_texel(job, &work->patch, i, work->around.texel[k], k < work->around.window_count,
                  &system);
    }
    bool fit = system.count >= RING_MIN;
    if (body->paper_form) {
        parian_blend_solve_free(&system, fit, q);
    } else {
        parian_blend_solve(&system, fit, q);
    }
    atomic_fetch_add(fit ? &job->fitted : &job->fallback, 1);
    for (int c = 0; c < 3; c++) {
        double carried = 0;
        for (int k = 0; k < 3; k++) {
            double w = q[k][c] * body->texel_area[i];
            body->blend_weight[i][k][c] = parian_half_from_float((float)fmin(fmax(w, -6e4), 6e4));
            carried += system.reach[k] * q[k][c];
        }
        *error = fmax(*error, fabs(carried - system.missing[c]) / system.whole[c]);
    }
}

static parian_result blend_triangle(blend_job *job, blend_work *work, uint32_t t, double *error)
{
    const uint32_t *offset = job->lists.offset + t;
    parian_result result = PARIAN_OK;
    parian_patch_begin(&work->patch, t);
    for (uint32_t n = offset[0]; n < offset[1] && result == PARIAN_OK; n++) {
        result = collect_around(job, work, job->lists.texel[n]);
        for (uint32_t k = 0; k < work->around.count && result == PARIAN_OK; k++) {
            result = parian_patch_add(&work->patch, work->around.texel[k]);
        }
    }
    if (result != PARIAN_OK) {
        return result;
    }
    parian_patch_gather(&work->patch, false);
    for (uint32_t n = offset[0]; n < offset[1] && result == PARIAN_OK; n++) {
        result = collect_around(job, work, job->lists.texel[n]);
        if (result == PARIAN_OK) {
            blend_texel(job, work, job->lists.texel[n], error);
        }
    }
    return result;
}

static void blend_block(void *context, size_t index)
{
    blend_job *job = context;
    size_t block = job->first_block + index;
    uint32_t first = (uint32_t)block * TRIANGLES_PER_BLOCK, last = first + TRIANGLES_PER_BLOCK;
    blend_work work = {0};
    parian_result result = parian_patch_make(job->env, job->body, &work.patch);
    if (result == PARIAN_OK && !PARIAN_NEW0(job->env, work.mark, job->body->texel_count)) {
        result = parian_fail(job->env, PARIAN_E_NOMEM, "no memory for the marks of %u texels",
                             job->body->texel_count);
    }
    last = last < job->body->triangle_count ? last : job->body->triangle_count;
    for (uint32_t t = first; t < last && result == PARIAN_OK; t++) {
        if (job->lists.offset[t] < job->lists.offset[t + 1]) {
            result = blend_triangle(job, &work, t, &job->block_error[block]);
        }
    }
    parian_patch_free(&work.patch);
    parian_free(job->env, work.around.texel);
    parian_free(job->env, work.mark);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* Totals from each vertex, areas of the hats in texels, and what the stored factors make of unit
 * flux. */
static parian_result prepare(blend_job *job)
{
    const parian_body *body = job->body;
    parian_vertex_frame frame = {0};
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(job->env, job->total, body->vertex_count) ||
        !PARIAN_NEW0(job->env, job->hat_area, body->vertex_count) ||
        !PARIAN_NEW(job->env, job->column, body->vertex_count)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %u vertices",
                           body->vertex_count);
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        float beta[3];
        parian_texel_hats(body, i, beta);
        for (int k = 0; k < 3; k++) {
            job->hat_area[body->triangle[body->texel_triangle[i]][k]] +=
                beta[k] * body->texel_area[i];
        }
    }
    result = parian_operators_column_sums(job->env, body->operators, body->operator_count,
                                          job->hat_area, job->column);
    if (result == PARIAN_OK) {
        result = parian_vertex_frame_make(job->env, body, &frame);
    }
    if (result == PARIAN_OK) {
        result = parian_vertex_totals(job->env, body, &job->model, &frame, true, job->total);
    }
    parian_vertex_frame_free(job->env, &frame);
    return result;
}

static parian_result run_blocks(blend_job *job, double *error)
{
    size_t blocks = (job->body->triangle_count + TRIANGLES_PER_BLOCK - 1) / TRIANGLES_PER_BLOCK;
    if (!PARIAN_NEW0(job->env, job->block_error, blocks)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %zu blocks", blocks);
    }
    for (size_t step = 0; step < STEPS; step++) {
        size_t first = blocks * step / STEPS, last = blocks * (step + 1) / STEPS;
        if (parian_cancelled(job->env)) {
            return parian_fail(job->env, PARIAN_E_INTERRUPTED, "interrupted in the blend stage");
        }
        job->first_block = first;
        parian_par(job->env, last - first, blend_block, job);
        if (job->result != PARIAN_OK) {
            return (parian_result)job->result;
        }
        parian_progress(job->env, "blend", 0.2 + 0.8 * (double)(step + 1) / STEPS);
    }
    *error = 0;
    for (size_t block = 0; block < blocks; block++) {
        *error = fmax(*error, job->block_error[block]);
    }
    return PARIAN_OK;
}

parian_result parian_blend_make(const parian_env *env, parian_body *body,
                                parian_blend_report *report)
{
    parian_local_form form = body->local_form;
    blend_job job = {.env = env, .body = body, .ring_width = body->paper_form ? 1 : 2};
    double error = 0;
    if (report) {
        memset(report, 0, sizeof *report);
    }
    if ((form != PARIAN_LOCAL_REBUILT && form != PARIAN_LOCAL_F16 && form != PARIAN_LOCAL_U8) ||
        body->operator_count == 0) {
        return PARIAN_OK;
    }
    parian_free(env, body->blend_weight);
    if (!PARIAN_NEW0(env, body->blend_weight, body->texel_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u blending weights",
                           body->texel_count);
    }
    parian_result result = parian_transport_model_make(env, body, PARIAN_MODEL_FULL, &job.model);
    if (result == PARIAN_OK) {
        parian_texel_response_init(body, &job.model, &job.response);
        result = prepare(&job);
    }
    if (result == PARIAN_OK) {
        result = parian_texel_lists_make(env, body, &job.lists);
    }
    if (result == PARIAN_OK) {
        result = run_blocks(&job, &error);
    }
    if (result == PARIAN_OK && report) {
        report->fitted = job.fitted;
        report->fallback = job.fallback;
        report->energy_error_max = error;
    }
    parian_transport_model_free(env, &job.model);
    parian_texel_lists_free(env, &job.lists);
    parian_free(env, job.total);
    parian_free(env, job.hat_area);
    parian_free(env, job.column);
    parian_free(env, job.block_error);
    return result;
}
