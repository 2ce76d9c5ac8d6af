/* surface_manifold.c - makes neighbours agree in orientation and every vertex the centre of one
 * fan.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/surface_steps.h"
#include "core/disjoint_sets.h"
#include "core/memory.h"

typedef struct manifold {
    const parian_env *env;
    parian_mesh *mesh;
    uint32_t *mate; /* [3 * triangle_count] */
    uint32_t *
        other; /* [3 * triangle_count] neighbours while orienting; then the union-find of corners */
    uint8_t *side;   /* [triangle_count] 0 as in the source, 1 turned, 2 not yet known */
    uint32_t *queue; /* [triangle_count] */
    surface_edges edges;
    parian_surface_report *report;
} manifold;

static void link_pair(uint32_t *mate, uint32_t a, uint32_t b)
{
    mate[a] = b;
    mate[b] = a;
}

static bool agree(const parian_mesh *mesh, uint32_t a, uint32_t b)
{
    return surface_from(mesh, a) == surface_to(mesh, b) &&
           surface_to(mesh, a) == surface_from(mesh, b);
}

/* Flood one patch of triangles over edges of two; returns how many the queue holds. */
static uint32_t flood_patch(manifold *m, uint32_t seed)
{
    uint32_t count = 1;
    m->queue[0] = seed;
    m->side[seed] = 0;
    for (uint32_t at = 0; at < count; at++) {
        uint32_t t = m->queue[at];
        for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
            uint32_t g = m->other[h];
            if (g == SURFACE_NO_MATE) {
                continue;
            }
            uint8_t wanted = m->side[t] ^ (agree(m->mesh, h, g) ? 0 : 1);
            if (m->side[g / 3] == 2) {
                m->side[g / 3] = wanted;
                m->queue[count++] = g / 3;
            } else if (m->side[g / 3] != wanted) {
                m->report->orientable = false;
            }
        }
    }
    return count;
}

/* Orient every patch as most of its area was. */
static void orient_patches(manifold *m)
{
    memset(m->side, 2, m->mesh->triangle_count);
    for (uint32_t seed = 0; seed < m->mesh->triangle_count; seed++) {
        if (m->side[seed] != 2) {
            continue;
        }
        uint32_t count = flood_patch(m, seed);
        double kept = 0, turned = 0;
        for (uint32_t i = 0; i < count; i++) {
            *(m->side[m->queue[i]] ? &turned : &kept) += surface_doubled_area(m->mesh, m->queue[i]);
        }
        for (uint32_t i = 0; i < count; i++) {
            m->side[m->queue[i]] ^= turned > kept;
        }
    }
    for (uint32_t t = 0; t < m->mesh->triangle_count; t++) {
        if (m->side[t]) {
            surface_turn_triangle(m->mesh, t);
            m->report->flipped_triangles++;
        }
    }
}

/* A triangle at an edge of more than two, seen along the edge. */
typedef struct spoke {
    double angle;
    uint32_t half_edge;
    bool forward; /* its half-edge goes from the lower vertex to the higher */
} spoke;

