/* path_checkpoint.h - the state of a path tracing run between two steps, and its file.
 *
 * A run is a sequence of rounds, a round a sequence of steps (slices of receivers, passes of
 * photons, a pass for the books). Every step depends on nothing but the settings and its number, so
 * that a run goes on from any of them and ends with the same bytes.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_CHECKPOINT_H
#define PARIAN_BAKE_PATH_CHECKPOINT_H

#include "bake/reference/path_tracing.h"
#include "bake/reference/walk.h"

/* Sums over walks, or over blocks of photons. */
typedef struct parian_path_sums {
    double sum[3], square[3], unscattered[3];
} parian_path_sums;

typedef struct parian_path_counters {
    uint64_t round, step; /* next */
    uint64_t walks;       /* per receiver and channel in finished rounds */
    uint64_t passes;      /* of photons in a round, as of now */
    uint64_t passes_done; /* each of PATH_BLOCKS blocks */
    uint64_t book_passes;
    uint64_t events, started,
        lost;       /* scattering events, walks and photons, those of them that were lost */
    double seconds; /* of earlier runs */
    parian_walk_books books[3]; /* W times photons */
} parian_path_counters;

typedef struct parian_path_state {
    parian_path_counters now;
    size_t count;              /* receivers */
    parian_path_sums *adjoint; /* [count] over walks */
    parian_path_sums *forward; /* [count] over blocks */
} parian_path_state;

parian_result parian_path_state_make(const parian_env *env, size_t count, parian_path_state *state);
void parian_path_state_free(const parian_env *env, parian_path_state *state);

/* XXH3-64 of all that the numbers depend on. Errors: PARIAN_E_NOMEM. */
parian_result parian_path_hash(const parian_env *env, const parian_reference_scene *scene,
                               const parian_receivers *receivers, const parian_path_desc *desc,
                               uint64_t *hash);

/* Write atomically. Errors: PARIAN_E_IO. */
parian_result parian_path_checkpoint_write(const parian_env *env, const char *path, uint64_t hash,
                                           const parian_path_state *state);
/* Read into state, which has its count; where there is no file, state stays and the result is
 * PARIAN_OK. Errors: PARIAN_E_FORMAT (damaged, or of another run), PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_path_checkpoint_read(const parian_env *env, const char *path, uint64_t hash,
                                          parian_path_state *state);

#endif
