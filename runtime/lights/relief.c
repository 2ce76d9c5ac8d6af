/* relief.c - compares the two normals of a texel; the size of the transfer surface's facets.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/relief.h"

#include <math.h>

#include "core/small_maths.h"
#include "vec3.h"

float parian_relief_of_texel(const parian_body *body, uint32_t texel)
{
    float between[3];
    vec3_sub(between, parian_body_lit_normal(body, texel), body->texel_normal[texel]);
    return vec3_length(between);
}

static const double EDGES = 1.5;

float parian_relief_reach(const parian_body *body)
{
    double sum = 0.0;
    const float(*p)[3] = (const float(*)[3])body->vertex_position;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        const uint32_t *c = body->triangle[t];
        for (int k = 0; k < 3; k++) {
            sum += (double)parian_distance2f(p[c[k]], p[c[(k + 1) % 3]]);
        }
    }
    return body->triangle_count > 0 ? (float)(EDGES * sqrt(sum / (3.0 * body->triangle_count)))
                                    : 0.0f;
}
