/* image_metrics.c - RMSE, relMSE, PSNR of two pictures, and the means and 95th percentiles of FLIP.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/image_metrics.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/memory.h"
#include "tests/measure/flip.h"

static const double FLIP_SHARE = 0.95;

static bool is_finite(const float rgb[4])
{
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

/* What a display is sent: clamped, sRGB [IEC 61966-2-1]. */
static double code(double linear)
{
    double v = fmin(fmax(linear, 0), 1);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

static double over(double part, double whole)
{
    return whole != 0 ? part / whole : part == 0 ? 0 : INFINITY;
}

static parian_result check_reference(const parian_env *env, uint32_t width, uint32_t height,
                                     const float (*reference)[4])
{
    if (width == 0 || height == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "pictures of %u x %u pixels cannot be compared",
                           width, height);
    }
    for (size_t i = 0; i < (size_t)width * height; i++) {
        if (!is_finite(reference[i])) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "the reference picture is not finite at pixel (%zu, %zu)", i % width,
                               i / width);
        }
    }
    return PARIAN_OK;
}

static void measure_values(size_t count, const float (*image)[4], const float (*reference)[4],
                           parian_image_metrics *metrics)
{
    double mean = 0, square = 0, relative = 0, coded = 0;
    size_t used = 0;
    for (size_t i = 0; i < count; i++) {
        mean +=
            ((double)reference[i][0] + reference[i][1] + reference[i][2]) / (3.0 * (double)count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!is_finite(image[i])) {
            metrics->not_finite++;
            continue;
        }
        used++;
        for (int c = 0; c < 3; c++) {
            double v = image[i][c], r = reference[i][c], d = v - r, e = code(v) - code(r);
            square += d * d;
            relative += over(d * d, r * r + 1e-2 * mean * mean);
            coded += e * e;
        }
    }
    double values = 3.0 * (double)used;
    metrics->rmse = used ? sqrt(square / values) : NAN;
    metrics->rel_mse = used ? relative / values : NAN;
    metrics->psnr = used ? (coded > 0 ? 10 * log10(values / coded) : INFINITY) : NAN;
}

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Mean and percentile (nearest rank) of a map, which is sorted. Pixels that are not finite count
 * as 1. */
static void pool(size_t count, float *map, const parian_image_metrics *metrics, double *mean,
                 double *p95)
{
    double sum = 0;
    qsort(map, count, sizeof *map, by_size);
    for (size_t i = 0; i < count; i++) {
        sum += map[i];
    }
    bool any = metrics->not_finite < count;
    *mean = any ? sum / (double)count : NAN;
    *p95 = any ? map[(size_t)ceil(FLIP_SHARE * (double)count) - 1] : NAN;
}

static void mark_not_finite(size_t count, const float (*image)[4], float *map)
{
    for (size_t i = 0; i < count; i++) {
        map[i] = is_finite(image[i]) ? map[i] : 1;
    }
}

parian_result parian_image_measure(const parian_env *env, uint32_t width, uint32_t height,
                                   const float (*image)[4], const float (*reference)[4],
                                   parian_image_metrics *metrics, float *flip_map)
{
    size_t count = (size_t)width * height;
    parian_image_metrics m = {0};
    float *map = NULL;
    parian_result result = check_reference(env, width, height, reference);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW(env, map, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to compare pictures of %u x %u pixels",
                           width, height);
    }
    measure_values(count, image, reference, &m);
    result = parian_flip_hdr(env, width, height, image, reference, 0, map);
    if (result == PARIAN_OK) {
        mark_not_finite(count, image, map);
        pool(count, map, &m, &m.hdr_flip_mean, &m.hdr_flip_p95);
        result = parian_flip_ldr(env, width, height, image, reference, NULL, map);
    }
    if (result == PARIAN_OK) {
        mark_not_finite(count, image, map);
        for (size_t i = 0; flip_map && i < count; i++) {
            flip_map[i] = map[i];
        }
        pool(count, map, &m, &m.flip_mean, &m.flip_p95);
        *metrics = m;
    }
    parian_free(env, map);
    return result;
}
