/* texture_samples.h - samples of the flux that enters a body, drawn in proportion to it from its
 * atlas.
 *
 * The pyramid's finest level holds the flux of each texel (its area times the mean of E over the
 * channels), each other level the sums of two by two. A number in [0, 1) leads from the top to a
 * texel: numbers that are spread evenly over the unit interval are spread evenly over the flux.
 *
 * Source  [Chang07], with the corrections of docs/runtime.md
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEXTURE_SAMPLES_H
#define PARIAN_TEXTURE_SAMPLES_H

#include "core/body.h"

enum { PARIAN_PYRAMID_LEVELS = 15 };

typedef struct parian_flux_pyramid {
    uint32_t side;        /* of the finest level: a power of two, at least that of the atlas */
    uint32_t level_count; /* the last one has a single number */
    float *level[PARIAN_PYRAMID_LEVELS]; /* [(side >> k)^2] W, row by row */
} parian_flux_pyramid;

/* A point through which light enters. */
typedef struct parian_flux_sample {
    float position[3]; /* metres, of the body */
    float normal[3];
    float flux[3]; /* W: all samples together are the flux of the body */
} parian_flux_sample;

/* Errors: PARIAN_E_NOMEM. */
parian_result parian_flux_pyramid_create(const parian_env *env, const parian_body *body,
                                         parian_flux_pyramid *pyramid);
void parian_flux_pyramid_free(const parian_env *env, parian_flux_pyramid *pyramid);
/* Sum E [texel_count], W m^-2. Threads: env->par; the same sums for any number of them. */
void parian_flux_pyramid_build(const parian_env *env, const parian_body *body,
                               const float (*irradiance)[3], parian_flux_pyramid *pyramid);

/* Numbers of count samples: [count] of u, one in each of count equal parts of [0, 1), and of a
 * place in the texel, in [0, 1)^2. */
void parian_texture_numbers(uint32_t seed, uint32_t count, float (*number)[3]);

/* The texel (place in the finest level, row by row) that a number in [0, 1) leads to; UINT32_MAX
 * where no light falls. */
uint32_t parian_flux_pyramid_find(const parian_flux_pyramid *pyramid, float number);

/* One sample for each number, at a point of its texel's square in the tangent plane. All samples
 * are zero where no light falls. Threads: env->par. */
void parian_texture_samples_draw(const parian_env *env, const parian_body *body,
                                 const parian_flux_pyramid *pyramid, const float (*irradiance)[3],
                                 const float (*number)[3], uint32_t count,
                                 parian_flux_sample *sample);

#endif
