/* truth.c - chooses receivers among texels and asks the reference models for B there.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/truth.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/reference/path_tracing.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/surface_quadrature.h"
#include "core/memory.h"
#include "core/random.h"
#include "tool/files.h"

static const uint64_t PATH_SAMPLES_MAX =
    UINT64_C(1) << 24; /* of a receiver and channel, when an error is asked for */
static const double STANDARD_ERROR_DEFAULT = 0.02;

const char *parian_reference_model_name(parian_reference_model model)
{
    static const char *const names[] = {"dipole", "dipole-flux", "directional", "pbd", "path"};
    return (unsigned)model <= PARIAN_REFERENCE_PATH ? names[model] : "unknown";
}

/* ---- choosing texels
 * ---------------------------------------------------------------------------------------- */
typedef struct keyed_texel {
    uint64_t key;
    uint32_t texel;
} keyed_texel;

/* Two zero bits between the lowest 21 bits. */
static uint64_t spread_bits(uint64_t x)
{
    x &= 0x1FFFFF;
    x = (x | x << 32) & 0x1F00000000FFFFu;
    x = (x | x << 16) & 0x1F0000FF0000FFu;
    x = (x | x << 8) & 0x100F00F00F00F00Fu;
    x = (x | x << 4) & 0x10C30C30C30C30C3u;
    return (x | x << 2) & 0x1249249249249249u;
}

static int by_key(const void *a, const void *b)
{
    const keyed_texel *x = a, *y = b;
    if (x->key != y->key) {
        return x->key < y->key ? -1 : 1;
    }
    return (x->texel > y->texel) - (x->texel < y->texel);
}

static void sort_texels(const float (*position)[3], size_t count, keyed_texel *list)
{
    double lower[3], extent = 0;
    for (int c = 0; c < 3; c++) {
        double upper = -INFINITY;
        lower[c] = INFINITY;
        for (size_t i = 0; i < count; i++) {
            lower[c] = fmin(lower[c], position[i][c]);
            upper = fmax(upper, position[i][c]);
        }
        extent = fmax(extent, upper - lower[c]);
    }
    double scale = extent > 0 ? 2097151.0 / extent : 0;
    for (size_t i = 0; i < count; i++) {
        list[i] = (keyed_texel){0, (uint32_t)i};
        for (int c = 0; c < 3; c++) {
            list[i].key |= spread_bits((uint64_t)((position[i][c] - lower[c]) * scale)) << c;
        }
    }
    qsort(list, count, sizeof *list, by_key);
}

void parian_texel_choice_free(const parian_env *env, parian_texel_choice *choice)
{
    parian_free(env, choice->texel);
    parian_free(env, choice->area);
    *choice = (parian_texel_choice){0};
}

/* Walk along the texels; every `share` of area gives one hit to the texel it falls on. */
static void take_shares(const keyed_texel *list, const float *area, size_t texel_count,
                        double start, double share, size_t shares, parian_texel_choice *choice)
{
    double sum = 0;
    size_t hit = 0;
    for (size_t i = 0; i < texel_count; i++) {
        sum += area[list[i].texel];
        size_t first = hit;
        bool last = i + 1 == texel_count;
        while (hit < shares && (last || (start + (double)hit) * share < sum)) {
            hit++;
        }
        if (hit > first) {
            choice->texel[choice->count] = list[i].texel;
            choice->area[choice->count++] = (double)(hit - first) * share;
        }
    }
}

parian_result parian_texels_choose(const parian_env *env, const float (*position)[3],
                                   const float *area, size_t texel_count, size_t count,
                                   uint64_t seed, parian_texel_choice *choice)
{
    keyed_texel *list = NULL;
    double whole = 0;
    *choice = (parian_texel_choice){0};
    if (!PARIAN_NEW(env, list, texel_count) || !PARIAN_NEW(env, choice->texel, texel_count) ||
        !PARIAN_NEW(env, choice->area, texel_count)) {
        parian_free(env, list);
        parian_texel_choice_free(env, choice);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu texels", texel_count);
    }
    sort_texels(position, texel_count, list);
    for (size_t i = 0; i < texel_count; i++) {
        whole += area[i];
    }
    if (count > 0 && count < texel_count) {
        parian_random random = parian_random_stream(seed, 1, 0, 0);
        take_shares(list, area, texel_count, parian_random_unit(&random), whole / (double)count,
                    count, choice);
    } else {
        for (size_t i = 0; i < texel_count; i++) {
            choice->texel[i] = list[i].texel;
            choice->area[i] = area[list[i].texel];
        }
        choice->count = texel_count;
    }
    parian_free(env, list);
    return PARIAN_OK;
}

