/* texels_parts.h - the pieces of the texels stage: coverage, border lists, gutter. Internal.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_TEXELS_PARTS_H
#define PARIAN_BAKE_TEXELS_PARTS_H

#include "core/body.h"

/* texels_clip.c: fill texel_count, texel_index, texel_triangle, texel_barycentric and texel_area.
 * covered receives an array [texel_count], the share of each texel's square that its chart covers;
 * the caller frees it. */
parian_result texels_clip(const parian_env *env, parian_body *body, float **covered);

/* border.c: fill the border arrays of a body with derived texels (positions, normals, texel_at). */
parian_result texels_border(const parian_env *env, parian_body *body, const float *covered);

/* gutter.c: fill the gutter arrays of a body with derived texels. */
parian_result texels_gutter(const parian_env *env, parian_body *body);

/* The chart that a texel belongs to. */
static inline uint32_t texel_chart(const parian_body *body, uint32_t texel)
{
    return body->triangle_chart[body->texel_triangle[texel]];
}

#endif
