/* transfer_mesh_order.c - numbers the vertices along a Hilbert curve, so that near ones have near
 * indices.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdlib.h>
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

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
    uint32_t *order = NULL, *rank = NULL;
    double(*position)[3] = NULL;
    if (!PARIAN_NEW(env, order, mesh->vertex_count) || !PARIAN_NEW(env, rank, mesh->vertex_count) ||
        !PARIAN_NEW(env, position, mesh->vertex_count)) {
        parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for the order of vertices");
        goto done;
    }
    result =
        parian_transfer_curve(env, mesh->vertex_count, (const double(*)[3])mesh->position, order);
    if (result != PARIAN_OK) {
        goto done;
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        rank[order[i]] = i;
        memcpy(position[i], mesh->position[order[i]], sizeof position[0]);
    }
    memcpy(mesh->position, position, mesh->vertex_count * sizeof *position);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            mesh->triangle[t][k] = rank[mesh->triangle[t][k]];
        }
        rotate_triangle(mesh->triangle[t]);
    }
    qsort(mesh->triangle, mesh->triangle_count, sizeof *mesh->triangle, compare_triangles);
done:
    parian_free(env, position);
    parian_free(env, rank);
    parian_free(env, order);
    return result;
}
