/* chart_surface.c - what is measured of each triangle before charts are made, and the lists of
 * charts.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/chart.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

void chart_set_free(const parian_env *env, chart_set *set)
{
    parian_free(env, set->neighbour);
    parian_free(env, set->normal);
    parian_free(env, set->centre);
    parian_free(env, set->edge);
    parian_free(env, set->area);
    parian_free(env, set->chart);
    parian_free(env, set->chart_begin);
    parian_free(env, set->chart_member);
    parian_free(env, set->flat);
    parian_free(env, set->extent);
    memset(set, 0, sizeof *set);
}

/* Area, unit normal, centroid and edge lengths of one triangle. A triangle thinner than single
 * precision resolves has no normal to speak of and counts as one without area. */
static void measure_triangle(chart_set *set, uint32_t t)
{
    double p[3][3], side[3][3], n[3], longest = 0.0;
    for (int k = 0; k < 3; k++) {
        for (int d = 0; d < 3; d++) {
            p[k][d] = (double)set->position[set->triangle[t][k]][d];
        }
    }
    for (int k = 0; k < 3; k++) {
        for (int d = 0; d < 3; d++) {
            side[k][d] = p[(k + 1) % 3][d] - p[k][d];
        }
        set->edge[t][k] = sqrt(dot3(side[k], side[k]));
        longest = fmax(longest, set->edge[t][k]);
    }
    n[0] = side[0][1] * side[1][2] - side[0][2] * side[1][1];
    n[1] = side[0][2] * side[1][0] - side[0][0] * side[1][2];
    n[2] = side[0][0] * side[1][1] - side[0][1] * side[1][0];
    double twice = sqrt(dot3(n, n));
    bool flat = twice > 1e-7 * longest * longest;
    set->area[t] = 0.5 * twice;
    for (int d = 0; d < 3; d++) {
        set->centre[t][d] = (p[0][d] + p[1][d] + p[2][d]) / 3.0;
        set->normal[t][d] = flat ? n[d] / twice : 0.0;
    }
}

parian_result chart_set_create(const parian_env *env, const parian_body *body, chart_set *set)
{
    uint32_t count = body->triangle_count;
    memset(set, 0, sizeof *set);
    set->triangle_count = count;
    set->triangle = (const uint32_t(*)[3])body->triangle;
    set->position = (const float(*)[3])body->vertex_position;
    if (!PARIAN_NEW(env, set->neighbour, count) || !PARIAN_NEW(env, set->normal, count) ||
        !PARIAN_NEW(env, set->centre, count) || !PARIAN_NEW(env, set->edge, count) ||
        !PARIAN_NEW(env, set->area, count) || !PARIAN_NEW(env, set->chart, count) ||
        !PARIAN_NEW(env, set->chart_member, count)) {
        chart_set_free(env, set);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the charts of %u triangles", count);
    }
    parian_result result =
        parian_triangle_neighbours(env, body->vertex_count, count, set->triangle, set->neighbour);
    for (uint32_t t = 0; t < count && result == PARIAN_OK; t++) {
        measure_triangle(set, t);
        set->area_total += set->area[t];
        set->chart[t] = PARIAN_NO_CHART;
    }
    if (result != PARIAN_OK) {
        chart_set_free(env, set);
    }
    return result;
}

parian_result chart_set_list(const parian_env *env, chart_set *set)
{
    uint32_t *number = NULL, next = 0;
    uint32_t old_count = set->chart_count;
    parian_free(env, set->chart_begin);
    set->chart_begin = NULL;
    if (!PARIAN_NEW(env, number, old_count) ||
        !PARIAN_NEW0(env, set->chart_begin, (size_t)old_count + 2)) {
        parian_free(env, number);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the lists of %u charts", old_count);
    }
    memset(number, 0xFF, old_count * sizeof *number);
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        uint32_t *given = &number[set->chart[t]];
        if (*given == PARIAN_NO_CHART) {
            *given = next++;
        }
        set->chart[t] = *given;
        set->chart_begin[*given + 2]++;
    }
    for (uint32_t c = 0; c < next; c++) {
        set->chart_begin[c + 1] += set->chart_begin[c];
    }
    for (uint32_t t = 0; t < set->triangle_count; t++) {
        set->chart_member[set->chart_begin[set->chart[t] + 1]++] = t;
    }
    set->chart_count = next;
    parian_free(env, number);
    return PARIAN_OK;
}

void chart_set_normal(const chart_set *set, uint32_t chart, double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0.0;
    for (uint32_t i = set->chart_begin[chart]; i < set->chart_begin[chart + 1]; i++) {
        uint32_t t = set->chart_member[i];
        for (int d = 0; d < 3; d++) {
            sum[d] += set->area[t] * set->normal[t][d];
        }
    }
}

void chart_frame(const double normal[3], double tangent[3], double bitangent[3])
{
    /* Cross with the axis that the normal leans least on. */
    int axis = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    axis = fabs(normal[2]) < fabs(normal[axis]) ? 2 : axis;
    double helper[3] = {axis == 0, axis == 1, axis == 2};
    tangent[0] = helper[1] * normal[2] - helper[2] * normal[1];
    tangent[1] = helper[2] * normal[0] - helper[0] * normal[2];
    tangent[2] = helper[0] * normal[1] - helper[1] * normal[0];
    double length = sqrt(dot3(tangent, tangent));
    for (int d = 0; d < 3; d++) {
        tangent[d] /= length;
    }
    bitangent[0] = normal[1] * tangent[2] - normal[2] * tangent[1];
    bitangent[1] = normal[2] * tangent[0] - normal[0] * tangent[2];
    bitangent[2] = normal[0] * tangent[1] - normal[1] * tangent[0];
}

static bool comes_before(const chart_heap_entry *a, const chart_heap_entry *b)
{
    if (a->cost != b->cost) {
        return a->cost < b->cost;
    }
    return a->item != b->item ? a->item < b->item : a->tag < b->tag;
}

bool chart_heap_push(const parian_env *env, chart_heap *heap, double cost, uint32_t item,
                     uint32_t tag)
{
    if (heap->count == heap->room) {
        size_t room = heap->room ? 2 * heap->room : 256;
        chart_heap_entry *grown;
        if (!PARIAN_NEW(env, grown, room)) {
            return false;
        }
        if (heap->count) {
            memcpy(grown, heap->entry, heap->count * sizeof *grown);
        }
        parian_free(env, heap->entry);
        heap->entry = grown;
        heap->room = room;
    }
    chart_heap_entry added = {cost, item, tag};
    size_t i = heap->count++;
    while (i > 0 && comes_before(&added, &heap->entry[(i - 1) / 2])) {
        heap->entry[i] = heap->entry[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    heap->entry[i] = added;
    return true;
}

bool chart_heap_pop(chart_heap *heap, chart_heap_entry *out)
{
    if (heap->count == 0) {
        return false;
    }
    *out = heap->entry[0];
    chart_heap_entry moved = heap->entry[--heap->count];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < heap->count; i = child) {
        if (child + 1 < heap->count && comes_before(&heap->entry[child + 1], &heap->entry[child])) {
            child++;
        }
        if (!comes_before(&heap->entry[child], &moved)) {
            break;
        }
        heap->entry[i] = heap->entry[child];
    }
    heap->entry[i] = moved;
    return true;
}
