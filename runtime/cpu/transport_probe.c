/* transport_probe.c - how far B of a body is from the direct integral of its R_d, at some
 * receivers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/transport_probe.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/memory.h"
#include "core/operator.h"
#include "core/texel_response.h"
#include "cpu/cpu_transfer.h"
#include "method/restriction.h"
#include "renderer_internal.h"

enum {
    RECEIVERS = 256,
    RECEIVERS_PER_BLOCK = 4,
    SQUARES = 8,
    REGISTER_MAX = 2 * PARIAN_MAX_OPERATORS
};

/* Texels nearer than this many of their sides are averaged over, as the kernels are. */
static const float NEAR_SIDES = 20;

typedef struct probe_job {
    const parian_env *env;
    const parian_body *body;
    const parian_kernels *kernels;
    parian_transport_model model;
    parian_texel_response response;
    parian_point_arrays points;
    float (*e[PARIAN_PROBE_COUNT])[3]; /* [texel_count], equal in all channels */
    float (*b[PARIAN_PROBE_COUNT])[3]; /* [texel_count] as the body's parts make it */
    uint32_t step, receivers;
    double (
        *sum)[PARIAN_PROBE_COUNT][4][3]; /* [receivers] error^2, truth^2, B, truth, times area */
    atomic_int result;
} probe_job;

/* ---- B by the body's parts ---- */

static void illuminate(const parian_body *body, float (*const e[PARIAN_PROBE_COUNT])[3])
{
    float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < body->texel_count; i++) {
        for (int k = 0; k < 2; k++) {
            low[k] = fminf(low[k], body->texel_position[i][k]);
            high[k] = fmaxf(high[k], body->texel_position[i][k]);
        }
    }
    float extent = fmaxf(fmaxf(high[0] - low[0], high[1] - low[1]), 1e-12f);
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *p = body->texel_position[i], *n = body->texel_normal[i];
        float slant = fmaxf(0, 0.36f * n[0] + 0.48f * n[1] + 0.8f * n[2]);
        int square =
            (int)(SQUARES * (p[0] - low[0]) / extent) + (int)(SQUARES * (p[1] - low[1]) / extent);
        for (int c = 0; c < 3; c++) {
            e[PARIAN_PROBE_SMOOTH][i][c] = slant;
            e[PARIAN_PROBE_HARD][i][c] = square & 1 ? fmaxf(0, n[2]) : 0;
        }
    }
}

static parian_result apply_parts(const probe_job *job, const parian_restriction *restriction,
                                 int light, float (*const registers[REGISTER_MAX])[3])
{
    const parian_body *body = job->body;
    float(*global)[3];
    if (!PARIAN_NEW(job->env, global, body->texel_count)) {
        return parian_fail(job->env, PARIAN_E_NOMEM, "no memory to probe %u texels",
                           body->texel_count);
    }
    for (uint32_t r = 2; r < parian_body_register_count(body); r++) {
        memset(registers[r], 0, parian_body_register_size(body, r) * sizeof *registers[r]);
    }
    parian_cpu_restrict(job->env, restriction, (const float(*)[3])job->e[light], registers[0],
                        registers[1]);
    for (uint32_t o = 0; o < body->operator_count; o++) {
        const parian_operator *op = &body->operators[o];
        parian_operator_apply(job->env, op, (const float(*)[3])registers[op->source_register],
                              registers[op->target_register], true);
    }
    parian_cpu_filter(job->env, body, job->kernels, (const float(*)[3])job->e[light],
                      (const float(*)[3])registers[1], job->b[light], global);
    for (size_t k = 0; k < (size_t)body->texel_count * 3; k++) {
        job->b[light][k / 3][k % 3] += global[k / 3][k % 3];
    }
    parian_free(job->env, global);
    return PARIAN_OK;
}

static parian_result evaluate(const probe_job *job)
{
    parian_restriction restriction = {0};
    float(*registers[REGISTER_MAX])[3] = {0};
    uint32_t count = parian_body_register_count(job->body);
    parian_result result = parian_restriction_build(job->env, job->body, &restriction);
    for (uint32_t r = 0; r < count && result == PARIAN_OK; r++) {
        uint32_t size = parian_body_register_size(job->body, r);
        if (!PARIAN_NEW(job->env, registers[r], size)) {
            result = parian_fail(job->env, PARIAN_E_NOMEM, "no memory to probe %u vertices", size);
        }
    }
    for (int light = 0; light < PARIAN_PROBE_COUNT && result == PARIAN_OK; light++) {
        result = apply_parts(job, &restriction, light, registers);
    }
    for (uint32_t r = 0; r < count; r++) {
        parian_free(job->env, registers[r]);
    }
    parian_restriction_free(job->env, &restriction);
    return result;
}

/* ---- the direct integral ---- */

