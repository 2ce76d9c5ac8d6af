/* array_check.c - finds the first element of a large array that breaks a rule, in parallel; bit
 * sets.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/array_check.h"

#include <string.h>

#include "core/memory.h"

enum { SLICE_COUNT = 64, SLICE_MIN = 4096, HALF_STRIDE = 4096 };

typedef struct search {
    parian_find_function find;
    const void *context;
    size_t count, slice;
    size_t bad[SLICE_COUNT];
} search;

static void search_slice(void *context, size_t index)
{
    search *s = context;
    size_t begin = index * s->slice;
    size_t end = s->count - begin < s->slice ? s->count : begin + s->slice;
    s->bad[index] = s->find(s->context, begin, end);
}

size_t parian_find_bad(const parian_env *env, size_t count, parian_find_function find,
                       const void *context)
{
    search s = {.find = find, .context = context, .count = count};
    s.slice = count / SLICE_COUNT + 1 < SLICE_MIN ? SLICE_MIN : count / SLICE_COUNT + 1;
    size_t slices = (count + s.slice - 1) / s.slice;
    parian_par(env, slices, search_slice, &s);
    for (size_t i = 0; i < slices; i++) {
        if (s.bad[i] != PARIAN_ALL_GOOD) {
            return s.bad[i];
        }
    }
    return PARIAN_ALL_GOOD;
}

typedef struct interval {
    const float *value;
    float minimum, maximum;
} interval;

static size_t find_outside(const void *context, size_t begin, size_t end)
{
    const interval *in = context;
    for (size_t i = begin; i < end; i++) {
        if (!(in->value[i] >= in->minimum && in->value[i] <= in->maximum)) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

size_t parian_find_outside(const parian_env *env, const void *values, size_t count, float minimum,
                           float maximum)
{
    interval in = {values, minimum, maximum};
    return parian_find_bad(env, count, find_outside, &in);
}

static size_t find_infinite_half(const void *context, size_t begin, size_t end)
{
    const uint16_t *half = context;
    for (size_t first = begin; first < end; first += HALF_STRIDE) {
        size_t last = end - first < HALF_STRIDE ? end : first + HALF_STRIDE;
        unsigned found = 0;
        for (size_t i = first; i < last; i++) {
            found |= (half[i] & 0x7c00u) == 0x7c00u;
        }
        for (size_t i = first; found && i < last; i++) {
            if ((half[i] & 0x7c00u) == 0x7c00u) {
                return i;
            }
        }
    }
    return PARIAN_ALL_GOOD;
}

size_t parian_find_infinite_half(const parian_env *env, const void *halves, size_t count)
{
    return parian_find_bad(env, count, find_infinite_half, halves);
}

typedef struct below {
    const uint32_t *index;
    uint32_t limit;
} below;

static size_t find_index(const void *context, size_t begin, size_t end)
{
    const below *b = context;
    for (size_t i = begin; i < end; i++) {
        if (b->index[i] >= b->limit) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

size_t parian_find_index(const parian_env *env, const void *indices, size_t count, uint32_t limit)
{
    below b = {indices, limit};
    return parian_find_bad(env, count, find_index, &b);
}

static size_t find_descent(const void *context, size_t begin, size_t end)
{
    const uint32_t *index = context;
    for (size_t i = begin ? begin : 1; i < end; i++) {
        if (index[i] <= index[i - 1]) {
            return i;
        }
    }
    return PARIAN_ALL_GOOD;
}

size_t parian_find_descent(const parian_env *env, const void *indices, size_t count)
{
    return parian_find_bad(env, count, find_descent, indices);
}

parian_result parian_bits_create(const parian_env *env, size_t count, parian_bits *bits)
{
    /* Four bytes more, so that parian_bits_all may load a word anywhere. */
    if (!PARIAN_NEW0(env, bits->byte, count / 8 + 5)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a set of %zu bits", count);
    }
    return PARIAN_OK;
}

void parian_bits_free(const parian_env *env, parian_bits *bits)
{
    parian_free(env, bits->byte);
    bits->byte = NULL;
}

bool parian_bits_all(const parian_bits *bits, size_t first, uint32_t width)
{
    uint32_t word, mask = (1u << width) - 1;
    memcpy(&word, bits->byte + (first >> 3), sizeof word);
    return (word >> (first & 7) & mask) == mask;
}
