/* global.c - vertex-to-vertex throughput factors: sampled, prefiltered, thresholded, coded in runs.
 *
 * Rows are computed twice: the first pass decides what is kept, the second writes it to its place,
 * so that only one copy of the factors ever exists.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_rows.h"

#include <math.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"

enum { ROWS_PER_BLOCK = 32, STEPS = 16 };

/* What the first pass finds in one block of rows. */
typedef struct row_block {
    parian_run_list runs;
    uint32_t run_end[ROWS_PER_BLOCK]; /* runs of the block up to and with this row */
    uint64_t factors;
    double lost_sum, lost_max, sum_min[3], sum_max[3];
} row_block;

typedef struct global_job {
    const parian_env *env;
    parian_row_maker maker;
    row_block *block;
    uint32_t block_count, first_block;
    parian_operator *op;
    atomic_int result;
} global_job;

static uint32_t rows_of_block(const global_job *job, uint32_t block)
{
    uint32_t first = block * ROWS_PER_BLOCK, count = job->maker.factors.body->vertex_count - first;
    return count < ROWS_PER_BLOCK ? count : ROWS_PER_BLOCK;
}

static void note_row(row_block *block, const parian_row_choice *choice)
{
    for (int c = 0; c < 3; c++) {
        block->lost_sum += choice->lost[c];
        block->lost_max = fmax(block->lost_max, choice->lost[c]);
        block->sum_min[c] = fmin(block->sum_min[c], choice->sum[c]);
        block->sum_max[c] = fmax(block->sum_max[c], choice->sum[c]);
    }
}

