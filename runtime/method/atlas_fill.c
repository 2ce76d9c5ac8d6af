/* atlas_fill.c - spreads values of owned texels over an atlas, gutters included.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/atlas_fill.h"

#include <string.h>

#include "vec3.h"

void parian_atlas_fill(const parian_body *body, const float (*value)[3], float (*atlas)[4])
{
    memset(atlas, 0, (size_t)body->atlas_size * body->atlas_size * sizeof *atlas);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        float *to = atlas[body->texel_index[t]];
        vec3_copy(to, value[t]);
        to[3] = 1.0f;
    }
    for (uint32_t g = 0; g < body->gutter_count; g++) {
        float *to = atlas[body->gutter_index[g]];
        for (int s = 0; s < PARIAN_GUTTER_SOURCES; s++) {
            float weight = body->gutter_weight[g][s];
            if (weight != 0.0f) {
                vec3_add_scaled(to, value[body->gutter_source[g][s]], weight);
            }
        }
        to[3] = 1.0f;
    }
}
