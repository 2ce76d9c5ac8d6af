/* transfer_mesh_untangle.c - moves the few vertices whose triangles are folded over or badly
 * shaped.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

enum { SWEEPS = 4, TRIALS = 3 };
/* Below it, a triangle counts as next to nothing; features are left alone unless it is far below.
 */
static const double quality_min = 0.03, quality_min_fixed = 1e-3;

/* The triangles around each vertex: triangle[offset[v]] to triangle[offset[v + 1] - 1]. */
typedef struct vertex_fans {
    uint32_t *offset;   /* [vertex_count + 2] */
    uint32_t *triangle; /* [3 * triangle_count] */
} vertex_fans;

static bool make_fans(const parian_env *env, const parian_mesh *mesh, vertex_fans *fans)
{
    if (!PARIAN_NEW0(env, fans->offset, (size_t)mesh->vertex_count + 2) ||
        !PARIAN_NEW(env, fans->triangle, 3 * (size_t)mesh->triangle_count)) {
        return false;
    }
    const uint32_t *corner = &mesh->triangle[0][0];
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        fans->offset[corner[i] + 2]++;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        fans->offset[v + 2] += fans->offset[v + 1];
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->triangle_count; i++) {
        fans->triangle[fans->offset[corner[i] + 1]++] = (uint32_t)(i / 3);
    }
    return true;
}

static void measure_triangle(const parian_mesh *mesh, uint32_t t, double normal[3], double *squares)
{
    const uint32_t *c = mesh->triangle[t];
    *squares = 0.0;
    for (int k = 0; k < 3; k++) {
        double edge[3];
        subtract(mesh->position[c[(k + 1) % 3]], mesh->position[c[k]], edge);
        *squares += parian_dot3(edge, edge);
    }
    area_vector(mesh->position[c[0]], mesh->position[c[1]], mesh->position[c[2]], normal);
}

/* The least of the qualities of the triangles around a vertex, each times the cosine to their
 * common normal: 1 for equilateral triangles in a plane, negative for a fold. The common normal
 * does not depend on where an inner vertex is. */
static double score(const parian_mesh *mesh, const vertex_fans *fans, uint32_t v)
{
    double common[3] = {0.0, 0.0, 0.0}, least = 1.0, n[3], squares;
    for (uint32_t i = fans->offset[v]; i < fans->offset[v + 1]; i++) {
        measure_triangle(mesh, fans->triangle[i], n, &squares);
        for (int k = 0; k < 3; k++) {
            common[k] += n[k];
        }
    }
    double length = norm(common);
    for (uint32_t i = fans->offset[v]; i < fans->offset[v + 1]; i++) {
        measure_triangle(mesh, fans->triangle[i], n, &squares);
        bool flat = squares > 0.0 && length > 0.0;
        least = fmin(least,
                     flat ? 2.0 * sqrt(3.0) * parian_dot3(n, common) / (length * squares) : -1.0);
    }
    return least;
}

static void find_ring_centroid(const parian_mesh *mesh, const vertex_fans *fans, uint32_t v,
                               double centroid[3])
{
    double count = 0.0;
    memset(centroid, 0, 3 * sizeof *centroid);
    for (uint32_t i = fans->offset[v]; i < fans->offset[v + 1]; i++) {
        for (int c = 0; c < 3; c++) {
            uint32_t u = mesh->triangle[fans->triangle[i]][c];
            for (int k = 0; k < 3 && u != v; k++) {
                centroid[k] += mesh->position[u][k];
            }
            count += u != v;
        }
    }
    for (int k = 0; k < 3; k++) {
        centroid[k] /= count;
    }
}

static bool has_sliver(const parian_mesh *mesh, const vertex_fans *fans, uint32_t v, double quality)
{
    for (uint32_t i = fans->offset[v]; i < fans->offset[v + 1]; i++) {
        double n[3], squares;
        measure_triangle(mesh, fans->triangle[i], n, &squares);
        if (2.0 * sqrt(3.0) * norm(n) <= quality * squares) {
            return true;
        }
    }
    return false;
}

/* Try positions on the way to the middle of the ring; keep the best. */
static bool improve(parian_mesh *mesh, const vertex_fans *fans, uint32_t v)
{
    double start[3], best[3], centroid[3], best_score = score(mesh, fans, v);
    bool moved = false;
    memcpy(start, mesh->position[v], sizeof start);
    memcpy(best, start, sizeof best);
    find_ring_centroid(mesh, fans, v, centroid);
    for (int trial = 1; trial <= TRIALS; trial++) {
        double t = (double)trial / TRIALS;
        for (int k = 0; k < 3; k++) {
            mesh->position[v][k] = (1.0 - t) * start[k] + t * centroid[k];
        }
        double now = score(mesh, fans, v);
        if (now > best_score + 1e-3) {
            best_score = now;
            memcpy(best, mesh->position[v], sizeof best);
            moved = true;
        }
    }
    memcpy(mesh->position[v], best, sizeof best);
    return moved;
}

parian_result parian_transfer_untangle(const parian_env *env, const bool *fixed, parian_mesh *mesh)
{
    vertex_fans fans = {0};
    parian_result result = PARIAN_E_NOMEM;
    if (!make_fans(env, mesh, &fans)) {
        parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory to untangle");
        goto done;
    }
    bool moved = true;
    for (int sweep = 0; sweep < SWEEPS && moved; sweep++) {
        moved = false;
        for (uint32_t v = 0; v < mesh->vertex_count; v++) {
            if (has_sliver(mesh, &fans, v, fixed[v] ? quality_min_fixed : quality_min)) {
                moved = improve(mesh, &fans, v) || moved;
            }
        }
    }
    result = PARIAN_OK;
done:
    parian_free(env, fans.triangle);
    parian_free(env, fans.offset);
    return result;
}
