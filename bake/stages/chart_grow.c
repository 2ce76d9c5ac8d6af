/* chart_grow.c - grows charts by normal deviation from deterministic seeds, then evens them out.
 *
 * A first pass grows one chart after another from the flattest triangle left, nearest triangles
 * first, as long as they deviate little from the running average normal [Lensch02]. It leaves
 * ragged remains between charts, which are merged (chart_merge.c); then all charts are grown again
 * at the same time from their centres, as in Lloyd's method, and merged again: charts become fewer
 * and compact, and compact charts waste fewer texels on borders and gutters.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/chart.h"
#include "core/memory.h"
#include "core/small_maths.h"

/* What a chart is like while it grows: its seed and the direction its triangles are held to. */
typedef struct proxy {
    double sum[3];    /* area times normal so far */
    double centre[3]; /* what distance is measured from */
    double normal[3];
    uint32_t seed;
} proxy;

typedef struct growth {
    const parian_env *env;
    chart_set *set;
    chart_heap heap;
    double cos_angle;
    proxy *proxies;
    size_t room;
} growth;

static double distance_squared(const double a[3], const double b[3])
{
    double u[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return dot3(u, u);
}

static bool has_normal(const double v[3])
{
    return v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0;
}

static bool within_angle(const double sum[3], const double normal[3], double cosine)
{
    double size = sqrt(dot3(sum, sum));
    return size == 0.0 || !has_normal(normal) || dot3(sum, normal) >= cosine * size;
}

/* Queue the triangles next to t for a chart. Distance from the chart's centre decides, stretched
 * where the normal turns away, so that a chart takes flat ground first. */
static bool queue_neighbours(growth *g, uint32_t t, uint32_t chart)
{
    const chart_set *set = g->set;
    const proxy *p = &g->proxies[chart];
    for (int k = 0; k < 3; k++) {
        uint32_t half = set->neighbour[t][k];
        if (half == PARIAN_NO_NEIGHBOUR || set->chart[half / 3] != PARIAN_NO_CHART) {
            continue;
        }
        double turn = 1.0 - dot3(p->normal, set->normal[half / 3]);
        double cost = distance_squared(p->centre, set->centre[half / 3]) * (1.0 + 4.0 * turn);
        if (!chart_heap_push(g->env, &g->heap, cost, half / 3, chart)) {
            return false;
        }
    }
    return true;
}

static bool give(growth *g, uint32_t t, uint32_t chart)
{
    proxy *p = &g->proxies[chart];
    g->set->chart[t] = chart;
    for (int d = 0; d < 3; d++) {
        p->sum[d] += g->set->area[t] * g->set->normal[t][d];
    }
    return queue_neighbours(g, t, chart);
}

static bool add_proxy(growth *g, uint32_t seed)
{
    if (g->set->chart_count == g->room) {
        size_t room = g->room ? 2 * g->room : 64;
        proxy *grown;
        if (!PARIAN_NEW(g->env, grown, room)) {
            return false;
        }
        if (g->room) {
            memcpy(grown, g->proxies, g->room * sizeof *grown);
        }
        parian_free(g->env, g->proxies);
        g->proxies = grown;
        g->room = room;
    }
    proxy *p = &g->proxies[g->set->chart_count++];
    memset(p, 0, sizeof *p);
    p->seed = seed;
    memcpy(p->centre, g->set->centre[seed], sizeof p->centre);
    memcpy(p->normal, g->set->normal[seed], sizeof p->normal);
    return true;
}

/* Grow new charts, one after another, over the triangles that have none; seeds in the given order.
 */
static bool grow_remaining(growth *g, const chart_heap_entry *order)
{
    chart_heap_entry next;
    for (uint32_t i = 0; i < g->set->triangle_count; i++) {
        uint32_t seed = order[i].item, chart = g->set->chart_count;
        if (g->set->chart[seed] != PARIAN_NO_CHART) {
            continue;
        }
        if (!add_proxy(g, seed) || !give(g, seed, chart)) {
            return false;
        }
        while (chart_heap_pop(&g->heap, &next)) {
            if (g->set->chart[next.item] == PARIAN_NO_CHART &&
                within_angle(g->proxies[chart].sum, g->set->normal[next.item], g->cos_angle) &&
                !give(g, next.item, chart)) {
                return false;
            }
        }
    }
    return true;
}

/* Move the centre of every chart to the triangle nearest to its centroid. */
static parian_result move_centres(growth *g)
{
    chart_set *set = g->set;
    parian_result result = chart_set_list(g->env, set);
    for (uint32_t c = 0; c < set->chart_count && result == PARIAN_OK; c++) {
        proxy *p = &g->proxies[c];
        double centroid[3] = {0, 0, 0}, weight = 0.0, best = INFINITY;
        for (uint32_t i = set->chart_begin[c]; i < set->chart_begin[c + 1]; i++) {
            uint32_t t = set->chart_member[i];
            weight += set->area[t];
            for (int d = 0; d < 3; d++) {
                centroid[d] += set->area[t] * set->centre[t][d];
            }
        }
        chart_set_normal(set, c, p->sum);
        double size = sqrt(dot3(p->sum, p->sum));
        p->seed = set->chart_member[set->chart_begin[c]];
        for (int d = 0; d < 3; d++) {
            p->normal[d] = size > 0.0 ? p->sum[d] / size : 0.0;
            p->centre[d] = weight > 0.0 ? centroid[d] / weight : set->centre[p->seed][d];
        }
        for (uint32_t i = set->chart_begin[c]; i < set->chart_begin[c + 1]; i++) {
            uint32_t t = set->chart_member[i];
            double away = distance_squared(p->centre, set->centre[t]);
            if (away < best && within_angle(p->normal, set->normal[t], g->cos_angle)) {
                best = away;
                p->seed = t;
            }
        }
    }
    return result;
}

/* Grow all charts again at once, each held to its own average normal of the round before. */
static parian_result grow_together(growth *g, const chart_heap_entry *order)
{
    parian_result result = move_centres(g);
    chart_set *set = g->set;
    chart_heap_entry next;
    if (result != PARIAN_OK) {
        return result;
    }
    memset(set->chart, 0xFF, set->triangle_count * sizeof *set->chart);
    for (uint32_t c = 0; c < set->chart_count; c++) {
        memset(g->proxies[c].sum, 0, sizeof g->proxies[c].sum);
        set->chart[g->proxies[c].seed] = c;
    }
    for (uint32_t c = 0; c < set->chart_count; c++) {
        if (!give(g, g->proxies[c].seed, c)) {
            return PARIAN_E_NOMEM;
        }
    }
    while (chart_heap_pop(&g->heap, &next)) {
        if (set->chart[next.item] == PARIAN_NO_CHART &&
            within_angle(g->proxies[next.tag].normal, set->normal[next.item], g->cos_angle) &&
            !give(g, next.item, next.tag)) {
            return PARIAN_E_NOMEM;
        }
    }
    return grow_remaining(g, order) ? PARIAN_OK : PARIAN_E_NOMEM;
}

/* Order seeds by how flat the surface is around them: 1 minus the length of the mean of a
 * triangle's and its neighbours' normals. Faces of a box come before its edges. */
static chart_heap_entry *order_seeds(const parian_env *env, const chart_set *set)
{
    chart_heap heap = {NULL, 0, 0};
    chart_heap_entry *order;
    if (!PARIAN_NEW(env, order, set->triangle_count)) {
        return NULL;
    }
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        double sum[3] = {set->normal[t][0], set->normal[t][1], set->normal[t][2]}, count = 1.0;
        for (int k = 0; k < 3; k++) {
            uint32_t half = set->neighbour[t][k];
            count += half != PARIAN_NO_NEIGHBOUR;
            for (int d = 0; d < 3 && half != PARIAN_NO_NEIGHBOUR; d++) {
                sum[d] += set->normal[half / 3][d];
            }
        }
        /* Rounded, so that flat regions are ties and are taken in the order of the triangles. */
        double bend = rint((1.0 - sqrt(dot3(sum, sum)) / count) * 4096.0);
        if (!chart_heap_push(env, &heap, bend, t, 0)) {
            parian_free(env, heap.entry);
            parian_free(env, order);
            return NULL;
        }
    }
    for (uint32_t i = 0; chart_heap_pop(&heap, &order[i]); i++) {
    }
    parian_free(env, heap.entry);
    return order;
}

