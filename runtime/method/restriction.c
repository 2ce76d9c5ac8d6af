/* restriction.c - for each transfer vertex, the texels that feed it.
 *
 * SPDX-License-Identifier: MIT
 */
#include "method/restriction.h"

#include <string.h>

#include "core/memory.h"

static void fill_feed(const parian_body *body, uint32_t texel, int corner, parian_restriction *made,
                      uint32_t slot)
{
    float b0 = body->texel_barycentric[texel][0], b1 = body->texel_barycentric[texel][1];
    float beta = corner == 0 ? b0 : corner == 1 ? b1 : 1.0f - b0 - b1;
    float share = body->paper_form ? 4.0f * beta - 1.0f : beta;
    made->feed[slot] = (parian_feed){texel, share * body->texel_area[texel]};
    if (made->weight) {
        memcpy(made->weight[slot], body->blend_weight[texel][corner], sizeof made->weight[slot]);
    }
}

static void fill(const parian_body *body, parian_restriction *made, uint32_t *cursor)
{
    for (uint32_t t = 0; t < body->texel_count; t++) {
        const uint32_t *triangle = body->triangle[body->texel_triangle[t]];
        for (int corner = 0; corner < 3; corner++) {
            fill_feed(body, t, corner, made, cursor[triangle[corner]]++);
        }
    }
}

parian_result parian_restriction_build(const parian_env *env, const parian_body *body,
                                       parian_restriction *restriction)
{
    parian_restriction made = {.vertex_count = body->vertex_count, .total = 3 * body->texel_count};
    uint32_t *cursor = NULL;
    if (!PARIAN_NEW0(env, made.offset, (size_t)body->vertex_count + 1) ||
        !PARIAN_NEW(env, made.feed, made.total) ||
        (body->blend_weight && !PARIAN_NEW(env, made.weight, made.total)) ||
        !PARIAN_NEW(env, cursor, (size_t)body->vertex_count + 1)) {
        parian_restriction_free(env, &made);
        parian_free(env, cursor);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the restriction of %u texels",
                           body->texel_count);
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            made.offset[body->triangle[body->texel_triangle[t]][corner] + 1]++;
        }
    }
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        made.offset[v + 1] += made.offset[v];
    }
    memcpy(cursor, made.offset, ((size_t)body->vertex_count + 1) * sizeof *cursor);
    fill(body, &made, cursor);
    parian_free(env, cursor);
    *restriction = made;
    return PARIAN_OK;
}

void parian_restriction_free(const parian_env *env, parian_restriction *restriction)
{
    if (restriction) {
        parian_free(env, restriction->offset);
        parian_free(env, restriction->feed);
        parian_free(env, restriction->weight);
        memset(restriction, 0, sizeof *restriction);
    }
}
