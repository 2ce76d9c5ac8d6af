/* mesh.c - area, bounds, adjacency and corner normals of an indexed triangle mesh.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/disjoint_sets.h"
#include "core/memory.h"

static const double pi = 3.14159265358979323846;

void parian_mesh_free(const parian_env *env, parian_mesh *mesh)
{
    if (!mesh) {
        return;
    }
    parian_free(env, mesh->position);
    parian_free(env, mesh->triangle);
    parian_free(env, mesh->corner_uv);
    parian_free(env, mesh->corner_normal);
    parian_free(env, mesh->material);
    memset(mesh, 0, sizeof *mesh);
}

/* Twice the area of a triangle times its unit normal. */
static void area_vector(const parian_mesh *mesh, uint32_t triangle, double out[3])
{
    const uint32_t *corner = mesh->triangle[triangle];
    const double *a = mesh->position[corner[0]];
    const double *b = mesh->position[corner[1]];
    const double *c = mesh->position[corner[2]];
    double u[3], v[3];
    for (int d = 0; d < 3; d++) {
        u[d] = b[d] - a[d];
        v[d] = c[d] - a[d];
    }
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double parian_mesh_area(const parian_mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double normal[3];
        area_vector(mesh, t, normal);
        sum += 0.5 * length(normal);
    }
    return sum;
}

void parian_mesh_bounds(const parian_mesh *mesh, double lower[3], double upper[3])
{
    for (int d = 0; d < 3; d++) {
        lower[d] = mesh->triangle_count ? INFINITY : 0.0;
        upper[d] = mesh->triangle_count ? -INFINITY : 0.0;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            const double *p = mesh->position[mesh->triangle[t][k]];
            for (int d = 0; d < 3; d++) {
                lower[d] = p[d] < lower[d] ? p[d] : lower[d];
                upper[d] = p[d] > upper[d] ? p[d] : upper[d];
            }
        }
    }
}

/* A half-edge filed under the smaller of its two vertices. */
typedef struct edge_entry {
    uint32_t other; /* the larger vertex */
    uint32_t half;  /* 3 * triangle + edge */
} edge_entry;

static int compare_edges(const void *left, const void *right)
{
    const edge_entry *a = left, *b = right;
    if (a->other != b->other) {
        return a->other < b->other ? -1 : 1;
    }
    return a->half < b->half ? -1 : a->half > b->half;
}

/* Sort a bucket; nearly all are a few entries long. */
static void sort_bucket(edge_entry *entry, size_t count)
{
    if (count > 24) {
        qsort(entry, count, sizeof *entry, compare_edges);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        edge_entry moving = entry[i];
        size_t j = i;
        for (; j > 0 && compare_edges(&moving, &entry[j - 1]) < 0; j--) {
            entry[j] = entry[j - 1];
        }
        entry[j] = moving;
    }
}

/* Pair the half-edges of a sorted bucket: two of the same edge, in opposite directions. */
static void pair_bucket(const edge_entry *entry, size_t count, const uint32_t (*triangle)[3],
                        uint32_t (*neighbour)[3])
{
    for (size_t i = 0; i < count;) {
        size_t end = i + 1;
        while (end < count && entry[end].other == entry[i].other) {
            end++;
        }
        if (end - i == 2) {
            uint32_t a = entry[i].half, b = entry[i + 1].half;
            if (triangle[a / 3][a % 3] != triangle[b / 3][b % 3]) {
                neighbour[a / 3][a % 3] = b;
                neighbour[b / 3][b % 3] = a;
            }
        }
        i = end;
    }
}

parian_result parian_triangle_neighbours(const parian_env *env, uint32_t vertex_count,
                                         uint32_t triangle_count, const uint32_t (*triangle)[3],
                                         uint32_t (*neighbour)[3])
{
    size_t *start = NULL;
    edge_entry *entry = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW0(env, start, (size_t)vertex_count + 2) ||
        !PARIAN_NEW(env, entry, 3 * (size_t)triangle_count)) {
        parian_fail(env, result, "no memory for the edges of %u triangles", triangle_count);
        goto cleanup;
    }
    /* Counting sort: start[v + 1] ends as the first entry of vertex v, then as its end. */
    for (size_t h = 0; h < 3 * (size_t)triangle_count; h++) {
        uint32_t a = triangle[h / 3][h % 3], b = triangle[h / 3][(h + 1) % 3];
        start[(a < b ? a : b) + 2]++;
        neighbour[h / 3][h % 3] = PARIAN_NO_NEIGHBOUR;
    }
    for (size_t v = 0; v + 1 < (size_t)vertex_count + 2; v++) {
        start[v + 1] += start[v];
    }
    for (size_t t = 0; t < triangle_count; t++) {
        for (unsigned k = 0; k < 3; k++) {
            uint32_t a = triangle[t][k], b = triangle[t][k < 2 ? k + 1 : 0];
            edge_entry *slot = &entry[start[(a < b ? a : b) + 1]++];
            slot->other = a < b ? b : a;
            slot->half = (uint32_t)(3 * t + k);
        }
    }
    for (size_t v = 0; v < vertex_count; v++) {
        sort_bucket(entry + start[v], start[v + 1] - start[v]);
        pair_bucket(entry + start[v], start[v + 1] - start[v], triangle, neighbour);
    }
    result = PARIAN_OK;