/* ---- receivers
 * ---------------------------------------------------------------------------------------------- */
static void warn_of_other_sides(const parian_env *env, const float (*normal)[3],
                                const parian_texel_choice *choice,
                                const parian_receivers *receivers)
{
    size_t away = 0;
    for (size_t i = 0; normal && i < choice->count; i++) {
        const float *n = normal[choice->texel[i]];
        const double *m = receivers->normal[i];
        away += n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0;
    }
    if (away > 0) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "%zu of %zu receivers are on a surface that faces away from their texels", away,
                   choice->count);
    }
}

parian_result parian_truth_receivers(const parian_env *env, const parian_reference_scene *scene,
                                     const float (*position)[3], const float (*normal)[3],
                                     const parian_texel_choice *choice, parian_receivers *receivers)
{
    double(*point)[3] = NULL;
    *receivers = (parian_receivers){0};
    if (!PARIAN_NEW(env, point, choice->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu receivers", choice->count);
    }
    for (size_t i = 0; i < choice->count; i++) {
        for (int c = 0; c < 3; c++) {
            point[i][c] = position[choice->texel[i]][c];
        }
    }
    parian_result r =
        parian_receivers_nearest(env, scene, (const double(*)[3])point, choice->count, receivers);
    parian_free(env, point);
    if (r == PARIAN_OK) {
        memcpy(receivers->area, choice->area, choice->count * sizeof *receivers->area);
        warn_of_other_sides(env, normal, choice, receivers);
    }
    return r;
}

/* ---- the truth
 * ---------------------------------------------------------------------------------------------- */
static parian_result compute_path(const parian_env *env, const parian_reference_scene *scene,
                                  const parian_receivers *receivers, const parian_truth_desc *desc,
                                  const char *checkpoint, parian_reference_result *result)
{
    parian_path_desc path = {.samples = desc->samples ? desc->samples : PATH_SAMPLES_MAX,
                             .standard_error = desc->standard_error,
                             .seed = desc->seed,
                             .checkpoint = checkpoint};
    if (!desc->samples && !(desc->standard_error > 0)) {
        path.standard_error = STANDARD_ERROR_DEFAULT;
    }
    return parian_reference_path(env, scene, receivers, &path, result);
}

static parian_result compute(const parian_env *env, const parian_reference_scene *scene,
                             const parian_receivers *receivers, const parian_truth_desc *desc,
                             const char *checkpoint, parian_reference_result *result)
{
    if (desc->model == PARIAN_REFERENCE_PATH) {
        return compute_path(env, scene, receivers, desc, checkpoint, result);
    }
    const parian_reference_quadrature_desc quadrature = {
        .bssrdf = {.model = desc->model, .fit_fdr = desc->fit_fdr, .normalise = desc->normalise},
        .samples = desc->samples,
        .seed = desc->seed};
    return parian_reference_quadrature(env, scene, receivers, &quadrature, result);
}

static parian_result get_kept(const parian_env *env, const parian_reference_scene *scene,
                              const parian_receivers *receivers, const parian_truth_desc *desc,
                              parian_reference_result *result, bool *cached)
{
    char name[PARIAN_TRUTH_NAME_MAX], path[4096], checkpoint[4096];
    parian_result r = parian_truth_name(env, scene, receivers, desc, name);
    if (r == PARIAN_OK) {
        r = parian_folder_create(env, desc->cache);
    }
    if (r != PARIAN_OK) {
        return r;
    }
    if (snprintf(path, sizeof path, "%s/%s.parian", desc->cache, name) >= (int)sizeof path ||
        snprintf(checkpoint, sizeof checkpoint, "%s/%s.checkpoint", desc->cache, name) >=
            (int)sizeof checkpoint) {
        return parian_fail(env, PARIAN_E_IO, "the name of the cache folder is too long");
    }
    *cached = access(path, R_OK) == 0 && parian_truth_load(env, path, receivers->count, result);
    if (*cached) {
        return PARIAN_OK;
    }
    r = compute(env, scene, receivers, desc, checkpoint, result);
    return r == PARIAN_OK ? parian_truth_save(env, path, receivers->count, result) : r;
}

parian_result parian_truth_get(const parian_env *env, const parian_reference_scene *scene,
                               const parian_receivers *receivers, const parian_truth_desc *desc,
                               parian_reference_result *result, bool *cached)
{
    *cached = false;
    *result = (parian_reference_result){0};
    return desc->cache ? get_kept(env, scene, receivers, desc, result, cached)
                       : compute(env, scene, receivers, desc, NULL, result);
}
