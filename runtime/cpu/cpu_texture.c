/* cpu_texture.c - B of texels from samples of the flux that enters: the C evaluation.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_texture.h"

#include <stdatomic.h>
#include <string.h>

#include "core/clones.h"
#include "core/memory.h"
#include "vec3.h"

enum { TEXEL_PIECE = 64, LANES = 16 };

typedef struct gather_job {
    const parian_env *env;
    const parian_body *body;
    const parian_transport_model *model;
    parian_point_arrays points;
    float *flux[3]; /* [padded], zero behind the last sample */
    float (*radiosity)[3];
    atomic_bool failed;
} gather_job;

/* Sixteen sums side by side, added in order. */
PARIAN_CLONES
static float dot(const float *restrict a, const float *restrict b, uint32_t padded)
{
    float lane[LANES] = {0}, sum = 0.0f;
    for (uint32_t i = 0; i < padded; i += LANES) {
        for (uint32_t k = 0; k < LANES; k++) {
            lane[k] += a[i + k] * b[i + k];
        }
    }
    for (uint32_t k = 0; k < LANES; k++) {
        sum += lane[k];
    }
    return sum;
}

static void gather_piece(void *context, size_t piece)
{
    gather_job *job = context;
    const parian_body *body = job->body;
    uint32_t padded = job->points.padded, first = (uint32_t)piece * TEXEL_PIECE;
    float *room = parian_alloc(job->env, 4 * (size_t)padded, sizeof *room);
    if (!room) {
        atomic_store(&job->failed, true);
        return;
    }
    float *const value[3] = {room + padded, room + 2 * (size_t)padded, room + 3 * (size_t)padded};
    for (uint32_t t = first; t < first + TEXEL_PIECE && t < body->texel_count; t++) {
        parian_transport_model_row(job->model, body->texel_position[t], body->texel_normal[t],
                                   false, &job->points, room, value);
        for (int c = 0; c < 3; c++) {
            job->radiosity[t][c] = dot(value[c], job->flux[c], padded);
        }
    }
    parian_free(job->env, room);
}

/* Samples with their coordinates and channels apart. */
static parian_result take_apart(const parian_env *env, const parian_flux_sample *sample,
                                uint32_t count, gather_job *job)
{
    float(*place)[3];
    if (!PARIAN_NEW(env, place, 2 * (size_t)count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", count);
    }
    float(*position)[3] = place, (*normal)[3] = place + count;
    for (uint32_t i = 0; i < count; i++) {
        vec3_copy(position[i], sample[i].position);
        vec3_copy(normal[i], sample[i].normal);
    }
    parian_result r = parian_point_arrays_make(env, (const float(*)[3])position,
                                               (const float(*)[3])normal, count, &job->points);
    parian_free(env, place);
    for (int c = 0; c < 3 && r == PARIAN_OK; c++) {
        if (!PARIAN_NEW0(env, job->flux[c], job->points.padded)) {
            r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", count);
        }
        for (uint32_t i = 0; i < count && r == PARIAN_OK; i++) {
            job->flux[c][i] = sample[i].flux[c];
        }
    }
    return r;
}

parian_result parian_cpu_texture_gather(const parian_env *env, const parian_body *body,
                                        const parian_transport_model *model,
                                        const parian_flux_sample *sample, uint32_t count,
                                        float (*radiosity)[3])
{
    gather_job job = {.env = env, .body = body, .model = model, .radiosity = radiosity};
    if (count == 0) {
        memset(radiosity, 0, body->texel_count * sizeof *radiosity);
        return PARIAN_OK;
    }
    parian_result r = take_apart(env, sample, count, &job);
    if (r == PARIAN_OK) {
        parian_par(env, (body->texel_count + TEXEL_PIECE - 1) / TEXEL_PIECE, gather_piece, &job);
        r = atomic_load(&job.failed)
                ? parian_fail(env, PARIAN_E_NOMEM, "no memory for %u samples", count)
                : r;
    }
    parian_point_arrays_free(env, &job.points);
    for (int c = 0; c < 3; c++) {
        parian_free(env, job.flux[c]);
    }
    return r;
}
