/* kernel.c - the local kernels of a body: decoded, or computed from what the body holds.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/kernel.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "core/near_factors.h"
#include "core/texel_response.h"

enum { TRIANGLES_PER_BLOCK = 128, TEXELS_PER_BLOCK = 4096, SCALED_EXPONENT = 14 };

typedef struct kernel_job {
    const parian_env *env;
    const parian_body *body;
    parian_kernels *kernels;
    parian_transport_model model;
    parian_texel_response response;
    parian_texel_lists lists;
    uint32_t *interior_rank; /* [texel_count] ordinal among interior texels */
    bool residual;           /* subtract what the global part and the blend carry */
    float inverse_scale[3];
    atomic_int result;
} kernel_job;

/* The taps of receiver o in the order of its kernel; 0xFFFFFFFF where the atlas has no texel. */
typedef struct tap_list {
    const uint32_t *tap;
    uint32_t count;
    parian_half (*out)[3];
} tap_list;

static tap_list taps_of(const kernel_job *job, uint32_t o, uint32_t *window)
{
    const parian_body *body = job->body;
    uint32_t border = body->texel_border[o], width = body->kernel_width;
    if (border != PARIAN_NO_BORDER) {
        uint32_t begin = body->border_offset[border];
        return (tap_list){body->border_neighbour + begin, body->border_offset[border + 1] - begin,
                          job->kernels->border + begin};
    }
    int32_t half = (int32_t)width / 2, size = (int32_t)body->atlas_size;
    int32_t u = (int32_t)(body->texel_index[o] % body->atlas_size);
    int32_t v = (int32_t)(body->texel_index[o] / body->atlas_size);
    uint32_t count = 0;
    for (int32_t dv = -half; dv <= half; dv++) {
        for (int32_t du = -half; du <= half; du++) {
            bool inside = u + du >= 0 && u + du < size && v + dv >= 0 && v + dv < size;
            window[count++] = inside ? body->texel_at[(v + dv) * size + u + du] : PARIAN_NO_BORDER;
        }
    }
    return (tap_list){window, count,
                      job->kernels->interior + (size_t)job->interior_rank[o] * width * width};
}

/* Take off what the global part and the blend of texel i carry to receiver o. */
static void subtract_carried(const kernel_job *job, const parian_patch *patch, uint32_t i,
                             const float beta_o[3], float kernel[3])
{
    const parian_body *body = job->body;
    const uint32_t *source = body->triangle[body->texel_triangle[i]];
    const uint32_t *here = body->triangle[patch->triangle];
    float entry[3], carried[3];
    parian_texel_entry(body, i, entry);
    parian_patch_response(patch, i, entry, carried);
    for (int c = 0; c < 3; c++) {
        kernel[c] -= body->texel_area[i] * carried[c];
    }
    for (int j = 0; j < 3 && body->blend_weight; j++) {
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3 && source[j] == here[k]; c++) {
                kernel[c] -= beta_o[k] * parian_half_to_float(body->blend_weight[i][j][c]);
            }
        }
    }
}

static void compute_kernel(const kernel_job *job, parian_patch *patch, uint32_t o, tap_list taps)
{
    float beta[3];
    parian_texel_hats(job->body, o, beta);
    if (job->residual) {
        parian_patch_mix(patch, beta);
    }
    for (uint32_t t = 0; t < taps.count; t++) {
        uint32_t i = taps.tap[t];
        float kernel[3] = {0, 0, 0};
        if (i != PARIAN_NO_BORDER) {
            parian_texel_response_eval(&job->response, i, o, kernel);
            for (int c = 0; c < 3; c++) {
                kernel[c] *= job->body->texel_area[i];
            }
            if (job->residual) {
                subtract_carried(job, patch, i, beta, kernel);
            }
        }
        for (int c = 0; c < 3; c++) {
            taps.out[t][c] = parian_half_from_float(kernel[c] * job->inverse_scale[c]);
        }
    }
}

static parian_result compute_triangle(const kernel_job *job, parian_patch *patch, uint32_t triangle,
                                      uint32_t *window)
{
    const uint32_t *offset = job->lists.offset + triangle;
    parian_patch_begin(patch, triangle);
    for (uint32_t k = offset[0]; job->residual && k < offset[1]; k++) {
        tap_list taps = taps_of(job, job->lists.texel[k], window);
        for (uint32_t t = 0; t < taps.count; t++) {
            parian_result result =
                taps.tap[t] == PARIAN_NO_BORDER ? PARIAN_OK : parian_patch_add(patch, taps.tap[t]);
            if (result != PARIAN_OK) {
                return result;
            }
        }
    }
    if (job->residual) {
        parian_patch_gather(patch, true);
    }
    for (uint32_t k = offset[0]; k < offset[1]; k++) {
        uint32_t o = job->lists.texel[k];
        compute_kernel(job, patch, o, taps_of(job, o, window));
    }
    return PARIAN_OK;
}

