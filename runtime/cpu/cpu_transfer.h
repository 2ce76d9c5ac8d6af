/* cpu_transfer.h - restriction, local filter and interpolation: the C evaluation of the transfer
 * passes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_TRANSFER_H
#define PARIAN_CPU_TRANSFER_H

#include "core/kernel.h"
#include "method/restriction.h"

/* Phi and D at vertices from E at texels; direct may be NULL and is zero without blending weights.
 */
void parian_cpu_restrict(const parian_env *env, const parian_restriction *restriction,
                         const float (*irradiance)[3], float (*flux)[3], float (*direct)[3]);

/* local[t]: sum of kernel times E over the texel's window or list. global[t]: B at the vertices of
 * its triangle, interpolated. */
void parian_cpu_filter(const parian_env *env, const parian_body *body,
                       const parian_kernels *kernels, const float (*irradiance)[3],
                       const float (*vertex_radiosity)[3], float (*local)[3], float (*global)[3]);

#endif
