/* kernel.h - the local kernels of a body, ready to be applied, whatever form the body carries them in.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_KERNEL_H
#define PARIAN_CORE_KERNEL_H

#include "core/body.h"

/* Weight of E_i in B_o, value = half * channel_scale. Layouts as kernel_f16 and border_f16 of a body. */
typedef struct parian_kernels {
    float channel_scale[PARIAN_CHANNELS];
    parian_half (*interior)[3]; /* [(texel_count - border_count) * width^2] */
    parian_half (*border)[3];   /* [border_offset[border_count]] */
    uint64_t interior_total, border_total;
} parian_kernels;

/* Make the kernels of a derived body: decoded where they are stored (F16, U8), computed where they are
 * not (REBUILT, SPLIT, ONLY); empty arrays with NONE. Errors: PARIAN_E_NOMEM, PARIAN_E_ARGUMENT.
 * Threads: uses env->par; the same values for any number of threads. */
parian_result parian_kernels_build(const parian_env *env, const parian_body *body, parian_kernels *kernels);
void parian_kernels_free(const parian_env *env, parian_kernels *kernels);

#endif
