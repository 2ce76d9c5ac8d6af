/* bench_transfer_mesh.c - seconds, counts and distances of the transfer mesh and of closest points.
 *
 *   bench_transfer_mesh [--vertices N] MODEL...
 *
 * Each model goes through import, surface and transfer mesh; without models a generated sphere
 * does.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/stages/import.h"
#include "bake/stages/surface.h"
#include "bake/stages/transfer_mesh.h"
#include "core/memory.h"
#include "tool/session.h"

enum { QUERY_COUNT = 160000 };

/* Edges across which the surface turns back by more than 143 degrees. */
static uint32_t count_folds(const parian_env *env, const parian_mesh *mesh)
{
    uint32_t(*neighbour)[3] = NULL, folds = 0;
    parian_mesh flat = *mesh;
    flat.corner_normal = NULL;
    if (!PARIAN_NEW(env, neighbour, mesh->triangle_count) ||
        parian_triangle_neighbours(env, mesh->vertex_count, mesh->triangle_count,
                                   (const uint32_t(*)[3])mesh->triangle, neighbour) != PARIAN_OK ||
        parian_mesh_make_corner_normals(env, &flat, 0.0) != PARIAN_OK) {
        parian_free(env, neighbour);
        return 0;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            uint32_t other = neighbour[t][k] / 3;
            if (neighbour[t][k] == PARIAN_NO_NEIGHBOUR || other < t) {
                continue;
            }
            const float *a = flat.corner_normal[t][0], *b = flat.corner_normal[other][0];
            folds += a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < -0.8f;
        }
    }
    parian_free(env, flat.corner_normal);
    parian_free(env, neighbour);
    return folds;
}

/* Triangles with less than a millionth of the mean area. */
static uint32_t count_slivers(const parian_mesh *mesh)
{
    double mean = parian_mesh_area(mesh) / mesh->triangle_count;
    uint32_t count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        parian_mesh one = {
            mesh->vertex_count, 1, mesh->position, mesh->triangle + t, NULL, NULL, NULL};
        count += parian_mesh_area(&one) < 1e-6 * mean;
    }
    return count;
}

/* Centroids of the transfer triangles, repeated: QUERY_COUNT queries on the source. */
static double time_closest(const parian_env *env, const parian_mesh *source,
                           const parian_mesh *transfer)
{
    double(*point)[3] = NULL, start = parian_seconds();
    parian_closest_hit *hit = NULL;
    parian_closest *closest = NULL;
    if (PARIAN_NEW(env, point, QUERY_COUNT) && PARIAN_NEW(env, hit, QUERY_COUNT)) {
        for (size_t i = 0; i < QUERY_COUNT; i++) {
            size_t t = i * transfer->triangle_count / QUERY_COUNT;
            for (int k = 0; k < 3; k++) {
                point[i][k] = 0.0;
                for (int c = 0; c < 3; c++) {
                    double weight = (i % 3 == (size_t)c ? 2.0 : 0.5) / 3.0;
                    point[i][k] += weight * transfer->position[transfer->triangle[t][c]][k];
                }
            }
        }
        parian_closest_query query = {.count = QUERY_COUNT, .point = (const double(*)[3])point};
        start = parian_seconds();
        if (parian_closest_create(env, source, &closest) == PARIAN_OK) {
            parian_closest_find(env, closest, &query, hit);
        }
    }
    double seconds = parian_seconds() - start;
    parian_closest_destroy(closest);
    parian_free(env, hit);
    parian_free(env, point);
    return seconds;
}

static void bench_mesh(const parian_env *env, const char *name, const parian_mesh *source,
                       uint32_t vertices)
{
    parian_mesh transfer = {0};
    parian_transfer_mesh_desc desc = {.vertex_target = vertices};
    parian_transfer_mesh_report r;
    double start = parian_seconds();
    parian_result result = parian_stage_transfer_mesh(env, source, &desc, &transfer, &r);
    double seconds = parian_seconds() - start;
    if (result != PARIAN_OK) {
        printf("%-32s %s\n", name, parian_result_text(result));
        return;
    }
    printf("%-32s %7u %6u %6.2f %7.2f %6.4f %7.4f %6.3f %6.4f %5.3f %5u %7u\n", name,
           source->vertex_count, r.vertex_count, seconds, time_closest(env, source, &transfer),
           r.quality_mean, r.distance_rms_m / r.edge_mean_m, r.distance_max_m / r.edge_mean_m,
           r.area_ratio, r.edge_min_m / r.edge_mean_m, count_folds(env, &transfer),
           count_slivers(&transfer));
    parian_mesh_free(env, &transfer);
}

static void bench_model(const parian_env *env, const char *path, uint32_t vertices)
{
    parian_source_scene scene;
    parian_surface_report report;
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    parian_result result = parian_import(env, path, &scene);
    if (result != PARIAN_OK) {
        printf("%-32s %s\n", name, parian_result_text(result));
        return;
    }
    for (uint32_t p = 0; p < scene.part_count; p++) {
        parian_mesh *mesh = &scene.parts[p].mesh;
        result = parian_stage_surface(env, mesh, &report);
        if (result == PARIAN_OK) {
            bench_mesh(env, name, mesh, vertices);
        } else {
            printf("%-32s surface: %s\n", name, parian_result_text(result));
        }
    }
    parian_source_scene_free(env, &scene);
}

int main(int argc, char **argv)
{
    const parian_env *env = test_env(0);
    uint32_t vertices = 10000;
    int first = 1;
    if (argc > 2 && strcmp(argv[1], "--vertices") == 0) {
        vertices = (uint32_t)strtoul(argv[2], NULL, 10);
        first = 3;
    }
    printf("%-32s %7s %6s %6s %7s %6s %7s %6s %6s %5s %5s %7s\n", "source", "from", "to", "s",
           "160k s", "qualit", "rms/e", "max/e", "area", "e min", "folds", "slivers");
    for (int i = first; i < argc; i++) {
        bench_model(env, argv[i], vertices);
        fflush(stdout);
    }
    if (first >= argc) {
        parian_mesh sphere;
        if (test_sphere(env, 0.05, 70, &sphere) == PARIAN_OK) {
            bench_mesh(env, "sphere", &sphere, vertices);
            parian_mesh_free(env, &sphere);
        }
    }
    return 0;
}