static int compare_spokes(const void *left, const void *right)
{
    const spoke *a = left, *b = right;
    if (a->angle != b->angle) {
        return a->angle < b->angle ? -1 : 1;
    }
    return a->half_edge < b->half_edge ? -1 : a->half_edge > b->half_edge;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        out[k] = a[u] * b[v] - a[v] * b[u];
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void measure_spokes(const parian_mesh *mesh, const uint32_t *half_edge, uint32_t count,
                           spoke *spokes)
{
    uint32_t from = surface_from(mesh, half_edge[0]), to = surface_to(mesh, half_edge[0]);
    uint32_t low = from < to ? from : to, high = from < to ? to : from;
    double axis[3], x[3], y[3], side[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        axis[k] = mesh->position[high][k] - mesh->position[low][k];
    }
    int smallest = fabs(axis[0]) < fabs(axis[1]) ? 0 : 1;
    smallest = fabs(axis[2]) < fabs(axis[smallest]) ? 2 : smallest;
    side[smallest] = 1;
    cross(side, axis, x);
    cross(axis, x, y);
    double x_scale = 1 / sqrt(dot(x, x)), y_scale = 1 / sqrt(dot(y, y));
    for (uint32_t i = 0; i < count; i++) {
        uint32_t h = half_edge[i];
        const double *apex = mesh->position[mesh->triangle[h / 3][(h % 3 + 2) % 3]];
        double d[3];
        for (int k = 0; k < 3; k++) {
            d[k] = apex[k] - mesh->position[low][k];
        }
        spokes[i] = (spoke){atan2(dot(d, y) * y_scale, dot(d, x) * x_scale), h,
                            surface_from(mesh, h) == low};
    }
    qsort(spokes, count, sizeof *spokes, compare_spokes);
}

/* Going round by increasing angle, the inside lies behind a backward triangle and before a forward
 * one: match them like brackets, so that each pair bounds a wedge of solid. What finds no partner
 * stays a border. */
static void match_spokes(uint32_t *mate, const spoke *spokes, uint32_t count, uint32_t *stack)
{
    uint32_t depth = 0;
    for (uint32_t round = 0; round < 2; round++) {
        for (uint32_t i = 0; i < count; i++) {
            if (!spokes[i].forward) {
                if (round == 0) {
                    stack[depth++] = spokes[i].half_edge;
                }
            } else if (depth > 0 && mate[spokes[i].half_edge] == SURFACE_NO_MATE) {
                link_pair(mate, stack[--depth], spokes[i].half_edge);
            }
        }
    }
}

static parian_result pair_crowded_edge(manifold *m, const uint32_t *half_edge, uint32_t count)
{
    spoke *spokes = NULL;
    uint32_t *stack = NULL;
    parian_result result = PARIAN_OK;
    if (PARIAN_NEW(m->env, spokes, count) && PARIAN_NEW(m->env, stack, count)) {
        measure_spokes(m->mesh, half_edge, count, spokes);
        match_spokes(m->mate, spokes, count, stack);
    } else {
        result = parian_fail(m->env, PARIAN_E_NOMEM,
                             "surface: out of memory at an edge of %u triangles", count);
    }
    parian_free(m->env, spokes);
    parian_free(m->env, stack);
    return result;
}

static parian_result pair_edges(manifold *m)
{
    parian_result result = PARIAN_OK;
    memset(m->mate, 0xFF, (size_t)3 * m->mesh->triangle_count * sizeof *m->mate);
    for (uint32_t k = 0; k < m->edges.group_count && result == PARIAN_OK; k++) {
        const uint32_t *half_edge = &m->edges.half_edge[m->edges.offset[k]];
        uint32_t count = m->edges.offset[k + 1] - m->edges.offset[k];
        if (count == 2 && agree(m->mesh, half_edge[0], half_edge[1])) {
            link_pair(m->mate, half_edge[0], half_edge[1]);
        } else if (count > 2) {
            result = pair_crowded_edge(m, half_edge, count);
        }
    }
    return result;
}

/* Corners that are joined over paired edges are one fan and one vertex; the first fan at a vertex
 * keeps it, each further one gets a copy. */
static parian_result split_fans(manifold *m)
{
    parian_mesh *mesh = m->mesh;
    uint32_t total = 3 * mesh->triangle_count, count = mesh->vertex_count;
    uint32_t *parent = m->other, *target;
    double(*position)[3];
    for (uint32_t c = 0; c < total; c++) {
        parent[c] = c;
    }
    for (uint32_t h = 0; h < total; h++) {
        uint32_t g = m->mate[h];
        if (g != SURFACE_NO_MATE && g > h) {
            parian_set_join(parent, h, 3 * (g / 3) + (g % 3 + 1) % 3);
            parian_set_join(parent, 3 * (h / 3) + (h % 3 + 1) % 3, g);
        }
    }
    if (!PARIAN_NEW(m->env, target, total)) {
        return parian_fail(m->env, PARIAN_E_NOMEM, "surface: out of memory for %u corners", total);
    }
    bool *used = (bool *)m->queue; /* a flag for each vertex fits: see allocate */
    memset(used, 0, mesh->vertex_count);
    for (uint32_t c = 0; c < total; c++) {
        if (parian_set_root(parent, c) == c) {
            uint32_t vertex = mesh->triangle[c / 3][c % 3];
            target[c] = used[vertex] ? count++ : vertex;
            used[vertex] = true;
        }
    }
    if (!PARIAN_NEW(m->env, position, count)) {
        parian_free(m->env, target);
        return parian_fail(m->env, PARIAN_E_NOMEM, "surface: out of memory for %u vertices", count);
    }
    for (uint32_t c = 0; c < total; c++) {
        uint32_t *vertex = &mesh->triangle[c / 3][c % 3], made = target[parian_set_root(parent, c)];
        memcpy(position[made], mesh->position[*vertex], sizeof *position);
        *vertex = made;
    }
    m->report->split_vertices += count - mesh->vertex_count;
    parian_free(m->env, target);
    parian_free(m->env, mesh->position);
    mesh->position = position;
    mesh->vertex_count = count;
    return PARIAN_OK;
}

static void detach(uint32_t *mate, uint32_t triangle)
{
    for (uint32_t h = 3 * triangle; h < 3 * triangle + 3; h++) {
        if (mate[h] != SURFACE_NO_MATE) {
            mate[mate[h]] = SURFACE_NO_MATE;
            mate[h] = SURFACE_NO_MATE;
        }
    }
}

/* Fans can meet again behind an edge that was cut or paired in twos: there, triangles are cut loose
 * until an edge is named by one triangle, or by two that are paired. Returns how many were. */
static uint32_t detach_crowded(manifold *m)
{
    uint32_t detached = 0;
    for (uint32_t k = 0; k < m->edges.group_count; k++) {
        const uint32_t *half_edge = &m->edges.half_edge[m->edges.offset[k]];
        uint32_t count = m->edges.offset[k + 1] - m->edges.offset[k];
        uint32_t keep = half_edge[0];
        for (uint32_t i = 0; i < count && m->mate[keep] == SURFACE_NO_MATE; i++) {
            keep = half_edge[i];
        }
        for (uint32_t i = 0; i < count; i++) {
            if (half_edge[i] != keep && half_edge[i] != m->mate[keep]) {
                detach(m->mate, half_edge[i] / 3);
                detached++;
            }
        }
    }
    return detached;
}

static parian_result remake_edges(manifold *m)
{
    surface_edges_free(m->env, &m->edges);
    return surface_edges_make(m->env, m->mesh, &m->edges);
}

static parian_result allocate(manifold *m)
{
    size_t total = (size_t)3 * m->mesh->triangle_count;
    /* every vertex is referenced, so that vertex_count <= 3 * triangle_count: the queue holds a
     * flag for each */
    if (!PARIAN_NEW(m->env, m->mate, total) || !PARIAN_NEW(m->env, m->other, total) ||
        !PARIAN_NEW(m->env, m->side, m->mesh->triangle_count) ||
        !PARIAN_NEW(m->env, m->queue, total)) {
        return parian_fail(m->env, PARIAN_E_NOMEM, "surface: out of memory for %u triangles",
                           m->mesh->triangle_count);
    }
    return PARIAN_OK;
}

static void find_neighbours(manifold *m)
{
    memset(m->other, 0xFF, (size_t)3 * m->mesh->triangle_count * sizeof *m->other);
    for (uint32_t k = 0; k < m->edges.group_count; k++) {
        if (m->edges.offset[k + 1] - m->edges.offset[k] == 2) {
            const uint32_t *pair = &m->edges.half_edge[m->edges.offset[k]];
            link_pair(m->other, pair[0], pair[1]);
        }
    }
}

parian_result surface_make_manifold(const parian_env *env, parian_mesh *mesh, uint32_t **mate,
                                    parian_surface_report *report)
{
    manifold m = {.env = env, .mesh = mesh, .report = report};
    uint32_t detached = 1;
    report->orientable = true;
    parian_result result = allocate(&m);
    if (result == PARIAN_OK) {
        result = remake_edges(&m);
    }
    if (result == PARIAN_OK) {
        find_neighbours(&m);
        orient_patches(&m);
        result = remake_edges(&m);
    }
    if (result == PARIAN_OK) {
        result = pair_edges(&m);
    }
    while (result == PARIAN_OK && detached > 0) {
        result = split_fans(&m);
        if (result == PARIAN_OK) {
            result = remake_edges(&m);
        }
        detached = result == PARIAN_OK ? detach_crowded(&m) : 0;
    }
    surface_edges_free(env, &m.edges);
    parian_free(env, m.other);
    parian_free(env, m.side);
    parian_free(env, m.queue);
    if (result == PARIAN_OK) {
        *mate = m.mate;
    } else {
        parian_free(env, m.mate);
    }
    return result;
}
