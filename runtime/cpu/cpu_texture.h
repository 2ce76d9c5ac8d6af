/* cpu_texture.h - B of texels from samples of the flux that enters: the C evaluation.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_TEXTURE_H
#define PARIAN_CPU_TEXTURE_H

#include "core/transport_model.h"
#include "method/texture_samples.h"

/* B at each texel, W m^-2: the sum over samples of R_d times flux. radiosity: [texel_count].
 * Errors: PARIAN_E_NOMEM. Threads: env->par; the same sums for any number of them. */
parian_result parian_cpu_texture_gather(const parian_env *env, const parian_body *body,
                                        const parian_transport_model *model,
                                        const parian_flux_sample *sample, uint32_t count,
                                        float (*radiosity)[3]);

#endif
