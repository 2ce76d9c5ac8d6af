/* operator.c - application of sparse operators: an interleaved product of two streams.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/operator.h"

#include <string.h>

#include "core/clones.h"
#include "core/half.h"
#include "core/memory.h"

/* Eight columns of three channels at a time: three vectors of eight floats. */
enum { ROWS_PER_BLOCK = 64, LANES = 24, COLUMN_SUM_BLOCKS = 16 };

/* A finite half as a float: shift exponent and mantissa to their places, then mend the bias by an
 * exact product. The arithmetic shift leaves the sign in place. */
static inline float decode(parian_half half)
{
    int32_t bits = (int32_t)((uint32_t)(int32_t)(int16_t)half << 13 & 0x8fffffffu);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value * 0x1p112f;
}

typedef float float8 __attribute__((vector_size(32)));
typedef void (*decode_eight)(const parian_half *half, float8 *value);

static inline void decode_plain(const parian_half *half, float8 *value)
{
    for (int k = 0; k < 8; k++) {
        (*value)[k] = decode(half[k]);
    }
}

/* sum += decoded halves times values. */
static inline __attribute__((always_inline)) void
add_eight(decode_eight decoder, const parian_half *half, const float *value, float8 *sum)
{
    float8 factor, other;
    decoder(half, &factor);
    memcpy(&other, value, sizeof other);
    *sum += factor * other;
}

/* One row. Lane k of the first, second, third vector and of the tail belongs to channel k, k + 8, k
 * + 16, k modulo 3. Inlined into a function for each decoder. */
static inline __attribute__((always_inline)) void multiply_row(decode_eight decoder,
                                                               const parian_operator *op,
                                                               uint32_t row, const float (*x)[3],
                                                               float out[3])
{
    float8 first = {0}, second = {0}, third = {0};
    float lane[LANES] = {0}, tail[LANES] = {0};
    for (uint32_t r = op->run_offset[row]; r < op->run_offset[row + 1]; r++) {
        const parian_half *f = op->factor[op->run_factor[r]];
        const float *v = x[op->run_column[r]];
        uint32_t count = 3 * (uint32_t)op->run_count[r], i = 0, k = 0;
        for (; i + LANES <= count; i += LANES) {
            add_eight(decoder, f + i, v + i, &first);
            add_eight(decoder, f + i + 8, v + i + 8, &second);
            add_eight(decoder, f + i + 16, v + i + 16, &third);
        }
        if (count - i >= 8) {
            add_eight(decoder, f + i, v + i, &first);
            k = 8;
        }
        if (count - i >= 16) {
            add_eight(decoder, f + i + 8, v + i + 8, &second);
            k = 16;
        }
        for (; i + k < count; k++) {
            tail[k] += decode(f[i + k]) * v[i + k];
        }
    }
    memcpy(lane, &first, sizeof first);
    memcpy(lane + 8, &second, sizeof second);
    memcpy(lane + 16, &third, sizeof third);
    for (int c = 0; c < 3; c++) {
        float sum = 0;
        for (int k = c; k < LANES; k += 3) {
            sum += lane[k] + tail[k];
        }
        out[c] = sum * op->scale[row][c];
    }
}

static void row_product_plain(const parian_operator *op, uint32_t row, const float (*x)[3],
                              float out[3])
{
    multiply_row(decode_plain, op, row, x, out);
}

typedef void (*row_product)(const parian_operator *op, uint32_t row, const float (*x)[3],
                            float out[3]);

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>

__attribute__((target("avx2,f16c"))) static inline void decode_f16c(const parian_half *half,
                                                                    float8 *value)
{
    __m256 eight = _mm256_cvtph_ps(_mm_loadu_si128((const __m128i *)(const void *)half));
    memcpy(value, &eight, sizeof eight);
}

__attribute__((target("avx2,f16c"))) static void
row_product_f16c(const parian_operator *op, uint32_t row, const float (*x)[3], float out[3])
{
    multiply_row(decode_f16c, op, row, x, out);
}

static row_product choose_product(void)
{
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("f16c") ? row_product_f16c
                                                                            : row_product_plain;
}
#else
static row_product choose_product(void)
{
    return row_product_plain;
}
#endif

typedef struct apply_job {
    const parian_operator *op;
    const float (*x)[3];
    float (*y)[3];
    bool accumulate;
    row_product product;
} apply_job;

static void apply_block(void *context, size_t block)
{
    const apply_job *job = context;
    uint32_t first = (uint32_t)block * ROWS_PER_BLOCK, last = first + ROWS_PER_BLOCK;
    last = last < job->op->row_count ? last : job->op->row_count;
    for (uint32_t row = first; row < last; row++) {
        float out[3];
        job->product(job->op, row, job->x, out);
        for (int c = 0; c < 3; c++) {
            job->y[row][c] = job->accumulate ? job->y[row][c] + out[c] : out[c];
        }
    }
}

