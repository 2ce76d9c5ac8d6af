/* path_rounds.h - the rounds of a path tracing run: steps, the stop rule, what the sums amount to.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_ROUNDS_H
#define PARIAN_BAKE_PATH_ROUNDS_H

#include "bake/reference/path_checkpoint.h"
#include "bake/reference/path_parts.h"

enum {
    PATH_ROUND_WALKS = 64, /* per receiver and channel */
    PATH_BLOCKS =
        32, /* of photons in a pass, per channel: the standard error is taken over blocks */
    PATH_BLOCK_PHOTONS = 512 /* per light that photons bring */
};

typedef struct path_run {
    const parian_env *env;
    const path_scene *path;
    const parian_path_desc *desc;
    uint64_t hash, samples;
    double (*straight)[3]; /* [receivers] what needs no walk */
    bool any_walk;         /* a light is met by walks */
    parian_path_state state;
    double started, written; /* seconds of the clock */
    double progress;
} path_run;

/* Run to the end; a checkpoint is written now and then and on interruption.
 * Errors: PARIAN_E_NOMEM, PARIAN_E_IO, PARIAN_E_INTERRUPTED. */
parian_result parian_path_rounds(path_run *run);

/* B, its standard error (INFINITY where it is not known yet) and the unscattered part of a
 * receiver. */
void parian_path_outcome(const path_run *run, size_t receiver, int channel, double *radiosity,
                         double *standard_error, double *unscattered);
/* Photons per channel that the books hold, for each light. */
uint64_t parian_path_book_photons(const path_run *run);

#endif
