/* chart_merge.c - joins neighbouring charts: fewer charts have fewer borders and gutters.
 *
 * Two charts may become one when all their triangles stay within the angle of the common average
 * normal and the union is compact. What is small afterwards (noise, creases) joins a neighbour at
 * wider angles, the smaller the wider: a few texels stretched by two cost less than a chart of a
 * few texels, which is nothing but border.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/chart.h"
#include "core/memory.h"
#include "core/small_maths.h"

/* Charts below a share of the surface may be joined up to a multiple of the angle. */
static const struct {
    double share, widening;
} SMALL_CHARTS[] = {{1.0 / 100, 1.2}, {1.0 / 200, 1.4}, {1.0 / 500, 1.6}, {1.0 / 1400, 1.9}};
static const double ANGLE_MAX_DEG = 72.0; /* stretch of 3.2; below the limit of chart_split.c */
static const double ROUNDNESS_MAX =
    2.6; /* perimeter^2 / (4 pi area); a square has 1.27, a 1:4 strip 2 */

typedef struct region {
    double sum[3], area, perimeter;
    uint32_t first, last; /* linked list of triangles */
    uint32_t version;     /* counts changes; PARIAN_NO_CHART when joined to another */
} region;

typedef struct region_pair {
    uint32_t a, b, version_a, version_b;
    double shared; /* length of the common border */
} region_pair;

typedef struct merger {
    const parian_env *env;
    chart_set *set;
    region *regions;
    uint32_t *next; /* [triangle_count] linked lists */
    double *
        shared; /* [chart_count] scratch: common border with the chart at hand, zero between uses */
    uint32_t *touched; /* [chart_count] scratch */
    region_pair *pairs;
    uint32_t pair_count, pair_room;
    chart_heap heap;
    double cos_angle, tiny_area; /* of the pass; tiny_area 0: compact unions of any size */
} merger;

static double joined_roundness(const merger *m, const region_pair *pair)
{
    const region *a = &m->regions[pair->a], *b = &m->regions[pair->b];
    double perimeter = a->perimeter + b->perimeter - 2.0 * pair->shared;
    return perimeter * perimeter / (4.0 * PARIAN_PI * fmax(a->area + b->area, 1e-300));
}

static bool queue_pair(merger *m, uint32_t a, uint32_t b, double shared)
{
    const region *p = &m->regions[a], *q = &m->regions[b];
    region_pair pair = {a, b, p->version, q->version, shared};
    double cost = joined_roundness(m, &pair);
    if (m->tiny_area > 0.0) {
        if (fmin(p->area, q->area) >= m->tiny_area) {
            return true;
        }
    } else {
        double before = fmax(p->perimeter * p->perimeter / fmax(p->area, 1e-300),
                             q->perimeter * q->perimeter / fmax(q->area, 1e-300)) /
                        (4.0 * PARIAN_PI);
        if (cost > fmax(ROUNDNESS_MAX, 0.8 * before)) {
            return true;
        }
    }
    if (m->pair_count == m->pair_room) {
        uint32_t room = m->pair_room ? 2 * m->pair_room : 1024;
        region_pair *grown;
        if (!PARIAN_NEW(m->env, grown, room)) {
            return false;
        }
        if (m->pair_count) {
            memcpy(grown, m->pairs, m->pair_count * sizeof *grown);
        }
        parian_free(m->env, m->pairs);
        m->pairs = grown;
        m->pair_room = room;
    }
    m->pairs[m->pair_count] = pair;
    return chart_heap_push(m->env, &m->heap, cost, m->pair_count++, 0);
}

/* Queue the pairs of a chart with its neighbours; with those of a higher number only, when all are
 * queued. */
static bool queue_chart(merger *m, uint32_t chart, bool higher_only)
{
    uint32_t count = 0;
    for (uint32_t t = m->regions[chart].first; t != PARIAN_NO_CHART; t = m->next[t]) {
        for (int k = 0; k < 3; k++) {
            uint32_t half = m->set->neighbour[t][k];
            uint32_t other = half == PARIAN_NO_NEIGHBOUR ? chart : m->set->chart[half / 3];
            if (other == chart || (higher_only && other < chart)) {
                continue;
            }
            if (m->shared[other] == 0.0) {
                m->touched[count++] = other;
            }
            m->shared[other] += fmax(m->set->edge[t][k], 1e-300);
        }
    }
    bool fine = true;
    for (uint32_t i = 0; i < count; i++) {
        fine = fine && queue_pair(m, chart, m->touched[i], m->shared[m->touched[i]]);
        m->shared[m->touched[i]] = 0.0;
    }
    return fine;
}

static bool angles_allow(const merger *m, uint32_t chart, const double normal[3])
{
    for (uint32_t t = m->regions[chart].first; t != PARIAN_NO_CHART; t = m->next[t]) {
        const double *n = m->set->normal[t];
        if (dot3(n, normal) < m->cos_angle && dot3(n, n) > 0.0) {
            return false;
        }
    }
    return true;
}

static bool may_join(const merger *m, const region_pair *pair)
{
    const region *a = &m->regions[pair->a], *b = &m->regions[pair->b];
    double normal[3];
    for (int d = 0; d < 3; d++) {
        normal[d] = a->sum[d] + b->sum[d];
    }
    double size = sqrt(dot3(normal, normal));
    for (int d = 0; d < 3 && size > 0.0; d++) {
        normal[d] /= size;
    }
    bool a_first = a->area < b->area;
    return angles_allow(m, a_first ? pair->a : pair->b, normal) &&
           angles_allow(m, a_first ? pair->b : pair->a, normal);
}

