/* blend.h - blending weights: by which E of a texel adds to B of its triangle's vertices.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_BLEND_H
#define PARIAN_CORE_BLEND_H

#include "core/body.h"

typedef struct parian_blend_report {
    uint32_t fitted, fallback; /* texels with the constrained fit, and with its fallback */
    double energy_error_max;   /* of an impulse, after the fit, estimated */
} parian_blend_report;

/* Fit blend_weight anew to the body's medium and factors (forms REBUILT, F16, U8; nothing to do for
 * the others). Errors: PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. Threads: uses env->par. */
parian_result parian_blend_make(const parian_env *env, parian_body *body,
                                parian_blend_report *report);

#endif
