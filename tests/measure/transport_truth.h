/* transport_truth.h - what a body's transport should make of the irradiance that the method itself
 * found.
 *
 * Leaves out the errors of E and of the surface: what remains is that of kernels, vertices,
 * blending and storage.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_TRANSPORT_TRUTH_H
#define PARIAN_MEASURE_TRANSPORT_TRUTH_H

#include "core/body.h"
#include "tests/measure/truth.h"

/* B at the chosen texels: the sum of A E R over all texels of the same body, with the asset's own
 * BSSRDF; texels within 20 of their edges by 2 x 2 Gauss points on their tangent planes, the
 * receiver's own as the disc of its area in closed form.
 *
 * irradiance  [texels of all bodies]; radiosity  [choice->count]
 *
 * Errors: PARIAN_E_NOMEM. Threads: env->par; the numbers do not depend on their count. */
parian_result parian_transport_truth(const parian_env *env, const parian_body *bodies,
                                     uint32_t body_count, const float (*irradiance)[3],
                                     const parian_texel_choice *choice, double (*radiosity)[3]);

#endif
