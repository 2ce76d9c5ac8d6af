/* random.h - counter-based random numbers: a stream is a key, a number is a function of key and place in the
 * stream, so that results never depend on threads or order.
 *
 * Source  the finaliser of SplitMix64 [Steele14], applied to key + place * odd constant
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_RANDOM_H
#define PARIAN_CORE_RANDOM_H

#include <stdint.h>

typedef struct parian_random {
    uint64_t state; /* key + place * odd constant */
} parian_random;

static inline uint64_t parian_random_mix(uint64_t x)
{
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

/* The stream of a seed and up to three indices, such as receiver, channel, walk. */
static inline parian_random parian_random_stream(uint64_t seed, uint64_t a, uint64_t b, uint64_t c)
{
    uint64_t key = parian_random_mix(seed + 0x9E3779B97F4A7C15u);
    key = parian_random_mix(key ^ (a * 0xD1342543DE82EF95u + 1));
    key = parian_random_mix(key ^ (b * 0xAF251AF3B0F025B5u + 2));
    key = parian_random_mix(key ^ (c * 0x9FB21C651E98DF25u + 3));
    return (parian_random){key};
}

static inline uint64_t parian_random_bits(parian_random *random)
{
    random->state += 0x9E3779B97F4A7C15u;
    return parian_random_mix(random->state);
}

/* Uniform in [0, 1), 53 bits. */
static inline double parian_random_unit(parian_random *random)
{
    return (double)(parian_random_bits(random) >> 11) * 0x1p-53;
}

#endif
