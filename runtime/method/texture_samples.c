/* texture_samples.c - the pyramid of flux, and samples from it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/texture_samples.h"

#include <string.h>

#include "core/memory.h"
#include "core/random.h"
#include "vec3.h"

enum { TEXEL_PIECE = 4096, ROW_PIECE = 32, SAMPLE_PIECE = 256 };

parian_result parian_flux_pyramid_create(const parian_env *env, const parian_body *body,
                                         parian_flux_pyramid *pyramid)
{
    size_t total = 0;
    *pyramid = (parian_flux_pyramid){.side = 1, .level_count = 1};
    while (pyramid->side < body->atlas_size) {
        pyramid->side *= 2;
        pyramid->level_count++;
    }
    for (uint32_t side = pyramid->side; side > 0; side /= 2) {
        total += (size_t)side * side;
    }
    if (!PARIAN_NEW0(env, pyramid->level[0], total)) {
        *pyramid = (parian_flux_pyramid){0};
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the flux of an atlas of %u x %u",
                           body->atlas_size, body->atlas_size);
    }
    for (uint32_t k = 1; k < pyramid->level_count; k++) {
        size_t side = pyramid->side >> (k - 1);
        pyramid->level[k] = pyramid->level[k - 1] + side * side;
    }
    return PARIAN_OK;
}

void parian_flux_pyramid_free(const parian_env *env, parian_flux_pyramid *pyramid)
{
    parian_free(env, pyramid->level[0]);
    *pyramid = (parian_flux_pyramid){0};
}

/* ---- sums ---- */

typedef struct build_job {
    const parian_body *body;
    const float (*irradiance)[3];
    const parian_flux_pyramid *pyramid;
    uint32_t level;
} build_job;

static void weigh_piece(void *context, size_t piece)
{
    const build_job *job = context;
    const parian_body *body = job->body;
    uint32_t first = (uint32_t)piece * TEXEL_PIECE;
    for (uint32_t t = first; t < first + TEXEL_PIECE && t < body->texel_count; t++) {
        const float *e = job->irradiance[t];
        uint32_t u = body->texel_index[t] % body->atlas_size;
        uint32_t v = body->texel_index[t] / body->atlas_size;
        job->pyramid->level[0][(size_t)v * job->pyramid->side + u] =
            body->texel_area[t] * ((e[0] + e[1] + e[2]) * (1.0f / 3.0f));
    }
}

static void sum_piece(void *context, size_t piece)
{
    const build_job *job = context;
    uint32_t side = job->pyramid->side >> job->level, first = (uint32_t)piece * ROW_PIECE;
    const float *fine = job->pyramid->level[job->level - 1];
    float *sum = job->pyramid->level[job->level];
    for (uint32_t v = first; v < first + ROW_PIECE && v < side; v++) {
        const float *low = fine + (size_t)2 * v * 2 * side, *high = low + (size_t)2 * side;
        for (uint32_t u = 0; u < side; u++) {
            sum[(size_t)v * side + u] =
                (low[2 * u] + low[2 * u + 1]) + (high[2 * u] + high[2 * u + 1]);
        }
    }
}

void parian_flux_pyramid_build(const parian_env *env, const parian_body *body,
                               const float (*irradiance)[3], parian_flux_pyramid *pyramid)
{
    build_job job = {body, irradiance, pyramid, 0};
    parian_par(env, (body->texel_count + TEXEL_PIECE - 1) / TEXEL_PIECE, weigh_piece, &job);
    for (job.level = 1; job.level < pyramid->level_count; job.level++) {
        parian_par(env, ((pyramid->side >> job.level) + ROW_PIECE - 1) / ROW_PIECE, sum_piece,
                   &job);
    }
}

/* ---- samples ---- */

void parian_texture_numbers(uint32_t seed, uint32_t count, float (*number)[3])
{
    for (uint32_t i = 0; i < count; i++) {
        parian_random random = parian_random_stream(0x7E8, seed, i, 0);
        double at = (i + parian_random_unit(&random)) / count;
        number[i][0] = fminf((float)at, 1.0f - 0x1p-24f);
        for (int k = 1; k < 3; k++) {
            number[i][k] = fminf((float)parian_random_unit(&random), 1.0f - 0x1p-24f);
        }
    }
}