static void compute_block(void *context, size_t block)
{
    kernel_job *job = context;
    uint32_t width = job->body->kernel_width, *window = NULL;
    uint32_t first = (uint32_t)block * TRIANGLES_PER_BLOCK, last = first + TRIANGLES_PER_BLOCK;
    parian_patch patch;
    parian_result result = parian_patch_make(job->env, job->body, &patch);
    if (result == PARIAN_OK && !PARIAN_NEW(job->env, window, (size_t)width * width)) {
        result =
            parian_fail(job->env, PARIAN_E_NOMEM, "no memory for a window of %u texels", width);
    }
    last = last < job->body->triangle_count ? last : job->body->triangle_count;
    for (uint32_t t = first; t < last && result == PARIAN_OK; t++) {
        if (job->lists.offset[t] < job->lists.offset[t + 1]) {
            result = compute_triangle(job, &patch, t, window);
        }
    }
    parian_free(job->env, window);
    parian_patch_free(&patch);
    if (result != PARIAN_OK) {
        job->result = (int)result;
    }
}

/* A bound of every kernel value: what enters, and what may be taken off. */
static void choose_scales(kernel_job *job)
{
    const parian_body *body = job->body;
    double area = 0, most_area_response[3] = {0}, weight[3] = {0}, factor[3] = {0};
    for (uint32_t i = 0; i < body->texel_count; i++) {
        area = fmax(area, body->texel_area[i]);
        for (int k = 0; k < 9 && body->blend_weight; k++) {
            double w = fabs((double)parian_half_to_float(body->blend_weight[i][k / 3][k % 3]));
            weight[k % 3] = fmax(weight[k % 3], w);
        }
    }
    for (uint32_t row = 0; job->residual && row < body->operators[0].row_count; row++) {
        for (int c = 0; c < 3; c++) {
            factor[c] = fmax(factor[c], ldexp(body->operators[0].scale[row][c], 14));
        }
    }
    for (int c = 0; c < 3; c++) {
        double peak = area * parian_dipole_rd(&job->model.dipole[c], 0);
        most_area_response[c] = body->paper_form ? peak : fmin(peak, job->model.dipole[c].albedo);
        double bound = most_area_response[c] + 3 * area * factor[c] + 3 * weight[c];
        int exponent = 0;
        if (bound > 0) {
            frexp(bound, &exponent);
        }
        job->kernels->channel_scale[c] = ldexpf(1, exponent - SCALED_EXPONENT);
        job->inverse_scale[c] = ldexpf(1, SCALED_EXPONENT - exponent);
    }
}

static parian_result rank_interior(kernel_job *job)
{
    const parian_body *body = job->body;
    uint32_t rank = 0;
    if (!PARIAN_NEW(job->env, job->interior_rank, body->texel_count)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %u texels", body->texel_count);
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        job->interior_rank[i] = rank;
        rank += body->texel_border[i] == PARIAN_NO_BORDER;
    }
    return PARIAN_OK;
}

static parian_result compute_kernels(const parian_env *env, const parian_body *body,
                                     parian_kernels *kernels)
{
    kernel_job job = {.env = env, .body = body, .kernels = kernels};
    bool split = body->local_form == PARIAN_LOCAL_SPLIT;
    job.residual = !split && body->local_form != PARIAN_LOCAL_ONLY && body->operator_count > 0;
    parian_result result = parian_transport_model_make(
        env, body, split ? PARIAN_MODEL_NEAR : PARIAN_MODEL_FULL, &job.model);
    if (result == PARIAN_OK) {
        result = parian_texel_lists_make(env, body, &job.lists);
    }
    if (result == PARIAN_OK) {
        result = rank_interior(&job);
    }
    if (result == PARIAN_OK) {
        parian_texel_response_init(body, &job.model, &job.response);
        choose_scales(&job);
        parian_par(env, (body->triangle_count + TRIANGLES_PER_BLOCK - 1) / TRIANGLES_PER_BLOCK,
                   compute_block, &job);
        result = (parian_result)job.result;
    }
    parian_transport_model_free(env, &job.model);
    parian_texel_lists_free(env, &job.lists);
    parian_free(env, job.interior_rank);
    return result;
}

