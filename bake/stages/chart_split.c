/* chart_split.c - finds charts whose orthographic projection overlaps itself (spirals, folds) and
 * cuts them.
 *
 * A chart is built up once more from its middle outwards; a triangle whose projection overlaps one
 * that is already there, or that turns away from the plane, stays out. What stays out makes new
 * charts, which are treated alike until nothing overlaps.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/chart.h"
#include "core/memory.h"

static const double COS_STEEPEST = 0.25882; /* 75 degrees: stretch of 3.9 */

enum { OUTSIDE = 0, INSIDE = 1 };

/* Triangles of one chart in its plane, filed in a grid of square cells. */
typedef struct plane_grid {
    double lower[2], cell;
    uint32_t width, height;
    uint32_t *head; /* [width * height] first entry, or PARIAN_NO_CHART */
    struct {
        uint32_t triangle, next;
    } * entry;
    size_t count, room;
} plane_grid;

typedef struct splitter {
    const parian_env *env;
    chart_set *set;
    double (*plane)[3][2]; /* [triangle_count] corners in the plane of the chart at hand */
    uint8_t *state;        /* [triangle_count] of the chart at hand */
    plane_grid grid;
    chart_heap heap;
} splitter;

static void project_chart(splitter *s, uint32_t chart, double normal[3])
{
    const chart_set *set = s->set;
    double tangent[3], bitangent[3];
    chart_set_normal(set, chart, normal);
    double size = sqrt(dot3(normal, normal));
    for (int d = 0; d < 3; d++) {
        normal[d] = size > 0.0 ? normal[d] / size : d == 2;
    }
    chart_frame(normal, tangent, bitangent);
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        uint32_t t = set->chart_member[i];
        s->state[t] = OUTSIDE;
        for (int k = 0; k < 3; k++) {
            double p[3];
            for (int d = 0; d < 3; d++) {
                p[d] = (double)set->position[set->triangle[t][k]][d];
            }
            s->plane[t][k][0] = dot3(p, tangent);
            s->plane[t][k][1] = dot3(p, bitangent);
        }
    }
}

/* Lay an empty grid over a chart, with about one triangle to a cell. */
static bool make_grid(splitter *s, uint32_t chart)
{
    const chart_set *set = s->set;
    plane_grid *grid = &s->grid;
    double upper[2] = {-INFINITY, -INFINITY};
    uint32_t count = set->chart_begin[chart + 1] - set->chart_begin[chart];
    grid->lower[0] = grid->lower[1] = INFINITY;
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        for (int k = 0; k < 6; k++) {
            double x = s->plane[set->chart_member[i]][k / 2][k % 2];
            grid->lower[k % 2] = fmin(grid->lower[k % 2], x);
            upper[k % 2] = fmax(upper[k % 2], x);
        }
    }
    double size[2] = {upper[0] - grid->lower[0], upper[1] - grid->lower[1]};
    grid->cell = fmax(sqrt(size[0] * size[1] / count), fmax(size[0], size[1]) / (count + 1.0));
    grid->cell = grid->cell > 0.0 ? grid->cell : 1.0;
    grid->width = 1 + (uint32_t)fmin(size[0] / grid->cell, count + 1.0);
    grid->height = 1 + (uint32_t)fmin(size[1] / grid->cell, count + 1.0);
    grid->count = 0;
    parian_free(s->env, grid->head);
    grid->head = NULL;
    if (!PARIAN_NEW(s->env, grid->head, (size_t)grid->width * grid->height)) {
        return false;
    }
    memset(grid->head, 0xFF, (size_t)grid->width * grid->height * sizeof *grid->head);
    return true;
}

static void cell_range(const plane_grid *grid, const double corner[3][2], uint32_t low[2],
                       uint32_t high[2])
{
    for (int d = 0; d < 2; d++) {
        double limit = (double)(d ? grid->height : grid->width) - 1.0;
        double least = fmin(corner[0][d], fmin(corner[1][d], corner[2][d])) - grid->lower[d];
        double most = fmax(corner[0][d], fmax(corner[1][d], corner[2][d])) - grid->lower[d];
        low[d] = (uint32_t)fmin(fmax(least / grid->cell, 0.0), limit);
        high[d] = (uint32_t)fmin(fmax(most / grid->cell, 0.0), limit);
    }
}

