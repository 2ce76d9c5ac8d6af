/* edited_levels.c - factors of another medium for a body with coarse levels.
 *
 * The operators are those that the global stage of a bake writes: the vertices' own factors, then
 * flux down level by level, then from the coarsest level on its factors and the way up. Points and
 * weights are read back from them; rows are made as in the bake, for the pairs that it stored.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/edited_levels.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/factor_far.h"
#include "core/memory.h"

enum { ROWS_PER_BLOCK = 32 };

typedef struct levels {
    uint32_t count;
    parian_factor_maker vertices, maker[PARIAN_LEVELS_MAX];
    parian_coarse coarse[PARIAN_LEVELS_MAX];
} levels;

/* Level 0 is the vertices'. */
static uint32_t factors_index(uint32_t count, uint32_t level)
{
    return level == 0 ? 0 : 1 + count + 2 * (count - level);
}

static bool leads(const parian_operator *op, uint32_t source, uint32_t target)
{
    return op->source_register == source && op->target_register == target;
}

static bool is_hierarchy(const parian_body *body, uint32_t count)
{
    bool good = body->operator_count == 1 + 3 * count && count >= 1 && count <= PARIAN_LEVELS_MAX;
    for (uint32_t l = 0; l <= count && good; l++) {
        const parian_operator *factors = &body->operators[factors_index(count, l)];
        good = leads(factors, 2 * l, 2 * l + 1) &&
               (l == 0 || (leads(&body->operators[l], 2 * l - 2, 2 * l) &&
                           leads(factors + 1, 2 * l + 1, 2 * l - 1)));
    }
    return good;
}

/* ---- rows ---- */

typedef struct refit_block {
    double beyond[3], beyond_max;
} refit_block;

typedef struct refit_job {
    const parian_env *env;
    const parian_factor_maker *maker;
    const parian_far *far; /* without levels at the coarsest */
    const parian_operator *baked;
    parian_operator *op;
    bool coarse;
    refit_block *block;
    atomic_int result;
} refit_job;

/* Between coarse points, zero is what finer points carry. */
static void clear_finer(const refit_job *job, uint32_t v, const parian_row *row)
{
    const parian_operator *op = job->baked;
    for (uint32_t r = op->run_offset[v]; r < op->run_offset[v + 1]; r++) {
        for (uint32_t k = 0; k < op->run_count[r]; k++) {
            const parian_half *half = op->factor[op->run_factor[r] + k];
            for (int c = 0; c < 3 && !(half[0] | half[1] | half[2]); c++) {
                row->value[c][op->run_column[r] + k] = 0;
            }
        }
    }
}

/* Zero what is not stored; dropped: its sum times areas. */
static void drop_others(const refit_job *job, uint32_t v, const parian_row *row, double dropped[3])
{
    const parian_operator *op = job->baked;
    const float *area = job->maker->frame.area;
    uint32_t next = 0, last = op->run_offset[v + 1];
    memset(dropped, 0, 3 * sizeof *dropped);
    for (uint32_t r = op->run_offset[v]; r <= last; r++) {
        uint32_t stop = r < last ? op->run_column[r] : op->column_count;
        for (uint32_t u = next; u < stop; u++) {
            for (int c = 0; c < 3; c++) {
                dropped[c] += (double)area[u] * row->value[c][u];
                row->value[c][u] = 0;
            }
        }
        next = r < last ? stop + op->run_count[r] : stop;
    }
}

/* Spread what was dropped of row v over what is stored, in proportion to plain factor and fourth
 * power of distance, as with one level: it belongs just beyond. */
