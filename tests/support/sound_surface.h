/* sound_surface.h - an independent check of what the surface stage promises.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_SOUND_SURFACE_H
#define PARIAN_TEST_SOUND_SURFACE_H

#include <math.h>
#include <stdlib.h>

#include "bake/stages/surface.h"
#include "support/test_support.h"

typedef struct directed_edge {
    uint32_t from, to;
} directed_edge;

static inline int compare_directed(const void *left, const void *right)
{
    const directed_edge *a = left, *b = right;
    if (a->from != b->from) {
        return a->from < b->from ? -1 : 1;
    }
    return a->to < b->to ? -1 : a->to > b->to;
}

/* Every directed edge once (so an edge has at most two triangles, and those agree), no triangle
 * without an area, every vertex used and finite; boundary edges as reported. */
static inline void assert_sound_surface(const parian_mesh *mesh,
                                        const parian_surface_report *report)
{
    uint32_t total = 3 * mesh->triangle_count, boundary = 0;
    directed_edge *edge = malloc(total * sizeof *edge);
    uint8_t *used = calloc(mesh->vertex_count, 1);
    assert_true(edge && used && mesh->triangle_count > 0);
    for (uint32_t h = 0; h < total; h++) {
        edge[h].from = mesh->triangle[h / 3][h % 3];
        edge[h].to = mesh->triangle[h / 3][(h + 1) % 3 == 0 ? 0 : h % 3 + 1];
        assert_true(edge[h].from < mesh->vertex_count && edge[h].from != edge[h].to);
        used[edge[h].from] = 1;
    }
    qsort(edge, total, sizeof *edge, compare_directed);
    for (uint32_t h = 0; h < total; h++) {
        assert_true(h == 0 || compare_directed(&edge[h], &edge[h - 1]) != 0);
        directed_edge back = {edge[h].to, edge[h].from};
        boundary += bsearch(&back, edge, total, sizeof *edge, compare_directed) == NULL;
    }
    assert_int_equal(boundary, report->boundary_edges);
    assert_true(report->closed == (boundary == 0));
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        assert_true(used[v] && isfinite(mesh->position[v][0]) && isfinite(mesh->position[v][1]) &&
                    isfinite(mesh->position[v][2]));
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const parian_mesh one = {.vertex_count = mesh->vertex_count,
                                 .triangle_count = 1,
                                 .position = mesh->position,
                                 .triangle = &mesh->triangle[t]};
        assert_true(parian_mesh_area(&one) > 0);
    }
    free(edge);
    free(used);
}

#endif