/* Some edge of a has all of b on its outer side, within the tolerance. */
static bool edge_separates(const double a[3][2], const double b[3][2], double tolerance)
{
    for (int k = 0; k < 3; k++) {
        const double *p = a[k], *q = a[(k + 1) % 3];
        double along[2] = {q[0] - p[0], q[1] - p[1]}, most = -INFINITY;
        double length = sqrt(along[0] * along[0] + along[1] * along[1]);
        for (int j = 0; j < 3; j++) {
            most = fmax(most, along[0] * (b[j][1] - p[1]) - along[1] * (b[j][0] - p[0]));
        }
        if (length > 0.0 && most <= tolerance * length) {
            return true;
        }
    }
    return false;
}

/* True when the counterclockwise triangle t overlaps one that is inside by more than a rounding. */
static bool overlaps(const splitter *s, uint32_t t)
{
    const plane_grid *grid = &s->grid;
    uint32_t low[2], high[2];
    cell_range(grid, (const double(*)[2])s->plane[t], low, high);
    for (uint32_t y = low[1]; y <= high[1]; y++) {
        for (uint32_t x = low[0]; x <= high[0]; x++) {
            uint32_t e = grid->head[(size_t)y * grid->width + x];
            for (; e != PARIAN_NO_CHART; e = grid->entry[e].next) {
                uint32_t other = grid->entry[e].triangle;
                const double(*a)[2] = (const double(*)[2])s->plane[t];
                const double(*b)[2] = (const double(*)[2])s->plane[other];
                double tolerance = 1e-5 * fmin(s->set->edge[t][0], s->set->edge[other][0]);
                if (!edge_separates(a, b, tolerance) && !edge_separates(b, a, tolerance)) {
                    return true;
                }
            }
        }
    }
    return false;
}

static bool file_triangle(splitter *s, uint32_t t)
{
    plane_grid *grid = &s->grid;
    uint32_t low[2], high[2];
    cell_range(grid, (const double(*)[2])s->plane[t], low, high);
    size_t needed = grid->count + (size_t)(high[0] - low[0] + 1) * (high[1] - low[1] + 1);
    if (needed > grid->room) {
        size_t room = needed + grid->room + 1024;
        void *grown = parian_alloc(s->env, room, sizeof *grid->entry);
        if (!grown) {
            return false;
        }
        if (grid->count) {
            memcpy(grown, grid->entry, grid->count * sizeof *grid->entry);
        }
        parian_free(s->env, grid->entry);
        grid->entry = grown;
        grid->room = room;
    }
    for (uint32_t y = low[1]; y <= high[1]; y++) {
        for (uint32_t x = low[0]; x <= high[0]; x++) {
            uint32_t *head = &grid->head[(size_t)y * grid->width + x];
            grid->entry[grid->count].triangle = t;
            grid->entry[grid->count].next = *head;
            *head = (uint32_t)grid->count++;
        }
    }
    return true;
}

/* The triangle that faces the plane well and is nearest to the middle of the chart. */
static uint32_t middle_triangle(const splitter *s, uint32_t chart, const double normal[3])
{
    const chart_set *set = s->set;
    double middle[3] = {0, 0, 0}, weight = 0.0, best = INFINITY, best_facing = -2.0;
    uint32_t found = PARIAN_NO_CHART, facing = set->chart_member[set->chart_begin[chart]];
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        uint32_t t = set->chart_member[i];
        weight += set->area[t];
        for (int d = 0; d < 3; d++) {
            middle[d] += set->area[t] * set->centre[t][d];
        }
    }
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        uint32_t t = set->chart_member[i];
        double away = 0.0, cosine = dot3(set->normal[t], normal);
        for (int d = 0; d < 3 && weight > 0.0; d++) {
            double x = set->centre[t][d] - middle[d] / weight;
            away += x * x;
        }
        if (cosine > best_facing) {
            best_facing = cosine;
            facing = t;
        }
        if (cosine > COS_STEEPEST && away < best) {
            best = away;
            found = t;
        }
    }
    return found != PARIAN_NO_CHART ? found : facing;
}

static bool queue_outside(splitter *s, uint32_t chart, uint32_t t, uint32_t start)
{
    for (int k = 0; k < 3; k++) {
        uint32_t half = s->set->neighbour[t][k], other = half / 3;
        if (half == PARIAN_NO_NEIGHBOUR || s->set->chart[other] != chart ||
            s->state[other] == INSIDE) {
            continue;
        }
        double u[3];
        for (int d = 0; d < 3; d++) {
            u[d] = s->set->centre[other][d] - s->set->centre[start][d];
        }
        if (!chart_heap_push(s->env, &s->heap, dot3(u, u), other, 0)) {
            return false;
        }
    }
    return true;
}

