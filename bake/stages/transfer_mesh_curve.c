/* transfer_mesh_curve.c - sorts points along a Hilbert curve.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdlib.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

enum { CURVE_BITS = 20 };

/* Position along the three-dimensional Hilbert curve of cell x, CURVE_BITS per axis.
 * Source: [Skilling04]. */
static uint64_t hilbert_key(uint32_t x[3])
{
    for (uint32_t q = 1u << (CURVE_BITS - 1); q > 1; q >>= 1) {
        for (int i = 0; i < 3; i++) {
            uint32_t t = (x[0] ^ x[i]) & (q - 1);
            if (x[i] & q) {
                x[0] ^= q - 1;
            } else {
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t turn = 0;
    for (uint32_t q = 1u << (CURVE_BITS - 1); q > 1; q >>= 1) {
        turn ^= x[2] & q ? q - 1 : 0;
    }
    uint64_t key = 0;
    for (int bit = CURVE_BITS - 1; bit >= 0; bit--) {
        for (int i = 0; i < 3; i++) {
            key = key << 1 | (((x[i] ^ turn) >> bit) & 1);
        }
    }
    return key;
}

typedef struct keyed_point {
    uint64_t key;
    uint32_t index;
} keyed_point;

static int compare_keys(const void *left, const void *right)
{
    const keyed_point *a = left, *b = right;
    if (a->key != b->key) {
        return a->key < b->key ? -1 : 1;
    }
    return a->index < b->index ? -1 : a->index > b->index;
}

static void find_bounds(uint32_t count, const double (*point)[3], double lower[3], double *extent)
{
    *extent = 0.0;
    for (int k = 0; k < 3; k++) {
        double upper = count ? point[0][k] : 0.0;
        lower[k] = upper;
        for (uint32_t i = 1; i < count; i++) {
            lower[k] = fmin(lower[k], point[i][k]);
            upper = fmax(upper, point[i][k]);
        }
        *extent = fmax(*extent, upper - lower[k]);
    }
}

parian_result parian_transfer_curve(const parian_env *env, uint32_t count, const double (*point)[3],
                                    uint32_t *order)
{
    keyed_point *sorted;
    double lower[3], extent;
    if (!PARIAN_NEW(env, sorted, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory to sort %u points",
                           count);
    }
    find_bounds(count, point, lower, &extent);
    double scale = extent > 0.0 ? ((1u << CURVE_BITS) - 1) / extent : 0.0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cell[3];
        for (int k = 0; k < 3; k++) {
            cell[k] = (uint32_t)((point[i][k] - lower[k]) * scale);
        }
        sorted[i] = (keyed_point){hilbert_key(cell), i};
    }
    qsort(sorted, count, sizeof *sorted, compare_keys);
    for (uint32_t i = 0; i < count; i++) {
        order[i] = sorted[i].index;
    }
    parian_free(env, sorted);
    return PARIAN_OK;
}