static void spread_dropped(const refit_job *job, uint32_t v, const parian_row *plain,
                           const double dropped[3], const parian_row *row)
{
    const parian_operator *op = job->baked;
    const float *area = job->maker->frame.area;
    double far[3] = {0};
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t r = op->run_offset[v]; r < op->run_offset[v + 1]; r++) {
            for (uint32_t u = op->run_column[r]; u < op->run_column[r] + op->run_count[r]; u++) {
                double r4 = u == v ? 0 : (double)row->r2[u] * row->r2[u];
                for (int c = 0; c < 3; c++) {
                    double weight = r4 * plain->value[c][u];
                    far[c] += pass ? 0 : area[u] * weight;
                    double share = pass && far[c] > 0 ? dropped[c] * weight / far[c] : 0;
                    row->value[c][u] += (float)fmax(share, -0.5 * plain->value[c][u]);
                }
            }
        }
    }
}

static void refit_row(const refit_job *job, uint32_t v, const parian_row *plain,
                      const parian_row *row, parian_far_work *work, refit_block *block)
{
    const parian_vertex_frame *frame = &job->maker->frame;
    size_t size = frame->points.padded * sizeof(float);
    double whole[3], dropped[3];
    parian_factor_row(job->maker, v, row);
    for (int c = 0; c < 3; c++) {
        whole[c] = parian_row_dot(frame->area, row->value[c], frame->points.padded);
    }
    if (job->coarse) {
        clear_finer(job, v, row);
    }
    for (int c = 0; c < 3; c++) {
        memcpy(plain->value[c], row->value[c], size);
    }
    if (job->far->count) {
        parian_far_subtract(job->far, v, work, row->value);
    }
    drop_others(job, v, row, dropped);
    if (!job->coarse) { /* what coarse points drop is not with the vertices, and counted there */
        spread_dropped(job, v, plain, dropped, row);
    }
    for (int c = 0; c < 3; c++) {
        double beyond = whole[c] > 0 ? fabs(dropped[c]) / whole[c] : 0;
        block->beyond[c] += beyond;
        block->beyond_max = fmax(block->beyond_max, beyond);
        job->op->scale[v][c] = parian_factor_scale(row->value[c], frame->points.padded);
    }
}

