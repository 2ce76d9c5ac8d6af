/* texels.h - what each texel of the atlas covers: area, centroid, neighbours across charts, gutter.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_TEXELS_H
#define PARIAN_BAKE_TEXELS_H

#include "core/body.h"

/* Fill the texel, gutter and border arrays of a body with an atlas (kernel_width must be set),
 * stored and derived ones. Texel areas are those of clipped triangles and sum to the surface area
 * to rounding. Errors: PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. */
parian_result parian_stage_texels(const parian_env *env, parian_body *body);

#endif
