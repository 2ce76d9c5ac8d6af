/* body_optics.h - what shading must know of a medium: Fresnel moments and albedo.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_BODY_OPTICS_H
#define PARIAN_BODY_OPTICS_H

#include "core/medium.h"

typedef struct parian_body_optics {
    float eta;
    float exit_norm;         /* C = 1 - 2 C1(eta), so that F_t / (pi C) integrates to one */
    float tint[3];           /* of what scatters out, 1 unless edited */
    float albedo[3];         /* total diffuse reflectance of a half-space of the medium */
} parian_body_optics;

parian_body_optics parian_body_optics_make(const parian_medium *medium, bool fit_fdr);

#endif
