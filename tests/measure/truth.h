/* truth.h - ground truth at texels of an asset, kept by content.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_TRUTH_H
#define PARIAN_MEASURE_TRUTH_H

#include "bake/reference/reference.h"

typedef struct parian_truth_desc {
    parian_reference_model model;
    bool fit_fdr, normalise;
    uint64_t samples; /* 0: what the model takes by default */
    double
        standard_error; /* path: share of the mean of B; 0 with samples given takes all of them */
    uint64_t seed;
    const char *cache; /* folder; NULL: nothing is kept */
} parian_truth_desc;

/* "dipole", "dipole-flux", ... */
const char *parian_reference_model_name(parian_reference_model model);

/* A set of texels that stands for all. */
typedef struct parian_texel_choice {
    size_t count;
    uint32_t *texel; /* [count] ordinals in the scene, ascending along the surface */
    double *area;    /* [count] m^2 that each stands for; they sum to the whole area */
} parian_texel_choice;

/* Choose count texels by area: systematic along a curve that fills space (Morton order), from a
 * seeded start. A texel that is hit more than once stands for that many shares; count 0, or at
 * least as many as there are, takes every texel with its own area. Errors: PARIAN_E_NOMEM. */
parian_result parian_texels_choose(const parian_env *env, const float (*position)[3],
                                   const float *area, size_t texel_count, size_t count,
                                   uint64_t seed, parian_texel_choice *choice);
void parian_texel_choice_free(const parian_env *env, parian_texel_choice *choice);

/* Receivers of a scene nearest to the chosen texels, with their areas. Warns of those whose surface
 * there faces away from the texel's. normal may be NULL. Free them in every case. */
parian_result parian_truth_receivers(const parian_env *env, const parian_reference_scene *scene,
                                     const float (*position)[3], const float (*normal)[3],
                                     const parian_texel_choice *choice,
                                     parian_receivers *receivers);

/* B and E at the receivers. A truth of the same surface, media, lights, receivers and settings is
 * taken from the cache; path leaves a checkpoint there when it is interrupted. result is freed by
 * the caller in every case. Errors: those of the reference models; a damaged file of the cache is
 * computed anew. */
parian_result parian_truth_get(const parian_env *env, const parian_reference_scene *scene,
                               const parian_receivers *receivers, const parian_truth_desc *desc,
                               parian_reference_result *result, bool *cached);

/* ---- truth_cache.c
 * ------------------------------------------------------------------------------------------ */
enum { PARIAN_TRUTH_NAME_MAX = 40 };
/* The name that a truth has in the cache. Errors: PARIAN_E_NOMEM. */
parian_result parian_truth_name(const parian_env *env, const parian_reference_scene *scene,
                                const parian_receivers *receivers, const parian_truth_desc *desc,
                                char name[PARIAN_TRUTH_NAME_MAX]);
/* Write a result of count receivers to a file. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_truth_save(const parian_env *env, const char *path, size_t count,
                                const parian_reference_result *result);
/* Read one; false where there is none of count receivers, or it is damaged: result is then zeroed.
 */
bool parian_truth_load(const parian_env *env, const char *path, size_t count,
                       parian_reference_result *result);

#endif