/* The child that `rest` falls into, taking what lies before it off; the last with any flux where
 * rounding leads beyond. */
static uint32_t pick_child(const float *level, uint32_t side, uint32_t place, float *rest)
{
    const uint32_t children[4] = {place, place + 1, place + side, place + side + 1};
    uint32_t chosen = UINT32_MAX;
    float start = 0.0f, own = 0.0f;
    for (int k = 0; k < 4; k++) {
        float flux = level[children[k]];
        if (!(flux > 0.0f)) {
            continue;
        }
        chosen = children[k];
        start = *rest;
        own = flux;
        if (*rest < flux) {
            break;
        }
        *rest -= flux;
    }
    *rest = start < own ? start : own * (1.0f - 0x1p-23f);
    return chosen;
}

uint32_t parian_flux_pyramid_find(const parian_flux_pyramid *pyramid, float number)
{
    uint32_t u = 0, v = 0;
    float rest = number * pyramid->level[pyramid->level_count - 1][0];
    if (!(pyramid->level[pyramid->level_count - 1][0] > 0.0f)) {
        return UINT32_MAX;
    }
    for (uint32_t k = pyramid->level_count - 1; k-- > 0;) {
        uint32_t side = pyramid->side >> k;
        uint32_t child = pick_child(pyramid->level[k], side, 2 * v * side + 2 * u, &rest);
        if (child == UINT32_MAX) {
            return UINT32_MAX;
        }
        u = child % side;
        v = child / side;
    }
    return v * pyramid->side + u;
}

typedef struct draw_job {
    const parian_body *body;
    const parian_flux_pyramid *pyramid;
    const float (*irradiance)[3];
    const float (*number)[3];
    uint32_t count;
    parian_flux_sample *sample;
} draw_job;

/* Two directions of the tangent plane. Source  [Duff17] */
static void tangents(const float n[3], float t[3], float b[3])
{
    float sign = n[2] < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + n[2]), c = n[0] * n[1] * a;
    t[0] = 1.0f + sign * n[0] * n[0] * a;
    t[1] = sign * c;
    t[2] = -sign * n[0];
    b[0] = c;
    b[1] = sign + n[1] * n[1] * a;
    b[2] = -n[1];
}

static void draw_sample(const draw_job *job, uint32_t i)
{
    const parian_body *body = job->body;
    const float *number = job->number[i];
    const parian_flux_pyramid *pyramid = job->pyramid;
    parian_flux_sample *sample = &job->sample[i];
    uint32_t place = parian_flux_pyramid_find(pyramid, number[0]);
    *sample = (parian_flux_sample){{0}, {0}, {0}};
    if (place == UINT32_MAX) {
        return;
    }
    uint32_t u = place % pyramid->side, v = place / pyramid->side;
    uint32_t texel = body->texel_at[(size_t)v * body->atlas_size + u];
    float side = sqrtf(body->texel_area[texel]), t[3], b[3];
    vec3_copy(sample->normal, body->texel_normal[texel]);
    tangents(sample->normal, t, b);
    vec3_copy(sample->position, body->texel_position[texel]);
    vec3_add_scaled(sample->position, t, side * (number[1] - 0.5f));
    vec3_add_scaled(sample->position, b, side * (number[2] - 0.5f));
    float share = body->texel_area[texel] / pyramid->level[0][place] *
                  pyramid->level[pyramid->level_count - 1][0] / (float)job->count;
    vec3_add_scaled(sample->flux, job->irradiance[texel], share);
}

static void draw_piece(void *context, size_t piece)
{
    const draw_job *job = context;
    uint32_t first = (uint32_t)piece * SAMPLE_PIECE;
    for (uint32_t i = first; i < first + SAMPLE_PIECE && i < job->count; i++) {
        draw_sample(job, i);
    }
}

void parian_texture_samples_draw(const parian_env *env, const parian_body *body,
                                 const parian_flux_pyramid *pyramid, const float (*irradiance)[3],
                                 const float (*number)[3], uint32_t count,
                                 parian_flux_sample *sample)
{
    draw_job job = {body, pyramid, irradiance, number, count, sample};
    parian_par(env, (count + SAMPLE_PIECE - 1) / SAMPLE_PIECE, draw_piece, &job);
}
