/* half.c - arrays of binary16 numbers to and from float, with F16C where the processor has it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/half.h"

static void to_float_plain(const parian_half *half, float *value, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        value[i] = parian_half_to_float(half[i]);
    }
}

static void from_float_plain(const float *value, parian_half *half, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        half[i] = parian_half_from_float(value[i]);
    }
}

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>

static int has_f16c(void)
{
    return __builtin_cpu_supports("avx") && __builtin_cpu_supports("f16c");
}

__attribute__((target("avx,f16c"))) static void to_float_f16c(const parian_half *half, float *value,
                                                              size_t count)
{
    size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        __m128i bits = _mm_loadu_si128((const __m128i *)(const void *)(half + i));
        _mm256_storeu_ps(value + i, _mm256_cvtph_ps(bits));
    }
    to_float_plain(half + i, value + i, count - i);
}

__attribute__((target("avx,f16c"))) static void from_float_f16c(const float *value,
                                                                parian_half *half, size_t count)
{
    size_t i = 0;
    for (; i + 8 <= count; i += 8) {
        __m128i bits = _mm256_cvtps_ph(_mm256_loadu_ps(value + i), _MM_FROUND_TO_NEAREST_INT);
        _mm_storeu_si128((__m128i *)(void *)(half + i), bits);
    }
    from_float_plain(value + i, half + i, count - i);
}

void parian_half_to_float_array(const parian_half *half, float *value, size_t count)
{
    if (has_f16c()) {
        to_float_f16c(half, value, count);
    } else {
        to_float_plain(half, value, count);
    }
}

void parian_half_from_float_array(const float *value, parian_half *half, size_t count)
{
    if (has_f16c()) {
        from_float_f16c(value, half, count);
    } else {
        from_float_plain(value, half, count);
    }
}
#else
void parian_half_to_float_array(const parian_half *half, float *value, size_t count)
{
    to_float_plain(half, value, count);
}

void parian_half_from_float_array(const float *value, parian_half *half, size_t count)
{
    from_float_plain(value, half, count);
}
#endif
