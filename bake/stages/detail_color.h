/* detail_color.h - the base colour of the source surface, averaged over the footprint of a texel.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_DETAIL_COLOR_H
#define PARIAN_BAKE_DETAIL_COLOR_H

#include "bake/adapters/cgal_closest.h"
#include "bake/stages/detail.h"

/* The material of a source triangle; NULL for none. */
const parian_source_material *parian_detail_material(const parian_detail_desc *desc,
                                                     uint32_t triangle);

/* Whether any triangle has a texture or a factor other than white. */
bool parian_detail_has_color(const parian_detail_desc *desc);

/* Linear base colour of the source at a point of it, factor times texture: bilinear, repeated,
 * averaged over a square of side footprint_m around the point. 1 where there is no material. */
void parian_detail_color(const parian_detail_desc *desc, const float srgb_to_linear[256],
                         const parian_closest_hit *hit, double footprint_m, float color[3]);

#endif