typedef struct decode_job {
    const parian_body *body;
    parian_kernels *kernels;
} decode_job;

static void decode_values(const int8_t (*bytes)[3], size_t count, const float scale[3],
                          const float inverse[3], parian_half (*out)[3])
{
    for (size_t k = 0; k < count; k++) {
        for (int c = 0; c < 3; c++) {
            float value = (float)bytes[k][c] * scale[c] * (1.0f / 127);
            out[k][c] = parian_half_from_float(value * inverse[c]);
        }
    }
}

static void decode_block(void *context, size_t block)
{
    const decode_job *job = context;
    const parian_body *body = job->body;
    uint32_t first = (uint32_t)block * TEXELS_PER_BLOCK, last = first + TEXELS_PER_BLOCK,
             interior = 0;
    size_t taps = (size_t)body->kernel_width * body->kernel_width;
    float inverse[3];
    for (int c = 0; c < 3; c++) {
        inverse[c] = 1 / job->kernels->channel_scale[c];
    }
    for (uint32_t i = 0; i < first; i++) {
        interior += body->texel_border[i] == PARIAN_NO_BORDER;
    }
    for (uint32_t i = first; i < last && i < body->texel_count; i++) {
        uint32_t border = body->texel_border[i];
        if (border == PARIAN_NO_BORDER) {
            decode_values((const int8_t(*)[3])body->kernel_s8 + interior * taps, taps,
                          body->kernel_scale[i], inverse, job->kernels->interior + interior * taps);
            interior++;
        } else {
            uint32_t begin = body->border_offset[border];
            decode_values((const int8_t(*)[3])body->border_s8 + begin,
                          body->border_offset[border + 1] - begin, body->kernel_scale[i], inverse,
                          job->kernels->border + begin);
        }
    }
}

static void decode_s8(const parian_env *env, const parian_body *body, parian_kernels *kernels)
{
    decode_job job = {body, kernels};
    for (int c = 0; c < 3; c++) {
        float most = 0;
        for (uint32_t i = 0; i < body->texel_count; i++) {
            most = fmaxf(most, body->kernel_scale[i][c]);
        }
        int exponent = 0;
        if (most > 0) {
            frexpf(most, &exponent);
        }
        kernels->channel_scale[c] = ldexpf(1, exponent - SCALED_EXPONENT);
    }
    parian_par(env, (body->texel_count + TEXELS_PER_BLOCK - 1) / TEXELS_PER_BLOCK, decode_block,
               &job);
}

static void copy_f16(const parian_body *body, parian_kernels *kernels)
{
    memcpy(kernels->channel_scale, body->kernel_channel_scale, sizeof kernels->channel_scale);
    memcpy(kernels->interior, body->kernel_f16,
           kernels->interior_total * sizeof *kernels->interior);
    memcpy(kernels->border, body->border_f16, kernels->border_total * sizeof *kernels->border);
}

parian_result parian_kernels_build(const parian_env *env, const parian_body *body,
                                   parian_kernels *kernels)
{
    parian_kernels made = {.channel_scale = {1, 1, 1}};
    parian_result result = PARIAN_OK;
    if (body->local_form != PARIAN_LOCAL_NONE) {
        made.interior_total = (uint64_t)(body->texel_count - body->border_count) *
                              body->kernel_width * body->kernel_width;
        made.border_total = body->border_count ? body->border_offset[body->border_count] : 0;
    }
    if (!body->texel_at || !body->texel_border || !body->texel_position) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "kernels of a body whose arrays are not derived");
    }
    if (!PARIAN_NEW(env, made.interior, made.interior_total) ||
        !PARIAN_NEW(env, made.border, made.border_total)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu kernel values",
                             (unsigned long long)(made.interior_total + made.border_total));
    } else if (body->local_form == PARIAN_LOCAL_F16 && body->kernel_f16) {
        copy_f16(body, &made);
    } else if (body->local_form == PARIAN_LOCAL_U8 && body->kernel_s8) {
        decode_s8(env, body, &made);
    } else if (body->local_form != PARIAN_LOCAL_NONE) {
        result = compute_kernels(env, body, &made);
    }
    if (result != PARIAN_OK) {
        parian_kernels_free(env, &made);
        return result;
    }
    *kernels = made;
    return PARIAN_OK;
}

void parian_kernels_free(const parian_env *env, parian_kernels *kernels)
{
    parian_free(env, kernels->interior);
    parian_free(env, kernels->border);
    memset(kernels, 0, sizeof *kernels);
}
