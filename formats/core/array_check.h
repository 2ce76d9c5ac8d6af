/* array_check.h - finds the first element of a large array that breaks a rule, in parallel; bit
 * sets.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_ARRAY_CHECK_H
#define PARIAN_CORE_ARRAY_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#define PARIAN_ALL_GOOD SIZE_MAX

/* Index of the first bad element of [begin, end), or PARIAN_ALL_GOOD. */
typedef size_t (*parian_find_function)(const void *context, size_t begin, size_t end);

/* The same for [0, count), in pieces over env->par; the answer is the first one for any number of
 * threads. */
size_t parian_find_bad(const parian_env *env, size_t count, parian_find_function find,
                       const void *context);

/* float [count]: not within [minimum, maximum] (a NaN is in no interval). */
size_t parian_find_outside(const parian_env *env, const void *values, size_t count, float minimum,
                           float maximum);
/* binary16 [count]: infinite or NaN. */
size_t parian_find_infinite_half(const parian_env *env, const void *halves, size_t count);
/* uint32_t [count]: not below limit. */
size_t parian_find_index(const parian_env *env, const void *indices, size_t count, uint32_t limit);
/* uint32_t [count]: not above the one before. */
size_t parian_find_descent(const parian_env *env, const void *indices, size_t count);

/* A set of numbers below count. */
typedef struct parian_bits {
    uint8_t *byte;
} parian_bits;

parian_result parian_bits_create(const parian_env *env, size_t count, parian_bits *bits);
void parian_bits_free(const parian_env *env, parian_bits *bits);
/* Whether `width` (1 to 24) numbers from first on are all in the set. */
bool parian_bits_all(const parian_bits *bits, size_t first, uint32_t width);

static inline void parian_bits_set(parian_bits *bits, size_t index)
{
    bits->byte[index >> 3] |= (uint8_t)(1u << (index & 7));
}

static inline bool parian_bits_get(const parian_bits *bits, size_t index)
{
    return bits->byte[index >> 3] >> (index & 7) & 1;
}

#endif
