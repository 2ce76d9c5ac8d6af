/* edited_body.c - a body of another medium than it was baked of.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/edited_body.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/blend.h"
#include "core/factor_row.h"
#include "core/memory.h"
#include "method/edited_levels.h"

enum { ROWS_PER_BLOCK = 32 };

typedef struct refit_block {
    double beyond[3], beyond_max;
} refit_block;

typedef struct refit_job {
    const parian_env *env;
    parian_factor_maker maker;
    parian_operator *op;
    refit_block *block;
    atomic_int result;
} refit_job;

/* Energy of the stored factors of a row; and weighted by the fourth power of distance. */
static void sum_stored(const refit_job *job, uint32_t v, const parian_row *row, double sum[3],
                       double far[3])
{
    const parian_operator *op = job->op;
    const float *area = job->maker.frame.area;
    memset(sum, 0, 3 * sizeof *sum);
    memset(far, 0, 3 * sizeof *far);
    for (uint32_t r = op->run_offset[v]; r < op->run_offset[v + 1]; r++) {
        for (uint32_t u = op->run_column[r]; u < op->run_column[r] + op->run_count[r]; u++) {
            double r4 = u == v ? 0 : (double)row->r2[u] * row->r2[u];
            for (int c = 0; c < 3; c++) {
                double share = (double)area[u] * row->value[c][u];
                sum[c] += share;
                far[c] += r4 * share;
            }
        }
    }
}

/* Spread the energy that lies beyond the stored pairs of row v over them, in proportion to factor
 * and fourth power of distance: it belongs far away (docs/transfer.md compares the powers). */
static void spread_beyond(const refit_job *job, uint32_t v, const parian_row *row,
                          refit_block *block)
{
    const parian_point_arrays *points = &job->maker.frame.points;
    double stored[3], far[3];
    sum_stored(job, v, row, stored, far);
    for (int c = 0; c < 3; c++) {
        double all = parian_row_dot(job->maker.frame.area, row->value[c], points->padded);
        double beyond = all > 0 ? fmax(0, (all - stored[c]) / all) : 0;
        block->beyond[c] += beyond;
        block->beyond_max = fmax(block->beyond_max, beyond);
        if (!(far[c] > 0) || job->maker.body->paper_form) {
            continue;
        }
        float gain = (float)(beyond * all / far[c]);
        for (uint32_t u = 0; u < points->count; u++) {
            row->value[c][u] *= u == v ? 1 : 1 + gain * row->r2[u] * row->r2[u];
        }
    }
}

static void refit_rows(void *context, size_t index)
{
    refit_job *job = context;
    const parian_point_arrays *points = &job->maker.frame.points;
    uint32_t first = (uint32_t)index * ROWS_PER_BLOCK, last = first + ROWS_PER_BLOCK;
    float(*coded)[3] = NULL;
    parian_row row = {0};
    parian_result result = parian_row_make(job->env, &job->maker.frame, &row);
    if (result == PARIAN_OK && !PARIAN_NEW(job->env, coded, PARIAN_RUN_MAX)) {
        result = parian_fail(job->env, PARIAN_E_NOMEM, "no memory for a run of factors");
    }
    last = last < job->op->row_count ? last : job->op->row_count;
    for (uint32_t v = first; result == PARIAN_OK && v < last; v++) {
        parian_factor_row(&job->maker, v, &row);
        spread_beyond(job, v, &row, &job->block[index]);
        for (int c = 0; c < 3; c++) {
            job->op->scale[v][c] = parian_factor_scale(row.value[c], points->padded);
        }
        parian_factor_code(&row, coded, job->op, v);
    }
    parian_row_free(job->env, &row);
    parian_free(job->env, coded);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

static void sum_blocks(const refit_job *job, size_t blocks, parian_edited_body *made)
{
    for (size_t b = 0; b < blocks; b++) {
        for (int c = 0; c < 3; c++) {
            made->beyond_mean[c] += job->block[b].beyond[c] / job->op->row_count;
        }
        made->beyond_max = fmax(made->beyond_max, job->block[b].beyond_max);
    }
}

/* Own factors and scales for the one operator; its runs stay shared. */
static parian_result refit_operator(const parian_env *env, parian_edited_body *made)
{
    parian_operator *op = &made->body.operators[0];
    refit_job job = {.env = env, .op = op};
    size_t blocks = ((size_t)op->row_count + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    op->factor = NULL;
    op->scale = NULL;
    if (!PARIAN_NEW(env, op->factor, op->factor_total) ||
        !PARIAN_NEW(env, op->scale, op->row_count) || !PARIAN_NEW0(env, job.block, blocks)) {
        parian_free(env, job.block);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu edited throughput factors",
                           (unsigned long long)op->factor_total);
    }
    parian_result result = parian_factor_maker_make(env, &made->body, &job.maker);
    if (result == PARIAN_OK) {
        parian_par(env, blocks, refit_rows, &job);
        result = (parian_result)job.result;
    }
    if (result == PARIAN_OK) {
        sum_blocks(&job, blocks, made);
    }
    parian_factor_maker_free(env, &job.maker);
    parian_free(env, job.block);
    return result;
}

/* A copy that shares everything but what a medium changes. */
static void share_body(const parian_body *baked, const parian_medium *medium,
                       parian_edited_body *made)
{
    parian_body *body = &made->body;
    memset(made, 0, sizeof *made);
    *body = *baked;
    body->medium = *medium;
    body->blend_weight = NULL;
    body->kernel_f16 = body->border_f16 = NULL;
    body->kernel_s8 = body->border_s8 = NULL;
    body->kernel_scale = NULL;
    for (uint32_t o = 0; o < body->operator_count; o++) {
        body->operators[o].factor = NULL;
        body->operators[o].scale = NULL;
    }
    if (body->local_form == PARIAN_LOCAL_F16 || body->local_form == PARIAN_LOCAL_U8) {
        body->local_form = PARIAN_LOCAL_REBUILT;
    }
    made->owned = true;
}

parian_result parian_edited_body_make(const parian_env *env, const parian_body *baked,
                                      const parian_medium *medium, parian_edited_body *made)
{
    parian_edited_body edited;
    share_body(baked, medium, &edited);
    parian_result result = PARIAN_OK;
    if (baked->operator_count > 1) {
        result = parian_edited_levels_make(env, baked, &edited);
    } else if (baked->operator_count) {
        result = refit_operator(env, &edited);
    }
    if (result == PARIAN_OK && baked->blend_weight) {
        result = parian_blend_make(env, &edited.body, NULL);
    }
    if (result == PARIAN_OK) {
        result = parian_kernels_build(env, &edited.body, &edited.kernels);
    }
    if (result != PARIAN_OK) {
        parian_edited_body_free(env, &edited);
        return result;
    }
    *made = edited;
    return PARIAN_OK;
}

parian_result parian_edited_body_restore(const parian_env *env, const parian_body *baked,
                                         parian_edited_body *made)
{
    parian_edited_body edited = {.body = *baked};
    parian_result result = parian_kernels_build(env, baked, &edited.kernels);
    if (result == PARIAN_OK) {
        *made = edited;
    }
    return result;
}

void parian_edited_body_free(const parian_env *env, parian_edited_body *made)
{
    parian_body *body = &made->body;
    parian_kernels_free(env, &made->kernels);
    for (uint32_t o = 0; made->owned && o < body->operator_count; o++) {
        parian_free(env, body->operators[o].factor);
        parian_free(env, body->operators[o].scale);
    }
    if (made->owned) {
        parian_free(env, body->blend_weight);
    }
    memset(made, 0, sizeof *made);
}
