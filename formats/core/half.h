/* half.h - IEEE 754 binary16 numbers: exact conversion to and from float.
 *
 * Rounds to nearest, ties to even, subnormals and infinities included; what exceeds 65,519.99
 * becomes infinite; a NaN stays a quiet NaN with its sign and the upper bits of its payload. The
 * array functions give the same bits as the scalar ones on every machine.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_HALF_H
#define PARIAN_CORE_HALF_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The bits of a binary16 number. */
typedef uint16_t parian_half;

#define PARIAN_HALF_MAX        65504.0f /* largest finite */
#define PARIAN_HALF_MIN_NORMAL 0x1p-14f /* smallest with full precision */
#define PARIAN_HALF_MIN        0x1p-24f /* smallest above zero */

static inline int parian_half_is_finite(parian_half half)
{
    return (half & 0x7c00u) != 0x7c00u;
}

static inline parian_half parian_half_from_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000u;
    uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude > 0x7f800000u) { /* NaN */
        return (parian_half)(sign | 0x7e00u | (magnitude >> 13 & 0x3ffu));
    }
    if (magnitude >= 0x477ff000u) { /* 65,520 and above round to infinity */
        return (parian_half)(sign | 0x7c00u);
    }
    if (magnitude >= 0x38800000u) { /* normal: rebias, round the 13 dropped bits */
        uint32_t rounded = magnitude - 0x38000000u + 0xfffu + (magnitude >> 13 & 1u);
        return (parian_half)(sign | rounded >> 13);
    }
    if (magnitude < 0x33000000u) { /* below half of the smallest subnormal */
        return (parian_half)sign;
    }
    uint32_t shift = 126u - (magnitude >> 23); /* 14 to 24: value = mantissa * 2^(-24 - shift) */
    uint32_t mantissa = (magnitude & 0x7fffffu) | 0x800000u;
    uint32_t half = mantissa >> shift;
    uint32_t rest = mantissa & ((1u << shift) - 1u);
    uint32_t tie = 1u << (shift - 1u);
    half += rest > tie || (rest == tie && (half & 1u));
    return (parian_half)(sign | half);
}

static inline float parian_half_to_float(parian_half half)
{
    uint32_t sign = (uint32_t)(half & 0x8000u) << 16;
    uint32_t exponent = half >> 10 & 0x1fu;
    uint32_t mantissa = half & 0x3ffu;
    uint32_t bits;
    float value;
    if (exponent == 0) { /* zero and subnormals: an exact product */
        value = (float)mantissa * 0x1p-24f;
        memcpy(&bits, &value, sizeof bits);
        bits |= sign;
    } else if (exponent == 31) {
        bits = sign | 0x7f800000u | mantissa << 13 | (mantissa ? 0x400000u : 0u);
    } else {
        bits = sign | (exponent + 112u) << 23 | mantissa << 13;
    }
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Convert count numbers; the arrays do not overlap. Threads: pure functions. */
void parian_half_to_float_array(const parian_half *half, float *value, size_t count);
void parian_half_from_float_array(const float *value, parian_half *half, size_t count);

#ifdef __cplusplus
}
#endif
#endif
