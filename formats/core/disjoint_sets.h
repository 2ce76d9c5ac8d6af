/* disjoint_sets.h - sets of indices that are joined pair by pair; the smallest member stands for
 * its set.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_DISJOINT_SETS_H
#define PARIAN_CORE_DISJOINT_SETS_H

#include <stdint.h>

/* parent: [count], parent[i] = i to begin with. Returns the smallest member of i's set; shortens
 * the path to it on the way. */
static inline uint32_t parian_set_root(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

/* Make one set of those of a and b. */
static inline void parian_set_join(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = parian_set_root(parent, a);
    b = parian_set_root(parent, b);
    parent[a > b ? a : b] = a < b ? a : b;
}

#endif