static void integrate(const probe_job *job, uint32_t o, float *r2, float *const value[3],
                      double truth[PARIAN_PROBE_COUNT][3])
{
    const parian_body *body = job->body;
    parian_transport_model_row(&job->model, body->texel_position[o], body->texel_normal[o], false,
                               &job->points, r2, value);
    memset(truth, 0, sizeof(double[PARIAN_PROBE_COUNT][3]));
    for (uint32_t i = 0; i < body->texel_count; i++) {
        float area = body->texel_area[i], rd[3] = {value[0][i], value[1][i], value[2][i]};
        double e[PARIAN_PROBE_COUNT] = {job->e[0][i][0], job->e[1][i][0]};
        if (e[0] == 0 && e[1] == 0) {
            continue;
        }
        if (r2[i] < NEAR_SIDES * NEAR_SIDES * area) {
            parian_texel_response_eval(&job->response, i, o, rd);
        }
        for (int k = 0; k < 6; k++) {
            truth[k / 3][k % 3] += e[k / 3] * area * rd[k % 3];
        }
    }
}

static void probe_receivers(void *context, size_t block)
{
    probe_job *job = context;
    uint32_t last = ((uint32_t)block + 1) * RECEIVERS_PER_BLOCK;
    size_t padded = job->points.padded;
    float *buffer = NULL;
    if (!PARIAN_NEW(job->env, buffer, padded * 4)) {
        job->result =
            (int)parian_fail(job->env, PARIAN_E_NOMEM, "no memory for %zu responses", padded);
        return;
    }
    float *const value[3] = {buffer + padded, buffer + 2 * padded, buffer + 3 * padded};
    for (uint32_t k = (uint32_t)block * RECEIVERS_PER_BLOCK; k < last && k < job->receivers; k++) {
        double truth[PARIAN_PROBE_COUNT][3];
        uint32_t o = k * job->step;
        integrate(job, o, buffer, value, truth);
        for (int j = 0; j < PARIAN_PROBE_COUNT * 3; j++) {
            int light = j / 3, c = j % 3;
            double area = job->body->texel_area[o], got = job->b[light][o][c],
                   want = truth[light][c];
            job->sum[k][light][0][c] = area * (got - want) * (got - want);
            job->sum[k][light][1][c] = area * want * want;
            job->sum[k][light][2][c] = area * got;
            job->sum[k][light][3][c] = area * want;
        }
    }
    parian_free(job->env, buffer);
}

static void add_up(const probe_job *job, parian_probe_error *error)
{
    for (int j = 0; j < PARIAN_PROBE_COUNT * 3; j++) {
        int light = j / 3, c = j % 3;
        double sum[4] = {0};
        for (size_t k = 0; k < (size_t)job->receivers * 4; k++) {
            sum[k % 4] += job->sum[k / 4][light][k % 4][c];
        }
        error->l2[light][c] = sum[1] > 0 ? sqrt(sum[0] / sum[1]) : 0;
        error->energy[light][c] = sum[3] > 0 ? sum[2] / sum[3] : 1;
    }
}

static parian_result allocate(probe_job *job)
{
    uint32_t texels = job->body->texel_count;
    job->step = texels > RECEIVERS ? texels / RECEIVERS : 1;
    job->receivers = texels ? (texels - 1) / job->step + 1 : 0;
    bool enough = PARIAN_NEW(job->env, job->sum, job->receivers);
    for (int light = 0; light < PARIAN_PROBE_COUNT; light++) {
        enough = enough && PARIAN_NEW(job->env, job->e[light], texels) &&
                 PARIAN_NEW(job->env, job->b[light], texels);
    }
    return enough ? PARIAN_OK
                  : parian_fail(job->env, PARIAN_E_NOMEM, "no memory to probe %u texels", texels);
}

parian_result parian_transport_probe(const parian_env *env, const parian_body *body,
                                     const parian_kernels *kernels, parian_probe_error *error)
{
    probe_job job = {.env = env, .body = body, .kernels = kernels};
    parian_result result = allocate(&job);
    if (result == PARIAN_OK) {
        illuminate(body, job.e);
        result = evaluate(&job);
    }
    if (result == PARIAN_OK) {
        result = parian_point_arrays_make(env, body->texel_position, body->texel_normal,
                                          body->texel_count, &job.points);
    }
    if (result == PARIAN_OK) {
        result = parian_transport_model_make(env, body, PARIAN_MODEL_FULL, &job.model);
    }
    if (result == PARIAN_OK) {
        parian_texel_response_init(body, &job.model, &job.response);
        parian_par(env, (job.receivers + RECEIVERS_PER_BLOCK - 1) / RECEIVERS_PER_BLOCK,
                   probe_receivers, &job);
        result = (parian_result)job.result;
    }
    if (result == PARIAN_OK) {
        add_up(&job, error);
    }
    for (int light = 0; light < PARIAN_PROBE_COUNT; light++) {
        parian_free(env, job.e[light]);
        parian_free(env, job.b[light]);
    }
    parian_free(env, job.sum);
    parian_point_arrays_free(env, &job.points);
    parian_transport_model_free(env, &job.model);
    return result;
}
