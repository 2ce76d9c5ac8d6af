/* rounding.h - rounds arrays of the surface to what anything computed from them needs.
 *
 * A float holds 24 bits, a normal or a weight needs 10 to 14. The rest would be noise that no codec
 * makes smaller. All later stages work on the rounded numbers, as the reader will.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_ROUNDING_H
#define PARIAN_BAKE_ROUNDING_H

#include "core/body.h"

/* Round, in place:
 *   texel_barycentric  down to multiples of 2^-12: a 4096th of an edge, a thousandth of a texel
 *   texel_area         to 13 bits behind the first: 0.006 %
 *   gutter_weight      to multiples of 2^-10 that sum to 1
 *   corner_normal, texel_normal_map   components to multiples of 2^-13: 0.005 degrees
 * and derive texel positions and normals anew.
 * Errors   PARIAN_E_NOMEM. Threads: uses env->par. */
parian_result parian_stage_rounding(const parian_env *env, parian_body *body);

/* Round blend_weight to 6 bits behind the first (0.8 %: many weights add up at a vertex), negative
 * ones towards zero, since they must not take away more than the factors give. */
void parian_round_blend(parian_body *body);

#endif
