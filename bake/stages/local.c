/* local.c - stores the local kernels, for the forms that store them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/transport.h"
#include "core/half.h"
#include "core/kernel.h"
#include "core/memory.h"

enum { TEXELS_PER_BLOCK = 4096 };

typedef struct code_job {
    parian_body *body;
    const parian_kernels *kernels;
} code_job;

/* One kernel as signed bytes. The rounding error of a tap goes to the next, so that the sum stays.
 */
static void code_bytes(const parian_half (*value)[3], size_t count, const float channel_scale[3],
                       float scale[3], int8_t (*bytes)[3])
{
    for (int c = 0; c < 3; c++) {
        float most = 0, carry = 0;
        for (size_t k = 0; k < count; k++) {
            most = fmaxf(most, fabsf(parian_half_to_float(value[k][c])));
        }
        scale[c] = most * channel_scale[c];
        for (size_t k = 0; k < count; k++) {
            float want = most > 0 ? parian_half_to_float(value[k][c]) / most * 127 + carry : 0;
            float rounded = fminf(fmaxf(rintf(want), -127), 127);
            carry = want - rounded;
            bytes[k][c] = (int8_t)rounded;
        }
    }
}

static void code_block(void *context, size_t block)
{
    const code_job *job = context;
    parian_body *body = job->body;
    size_t taps = (size_t)body->kernel_width * body->kernel_width, interior = 0;
    uint32_t first = (uint32_t)block * TEXELS_PER_BLOCK, last = first + TEXELS_PER_BLOCK;
    for (uint32_t i = 0; i < first; i++) {
        interior += body->texel_border[i] == PARIAN_NO_BORDER;
    }
    for (uint32_t i = first; i < last && i < body->texel_count; i++) {
        uint32_t border = body->texel_border[i];
        if (border == PARIAN_NO_BORDER) {
            code_bytes((const parian_half(*)[3])job->kernels->interior + interior * taps, taps,
                       job->kernels->channel_scale, body->kernel_scale[i],
                       body->kernel_s8 + interior * taps);
            interior++;
        } else {
            uint32_t begin = body->border_offset[border];
            code_bytes((const parian_half(*)[3])job->kernels->border + begin,
                       body->border_offset[border + 1] - begin, job->kernels->channel_scale,
                       body->kernel_scale[i], body->border_s8 + begin);
        }
    }
}

static parian_result store_bytes(const parian_env *env, parian_body *body,
                                 const parian_kernels *kernels)
{
    code_job job = {body, kernels};
    if (!PARIAN_NEW(env, body->kernel_s8, kernels->interior_total) ||
        !PARIAN_NEW(env, body->border_s8, kernels->border_total) ||
        !PARIAN_NEW(env, body->kernel_scale, body->texel_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the kernels of %u texels",
                           body->texel_count);
    }
    parian_par(env, (body->texel_count + TEXELS_PER_BLOCK - 1) / TEXELS_PER_BLOCK, code_block,
               &job);
    return PARIAN_OK;
}

parian_result parian_stage_local(const parian_env *env, parian_body *body)
{
    parian_kernels kernels;
    if (body->local_form != PARIAN_LOCAL_F16 && body->local_form != PARIAN_LOCAL_U8) {
        return PARIAN_OK;
    }
    parian_free(env, body->kernel_f16);
    parian_free(env, body->border_f16);
    parian_free(env, body->kernel_s8);
    parian_free(env, body->border_s8);
    parian_free(env, body->kernel_scale);
    body->kernel_f16 = body->border_f16 = NULL;
    body->kernel_s8 = body->border_s8 = NULL;
    body->kernel_scale = NULL;
    parian_result result = parian_kernels_build(env, body, &kernels);
    if (result != PARIAN_OK) {
        return result;
    }
    if (body->local_form == PARIAN_LOCAL_F16) {
        memcpy(body->kernel_channel_scale, kernels.channel_scale, sizeof kernels.channel_scale);
        body->kernel_f16 = kernels.interior;
        body->border_f16 = kernels.border;
        return PARIAN_OK;
    }
    result = store_bytes(env, body, &kernels);
    parian_kernels_free(env, &kernels);
    return result;
}
