/* global_operator.c - all rows of factors between some points, as a sparse operator.
 *
 * Blocks of rows are made in parallel, each with its own runs and factors, and joined in their
 * order. Whole rows, without coarse levels, are computed twice instead: the first pass decides what
 * is kept, the second writes it to its place, so that only one copy of many factors ever exists.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_operator.h"

#include <math.h>
#include <string.h>

#include "bake/stages/global_rounding.h"
#include "core/half.h"
#include "core/memory.h"

enum { ROWS_PER_BLOCK = 32, STEPS = 16, SAMPLES = 64 };

typedef struct row_block {
    parian_run_list runs;
    uint32_t run_end[ROWS_PER_BLOCK]; /* runs of the block up to and with this row */
    uint64_t factors, capacity;
    parian_half (*factor)[3];
    double lost_sum, lost_max, sum_min[3], sum_max[3];
} row_block;

typedef struct rows_job {
    const parian_env *env;
    const parian_row_maker *maker;
    row_block *block;
    uint32_t block_count, first_block;
    parian_operator *op;
    bool whole_rows;
    double area_mean_m2;
    atomic_int result;
} rows_job;

static uint32_t rows_of_block(const rows_job *job, uint32_t block)
{
    uint32_t first = block * ROWS_PER_BLOCK, count = job->maker->factors.frame.points.count - first;
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

static parian_result reserve_factors(const parian_env *env, row_block *block, uint64_t used)
{
    parian_half(*more)[3];
    uint64_t capacity = 2 * block->capacity > block->factors ? 2 * block->capacity : block->factors;
    if (block->factors <= block->capacity) {
        return PARIAN_OK;
    }
    if (!PARIAN_NEW(env, more, capacity)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu throughput factors",
                           (unsigned long long)capacity);
    }
    if (used) {
        memcpy(more, block->factor, used * sizeof *more);
    }
    parian_free(env, block->factor);
    block->factor = more;
    block->capacity = capacity;
    return PARIAN_OK;
}

static parian_result add_row(const rows_job *job, row_block *block, uint32_t i, uint32_t v,
                             parian_row_work *work)
{
    parian_row_choice choice;
    uint32_t first_run = block->runs.count;
    uint64_t at = block->factors;
    parian_row_compute(job->maker, v, work);
    parian_row_choose(job->maker, v, work, &choice);
    parian_result result =
        parian_row_append_runs(job->env, job->maker, work, &block->runs, &block->factors);
    if (result == PARIAN_OK && !job->whole_rows) {
        result = reserve_factors(job->env, block, at);
    }
    if (!job->whole_rows) {
        parian_row_round(job->maker, job->area_mean_m2, work);
    }
    for (uint32_t r = first_run; result == PARIAN_OK && !job->whole_rows && r < block->runs.count;
         r++) {
        const parian_run *run = &block->runs.run[r];
        parian_factor_code_run(&work->row, choice.scale, run->column, run->count, work->coded,
                               block->factor + at);
        at += run->count;
    }
    block->run_end[i] = block->runs.count;
    memcpy(job->op->scale[v], choice.scale, sizeof choice.scale);
    note_row(block, &choice);
    return result;
}

