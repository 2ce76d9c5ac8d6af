/* surface_edges.c - groups half-edges by edge, keeps and turns triangles with their attributes.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/surface_steps.h"
#include "core/memory.h"

uint32_t surface_from(const parian_mesh *mesh, uint32_t half_edge)
{
    return mesh->triangle[half_edge / 3][half_edge % 3];
}

uint32_t surface_to(const parian_mesh *mesh, uint32_t half_edge)
{
    return mesh->triangle[half_edge / 3][(half_edge % 3 + 1) % 3];
}

double surface_doubled_area(const parian_mesh *mesh, uint32_t triangle)
{
    const double *a = mesh->position[mesh->triangle[triangle][0]];
    const double *b = mesh->position[mesh->triangle[triangle][1]];
    const double *c = mesh->position[mesh->triangle[triangle][2]];
    double n[3];
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        n[k] = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    }
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

typedef struct edge_entry {
    uint32_t high, half_edge;
} edge_entry;

static int compare_entries(const void *left, const void *right)
{
    const edge_entry *a = left, *b = right;
    if (a->high != b->high) {
        return a->high < b->high ? -1 : 1;
    }
    return a->half_edge < b->half_edge ? -1 : a->half_edge > b->half_edge;
}

static void sort_entries(edge_entry *entry, uint32_t count)
{
    if (count > 24) {
        qsort(entry, count, sizeof *entry, compare_entries);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        edge_entry moving = entry[i];
        uint32_t k = i;
        for (; k > 0 && compare_entries(&moving, &entry[k - 1]) < 0; k--) {
            entry[k] = entry[k - 1];
        }
        entry[k] = moving;
    }
}

/* Counting sort by the lower vertex; each vertex's few entries are then sorted by the higher. */
static void fill_buckets(const parian_mesh *mesh, uint32_t *start, edge_entry *entry)
{
    uint32_t total = 3 * mesh->triangle_count;
    memset(start, 0, ((size_t)mesh->vertex_count + 1) * sizeof *start);
    for (uint32_t h = 0; h < total; h++) {
        uint32_t a = surface_from(mesh, h), b = surface_to(mesh, h);
        start[(a < b ? a : b) + 1]++;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        start[v + 1] += start[v];
    }
    for (uint32_t h = total; h-- > 0;) {
        uint32_t a = surface_from(mesh, h), b = surface_to(mesh, h);
        uint32_t slot = --start[(a < b ? a : b) + 1];
        entry[slot] = (edge_entry){a < b ? b : a, h};
    }
}

parian_result surface_edges_make(const parian_env *env, const parian_mesh *mesh,
                                 surface_edges *edges)
{
    uint32_t total = 3 * mesh->triangle_count;
    surface_edges made = {0};
    uint32_t *start = NULL;
    edge_entry *entry = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(env, start, (size_t)mesh->vertex_count + 2) || !PARIAN_NEW(env, entry, total) ||
        !PARIAN_NEW(env, made.offset, (size_t)total + 1) ||
        !PARIAN_NEW(env, made.half_edge, total)) {
        parian_fail(env, result, "surface: out of memory for %u half-edges", total);
        goto done;
    }
    fill_buckets(mesh, start, entry);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t first = start[v + 1], last = v + 1 < mesh->vertex_count ? start[v + 2] : total;
        sort_entries(&entry[first], last - first);
        for (uint32_t i = first; i < last; i++) {
            if (i == first || entry[i].high != entry[i - 1].high) {
                made.offset[made.group_count++] = i;
            }
            made.half_edge[i] = entry[i].half_edge;
        }
    }
    made.offset[made.group_count] = total;
    *edges = made;
    made = (surface_edges){0};
    result = PARIAN_OK;
done:
    parian_free(env, start);
    parian_free(env, entry);
    surface_edges_free(env, &made);
    return result;
}

void surface_edges_free(const parian_env *env, surface_edges *edges)
{
    parian_free(env, edges->offset);
    parian_free(env, edges->half_edge);
    *edges = (surface_edges){0};
}

void surface_keep_triangles(parian_mesh *mesh, const bool *keep)
{
    uint32_t count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (!keep[t]) {
            continue;
        }
        if (count != t) {
            memcpy(mesh->triangle[count], mesh->triangle[t], sizeof *mesh->triangle);
            if (mesh->corner_uv) {
                memcpy(mesh->corner_uv[count], mesh->corner_uv[t], sizeof *mesh->corner_uv);
            }
            if (mesh->corner_normal) {
                memcpy(mesh->corner_normal[count], mesh->corner_normal[t],
                       sizeof *mesh->corner_normal);
            }
            if (mesh->material) {
                mesh->material[count] = mesh->material[t];
            }
        }
        count++;
    }
    mesh->triangle_count = count;
}

void surface_turn_triangle(parian_mesh *mesh, uint32_t triangle)
{
    uint32_t *corner = mesh->triangle[triangle];
    uint32_t swapped = corner[1];
    corner[1] = corner[2];
    corner[2] = swapped;
    if (mesh->corner_uv) {
        float uv[2];
        memcpy(uv, mesh->corner_uv[triangle][1], sizeof uv);
        memcpy(mesh->corner_uv[triangle][1], mesh->corner_uv[triangle][2], sizeof uv);
        memcpy(mesh->corner_uv[triangle][2], uv, sizeof uv);
    }
    if (mesh->corner_normal) {
        float normal[3];
        memcpy(normal, mesh->corner_normal[triangle][1], sizeof normal);
        memcpy(mesh->corner_normal[triangle][1], mesh->corner_normal[triangle][2], sizeof normal);
        memcpy(mesh->corner_normal[triangle][2], normal, sizeof normal);
        for (int i = 0; i < 9; i++) {
            mesh->corner_normal[triangle][i / 3][i % 3] *= -1;
        }
    }
}