/* Build a chart up from its middle; inside counts the triangles that fit. */
static bool build_up(splitter *s, uint32_t chart, uint32_t *inside)
{
    double normal[3];
    chart_heap_entry next;
    project_chart(s, chart, normal);
    uint32_t start = middle_triangle(s, chart, normal);
    *inside = 0;
    if (!make_grid(s, chart) || !chart_heap_push(s->env, &s->heap, 0.0, start, 0)) {
        return false;
    }
    while (chart_heap_pop(&s->heap, &next)) {
        uint32_t t = next.item;
        const double *n = s->set->normal[t];
        bool thin = dot3(n, n) == 0.0;
        if (s->state[t] == INSIDE ||
            (t != start && !thin && (dot3(n, normal) < COS_STEEPEST || overlaps(s, t)))) {
            continue;
        }
        s->state[t] = INSIDE;
        ++*inside;
        if ((!thin && !file_triangle(s, t)) || !queue_outside(s, chart, t, start)) {
            return false;
        }
    }
    return true;
}

/* Give the triangles of a chart that stayed outside new chart numbers, one for each connected
 * piece. */
static bool renumber_outside(splitter *s, uint32_t chart, uint32_t *next_chart)
{
    chart_set *set = s->set;
    chart_heap_entry next;
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        uint32_t seed = set->chart_member[i];
        if (s->state[seed] == INSIDE || set->chart[seed] != chart) {
            continue;
        }
        uint32_t piece = (*next_chart)++;
        set->chart[seed] = piece;
        if (!chart_heap_push(s->env, &s->heap, 0.0, seed, 0)) {
            return false;
        }
        while (chart_heap_pop(&s->heap, &next)) {
            for (int k = 0; k < 3; k++) {
                uint32_t half = set->neighbour[next.item][k], other = half / 3;
                if (half != PARIAN_NO_NEIGHBOUR && set->chart[other] == chart &&
                    s->state[other] == OUTSIDE) {
                    set->chart[other] = piece;
                    if (!chart_heap_push(s->env, &s->heap, 0.0, other, 0)) {
                        return false;
                    }
                }
            }
        }
    }
    return true;
}

/* One round over all charts that are not yet known to be sound. */
static parian_result split_round(splitter *s, uint8_t *sound, bool *changed)
{
    chart_set *set = s->set;
    uint32_t next_chart = set->chart_count;
    *changed = false;
    for (uint32_t c = 0; c < set->chart_count; c++) {
        uint32_t first = set->chart_member[set->chart_begin[c]], inside;
        uint32_t count = set->chart_begin[c + 1] - set->chart_begin[c];
        if (sound[first]) {
            continue;
        }
        if (!build_up(s, c, &inside)) {
            return PARIAN_E_NOMEM;
        }
        for (uint32_t i = 0; i < count && inside == count; i++) {
            sound[set->chart_member[set->chart_begin[c] + i]] = 1;
        }
        if (inside < count) {
            *changed = true;
            if (!renumber_outside(s, c, &next_chart)) {
                return PARIAN_E_NOMEM;
            }
        }
    }
    set->chart_count = next_chart;
    return chart_set_list(s->env, set);
}

parian_result chart_set_split(const parian_env *env, chart_set *set)
{
    splitter s = {.env = env, .set = set};
    uint8_t *sound = NULL;
    bool changed = true;
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW(env, s.plane, set->triangle_count) ||
        !PARIAN_NEW(env, s.state, set->triangle_count) ||
        !PARIAN_NEW0(env, sound, set->triangle_count)) {
        result = PARIAN_E_NOMEM;
    }
    while (changed && result == PARIAN_OK) {
        result = parian_cancelled(env) ? PARIAN_E_INTERRUPTED : split_round(&s, sound, &changed);
    }
    if (result == PARIAN_E_NOMEM) {
        parian_fail(env, result, "no memory for the overlap test of %u charts", set->chart_count);
    }
    parian_free(env, s.heap.entry);
    parian_free(env, s.grid.entry);
    parian_free(env, s.grid.head);
    parian_free(env, s.state);
    parian_free(env, s.plane);
    parian_free(env, sound);
    return result;
}
