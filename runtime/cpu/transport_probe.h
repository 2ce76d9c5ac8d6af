/* transport_probe.h - how far B of a body is from the direct integral of its R_d, at some
 * receivers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TRANSPORT_PROBE_H
#define PARIAN_TRANSPORT_PROBE_H

#include "core/body.h"
#include "core/kernel.h"

/* Two lights: from afar, without shadows; and the slide of a checkerboard, 8 squares across the
 * body, from +z. */
typedef enum parian_probe_light {
    PARIAN_PROBE_SMOOTH,
    PARIAN_PROBE_HARD,
    PARIAN_PROBE_COUNT
} parian_probe_light;

typedef struct parian_probe_error {
    double l2[PARIAN_PROBE_COUNT][3];     /* relative, weighted by area */
    double energy[PARIAN_PROBE_COUNT][3]; /* B over what it should be, both summed */
} parian_probe_error;

/* Compare at 256 receivers, spread over the texels; R_d is integrated over all texels. kernels are
 * those of the body. Channels that do not scatter have no error. Errors: PARIAN_E_NOMEM. Threads:
 * uses env->par; the same values for any number of threads. */
parian_result parian_transport_probe(const parian_env *env, const parian_body *body,
                                     const parian_kernels *kernels, parian_probe_error *error);

#endif
