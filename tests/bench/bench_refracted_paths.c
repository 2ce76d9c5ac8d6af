/* bench_refracted_paths.c - searches for refracted paths a second, at several depths below a
 * surface.
 *
 *   bench_refracted_paths MODEL [ETA]     MODEL is a file, of which the largest part is taken, or
 * sphere:CUTS
 *
 * One line a depth (in mean edges): nanoseconds, nodes of four and facets a search, paths found; by
 * the general search for a direction, a point two radii away and a random direction each time, and
 * by the index of one direction. Places are spread by area and moved in along the facet's normal.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bake/reference/refracted_paths.h"
#include "bake/stages/import.h"
#include "bake/stages/surface.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/small_maths.h"
#include "support/test_support.h"

enum { QUERIES = 20000 };

typedef struct bench {
    parian_mesh mesh;
    parian_refractor *refractor;
    double edge;
    double (*x)[3], (*normal)[3], (*way)[3]; /* [QUERIES] */
    size_t found;
} bench;

/* Seconds of this process alone: other work on the machine is left out. */
static double process_seconds(void)
{
    return (double)clock() / CLOCKS_PER_SEC;
}

static void count(void *context, const parian_refracted_path *path)
{
    bench *b = context;
    b->found += path->factor >= 0;
}

static void place_points(bench *b)
{
    double area = parian_mesh_area(&b->mesh), passed = 0;
    size_t i = 0;
    b->edge = sqrt(area / b->mesh.triangle_count * 4 / sqrt(3.0));
    for (uint32_t t = 0; t < b->mesh.triangle_count; t++) {
        const double *v[3];
        double e[2][3], n[3];
        for (int c = 0; c < 3; c++) {
            v[c] = b->mesh.position[b->mesh.triangle[t][c]];
        }
        for (int k = 0; k < 3; k++) {
            e[0][k] = v[1][k] - v[0][k];
            e[1][k] = v[2][k] - v[0][k];
        }
        parian_cross3(e[0], e[1], n);
        double twice = sqrt(parian_dot3(n, n));
        for (passed += 0.5 * twice; i < QUERIES && passed > area * ((double)i + 0.5) / QUERIES;
             i++) {
            parian_random random = parian_random_stream(1, i, 0, 0);
            double s = sqrt(parian_random_unit(&random)), u = parian_random_unit(&random) * s,
                   way = 0;
            for (int k = 0; k < 3; k++) {
                b->x[i][k] = v[0][k] + (1 - s) * e[0][k] + u * e[1][k];
                b->normal[i][k] = n[k] / twice;
                b->way[i][k] = parian_random_unit(&random) - 0.5;
                way += b->way[i][k] * b->way[i][k];
            }
            for (int k = 0; k < 3; k++) {
                b->way[i][k] /= sqrt(way);
            }
        }
    }
}

static void run(bench *b, int kind, const parian_refractor_index *index, double depth,
                double longest)
{
    static const char *const name[] = {"direction", "point", "directions", "index"};
    double lower[3], upper[3];
    parian_refracted_cost cost = {0, 0};
    parian_light_point light = {.at_infinity = kind != 1, .direction = {0.36, 0.8, 0.48}};
    parian_mesh_bounds(&b->mesh, lower, upper);
    for (int k = 0; k < 3; k++) {
        light.position[k] =
            0.5 * (lower[k] + upper[k]) + light.direction[k] * 2 * (upper[1] - lower[1]);
    }
    b->found = 0;
    double start = process_seconds();
    for (size_t i = 0; i < QUERIES; i++) {
        double x[3];
        for (int k = 0; k < 3; k++) {
            x[k] = b->x[i][k] - depth * b->edge * b->normal[i][k];
        }
        if (kind == 2) {
            memcpy(light.direction, b->way[i], sizeof light.direction);
        }
        if (index) {
            parian_refractor_index_paths_counted(index, x, longest * b->edge,
                                                 PARIAN_REFRACTOR_NO_SKIP, count, b, &cost);
        } else {
            parian_refracted_paths_counted(b->refractor, x, &light, longest * b->edge,
                                           PARIAN_REFRACTOR_NO_SKIP, count, b, &cost);
        }
    }
    double seconds = process_seconds() - start;
    printf(
        "%-10s depth %5.1f longest %3.0f edges: %7.0f ns, %6.1f nodes, %6.1f facets, %7.5f paths\n",
        name[kind], depth, longest, seconds / QUERIES * 1e9, (double)cost.nodes / QUERIES,
        (double)cost.facets / QUERIES, (double)b->found / QUERIES);
}

static parian_result load(const parian_env *env, const char *path, parian_mesh *mesh)
{
    if (!strncmp(path, "sphere:", 7)) {
        return test_sphere(env, 1, (unsigned)atoi(path + 7), mesh);
    }
    parian_source_scene scene;
    parian_surface_report report;
    parian_result r = parian_import(env, path, &scene);
    if (r != PARIAN_OK) {
        return r;
    }
    uint32_t largest = 0;
    for (uint32_t p = 1; p < scene.part_count; p++) {
        bool larger = scene.parts[p].mesh.triangle_count > scene.parts[largest].mesh.triangle_count;
        largest = larger ? p : largest;
    }
    r = parian_stage_surface(env, &scene.parts[largest].mesh, &report);
    *mesh = scene.parts[largest].mesh;
    scene.parts[largest].mesh = (parian_mesh){0};
    parian_source_scene_free(env, &scene);
    return r;
}

int main(int argc, char **argv)
{
    static const double depths[] = {0.1, 1, 3, 10, 30};
    const parian_env *env = test_env(0);
    bench b = {.found = 0};
    if (argc < 2 || load(env, argv[1], &b.mesh) != PARIAN_OK || !PARIAN_NEW(env, b.x, QUERIES) ||
        !PARIAN_NEW(env, b.normal, QUERIES) || !PARIAN_NEW(env, b.way, QUERIES)) {
        fprintf(stderr, "usage: bench_refracted_paths MODEL|sphere:CUTS [ETA]\n");
        return 2;
    }
    place_points(&b);
    double start = process_seconds(), direction[3] = {0.36, 0.8, 0.48};
    if (parian_refractor_create(env, &b.mesh, argc > 2 ? atof(argv[2]) : 1.5, &b.refractor) !=
        PARIAN_OK) {
        return 1;
    }
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ);
    printf("%u triangles, hierarchy built in %.3f s\n", b.mesh.triangle_count,
           process_seconds() - start);
    for (double longest = 5; longest <= 50; longest *= 10) {
        parian_refractor_index *index = NULL;
        start = process_seconds();
        if (parian_refractor_prepare_direction(env, b.refractor, direction, longest * b.edge,
                                               &index) != PARIAN_OK) {
            return 1;
        }
        printf("index of paths up to %.0f edges built in %.3f s\n", longest,
               process_seconds() - start);
        for (int d = 0; d < 5; d++) {
            for (int kind = 0; kind < 4; kind++) {
                run(&b, kind, kind == 3 ? index : NULL, depths[d], longest);
            }
        }
        parian_refractor_index_destroy(index);
    }
    parian_refractor_destroy(b.refractor);
    parian_free(env, b.x);
    parian_free(env, b.normal);
    parian_free(env, b.way);
    parian_mesh_free(env, &b.mesh);
    return 0;
}
