/* walk.h - what every random walk in a medium shares: free flights, scattering, the boundary, roulette and the
 * books that prove its energy. Inline, for these are the inner loops.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_WALK_H
#define PARIAN_BAKE_WALK_H

#include <math.h>
#include <stdbool.h>

#include "core/random.h"

/* One channel of a medium as a walk sees it. Where a medium is known only by its reduced coefficients, g is 0
 * and sigma_s is sigma_s'. */
typedef struct parian_walk_medium {
    double sigma_s, sigma_a, sigma_t; /* m^-1 */
    double albedo;                    /* sigma_s / sigma_t */
    double g, eta;
} parian_walk_medium;

/* Where the energy of walks went. started + roulette_added = left + absorbed + roulette_removed + lost. */
typedef struct parian_walk_books {
    double started, left, absorbed, roulette_added, roulette_removed;
    double lost;       /* by walks that a hole of the mesh let out, and that were ended */
    uint64_t events;   /* scattering events */
    uint64_t lost_walks;
} parian_walk_books;

/* Add a to b; the order of additions is the caller's. */
static inline void parian_walk_books_add(parian_walk_books *b, const parian_walk_books *a)
{
    b->started += a->started;
    b->left += a->left;
    b->absorbed += a->absorbed;
    b->roulette_added += a->roulette_added;
    b->roulette_removed += a->roulette_removed;
    b->lost += a->lost;
    b->events += a->events;
    b->lost_walks += a->lost_walks;
}

/* Russian roulette: below threshold a walk survives with probability weight / target and goes on with weight
 * target; expectation is kept, and the books say what was added and removed. Returns false when it ended. */
static inline bool parian_walk_roulette(double *weight, double threshold, double target, parian_random *random,
                                        parian_walk_books *books)
{
    if (*weight >= threshold) {
        return true;
    }
    if (parian_random_unit(random) * target < *weight) {
        books->roulette_added += target - *weight;
        *weight = target;
        return true;
    }
    books->roulette_removed += *weight;
    return false;
}

#endif
