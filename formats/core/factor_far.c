/* factor_far.c - what coarser points carry between finer ones, a row at a time.
 *
 * The receiver's weights go up through the levels; from the top on, a row of factors is gathered at
 * each level and handed down by the same interpolation.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/factor_far.h"

#include <string.h>

#include "core/half.h"
#include "core/memory.h"

parian_result parian_far_work_make(const parian_env *env, const parian_far *far,
                                   parian_far_work *work)
{
    memset(work, 0, sizeof *work);
    for (uint32_t l = 0; l < far->count; l++) {
        if (!PARIAN_NEW(env, work->row[l], far->coarse[l]->count)) {
            parian_far_work_free(env, work);
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for a row of %u coarse points",
                               far->coarse[l]->count);
        }
    }
    return PARIAN_OK;
}

void parian_far_work_free(const parian_env *env, parian_far_work *work)
{
    for (uint32_t l = 0; l < PARIAN_LEVELS_MAX; l++) {
        parian_free(env, work->row[l]);
    }
    memset(work, 0, sizeof *work);
}

static void add_source(parian_far_sources *sources, uint32_t point, float weight)
{
    uint32_t n = 0;
    while (n < sources->count && sources->point[n] != point) {
        n++;
    }
    if (n == sources->count) {
        sources->point[n] = point;
        sources->weight[n] = 0;
        sources->count++;
    }
    sources->weight[n] += weight;
}

/* Spread a finer point of some weight over the coarse points around it. */
static void climb(const parian_coarse *coarse, uint32_t point, float weight,
                  parian_far_sources *sources)
{
    for (int k = 0; k < 3; k++) {
        if (coarse->weight[point][k] > 0) {
            add_source(sources, coarse->near[point][k], weight * coarse->weight[point][k]);
        }
    }
}

/* row += weight times a row of factors. */
static void add_row(const parian_operator *op, uint32_t index, float weight, float (*row)[4])
{
    float gain[3];
    for (int c = 0; c < 3; c++) {
        gain[c] = weight * op->scale[index][c];
    }
    for (uint32_t r = op->run_offset[index]; r < op->run_offset[index + 1]; r++) {
        float factor[PARIAN_RUN_MAX][3], (*at)[4] = row + op->run_column[r];
        parian_half_to_float_array(op->factor[op->run_factor[r]], factor[0],
                                   3 * (size_t)op->run_count[r]);
        for (uint32_t k = 0; k < op->run_count[r]; k++) {
            for (int c = 0; c < 3; c++) {
                at[k][c] += gain[c] * factor[k][c];
            }
        }
    }
}

typedef float float4 __attribute__((vector_size(16)));

/* What a finer point receives by its weights from a row of coarse ones. */
static inline float4 gather(const parian_coarse *coarse, uint32_t u, const float (*row)[4])
{
    float4 sum = {0}, value;
    for (int k = 0; k < 3; k++) {
        memcpy(&value, row[coarse->near[u][k]], sizeof value);
        sum += value * coarse->weight[u][k];
    }
    return sum;
}

static void hand_down(const parian_coarse *coarse, const float (*row)[4], float (*finer)[4])
{
    for (uint32_t u = 0; u < coarse->fine_count; u++) {
        float4 sum = gather(coarse, u, row);
        memcpy(finer[u], &sum, sizeof sum);
    }
}

static void subtract(const parian_coarse *coarse, const float (*row)[4], float *const value[3])
{
    float *r = value[0], *g = value[1], *b = value[2];
    for (uint32_t u = 0; u < coarse->fine_count; u++) {
        float4 sum = gather(coarse, u, row);
        r[u] -= sum[0];
        g[u] -= sum[1];
        b[u] -= sum[2];
    }
}

void parian_far_subtract(const parian_far *far, uint32_t v, parian_far_work *work,
                         float *const value[3])
{
    uint32_t top = far->count - 1;
    for (uint32_t l = 0; l <= top; l++) {
        parian_far_sources *sources = &work->sources[l];
        sources->count = 0;
        if (l == 0) {
            climb(far->coarse[0], v, 1, sources);
        }
        for (uint32_t n = 0; l > 0 && n < work->sources[l - 1].count; n++) {
            climb(far->coarse[l], work->sources[l - 1].point[n], work->sources[l - 1].weight[n],
                  sources);
        }
    }
    memset(work->row[top], 0, far->coarse[top]->count * sizeof *work->row[top]);
    for (uint32_t l = top + 1; l-- > 0;) {
        const parian_far_sources *sources = &work->sources[l];
        for (uint32_t n = 0; n < sources->count; n++) {
            add_row(far->factors[l], sources->point[n], sources->weight[n], work->row[l]);
        }
        if (l > 0) {
            hand_down(far->coarse[l], (const float(*)[4])work->row[l], work->row[l - 1]);
        }
    }
    subtract(far->coarse[0], (const float(*)[4])work->row[0], value);
}