static parian_result finish_growth(growth *g, chart_heap_entry *order, parian_result result)
{
    if (result == PARIAN_OK) {
        result = chart_set_list(g->env, g->set);
    } else if (result == PARIAN_E_NOMEM) {
        parian_fail(g->env, result, "no memory for growing charts over %u triangles",
                    g->set->triangle_count);
    }
    parian_free(g->env, g->heap.entry);
    parian_free(g->env, g->proxies);
    parian_free(g->env, order);
    return result;
}

parian_result chart_set_grow(const parian_env *env, chart_set *set, double angle_deg)
{
    growth g = {.env = env, .set = set, .cos_angle = cos(angle_deg * PARIAN_PI / 180.0)};
    chart_heap_entry *order = order_seeds(env, set);
    set->chart_count = 0;
    bool grown = order && grow_remaining(&g, order);
    return finish_growth(&g, order, grown ? PARIAN_OK : PARIAN_E_NOMEM);
}

parian_result chart_set_relax(const parian_env *env, chart_set *set, double angle_deg)
{
    growth g = {.env = env, .set = set, .cos_angle = cos(angle_deg * PARIAN_PI / 180.0)};
    chart_heap_entry *order = order_seeds(env, set);
    uint32_t count = set->chart_count;
    bool ready = order != NULL;
    set->chart_count = 0;
    while (ready && set->chart_count < count) {
        ready = add_proxy(&g, 0);
    }
    return finish_growth(&g, order, ready ? grow_together(&g, order) : PARIAN_E_NOMEM);
}
