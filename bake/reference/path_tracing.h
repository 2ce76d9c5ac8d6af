/* path_tracing.h - volumetric path tracing of the radiative transfer equation inside bodies of
 * triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_TRACING_H
#define PARIAN_BAKE_PATH_TRACING_H

#include "bake/reference/reference.h"

typedef enum parian_walk_kind {
    PARIAN_WALK_AUTO = 0,
    PARIAN_WALK_ADJOINT,
    PARIAN_WALK_FORWARD
} parian_walk_kind;

typedef struct parian_path_desc {
    uint64_t samples;      /* walks per receiver and channel; with standard_error the most */
    double standard_error; /* stop when its root mean square over the receivers is below this share
                            * of the mean of B in every channel; 0: take all samples */
    uint64_t seed;
    parian_walk_kind walk; /* auto: the one that takes less work, tried for each light */
    double patch; /* forward: radius of the disc around a receiver that gathers, m; 0 takes a
                     default */
    const char *checkpoint; /* file that a stopped run goes on from and that is removed at the end;
                               NULL: none */
} parian_path_desc;

/* result is initialised by the callee; free it in every case. Errors: PARIAN_E_NOMEM,
 * PARIAN_E_ARGUMENT, PARIAN_E_FORMAT (an open body; a checkpoint of other settings), PARIAN_E_IO,
 * PARIAN_E_INTERRUPTED (the checkpoint is written). Threads: env->par; the bytes do not depend on
 * their count, nor on interruptions. */
parian_result parian_reference_path(const parian_env *env, const parian_reference_scene *scene,
                                    const parian_receivers *receivers, const parian_path_desc *desc,
                                    parian_reference_result *result);

#endif
