/* view_nearest.c - for each point of one set, the nearest of another: a grid of cells, searched in
 * growing shells.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_nearest.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

enum { SIDE_MAX = 128, PIECE = 1024, NONE = -1 };

typedef struct grid {
    const parian_view_points *from, *to;
    float lower[3], cell; /* metres */
    int side[3];
    uint32_t *first; /* [cells + 1] into item */
    uint32_t *item;  /* [to->count] */
    uint32_t *found;
} grid;

static int clamp(int value, int side)
{
    return value < 0 ? 0 : value >= side ? side - 1 : value;
}

static void cell_of(const grid *g, const float p[3], int cell[3])
{
    for (int c = 0; c < 3; c++) {
        const float at = floorf((p[c] - g->lower[c]) / g->cell);
        cell[c] = clamp((int)fmaxf(fminf(at, 1e6f), -1e6f), g->side[c]);
    }
}

static size_t cell_index(const grid *g, const int cell[3])
{
    return ((size_t)cell[2] * (size_t)g->side[1] + (size_t)cell[1]) * (size_t)g->side[0] +
           (size_t)cell[0];
}

static void lay_out(grid *g)
{
    float upper[3], longest = 0;
    for (int c = 0; c < 3; c++) {
        g->lower[c] = upper[c] = g->to->position[0][c];
        for (size_t i = 1; i < g->to->count; i++) {
            g->lower[c] = fminf(g->lower[c], g->to->position[i][c]);
            upper[c] = fmaxf(upper[c], g->to->position[i][c]);
        }
        longest = fmaxf(longest, upper[c] - g->lower[c]);
    }
    /* Points of a surface fill about 6 side^2 cells: a few points in each. */
    const float side = fminf(fmaxf(sqrtf((float)g->to->count / 12), 1), SIDE_MAX);
    g->cell = longest > 0 ? 1.0001f * longest / floorf(side) : 1;
    for (int c = 0; c < 3; c++) {
        g->side[c] = clamp((int)((upper[c] - g->lower[c]) / g->cell), SIDE_MAX) + 1;
    }
}

static parian_result sort_in(const parian_env *env, grid *g)
{
    const size_t cells = (size_t)g->side[0] * (size_t)g->side[1] * (size_t)g->side[2];
    int cell[3];
    if (!PARIAN_NEW0(env, g->first, cells + 2) || !PARIAN_NEW(env, g->item, g->to->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to search %zu points", g->to->count);
    }
    for (size_t i = 0; i < g->to->count; i++) {
        cell_of(g, g->to->position[i], cell);
        g->first[cell_index(g, cell) + 2]++;
    }
    for (size_t i = 2; i < cells + 2; i++) {
        g->first[i] += g->first[i - 1];
    }
    for (size_t i = 0; i < g->to->count; i++) {
        cell_of(g, g->to->position[i], cell);
        g->item[g->first[cell_index(g, cell) + 1]++] = (uint32_t)i;
    }
    return PARIAN_OK;
}

/* How much farther a point that faces the same way may be than one that faces away, squared. */
static const float FAR_SQUARED = 16;

/* The best so far: of points that face the same way, and of those that face away. */
typedef struct best {
    float squared[2];
    int64_t item[2];
} best;

static void look_in(const grid *g, size_t query, const int cell[3], best *b)
{
    const size_t index = cell_index(g, cell);
    const float *p = g->from->position[query];
    for (uint32_t i = g->first[index]; i < g->first[index + 1]; i++) {
        const uint32_t item = g->item[i];
        const float *q = g->to->position[item];
        const float d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        const float squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        int away = 0;
        if (g->from->normal && g->to->normal) {
            const float *n = g->from->normal[query], *m = g->to->normal[item];
            away = n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0;
        }
        if (squared < b->squared[away] || (squared == b->squared[away] && item < b->item[away])) {
            b->squared[away] = squared;
            b->item[away] = item;
        }
    }
}

/* All cells at a distance of `ring` from the middle one, in the largest of the three axes. */
static void look_in_ring(const grid *g, size_t query, const int middle[3], int ring, best *b)
{
    int at[3];
    for (at[2] = middle[2] - ring; at[2] <= middle[2] + ring; at[2]++) {
        for (at[1] = middle[1] - ring; at[1] <= middle[1] + ring; at[1]++) {
            const bool face = abs(at[2] - middle[2]) == ring || abs(at[1] - middle[1]) == ring;
            if (at[2] < 0 || at[2] >= g->side[2] || at[1] < 0 || at[1] >= g->side[1]) {
                continue;
            }
            for (int x = -ring; x <= ring; x += face || ring == 0 ? 1 : 2 * ring) {
                at[0] = middle[0] + x;
                if (at[0] >= 0 && at[0] < g->side[0]) {
                    look_in(g, query, at, b);
                }
            }
        }
    }
}

static void search(const grid *g, size_t query)
{
    int middle[3];
    const int rings = 1 + (g->side[0] > g->side[1] ? g->side[0] : g->side[1]) + g->side[2];
    best b = {{INFINITY, INFINITY}, {NONE, NONE}};
    cell_of(g, g->from->position[query], middle);
    for (int ring = 0; ring <= rings; ring++) {
        look_in_ring(g, query, middle, ring, &b);
        /* What lies outside of the rings so far is farther away than this. */
        const float reach = (float)ring * g->cell;
        if ((b.item[0] != NONE && b.squared[0] <= reach * reach) ||
            (b.item[1] != NONE && FAR_SQUARED * b.squared[1] < reach * reach)) {
            break;
        }
    }
    g->found[query] = (uint32_t)(b.item[0] != NONE ? b.item[0] : b.item[1]);
}

static void search_piece(void *context, size_t piece)
{
    const grid *g = context;
    for (size_t i = piece * PIECE; i < (piece + 1) * PIECE && i < g->from->count; i++) {
        search(g, i);
    }
}

parian_result parian_view_nearest(const parian_env *env, const parian_view_points *from,
                                  const parian_view_points *to, uint32_t *found)
{
    grid g = {.from = from, .to = to, .found = found};
    lay_out(&g);
    parian_result result = sort_in(env, &g);
    if (result == PARIAN_OK) {
        parian_par(env, (from->count + PIECE - 1) / PIECE, search_piece, &g);
    }
    parian_free(env, g.first);
    parian_free(env, g.item);
    return result;
}