static void refit_rows(void *context, size_t index)
{
    refit_job *job = context;
    uint32_t first = (uint32_t)index * ROWS_PER_BLOCK, last = first + ROWS_PER_BLOCK;
    float(*coded)[3] = NULL;
    parian_row row = {0}, plain = {0};
    parian_far_work work = {0};
    parian_result result = parian_row_make(job->env, &job->maker->frame, &row);
    if (result == PARIAN_OK) {
        result = parian_row_make(job->env, &job->maker->frame, &plain);
    }
    if (result == PARIAN_OK) {
        result = parian_far_work_make(job->env, job->far, &work);
    }
    if (result == PARIAN_OK && !PARIAN_NEW(job->env, coded, PARIAN_RUN_MAX)) {
        result = parian_fail(job->env, PARIAN_E_NOMEM, "no memory for a run of factors");
    }
    last = last < job->op->row_count ? last : job->op->row_count;
    for (uint32_t v = first; result == PARIAN_OK && v < last; v++) {
        refit_row(job, v, &plain, &row, &work, &job->block[index]);
        parian_factor_code(&row, coded, job->op, v);
    }
    parian_row_free(job->env, &row);
    parian_row_free(job->env, &plain);
    parian_far_work_free(job->env, &work);
    parian_free(job->env, coded);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* ---- operators ---- */

static parian_result own_arrays(const parian_env *env, parian_operator *op)
{
    if (!PARIAN_NEW(env, op->factor, op->factor_total) ||
        !PARIAN_NEW(env, op->scale, op->row_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu edited throughput factors",
                           (unsigned long long)op->factor_total);
    }
    return PARIAN_OK;
}

/* The levels above `level`, with edited factors. */
static void levels_above(const levels *all, uint32_t level, const parian_body *body,
                         parian_far *far)
{
    far->count = 0;
    for (uint32_t l = level; l < all->count; l++) {
        far->coarse[far->count] = &all->coarse[l];
        far->factors[far->count++] = &body->operators[factors_index(all->count, l + 1)];
    }
}

static parian_result refit_level(const parian_env *env, const parian_body *baked, const levels *all,
                                 uint32_t level, parian_edited_body *made)
{
    uint32_t index = factors_index(all->count, level);
    parian_far far;
    refit_job job = {.env = env, .far = &far, .coarse = level > 0};
    job.maker = level ? &all->maker[level - 1] : &all->vertices;
    job.baked = &baked->operators[index];
    job.op = &made->body.operators[index];
    size_t blocks = ((size_t)job.op->row_count + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK;
    levels_above(all, level, &made->body, &far);
    parian_result result = own_arrays(env, job.op);
    if (result == PARIAN_OK && !PARIAN_NEW0(env, job.block, blocks)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu blocks", blocks);
    }
    if (result == PARIAN_OK) {
        parian_par(env, blocks, refit_rows, &job);
        result = parian_cancelled(env) ? PARIAN_E_INTERRUPTED : (parian_result)job.result;
    }
    for (size_t b = 0; b < blocks && level == 0 && result == PARIAN_OK; b++) {
        for (int c = 0; c < 3; c++) {
            made->beyond_mean[c] += job.block[b].beyond[c] / job.op->row_count;
        }
        made->beyond_max = fmax(made->beyond_max, job.block[b].beyond_max);
    }
    parian_free(env, job.block);
    return result;
}

static parian_result copy_interpolation(const parian_env *env, const parian_operator *baked,
                                        parian_operator *op)
{
    parian_result result = own_arrays(env, op);
    if (result == PARIAN_OK) {
        memcpy(op->factor, baked->factor, baked->factor_total * sizeof *op->factor);
        memcpy(op->scale, baked->scale, baked->row_count * sizeof *op->scale);
    }
    return result;
}

/* Read the points back, and make what rows need. */
static parian_result prepare(const parian_env *env, const parian_body *baked,
                             const parian_body *body, levels *all)
{
    parian_result result = parian_factor_maker_make(env, body, &all->vertices);
    for (uint32_t l = 0; l < all->count && result == PARIAN_OK; l++) {
        const parian_operator *up = &baked->operators[factors_index(all->count, l + 1) + 1];
        const uint32_t *fine = l ? all->coarse[l - 1].vertex : NULL;
        result = parian_coarse_read(env, baked, fine, up, &all->coarse[l]);
        if (result == PARIAN_OK) {
            result =
                parian_coarse_maker_make(env, &all->coarse[l], &all->vertices,
                                         l ? &all->maker[l - 1] : &all->vertices, &all->maker[l]);
        }
    }
    return result;
}

parian_result parian_edited_levels_make(const parian_env *env, const parian_body *baked,
                                        parian_edited_body *made)
{
    levels all = {.count = (baked->operator_count - 1) / 3};
    if (!is_hierarchy(baked, all.count)) {
        return parian_fail(env, PARIAN_E_UNSUPPORTED,
                           "the medium of a body with %u operators that are no hierarchy cannot be "
                           "edited",
                           baked->operator_count);
    }
    parian_result result = prepare(env, baked, &made->body, &all);
    for (uint32_t l = all.count + 1; l-- > 0 && result == PARIAN_OK;) {
        result = refit_level(env, baked, &all, l, made);
    }
    for (uint32_t l = 1; l <= all.count && result == PARIAN_OK; l++) {
        uint32_t up = factors_index(all.count, l) + 1;
        result = copy_interpolation(env, &baked->operators[l], &made->body.operators[l]);
        if (result == PARIAN_OK) {
            result = copy_interpolation(env, &baked->operators[up], &made->body.operators[up]);
        }
    }
    for (uint32_t l = 0; l < all.count; l++) {
        parian_coarse_maker_free(env, &all.maker[l]);
        parian_coarse_free(env, &all.coarse[l]);
    }
    parian_factor_maker_free(env, &all.vertices);
    return result;
}
