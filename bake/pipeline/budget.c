/* budget.c - shares vertices and texels among the bodies of a scene with many.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/pipeline/bake.h"

/* Up to this many bodies each get the settings as given; more share what these would get. */
enum { FULL_BODIES = 4, VERTEX_MIN = 300, ATLAS_MIN = 64, ATLAS_STEP = 16 };

void parian_share_budget(const parian_bake_desc *desc, uint32_t body_count, double area_share,
                         uint32_t *vertices, uint32_t *atlas_size)
{
    *vertices = desc->transfer_vertices;
    *atlas_size = desc->atlas_size;
    if (body_count <= FULL_BODIES) {
        return;
    }
    double share = fmin(1, FULL_BODIES * area_share);
    double wanted = fmax(VERTEX_MIN, desc->transfer_vertices * share);
    double side = fmax(ATLAS_MIN, desc->atlas_size * sqrt(share));
    if (wanted < desc->transfer_vertices) {
        *vertices = (uint32_t)wanted;
    }
    if (side < desc->atlas_size) {
        *atlas_size = (uint32_t)ceil(side / ATLAS_STEP) * ATLAS_STEP;
    }
}