void parian_operator_apply(const parian_env *env, const parian_operator *op, const float (*x)[3],
                           float (*y)[3], bool accumulate)
{
    apply_job job = {.op = op, .x = x, .y = y, .accumulate = accumulate};
    job.product = choose_product();
    parian_par(env, (op->row_count + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK, apply_block, &job);
}

typedef struct column_job {
    const parian_operator *op;
    const double (*weight)[3]; /* [row_count] */
    double (*partial)[3];      /* [COLUMN_SUM_BLOCKS][column_count] */
} column_job;

PARIAN_CLONES
static void add_run(const parian_half *restrict factor, uint32_t count, const float gain[3],
                    double *restrict sum)
{
    double r = gain[0], g = gain[1], b = gain[2];
    for (uint32_t i = 0; i < count; i++) {
        sum[3 * i] += r * (double)decode(factor[3 * i]);
        sum[3 * i + 1] += g * (double)decode(factor[3 * i + 1]);
        sum[3 * i + 2] += b * (double)decode(factor[3 * i + 2]);
    }
}

static void column_block(void *context, size_t block)
{
    const column_job *job = context;
    const parian_operator *op = job->op;
    double(*partial)[3] = job->partial + block * op->column_count;
    uint32_t first = (uint32_t)((uint64_t)op->row_count * block / COLUMN_SUM_BLOCKS);
    uint32_t last = (uint32_t)((uint64_t)op->row_count * (block + 1) / COLUMN_SUM_BLOCKS);
    for (uint32_t row = first; row < last; row++) {
        float gain[3];
        for (int c = 0; c < 3; c++) {
            gain[c] = (float)job->weight[row][c] * op->scale[row][c];
        }
        for (uint32_t r = op->run_offset[row]; r < op->run_offset[row + 1]; r++) {
            add_run(op->factor[op->run_factor[r]], op->run_count[r], gain,
                    partial[op->run_column[r]]);
        }
    }
}

/* sum += op transposed times weight. */
static parian_result add_column_sums(const parian_env *env, const parian_operator *op,
                                     const double (*weight)[3], double (*sum)[3])
{
    column_job job = {.op = op, .weight = weight};
    if (!PARIAN_NEW0(env, job.partial, (size_t)op->column_count * COLUMN_SUM_BLOCKS)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u column sums", op->column_count);
    }
    parian_par(env, COLUMN_SUM_BLOCKS, column_block, &job);
    for (size_t i = 0; i < (size_t)op->column_count * 3; i++) {
        for (size_t b = 0; b < COLUMN_SUM_BLOCKS; b++) {
            sum[i / 3][i % 3] += job.partial[b * op->column_count + i / 3][i % 3];
        }
    }
    parian_free(env, job.partial);
    return PARIAN_OK;
}

/* ---- chains of operators ---- */

enum { REGISTER_COUNT = 2 * PARIAN_MAX_OPERATORS };

/* Zeroed registers for all that the operators name but those already given. */
static parian_result make_registers(const parian_env *env, const parian_operator *ops,
                                    uint32_t count, size_t element, void *given[REGISTER_COUNT],
                                    void *made[REGISTER_COUNT])
{
    for (uint32_t o = 0; o < 2 * count; o++) {
        const parian_operator *op = &ops[o / 2];
        uint32_t index = o % 2 ? op->target_register : op->source_register;
        uint32_t size = o % 2 ? op->row_count : op->column_count;
        if (index >= REGISTER_COUNT) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "register %u, at most 31 are possible",
                               index);
        }
        if (!given[index]) {
            made[index] = parian_zalloc(env, size, element);
            given[index] = made[index];
        }
        if (!given[index]) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for a register of %u numbers", size);
        }
    }
    return PARIAN_OK;
}

static void free_registers(const parian_env *env, void *made[REGISTER_COUNT])
{
    for (int r = 0; r < REGISTER_COUNT; r++) {
        parian_free(env, made[r]);
    }
}

parian_result parian_operators_apply(const parian_env *env, const parian_operator *ops,
                                     uint32_t count, const float (*flux)[3], float (*radiosity)[3])
{
    float *copy = NULL;
    void *at[REGISTER_COUNT] = {0}, *made[REGISTER_COUNT] = {0};
    uint32_t vertices = count ? ops[0].column_count : 0;
    if (!PARIAN_NEW(env, copy, (size_t)vertices * 3)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the flux at %u vertices", vertices);
    }
    memcpy(copy, flux, (size_t)vertices * sizeof *flux);
    at[0] = made[0] = copy;
    at[1] = radiosity;
    parian_result result = make_registers(env, ops, count, sizeof *flux, at, made);
    for (uint32_t o = 0; o < count && result == PARIAN_OK; o++) {
        parian_operator_apply(env, &ops[o], (const float(*)[3])at[ops[o].source_register],
                              (float(*)[3])at[ops[o].target_register], true);
    }
    free_registers(env, made);
    return result;
}

parian_result parian_operators_column_sums(const parian_env *env, const parian_operator *ops,
                                           uint32_t count, const float *weight, double (*sum)[3])
{
    void *at[REGISTER_COUNT] = {0}, *made[REGISTER_COUNT] = {0};
    uint32_t vertices = count ? ops[0].column_count : 0;
    memset(sum, 0, (size_t)vertices * sizeof *sum);
    at[0] = sum;
    parian_result result = make_registers(env, ops, count, sizeof *sum, at, made);
    for (uint32_t v = 0; v < vertices && result == PARIAN_OK; v++) {
        for (int c = 0; c < 3; c++) {
            ((double(*)[3])at[1])[v][c] = weight[v];
        }
    }
    for (uint32_t o = count; o > 0 && result == PARIAN_OK; o--) {
        result =
            add_column_sums(env, &ops[o - 1], (const double(*)[3])at[ops[o - 1].target_register],
                            (double(*)[3])at[ops[o - 1].source_register]);
    }
    free_registers(env, made);
    return result;
}
