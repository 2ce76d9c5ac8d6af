/* transfer_mesh_order.c - numbers the vertices along a Hilbert curve, so that near ones have near
 * indices.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdlib.h>
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

enum { CURVE_BITS = 20 };

/* Position along the three-dimensional Hilbert curve of cell x, CURVE_BITS per axis.
 * Source: J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707 (2004). */
static uint64_t hilbert_key(uint32_t x[3])
{
    for (uint32_t q = 1u << (CURVE_BITS - 1); q > 1; q >>= 1) {
        for (int i = 0; i < 3; i++) {
            uint32_t t = (x[0] ^ x[i]) & (q - 1);
            if (x[i] & q) {
                x[0] ^= q - 1;
            } else {
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t turn = 0;
    for (uint32_t q = 1u << (CURVE_BITS - 1); q > 1; q >>= 1) {
        turn ^= x[2] & q ? q - 1 : 0;
    }
    uint64_t key = 0;
    for (int bit = CURVE_BITS - 1; bit >= 0; bit--) {
        for (int i = 0; i < 3; i++) {
            key = key << 1 | (((x[i] ^ turn) >> bit) & 1);
        }
    }
    return key;
}

typedef struct keyed_vertex {
    uint64_t key;
    uint32_t vertex;
} keyed_vertex;

static int compare_keys(const void *left, const void *right)
{
    const keyed_vertex *a = left, *b = right;
    if (a->key != b->key) {
        return a->key < b->key ? -1 : 1;
    }
    return a->vertex < b->vertex ? -1 : a->vertex > b->vertex;
}

static void make_keys(const parian_mesh *mesh, keyed_vertex *order)
{
    double lower[3], upper[3], extent = 0.0;
    parian_mesh_bounds(mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        extent = fmax(extent, upper[k] - lower[k]);
    }
    double scale = extent > 0.0 ? ((1u << CURVE_BITS) - 1) / extent : 0.0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t cell[3];
        for (int k = 0; k < 3; k++) {
            cell[k] = (uint32_t)((mesh->position[v][k] - lower[k]) * scale);
        }
        order[v] = (keyed_vertex){hilbert_key(cell), v};
    }
    qsort(order, mesh->vertex_count, sizeof *order, compare_keys);
}

/* The smallest corner first, orientation kept. */
static void rotate_triangle(uint32_t corner[3])
{
    while (corner[0] > corner[1] || corner[0] > corner[2]) {
        uint32_t first = corner[0];
        corner[0] = corner[1];
        corner[1] = corner[2];
        corner[2] = first;
    }
}

static int compare_triangles(const void *left, const void *right)
{
    const uint32_t *a = left, *b = right;
    for (int k = 0; k < 3; k++) {
        if (a[k] != b[k]) {
            return a[k] < b[k] ? -1 : 1;
        }
    }
    return 0;
}

parian_result parian_transfer_order(const parian_env *env, parian_mesh *mesh)
{
    parian_result result = PARIAN_E_NOMEM;
    keyed_vertex *order = NULL;
    uint32_t *rank = NULL;
    double(*position)[3] = NULL;
    if (!PARIAN_NEW(env, order, mesh->vertex_count) || !PARIAN_NEW(env, rank, mesh->vertex_count) ||
        !PARIAN_NEW(env, position, mesh->vertex_count)) {
        parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for the order of vertices");
        goto done;
    }
    make_keys(mesh, order);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        rank[order[i].vertex] = i;
        memcpy(position[i], mesh->position[order[i].vertex], sizeof position[0]);
    }
    memcpy(mesh->position, position, mesh->vertex_count * sizeof *position);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangle[t][k] = rank[mesh->triangle[t][k]];
        }
        rotate_triangle(mesh->triangle[t]);
    }
    qsort(mesh->triangle, mesh->triangle_count, sizeof *mesh->triangle, compare_triangles);
    result = PARIAN_OK;
done:
    parian_free(env, position);
    parian_free(env, rank);
    parian_free(env, order);
    return result;
}
