/* import_polygons.c - splits polygons into triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/import_polygons.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

enum {
    BEST_EAR_MAX = 64
}; /* up to here the ear with the shortest cut is taken, beyond it the first */

static const uint64_t test_budget = 1000000000u; /* point-in-ear tests for one file: seconds */

typedef struct splitter {
    const parian_polygons *polygons;
    parian_mesh *mesh;
    uint32_t *ring;    /* corners left of the current polygon */
    double (*flat)[2]; /* their positions in its plane */
    uint32_t ring_count;
    uint64_t tests;
    uint32_t fans;
} splitter;

static void emit(splitter *split, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *triangle = split->mesh->triangle[split->mesh->triangle_count++];
    triangle[0] = split->ring[a];
    triangle[1] = split->ring[b];
    triangle[2] = split->ring[c];
}

/* Load a polygon without repeated corners, seen along the longest axis of its Newell normal. */
static void load_ring(splitter *split, const uint32_t *corner, uint32_t count)
{
    double normal[3] = {0, 0, 0};
    split->ring_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (corner[i] != corner[(i + count - 1) % count]) {
            split->ring[split->ring_count++] = corner[i];
        }
    }
    for (uint32_t i = 0; i < split->ring_count; i++) {
        const double *a = split->polygons->position[split->ring[i]];
        const double *b = split->polygons->position[split->ring[(i + 1) % split->ring_count]];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += (a[u] - b[u]) * (a[v] + b[v]);
        }
    }
    int axis = fabs(normal[0]) > fabs(normal[1]) ? 0 : 1;
    axis = fabs(normal[2]) > fabs(normal[axis]) ? 2 : axis;
    double sign = normal[axis] < 0 ? -1 : 1;
    for (uint32_t i = 0; i < split->ring_count; i++) {
        const double *p = split->polygons->position[split->ring[i]];
        split->flat[i][0] = sign * p[(axis + 1) % 3];
        split->flat[i][1] = p[(axis + 2) % 3];
    }
}

/* Twice the signed area of a flat triangle. */
static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool is_ear(splitter *split, uint32_t i)
{
    uint32_t n = split->ring_count, before = (i + n - 1) % n, after = (i + 1) % n;
    const double *a = split->flat[before], *b = split->flat[i], *c = split->flat[after];
    if (!(turn(a, b, c) > 0)) {
        return false;
    }
    for (uint32_t k = 0; k < n; k++) {
        const double *p = split->flat[k];
        uint32_t corner = split->ring[k];
        split->tests++;
        if (corner == split->ring[before] || corner == split->ring[i] ||
            corner == split->ring[after]) {
            continue;
        }
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) {
            return false;
        }
    }
    return true;
}

static double cut_length(const splitter *split, uint32_t i)
{
    uint32_t n = split->ring_count;
    const double *a = split->polygons->position[split->ring[(i + n - 1) % n]];
    const double *c = split->polygons->position[split->ring[(i + 1) % n]];
    double d[3] = {a[0] - c[0], a[1] - c[1], a[2] - c[2]};
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* An ear of the ring, or ring_count where there is none (flat or crossing itself). */
static uint32_t find_ear(splitter *split)
{
    uint32_t best = split->ring_count;
    double best_length = HUGE_VAL;
    for (uint32_t i = 0; i < split->ring_count; i++) {
        double length = cut_length(split, i);
        if (length < best_length && is_ear(split, i)) {
            best = i;
            best_length = length;
            if (split->ring_count > BEST_EAR_MAX) {
                break;
            }
        }
    }
    return best;
}

static void remove_corner(splitter *split, uint32_t i)
{
    uint32_t behind = split->ring_count - i - 1;
    memmove(&split->ring[i], &split->ring[i + 1], behind * sizeof *split->ring);
    memmove(&split->flat[i], &split->flat[i + 1], behind * sizeof *split->flat);
    split->ring_count--;
}

static void split_polygon(splitter *split, const uint32_t *corner, uint32_t count)
{
    load_ring(split, corner, count);
    while (split->ring_count > 3) {
        uint32_t ear = split->tests < test_budget ? find_ear(split) : split->ring_count;
        if (ear == split->ring_count) {
            split->fans++;
            break;
        }
        emit(split, (ear + split->ring_count - 1) % split->ring_count, ear,
             (ear + 1) % split->ring_count);
        remove_corner(split, ear);
    }
    for (uint32_t i = 2; i < split->ring_count; i++) {
        emit(split, 0, i - 1, i);
    }
}

static parian_result allocate(const parian_env *env, splitter *split, parian_mesh *mesh)
{
    const parian_polygons *polygons = split->polygons;
    uint64_t triangle_count = 0;
    uint32_t longest = 0;
    for (uint32_t i = 0; i < polygons->polygon_count; i++) {
        uint32_t count = polygons->offset[i + 1] - polygons->offset[i];
        triangle_count += count >= 3 ? count - 2 : 0;
        longest = count > longest ? count : longest;
    }
    if (triangle_count > INT32_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT, "%llu triangles, expected at most 2^31 - 1",
                           (unsigned long long)triangle_count);
    }
    if (!PARIAN_NEW(env, mesh->triangle, triangle_count) ||
        !PARIAN_NEW(env, mesh->position, polygons->vertex_count) ||
        !PARIAN_NEW(env, split->ring, longest) || !PARIAN_NEW(env, split->flat, longest)) {
        return parian_fail(env, PARIAN_E_NOMEM, "out of memory for %llu triangles",
                           (unsigned long long)triangle_count);
    }
    return PARIAN_OK;
}

parian_result parian_triangulate(const parian_env *env, const char *name,
                                 const parian_polygons *polygons, parian_mesh *mesh)
{
    parian_mesh made = {0};
    splitter split = {.polygons = polygons, .mesh = &made};
    parian_result result = allocate(env, &split, &made);
    if (result == PARIAN_OK) {
        made.vertex_count = polygons->vertex_count;
        if (made.vertex_count > 0) {
            memcpy(made.position, polygons->position, made.vertex_count * sizeof *made.position);
        }
        for (uint32_t i = 0; i < polygons->polygon_count; i++) {
            uint32_t first = polygons->offset[i];
            split_polygon(&split, &polygons->corner[first], polygons->offset[i + 1] - first);
        }
        if (split.fans > 0) {
            parian_log(env, PARIAN_LOG_WARNING,
                       "%s: %u polygons are flat or cross themselves and are split as fans", name,
                       split.fans);
        }
        *mesh = made;
    } else {
        parian_mesh_free(env, &made);
    }
    parian_free(env, split.ring);
    parian_free(env, split.flat);
    return result;
}
