/* atlas_fill.c - spreads values of owned texels over an atlas, gutters included.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/atlas_fill.h"

#include <string.h>

#include "vec3.h"

uint32_t parian_find_first(const uint32_t *list, uint32_t count, uint64_t value)
{
    uint32_t low = 0, high = count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (list[middle] < value) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static void fill_gutter(const parian_body *body, const float (*value)[3], uint32_t g, float to[4])
{
    for (int s = 0; s < PARIAN_GUTTER_SOURCES; s++) {
        float weight = body->gutter_weight[g][s];
        if (weight != 0.0f) {
            vec3_add_scaled(to, value[body->gutter_source[g][s]], weight);
        }
    }
    to[3] = 1.0f;
}

void parian_atlas_fill(const parian_body *body, const float (*value)[3], uint64_t first,
                       uint64_t count, float (*atlas)[4])
{
    memset(atlas, 0, count * sizeof *atlas);
    for (uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
         t < body->texel_count && body->texel_index[t] < first + count; t++) {
        float *to = atlas[body->texel_index[t] - first];
        vec3_copy(to, value[t]);
        to[3] = 1.0f;
    }
    for (uint32_t g = parian_find_first(body->gutter_index, body->gutter_count, first);
         g < body->gutter_count && body->gutter_index[g] < first + count; g++) {
        fill_gutter(body, value, g, atlas[body->gutter_index[g] - first]);
    }
}
