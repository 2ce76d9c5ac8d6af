/* flip_hdr.c - HDR-FLIP: the largest LDR-FLIP over a range of exposures that the reference picture
 * gives.
 *
 * Source  [Andersson21]
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>

#include "core/memory.h"
#include "tests/measure/flip.h"

static const double SHOWN_BRIGHT =
    0.85; /* share of the display that brightest and median are taken to */
static const double DARKEST = 0x1p-30; /* of the brightest: less than that is taken as black */

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float luminance(const float rgb[4])
{
    float sum = 0;
    static const float weight[3] = {0.2126f, 0.7152f, 0.0722f};
    for (int c = 0; c < 3; c++) {
        sum += isfinite(rgb[c]) && rgb[c] > 0 ? weight[c] * rgb[c] : 0;
    }
    return isfinite(sum) ? sum : 0;
}

/* The linear value that the filmic curve takes to SHOWN_BRIGHT: root of a x^2 + b x + c. */
static double bright_input(void)
{
    double a = 0.9036 - SHOWN_BRIGHT * 0.8748, b = 0.018 - SHOWN_BRIGHT * 0.354,
           c = -SHOWN_BRIGHT * 0.14;
    return (-b + sqrt(b * b - 4 * a * c)) / (2 * a);
}

/* Median of a sorted list: of all, or of those above `dark` where half and more are not. */
static double lit_median(const float *sorted, size_t count, double dark)
{
    double median = 0.5 * ((double)sorted[(count - 1) / 2] + sorted[count / 2]);
    if (median > dark) {
        return median;
    }
    size_t first = 0;
    while (first < count - 1 && !(sorted[first] > dark)) {
        first++;
    }
    size_t lit = count - first;
    return 0.5 * ((double)sorted[first + (lit - 1) / 2] + sorted[first + lit / 2]);
}

parian_result parian_flip_find_exposures(const parian_env *env, uint32_t width, uint32_t height,
                                         const float (*reference)[4],
                                         parian_flip_exposures *exposures)
{
    size_t count = (size_t)width * height;
    float *list;
    *exposures = (parian_flip_exposures){0, 0, 1};
    if (!PARIAN_NEW(env, list, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu luminances", count);
    }
    for (size_t i = 0; i < count; i++) {
        list[i] = luminance(reference[i]);
    }
    qsort(list, count, sizeof *list, by_size);
    double brightest = count ? list[count - 1] : 0;
    if (brightest > 0) {
        exposures->start = log2(bright_input() / brightest);
        exposures->stop = log2(bright_input() / lit_median(list, count, DARKEST * brightest));
        exposures->count = (unsigned)fmax(2, ceil(exposures->stop - exposures->start));
    }
    parian_free(env, list);
    return PARIAN_OK;
}

parian_result parian_flip_hdr(const parian_env *env, uint32_t width, uint32_t height,
                              const float (*image)[4], const float (*reference)[4],
                              double pixels_per_degree, float *map)
{
    size_t count = (size_t)width * height;
    float *one = NULL, *largest = NULL;
    parian_flip_exposures exposures;
    parian_result result = parian_flip_find_exposures(env, width, height, reference, &exposures);
    if (result == PARIAN_OK &&
        (!PARIAN_NEW(env, one, count) || !PARIAN_NEW0(env, largest, count))) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for HDR-FLIP of %u x %u pixels", width,
                             height);
    }
    for (unsigned e = 0; result == PARIAN_OK && e < exposures.count; e++) {
        double step =
            exposures.count > 1 ? (exposures.stop - exposures.start) / (exposures.count - 1) : 0;
        parian_flip_desc desc = {pixels_per_degree, true, exposures.start + e * step};
        result = parian_flip_ldr(env, width, height, image, reference, &desc, one);
        for (size_t i = 0; result == PARIAN_OK && i < count; i++) {
            largest[i] = one[i] > largest[i] ? one[i] : largest[i];
        }
    }
    for (size_t i = 0; result == PARIAN_OK && i < count; i++) {
        map[i] = largest[i];
    }
    parian_free(env, one);
    parian_free(env, largest);
    return result;
}
