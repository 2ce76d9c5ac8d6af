/* cpu_irradiance.c - E of texels, with shadows by rays.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_irradiance.h"

#include "core/fresnel.h"
#include "core/memory.h"
#include "lights/relief.h"
#include "vec3.h"

enum { TEXEL_PIECE = 1024 };

typedef struct irradiance_job {
    const parian_irradiance_desc *desc;
    float (*irradiance)[3];
} irradiance_job;

/* Where a ray of a texel starts, in the body's coordinates, when it does so some metres towards the
 * light. */
static void start_of_ray(const parian_irradiance_desc *desc, uint32_t t, const float to_light[3],
                         float metres, float own[3])
{
    const float *m = desc->at->model;
    vec3_copy(own, desc->origin[t]);
    for (int c = 0; c < 3; c++) {
        own[c] += metres * vec3_dot(&m[4 * c], to_light) / desc->at->scale;
    }
}

/* Is a light hidden from a texel? to_light: unit direction; cosine: of the lit normal with it. */
static bool is_hidden(const parian_irradiance_desc *desc, const parian_light_sample *sample,
                      uint32_t t, const float to_light[3], float cosine)
{
    float own[3], origin[3], direction[3], far = 1e30f;
    float relief = parian_relief_of_texel(desc->body, t);
    start_of_ray(desc, t, to_light, parian_relief_start(relief, cosine, desc->relief_reach), own);
    placement_point(desc->at, own, origin);
    vec3_copy(direction, to_light);
    if (sample->kind != PARIAN_SAMPLE_DIRECTIONAL && sample->kind != PARIAN_SAMPLE_PROBE) {
        vec3_sub(direction, sample->position, origin);
        far = 0.99999f;
    }
    return parian_cpu_occluded(&desc->casters, desc->own_first, desc->own_count, own, origin,
                               direction, far);
}

static void irradiance_of_texel(const parian_irradiance_desc *desc, uint32_t t, float sum[3])
{
    float extent = sqrtf(desc->body->texel_area[t]) * desc->at->scale;
    float p[3], n[3];
    placement_point(desc->at, desc->body->texel_position[t], p);
    placement_normal(desc->at, parian_body_lit_normal(desc->body, t), n);
    vec3_set(sum, 0.0f);
    for (uint32_t i = 0; i < desc->list->sample_count; i++) {
        const parian_light_sample *sample = &desc->sample[i];
        float to_light[3], light[3];
        parian_cpu_light_at(desc->list, sample, p, extent, to_light, light);
        float cosine = vec3_dot(n, to_light);
        if (cosine <= 0.0f || light[0] + light[1] + light[2] <= 0.0f) {
            continue;
        }
        if (!is_hidden(desc, sample, t, to_light, cosine)) {
            vec3_add_scaled(sum, light, cosine * parian_fresnel_transmittancef(cosine, desc->eta));
        }
    }
}

static void irradiance_piece(void *context, size_t piece)
{
    const irradiance_job *job = context;
    const parian_irradiance_desc *desc = job->desc;
    uint32_t first = (uint32_t)piece * TEXEL_PIECE;
    for (uint32_t t = first; t < first + TEXEL_PIECE && t < desc->body->texel_count; t++) {
        float sum[3], *to = job->irradiance[t];
        irradiance_of_texel(desc, t, sum);
        for (int c = 0; c < 3; c++) {
            to[c] =
                desc->share < 1.0f ? to[c] * (1.0f - desc->share) + sum[c] * desc->share : sum[c];
        }
    }
}

void parian_cpu_irradiance(const parian_env *env, const parian_irradiance_desc *desc,
                           float (*irradiance)[3])
{
    irradiance_job job = {desc, irradiance};
    parian_par(env, (desc->body->texel_count + TEXEL_PIECE - 1) / TEXEL_PIECE, irradiance_piece,
               &job);
}