static void choose_block(void *context, size_t index)
{
    global_job *job = context;
    uint32_t number = job->first_block + (uint32_t)index;
    row_block *block = &job->block[number];
    parian_row_work work = {0};
    parian_result result = parian_row_work_make(job->env, &job->maker, &work);
    for (uint32_t i = 0; result == PARIAN_OK && i < rows_of_block(job, number); i++) {
        uint32_t v = number * ROWS_PER_BLOCK + i;
        parian_row_choice choice;
        parian_factor_row(&job->maker.factors, v, &work.row);
        parian_row_choose(&job->maker, &work, &choice);
        result =
            parian_row_append_runs(job->env, &job->maker, &work, &block->runs, &block->factors);
        block->run_end[i] = block->runs.count;
        memcpy(job->op->scale[v], choice.scale, sizeof choice.scale);
        note_row(block, &choice);
    }
    parian_row_work_free(job->env, &work);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

static void code_block(void *context, size_t index)
{
    global_job *job = context;
    uint32_t number = job->first_block + (uint32_t)index;
    parian_row_work work = {0};
    parian_result result = parian_row_work_make(job->env, &job->maker, &work);
    for (uint32_t i = 0; result == PARIAN_OK && i < rows_of_block(job, number); i++) {
        uint32_t v = number * ROWS_PER_BLOCK + i;
        parian_factor_row(&job->maker.factors, v, &work.row);
        parian_factor_code(&work.row, work.coded, job->op, v);
    }
    parian_row_work_free(job->env, &work);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* Run one pass over all blocks in slices, with progress and the chance to stop between them. */
static parian_result run_pass(global_job *job, void (*body)(void *, size_t), double begin,
                              double end)
{
    for (uint32_t step = 0; step < STEPS; step++) {
        uint32_t first = (uint32_t)((uint64_t)job->block_count * step / STEPS);
        uint32_t last = (uint32_t)((uint64_t)job->block_count * (step + 1) / STEPS);
        if (parian_cancelled(job->env)) {
            return parian_fail(job->env, PARIAN_E_INTERRUPTED, "interrupted in the global stage");
        }
        job->first_block = first;
        parian_par(job->env, last - first, body, job);
        if (job->result != PARIAN_OK) {
            return (parian_result)job->result;
        }
        parian_progress(job->env, "global", begin + (end - begin) * (step + 1) / STEPS);
    }
    return PARIAN_OK;
}

/* Join the runs of the blocks and allocate the factors. */
static parian_result layout_operator(global_job *job)
{
    parian_operator *op = job->op;
    uint64_t runs = 0, factors = 0;
    for (uint32_t b = 0; b < job->block_count; b++) {
        runs += job->block[b].runs.count;
        factors += job->block[b].factors;
    }
    if (runs >= UINT32_MAX) {
        return parian_fail(job->env, PARIAN_E_COMPUTE, "%llu runs of factors, at most 4294967294",
                           (unsigned long long)runs);
    }
    op->run_total = (uint32_t)runs;
    op->factor_total = factors;
    if (!PARIAN_NEW(job->env, op->run_column, runs) || !PARIAN_NEW(job->env, op->run_count, runs) ||
        !PARIAN_NEW(job->env, op->run_factor, runs + 1) ||
        !PARIAN_NEW(job->env, op->factor, factors)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %llu throughput factors",
                           (unsigned long long)factors);
    }
    uint32_t run = 0;
    op->run_factor[0] = 0;
    op->run_offset[0] = 0;
    for (uint32_t b = 0; b < job->block_count; b++) {
        for (uint32_t i = 0; i < rows_of_block(job, b); i++) {
            op->run_offset[b * ROWS_PER_BLOCK + i + 1] = run + job->block[b].run_end[i];
        }
        for (uint32_t i = 0; i < job->block[b].runs.count; i++, run++) {
            op->run_column[run] = job->block[b].runs.run[i].column;
            op->run_count[run] = (uint16_t)job->block[b].runs.run[i].count;
            op->run_factor[run + 1] = op->run_factor[run] + op->run_count[run];
        }
        parian_run_list_free(job->env, &job->block[b].runs);
    }
    return PARIAN_OK;
}

static void fill_report(const global_job *job, parian_global_report *report)
{
    double rows = job->op->row_count;
    memset(report, 0, sizeof *report);
    report->factor_count = job->op->factor_total;
    report->kept_share = (double)job->op->factor_total / (rows * rows);
    for (uint32_t b = 0; b < job->block_count; b++) {
        const row_block *block = &job->block[b];
        report->lost_mean += block->lost_sum / (3 * rows);
        report->lost_max = fmax(report->lost_max, block->lost_max);
        for (int c = 0; c < 3; c++) {
            report->row_sum_min[c] = fmin(b ? report->row_sum_min[c] : INFINITY, block->sum_min[c]);
            report->row_sum_max[c] = fmax(report->row_sum_max[c], block->sum_max[c]);
        }
    }
}

static parian_result make_operator(global_job *job)
{
    parian_operator *op = job->op;
    uint32_t vertices = job->maker.factors.body->vertex_count;
    job->block_count = (vertices + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    op->source_register = 0;
    op->target_register = 1;
    op->row_count = op->column_count = vertices;
    if (!PARIAN_NEW0(job->env, job->block, job->block_count) ||
        !PARIAN_NEW(job->env, op->run_offset, (size_t)vertices + 1) ||
        !PARIAN_NEW0(job->env, op->scale, vertices)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %u rows of factors", vertices);
    }
    for (uint32_t b = 0; b < job->block_count; b++) {
        for (int c = 0; c < 3; c++) {
            job->block[b].sum_min[c] = INFINITY;
        }
    }
    parian_result result = run_pass(job, choose_block, 0.1, 0.55);
    if (result == PARIAN_OK) {
        result = layout_operator(job);
    }
    if (result == PARIAN_OK) {
        result = run_pass(job, code_block, 0.55, 1);
    }
    return result;
}

parian_result parian_stage_global(const parian_env *env, const parian_global_desc *desc,
                                  parian_body *body, parian_global_report *report)
{
    parian_global_report unused;
    parian_operator op = {0};
    if (!body->has_global) {
        memset(report ? report : &unused, 0, sizeof *report);
        return PARIAN_OK;
    }
    global_job job = {.env = env, .op = &op};
    parian_result result = parian_row_maker_make(env, desc, body, &job.maker);
    if (result == PARIAN_OK) {
        result = make_operator(&job);
    }
    if (result == PARIAN_OK) {
        fill_report(&job, report ? report : &unused);
        parian_operator_free(env, &body->operators[0]);
        body->operators[0] = op;
        body->operator_count = 1;
    } else {
        parian_operator_free(env, &op);
    }
    for (uint32_t b = 0; job.block && b < job.block_count; b++) {
        parian_run_list_free(env, &job.block[b].runs);
    }
    parian_free(env, job.block);
    parian_row_maker_free(env, &job.maker);
    return result;
}