cleanup:
    parian_free(env, entry);
    parian_free(env, start);
    return result;
}

/* Angle of a triangle at a corner, radians; 0 for a corner without one. */
static double corner_angle(const parian_mesh *mesh, uint32_t triangle, unsigned corner)
{
    const double *p = mesh->position[mesh->triangle[triangle][corner]];
    const double *q = mesh->position[mesh->triangle[triangle][(corner + 1) % 3]];
    const double *r = mesh->position[mesh->triangle[triangle][(corner + 2) % 3]];
    double u[3], v[3];
    for (int d = 0; d < 3; d++) {
        u[d] = q[d] - p[d];
        v[d] = r[d] - p[d];
    }
    double scale = length(u) * length(v);
    if (!(scale > 0.0)) {
        return 0.0;
    }
    double cosine = (u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / scale;
    return acos(fmin(1.0, fmax(-1.0, cosine)));
}

/* Join the corners that share a normal: those at both ends of every edge flatter than the crease. A
 * triangle without area has no normal to disagree with. */
static void join_smooth_corners(const parian_mesh *mesh, const double (*normal)[3],
                                const uint32_t (*neighbour)[3], double cos_crease, uint32_t *parent)
{
    for (uint32_t h = 0; h < 3 * mesh->triangle_count; h++) {
        parent[h] = h;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (unsigned k = 0; k < 3; k++) {
            uint32_t other = neighbour[t][k];
            if (other == PARIAN_NO_NEIGHBOUR || other < 3 * t + k) {
                continue;
            }
            const double *a = normal[t], *b = normal[other / 3];
            double scale = length(a) * length(b);
            double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            if (scale == 0.0 || cosine >= cos_crease * scale) {
                parian_set_join(parent, 3 * t + k, other - other % 3 + (other + 1) % 3);
                parian_set_join(parent, 3 * t + (k + 1) % 3, other);
            }
        }
    }
}

/* Sum unit normals weighted by corner angles over each set of joined corners. */
static void sum_corner_normals(const parian_mesh *mesh, const double (*normal)[3], uint32_t *parent,
                               double (*sum)[3])
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double size = length(normal[t]);
        for (unsigned k = 0; k < 3 && size > 0.0; k++) {
            double weight = corner_angle(mesh, t, k) / size;
            double *target = sum[parian_set_root(parent, 3 * t + k)];
            for (int d = 0; d < 3; d++) {
                target[d] += weight * normal[t][d];
            }
        }
    }
}

/* Unit vector of the first candidate that has a direction; +z where none has. */
static void store_unit(const double first[3], const double second[3], float out[3])
{
    const double *chosen = length(first) > 1e-9 ? first : second;
    double size = length(chosen);
    for (int d = 0; d < 3; d++) {
        out[d] = size > 0.0 ? (float)(chosen[d] / size) : (d == 2 ? 1.0f : 0.0f);
    }
}

parian_result parian_mesh_make_corner_normals(const parian_env *env, parian_mesh *mesh,
                                              double crease_deg)
{
    size_t count = mesh->triangle_count;
    uint32_t(*neighbour)[3] = NULL, *parent = NULL;
    double(*normal)[3] = NULL, (*sum)[3] = NULL;
    float(*corner_normal)[3][3] = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(env, neighbour, count) || !PARIAN_NEW(env, parent, 3 * count) ||
        !PARIAN_NEW(env, normal, count) || !PARIAN_NEW0(env, sum, 3 * count) ||
        !PARIAN_NEW(env, corner_normal, count)) {
        parian_fail(env, result, "no memory for the corner normals of %zu triangles", count);
        goto cleanup;
    }
    result = parian_triangle_neighbours(env, mesh->vertex_count, mesh->triangle_count,
                                        (const uint32_t(*)[3])mesh->triangle, neighbour);
    if (result != PARIAN_OK) {
        goto cleanup;
    }
    for (uint32_t t = 0; t < count; t++) {
        area_vector(mesh, t, normal[t]);
    }
    join_smooth_corners(mesh, (const double(*)[3])normal, (const uint32_t(*)[3])neighbour,
                        cos(crease_deg * pi / 180.0), parent);
    sum_corner_normals(mesh, (const double(*)[3])normal, parent, sum);
    for (uint32_t t = 0; t < count; t++) {
        for (unsigned k = 0; k < 3; k++) {
            store_unit(sum[parian_set_root(parent, 3 * t + k)], normal[t], corner_normal[t][k]);
        }
    }
    parian_free(env, mesh->corner_normal);
    mesh->corner_normal = corner_normal;
    corner_normal = NULL;
cleanup:
    parian_free(env, corner_normal);
    parian_free(env, sum);
    parian_free(env, normal);
    parian_free(env, parent);
    parian_free(env, neighbour);
    return result;
}