static void join_regions(merger *m, const region_pair *pair)
{
    region *a = &m->regions[pair->a], *b = &m->regions[pair->b];
    for (uint32_t t = b->first; t != PARIAN_NO_CHART; t = m->next[t]) {
        m->set->chart[t] = pair->a;
    }
    m->next[a->last] = b->first;
    a->last = b->last;
    a->area += b->area;
    a->perimeter += b->perimeter - 2.0 * pair->shared;
    for (int d = 0; d < 3; d++) {
        a->sum[d] += b->sum[d];
    }
    a->version++;
    b->version = PARIAN_NO_CHART;
}

static parian_result merge_pass(merger *m, double angle_deg, double tiny_area)
{
    chart_heap_entry entry;
    m->cos_angle = cos(angle_deg * PARIAN_PI / 180.0);
    m->tiny_area = tiny_area;
    m->pair_count = 0;
    for (uint32_t c = 0; c < m->set->chart_count; c++) {
        if (m->regions[c].version != PARIAN_NO_CHART && !queue_chart(m, c, true)) {
            return PARIAN_E_NOMEM;
        }
    }
    while (chart_heap_pop(&m->heap, &entry)) {
        region_pair pair = m->pairs[entry.item];
        if (m->regions[pair.a].version != pair.version_a ||
            m->regions[pair.b].version != pair.version_b || !may_join(m, &pair)) {
            continue;
        }
        join_regions(m, &pair);
        if (!queue_chart(m, pair.a, false)) {
            return PARIAN_E_NOMEM;
        }
    }
    return PARIAN_OK;
}

static void make_regions(merger *m)
{
    const chart_set *set = m->set;
    for (uint32_t c = 0; c < set->chart_count; c++) {
        region *r = &m->regions[c];
        memset(r, 0, sizeof *r);
        chart_set_normal(set, c, r->sum);
        r->first = set->chart_member[set->chart_begin[c]];
        r->last = set->chart_member[set->chart_begin[c + 1] - 1];
        for (uint32_t i = set->chart_begin[c]; i < set->chart_begin[c + 1]; i++) {
            uint32_t t = set->chart_member[i];
            m->next[t] = t == r->last ? PARIAN_NO_CHART : set->chart_member[i + 1];
            r->area += set->area[t];
            for (int k = 0; k < 3; k++) {
                uint32_t half = set->neighbour[t][k];
                bool inside = half != PARIAN_NO_NEIGHBOUR && set->chart[half / 3] == c;
                r->perimeter += inside ? 0.0 : set->edge[t][k];
            }
        }
    }
}

/* Give a triangle that juts out between two triangles of one other chart to that chart: straighter
 * borders. It has one neighbour of its own chart at most, so its chart stays in one piece. */
static void straighten_borders(chart_set *set, double cos_angle)
{
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        uint32_t other[3] = {PARIAN_NO_CHART, PARIAN_NO_CHART, PARIAN_NO_CHART};
        double sum[3];
        for (int k = 0; k < 3; k++) {
            uint32_t half = set->neighbour[t][k];
            other[k] = half == PARIAN_NO_NEIGHBOUR ? PARIAN_NO_CHART : set->chart[half / 3];
        }
        uint32_t to = other[0] == other[1] || other[0] == other[2] ? other[0] : other[1];
        bool twice = (other[0] == to) + (other[1] == to) + (other[2] == to) >= 2;
        if (!twice || to == PARIAN_NO_CHART || to == set->chart[t]) {
            continue;
        }
        chart_set_normal(set, to, sum);
        if (dot3(sum, set->normal[t]) >= cos_angle * sqrt(dot3(sum, sum))) {
            set->chart[t] = to;
        }
    }
}

static parian_result straighten(const parian_env *env, chart_set *set, double angle_deg)
{
    parian_result result = PARIAN_OK;
    for (int round = 0; round < 2 && result == PARIAN_OK; round++) {
        straighten_borders(set, cos(angle_deg * PARIAN_PI / 180.0));
        result = chart_set_list(env, set);
    }
    return result;
}

parian_result chart_set_merge(const parian_env *env, chart_set *set, double angle_deg)
{
    merger m = {.env = env, .set = set};
    parian_result result = PARIAN_E_NOMEM;
    if (PARIAN_NEW(env, m.regions, set->chart_count) &&
        PARIAN_NEW(env, m.next, set->triangle_count) &&
        PARIAN_NEW0(env, m.shared, set->chart_count) &&
        PARIAN_NEW(env, m.touched, set->chart_count)) {
        make_regions(&m);
        result = merge_pass(&m, fmin(angle_deg, ANGLE_MAX_DEG), 0.0);
        for (size_t i = 0; i < sizeof SMALL_CHARTS / sizeof *SMALL_CHARTS && result == PARIAN_OK;
             i++) {
            result = merge_pass(&m, fmin(SMALL_CHARTS[i].widening * angle_deg, ANGLE_MAX_DEG),
                                SMALL_CHARTS[i].share * set->area_total);
        }
    }
    if (result == PARIAN_OK) {
        result = chart_set_list(env, set);
    } else {
        parian_fail(env, result, "no memory for merging %u charts", set->chart_count);
    }
    parian_free(env, m.heap.entry);
    parian_free(env, m.pairs);
    parian_free(env, m.touched);
    parian_free(env, m.shared);
    parian_free(env, m.next);
    parian_free(env, m.regions);
    return result == PARIAN_OK ? straighten(env, set, fmin(angle_deg, ANGLE_MAX_DEG)) : result;
}
