/* chart_flatten.c - projects charts along their average normals and turns each to its minimal
 * rectangle.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/adapters/cgal_rectangle.h"
#include "bake/stages/chart.h"
#include "core/memory.h"

/* Orthographic projection; points: [3 * triangles of the chart]. Charts without area fall on one
 * point. */
static void project(const chart_set *set, uint32_t chart, double (*points)[2])
{
    double normal[3], tangent[3], bitangent[3], size;
    chart_set_normal(set, chart, normal);
    size = sqrt(dot3(normal, normal));
    uint32_t begin = set->chart_begin[chart], count = set->chart_begin[chart + 1] - begin;
    if (!(size > 0.0)) {
        memset(points, 0, 3 * (size_t)count * sizeof *points);
        return;
    }
    for (int d = 0; d < 3; d++) {
        normal[d] /= size;
    }
    chart_frame(normal, tangent, bitangent);
    const float *origin = set->position[set->triangle[set->chart_member[begin]][0]];
    for (uint32_t i = 0; i < 3 * count; i++) {
        const float *p = set->position[set->triangle[set->chart_member[begin + i / 3]][i % 3]];
        double u[3];
        for (int d = 0; d < 3; d++) {
            u[d] = (double)p[d] - (double)origin[d];
        }
        points[i][0] = dot3(u, tangent);
        points[i][1] = dot3(u, bitangent);
    }
}

/* Turn the points so that the axis becomes u, move them to the origin, and file them as corners. */
static void store(chart_set *set, uint32_t chart, double (*points)[2], const double axis[2])
{
    uint32_t begin = set->chart_begin[chart], count = set->chart_begin[chart + 1] - begin;
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < 3 * count; i++) {
        double x = points[i][0], y = points[i][1];
        points[i][0] = axis[0] * x + axis[1] * y;
        points[i][1] = axis[0] * y - axis[1] * x;
        for (int d = 0; d < 2; d++) {
            low[d] = fmin(low[d], points[i][d]);
            high[d] = fmax(high[d], points[i][d]);
        }
    }
    for (uint32_t i = 0; i < 3 * count; i++) {
        for (int d = 0; d < 2; d++) {
            set->flat[set->chart_member[begin + i / 3]][i % 3][d] = points[i][d] - low[d];
        }
    }
    set->extent[chart][0] = high[0] - low[0];
    set->extent[chart][1] = high[1] - low[1];
}

parian_result chart_set_flatten(const parian_env *env, chart_set *set)
{
    double(*points)[2] = NULL;
    parian_result result = PARIAN_OK;
    parian_free(env, set->flat);
    parian_free(env, set->extent);
    set->flat = NULL;
    set->extent = NULL;
    if (!PARIAN_NEW(env, points, 3 * (size_t)set->triangle_count) ||
        !PARIAN_NEW(env, set->flat, set->triangle_count) ||
        !PARIAN_NEW(env, set->extent, set->chart_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for flattening %u triangles",
                             set->triangle_count);
    }
    for (uint32_t c = 0; c < set->chart_count && result == PARIAN_OK; c++) {
        double axis[2];
        project(set, c, points);
        result = parian_minimal_rectangle(
            env, 3 * (size_t)(set->chart_begin[c + 1] - set->chart_begin[c]),
            (const double(*)[2])points, axis);
        if (result == PARIAN_OK) {
            store(set, c, points, axis);
        }
    }
    parian_free(env, points);
    return result;
}