static void make_block(void *context, size_t index)
{
    rows_job *job = context;
    uint32_t number = job->first_block + (uint32_t)index;
    row_block *block = &job->block[number];
    parian_row_work work = {0};
    parian_result result = parian_row_work_make(job->env, job->maker, &work);
    for (int c = 0; c < 3; c++) {
        block->sum_min[c] = INFINITY;
    }
    for (uint32_t i = 0; result == PARIAN_OK && i < rows_of_block(job, number); i++) {
        result = add_row(job, block, i, number * ROWS_PER_BLOCK + i, &work);
    }
    parian_row_work_free(job->env, &work);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* Mark the columns of row v, whose runs are known. */
static void mark_runs(const parian_operator *op, uint32_t v, uint8_t *keep)
{
    memset(keep, 0, op->column_count);
    for (uint32_t r = op->run_offset[v]; r < op->run_offset[v + 1]; r++) {
        memset(keep + op->run_column[r], 1, op->run_count[r]);
    }
}

/* The second pass: compute the rows of a block again and code them where they belong. */
static void code_block(void *context, size_t index)
{
    rows_job *job = context;
    parian_operator *op = job->op;
    uint32_t number = job->first_block + (uint32_t)index;
    parian_row_work work = {0};
    parian_result result = parian_row_work_make(job->env, job->maker, &work);
    for (uint32_t i = 0; result == PARIAN_OK && i < rows_of_block(job, number); i++) {
        uint32_t v = number * ROWS_PER_BLOCK + i;
        parian_row_compute(job->maker, v, &work);
        mark_runs(op, v, work.keep);
        parian_row_round(job->maker, job->area_mean_m2, &work);
        parian_factor_code(&work.row, work.coded, op, v);
    }
    parian_row_work_free(job->env, &work);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* One pass over all blocks in slices, with progress and the chance to stop between them. */
static parian_result run_pass(rows_job *job, void (*pass)(void *, size_t), double begin, double end)
{
    for (uint32_t step = 0; step < STEPS; step++) {
        uint32_t first = (uint32_t)((uint64_t)job->block_count * step / STEPS);
        uint32_t last = (uint32_t)((uint64_t)job->block_count * (step + 1) / STEPS);
        if (parian_cancelled(job->env)) {
            return parian_fail(job->env, PARIAN_E_INTERRUPTED, "interrupted in the global stage");
        }
        job->first_block = first;
        parian_par(job->env, last - first, pass, job);
        if (job->result != PARIAN_OK) {
            return (parian_result)job->result;
        }
        parian_progress(job->env, "global", begin + (end - begin) * (step + 1) / STEPS);
    }
    return PARIAN_OK;
}

static void free_block(const parian_env *env, row_block *block)
{
    parian_run_list_free(env, &block->runs);
    parian_free(env, block->factor);
    block->factor = NULL;
}

static parian_result allocate_runs(const rows_job *job)
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
    return PARIAN_OK;
}

static void join_blocks(const rows_job *job)
{
    parian_operator *op = job->op;
    uint32_t run = 0;
    op->run_factor[0] = 0;
    op->run_offset[0] = 0;
    for (uint32_t b = 0; b < job->block_count; b++) {
        row_block *block = &job->block[b];
        for (uint32_t i = 0; i < rows_of_block(job, b); i++) {
            op->run_offset[b * ROWS_PER_BLOCK + i + 1] = run + block->run_end[i];
        }
        if (block->factor) {
            memcpy(op->factor[op->run_factor[run]], block->factor,
                   block->factors * sizeof *block->factor);
        }
        for (uint32_t i = 0; i < block->runs.count; i++, run++) {
            op->run_column[run] = block->runs.run[i].column;
            op->run_count[run] = (uint16_t)block->runs.run[i].count;
            op->run_factor[run + 1] = op->run_factor[run] + op->run_count[run];
        }
        free_block(job->env, block);
    }
}

static void fill_report(const rows_job *job, parian_rows_report *report)
{
    double rows = job->op->row_count;
    memset(report, 0, sizeof *report);
    for (uint32_t b = 0; b < job->block_count; b++) {
        const row_block *block = &job->block[b];
        report->lost_mean += block->lost_sum / (3 * rows);
        report->lost_max = fmax(report->lost_max, block->lost_max);
        for (int c = 0; c < 3; c++) {
            report->sum_min[c] = fmin(b ? report->sum_min[c] : INFINITY, block->sum_min[c]);
            report->sum_max[c] = fmax(report->sum_max[c], block->sum_max[c]);
        }
    }
}

static double mean_area(const parian_vertex_frame *frame)
{
    double sum = 0;
    for (uint32_t i = 0; i < frame->points.count; i++) {
        sum += frame->area[i];
    }
    return frame->points.count ? sum / frame->points.count : 0;
}

parian_result parian_rows_to_operator(const parian_env *env, const parian_row_maker *maker,
                                      double begin, double end, parian_operator *op,
                                      parian_rows_report *report)
{
    uint32_t points = maker->factors.frame.points.count;
    rows_job job = {.env = env, .maker = maker, .op = op};
    parian_result result = PARIAN_OK;
    memset(op, 0, sizeof *op);
    job.block_count = (points + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    job.whole_rows = !maker->far && !maker->finer;
    op->row_count = op->column_count = points;
    job.area_mean_m2 = mean_area(&maker->factors.frame);
    if (!PARIAN_NEW0(env, job.block, job.block_count) ||
        !PARIAN_NEW(env, op->run_offset, (size_t)points + 1) ||
        !PARIAN_NEW0(env, op->scale, points)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u rows of factors", points);
    }
    double middle = job.whole_rows ? 0.5 * (begin + end) : end;
    if (result == PARIAN_OK) {
        result = run_pass(&job, make_block, begin, middle);
    }
    if (result == PARIAN_OK) {
        result = allocate_runs(&job);
    }
    if (result == PARIAN_OK) {
        join_blocks(&job);
        fill_report(&job, report);
        result = job.whole_rows ? run_pass(&job, code_block, middle, end) : PARIAN_OK;
    }
    if (result != PARIAN_OK) {
        parian_operator_free(env, op);
    }
    for (uint32_t b = 0; job.block && b < job.block_count; b++) {
        free_block(env, &job.block[b]);
    }
    parian_free(env, job.block);
    return result;
}

/* ---- sample ---- */

typedef struct sample_job {
    const parian_env *env;
    const parian_row_maker *maker;
    uint64_t factors[SAMPLES];
    atomic_int result;
} sample_job;

static void sample_row(void *context, size_t index)
{
    sample_job *job = context;
    uint32_t points = job->maker->factors.frame.points.count;
    uint32_t v = (uint32_t)((uint64_t)points * index / SAMPLES);
    parian_row_work work = {0};
    parian_row_choice choice;
    parian_run_list runs = {0};
    parian_result result = parian_row_work_make(job->env, job->maker, &work);
    if (result == PARIAN_OK) {
        parian_row_compute(job->maker, v, &work);
        parian_row_choose(job->maker, v, &work, &choice);
        result = parian_row_append_runs(job->env, job->maker, &work, &runs, &job->factors[index]);
    }
    parian_run_list_free(job->env, &runs);
    parian_row_work_free(job->env, &work);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

parian_result parian_rows_sample(const parian_env *env, const parian_row_maker *maker,
                                 double *factors_per_row)
{
    sample_job job = {.env = env, .maker = maker};
    uint64_t factors = 0;
    parian_par(env, SAMPLES, sample_row, &job);
    for (int k = 0; k < SAMPLES; k++) {
        factors += job.factors[k];
    }
    *factors_per_row = (double)factors / SAMPLES;
    return (parian_result)job.result;
}
