/* global_pairs.c - pairs of coarse points whose exchange is left to finer points.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/global_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "core/near_factors.h"
#include "core/small_maths.h"

static void add_pair(const parian_coarse *coarse, uint32_t a, uint32_t b, parian_bits *pairs)
{
    parian_bits_set(pairs, (size_t)a * coarse->count + b);
    parian_bits_set(pairs, (size_t)b * coarse->count + a);
}

void parian_pairs_add_near(const parian_body *body, const parian_coarse *coarse, double reach,
                           parian_bits *pairs)
{
    const float(*position)[3] = (const float(*)[3])body->vertex_position;
    for (uint32_t a = 0; a < coarse->count; a++) {
        for (uint32_t b = 0; b <= a; b++) {
            float r2 = parian_distance2f(position[coarse->vertex[a]], position[coarse->vertex[b]]);
            if (a == b || r2 < reach * reach) {
                add_pair(coarse, a, b, pairs);
            }
        }
    }
}

/* Add all pairs of the coarse points around i and around j. */
static void add_around(const parian_coarse *coarse, uint32_t i, uint32_t j, parian_bits *pairs)
{
    for (int k = 0; k < 9; k++) {
        if (coarse->weight[i][k / 3] > 0 && coarse->weight[j][k % 3] > 0) {
            add_pair(coarse, coarse->near[i][k / 3], coarse->near[j][k % 3], pairs);
        }
    }
}

void parian_pairs_add_lifted(const parian_coarse *coarse, const parian_bits *finer,
                             parian_bits *pairs)
{
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            if (parian_bits_get(finer, (size_t)i * coarse->fine_count + j)) {
                add_around(coarse, i, j, pairs);
            }
        }
    }
}

/* ---- windows ---- */

typedef struct window_work {
    const parian_body *body;
    const parian_coarse *coarse;
    parian_bits *pairs;
    uint32_t *stamp; /* [triangle_count] last triangle + 1 that saw it */
} window_work;

static void add_triangles(window_work *work, uint32_t t, uint32_t other)
{
    if (work->stamp[other] == t + 1) {
        return;
    }
    work->stamp[other] = t + 1;
    for (int k = 0; k < 9; k++) {
        add_around(work->coarse, work->body->triangle[t][k / 3], work->body->triangle[other][k % 3],
                   work->pairs);
    }
}

/* Window and ring of a texel: the texels of its chart in the square, and its list. */
static void add_window(window_work *work, uint32_t texel)
{
    enum { RING = 2 };
    const parian_body *body = work->body;
    int32_t side = (int32_t)body->atlas_size, reach = (int32_t)body->kernel_width / 2 + RING;
    int32_t u = (int32_t)body->texel_index[texel] % side;
    int32_t v = (int32_t)body->texel_index[texel] / side;
    uint32_t t = body->texel_triangle[texel], border = body->texel_border[texel];
    for (int32_t y = v - reach; y <= v + reach; y++) {
        for (int32_t x = u - reach; x <= u + reach; x++) {
            uint32_t o = x >= 0 && x < side && y >= 0 && y < side ? body->texel_at[y * side + x]
                                                                  : PARIAN_NO_BORDER;
            if (o != PARIAN_NO_BORDER &&
                (!body->triangle_chart ||
                 body->triangle_chart[body->texel_triangle[o]] == body->triangle_chart[t])) {
                add_triangles(work, t, body->texel_triangle[o]);
            }
        }
    }
    for (uint32_t k = border == PARIAN_NO_BORDER ? 0 : body->border_offset[border];
         border != PARIAN_NO_BORDER && k < body->border_offset[border + 1]; k++) {
        add_triangles(work, t, body->texel_triangle[body->border_neighbour[k]]);
    }
}

parian_result parian_pairs_add_windows(const parian_env *env, const parian_body *body,
                                       const parian_coarse *coarse, parian_bits *pairs)
{
    window_work work = {body, coarse, pairs, NULL};
    parian_texel_lists lists = {0};
    parian_result result = parian_texel_lists_make(env, body, &lists);
    if (result == PARIAN_OK && !PARIAN_NEW0(env, work.stamp, body->triangle_count)) {
        result =
            parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", body->triangle_count);
    }
    for (uint32_t t = 0; t < body->triangle_count && result == PARIAN_OK; t++) {
        for (uint32_t n = lists.offset[t]; n < lists.offset[t + 1]; n++) {
            add_window(&work, lists.texel[n]);
        }
    }
    parian_texel_lists_free(env, &lists);
    parian_free(env, work.stamp);
    return result;
}
