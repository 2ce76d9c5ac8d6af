/* refracted_four.h - four floats at a time, one for each child of a node, in the compiler's vector
 * types.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFRACTED_FOUR_H
#define PARIAN_BAKE_REFRACTED_FOUR_H

#include <math.h>
#include <stdint.h>
#include <string.h>
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

typedef float four __attribute__((vector_size(16)));
typedef int32_t four_mask __attribute__((vector_size(16))); /* -1 or 0 */

static inline four four_load(const float from[4])
{
    four out;
    memcpy(&out, from, sizeof out);
    return out;
}

static inline four four_of(float value)
{
    return (four){value, value, value, value};
}

static inline four four_where(four_mask mask, four a, four b)
{
    return (four)(((four_mask)a & mask) | ((four_mask)b & ~mask));
}

static inline four four_larger(four a, four b)
{
    return four_where(a > b, a, b);
}

static inline four four_smaller(four a, four b)
{
    return four_where(a < b, a, b);
}

static inline four four_abs(four a)
{
    return (four)((four_mask)a & 0x7FFFFFFF);
}

static inline four four_sqrt(four a)
{
#if defined(__SSE2__)
    return (four)_mm_sqrt_ps((__m128)a);
#else
    return (four){sqrtf(a[0]), sqrtf(a[1]), sqrtf(a[2]), sqrtf(a[3])};
#endif
}

static inline four four_dot(const four a[3], const four b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Bit k is set where mask is in lane k. */
static inline unsigned four_bits(four_mask mask)
{
#if defined(__SSE2__)
    return (unsigned)_mm_movemask_ps((__m128)mask);
#else
    return (mask[0] & 1u) | (mask[1] & 2u) | (mask[2] & 4u) | (mask[3] & 8u);
#endif
}

/* Take away the highest bit of bits (not 0): its place. */
static inline int four_last(unsigned *bits)
{
    int k = 31 - __builtin_clz(*bits);
    *bits ^= 1u << k;
    return k;
}

#endif
