/* bench_samples.c - Poisson-disk sample sets: seconds, promises kept, and the error of integrals
 * beside other kinds of sets.
 *
 *   bench_samples [--count N] MODEL...
 *
 * Models are scaled to 50 mm; without any a sphere is taken. For each: the set of N samples
 * (20,000), then, at 100 to 6400 samples, the error of the flux that enters under a directional
 * light and of B in marble at 100 receivers, for uniform random points, points stratified by area,
 * random darts at the least distance without filling of gaps, and this set whole and as first part
 * of the large one. Errors are root mean squares over 8 seeds, relative; the truth is the sum over
 * every triangle cut until edges are below a tenth of a mean free path or the triangles are taken
 * whole.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/import.h"
#include "bake/stages/samples.h"
#include "bake/stages/surface.h"
#include "core/dipole.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/small_maths.h"
#include "tool/media_file.h"
#include "tool/session.h"

enum { RECEIVERS = 100, SEEDS = 8 };

/* Points with areas that stand for a surface. */
typedef struct point_set {
    uint32_t count;
    parian_point *point;
    double *area;
} point_set;

typedef struct bench_case {
    const char *name;
    parian_sampled_surface surface;
    double *until; /* [triangle_count] area up to and with each */
    double area;
    parian_dipole dipole; /* marble, green */
    parian_point receiver[RECEIVERS];
    double flux, radiosity[RECEIVERS]; /* the truth */
} bench_case;

static const double LIGHT[3] = {0.3713906763541037, 0.5570860145311556, 0.7427813527082074};

static double irradiance_at(const parian_point *p)
{
    return fmax(0, parian_dot3(p->normal, LIGHT));
}

/* Flux that enters (without Fresnel, without shadows) and B at the receivers. */
static void integrate(const bench_case *c, const point_set *set, double *flux, double *radiosity)
{
    *flux = 0;
    memset(radiosity, 0, RECEIVERS * sizeof *radiosity);
    for (uint32_t i = 0; i < set->count; i++) {
        double power = irradiance_at(&set->point[i]) * set->area[i];
        *flux += power;
        for (int k = 0; k < RECEIVERS && power > 0; k++) {
            radiosity[k] +=
                power * parian_dipole_rd(&c->dipole,
                                         parian_points_squared(&set->point[i], &c->receiver[k]));
        }
    }
}

/* ---- kinds of sets ---- */

static point_set set_with_room(uint32_t count)
{
    point_set set = {.count = count};
    if (!PARIAN_NEW(NULL, set.point, count) || !PARIAN_NEW(NULL, set.area, count)) {
        abort();
    }
    return set;
}

static void free_set(point_set *set)
{
    parian_free(NULL, set->point);
    parian_free(NULL, set->area);
}

static parian_point point_by_area(const bench_case *c, double area, double u, double v)
{
    uint32_t low = 0, high = c->surface.triangle_count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (c->until[middle] > area) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    float root = sqrtf((float)u), at[2] = {1 - root, root * (1 - (float)v)};
    return parian_surface_point(&c->surface, low, at);
}

/* Uniform by area; stratified: one in each of equal shares of the area in the mesh's order. */
static point_set random_set(const bench_case *c, uint32_t count, uint64_t seed, bool stratified)
{
    point_set set = set_with_room(count);
    for (uint32_t i = 0; i < count; i++) {
        parian_random random = parian_random_stream(seed, 7, i, 0);
        double share = parian_random_unit(&random), u = parian_random_unit(&random);
        share = stratified ? (i + share) / count : share;
        set.point[i] = point_by_area(c, share * c->area, u, parian_random_unit(&random));
        set.area[i] = c->area / count;
    }
    return set;
}

/* Random darts that keep the distance of a set of that many, each of the same area; no more are
 * thrown once there are as many as wanted or 30 for each. */
static point_set dart_set(const bench_case *c, uint32_t count, uint64_t seed, double radius)
{
    parian_point_grid grid;
    if (parian_point_grid_create(NULL, radius, count, &grid) != PARIAN_OK) {
        abort();
    }
    for (uint64_t i = 0; i < 30 * (uint64_t)count && grid.count < count; i++) {
        parian_random random = parian_random_stream(seed, 8, i, 0);
        double share = parian_random_unit(&random), u = parian_random_unit(&random);
        parian_point p = point_by_area(c, share * c->area, u, parian_random_unit(&random));
        if (!parian_point_grid_has(&grid, &p, radius)) {
            parian_point_grid_put(NULL, &grid, &p);
        }
    }
    point_set set = set_with_room(grid.count);
    for (uint32_t i = 0; i < grid.count; i++) {
        set.point[i] = grid.point[i];
        set.area[i] = c->area / grid.count;
    }
    parian_point_grid_free(NULL, &grid);
    return set;
}

static point_set set_of_samples(const bench_case *c, const parian_surface_samples *samples,
                                uint32_t count, bool own_areas)
{
    point_set set = set_with_room(count);
    for (uint32_t i = 0; i < count; i++) {
        set.point[i] =
            parian_surface_point(&c->surface, samples->triangle[i], samples->barycentric[i]);
        set.area[i] = own_areas ? (double)samples->area[i] : c->area / count;
    }
    return set;
}

/* ---- the truth ---- */

static void add_triangle(bench_case *c, const parian_point corner[3], double area, int depth)
{
    static const double edge_most = 0.1;
    double edge = 0, z = c->dipole.z_r;
    for (int k = 0; k < 3; k++) {
        edge = fmax(edge, parian_points_squared(&corner[k], &corner[(k + 1) % 3]));
    }
    if (edge > edge_most * edge_most * z * z && depth < 8) {
        parian_point middle[3];
        for (int k = 0; k < 3; k++) {
            middle[k] = corner[k];
            for (int i = 0; i < 3; i++) {
                middle[k].position[i] =
                    (corner[k].position[i] + corner[(k + 1) % 3].position[i]) / 2;
            }
        }
        for (int k = 0; k < 3; k++) {
            const parian_point part[3] = {corner[k], middle[k], middle[(k + 2) % 3]};
            add_triangle(c, part, area / 4, depth + 1);
        }
        add_triangle(c, middle, area / 4, depth + 1);
        return;
    }
    point_set one = {1, (parian_point[1]){corner[0]}, &area};
    for (int i = 0; i < 3; i++) {
        one.point->position[i] =
            (corner[0].position[i] + corner[1].position[i] + corner[2].position[i]) / 3;
    }
    double flux, radiosity[RECEIVERS];
    integrate(c, &one, &flux, radiosity);
    c->flux += flux;
    for (int k = 0; k < RECEIVERS; k++) {
        c->radiosity[k] += radiosity[k];
    }
}

static void find_truth(bench_case *c)
{
    c->flux = 0;
    memset(c->radiosity, 0, sizeof c->radiosity);
    for (uint32_t t = 0; t < c->surface.triangle_count; t++) {
        const float at[3][2] = {{1, 0}, {0, 1}, {0, 0}};
        parian_point corner[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = parian_surface_point(&c->surface, t, at[k]);
        }
        if (irradiance_at(&corner[0]) > 0) {
            add_triangle(c, (const parian_point *)corner, c->until[t] - (t ? c->until[t - 1] : 0),
                         0);
        }
    }
}

/* ---- tables ---- */

typedef struct error_sum {
    double flux, radiosity, count;
    int seeds;
} error_sum;

static void add_error(const bench_case *c, point_set set, error_sum *sum)
{
    double flux, radiosity[RECEIVERS], difference = 0, norm = 0;
    integrate(c, &set, &flux, radiosity);
    for (int k = 0; k < RECEIVERS; k++) {
        difference += (radiosity[k] - c->radiosity[k]) * (radiosity[k] - c->radiosity[k]);
        norm += c->radiosity[k] * c->radiosity[k];
    }
    sum->flux += (flux / c->flux - 1) * (flux / c->flux - 1);
    sum->radiosity += difference / norm;
    sum->count += set.count;
    sum->seeds++;
    free_set(&set);
}

static void print_row(const bench_case *c, const char *kind, const error_sum *sum)
{
    printf("| %s | %s | %.0f | %.3f | %.3f |\n", c->name, kind, sum->count / sum->seeds,
           100 * sqrt(sum->flux / sum->seeds), 100 * sqrt(sum->radiosity / sum->seeds));
    fflush(stdout);
}

static void bench_integrals(const parian_env *env, const bench_case *c,
                            const parian_surface_samples *large)
{
    enum { RANDOM, STRATIFIED, DARTS, SET, PREFIX, KINDS };
    static const char *const name[KINDS] = {"uniform random", "stratified by area",
                                            "darts, gaps left", "Poisson-disk set",
                                            "first part of the large set"};
    for (uint32_t count = 100; count <= 6400 && count <= large->count; count *= 4) {
        error_sum sum[KINDS] = {{0}};
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            parian_surface_samples set;
            parian_samples_report report;
            parian_samples_desc desc = {.count = count, .seed = seed};
            if (parian_stage_samples(env, &c->surface, &desc, &set, &report) != PARIAN_OK) {
                return;
            }
            add_error(c, random_set(c, count, seed, false), &sum[RANDOM]);
            add_error(c, random_set(c, count, seed, true), &sum[STRATIFIED]);
            add_error(c, dart_set(c, count, seed, set.radius_m), &sum[DARTS]);
            add_error(c, set_of_samples(c, &set, set.count, true), &sum[SET]);
            if (seed == 0) {
                add_error(c, set_of_samples(c, large, count, false), &sum[PREFIX]);
            }
            parian_surface_samples_free(env, &set);
        }
        for (int k = 0; k < KINDS; k++) {
            print_row(c, name[k], &sum[k]);
        }
    }
}

/* Least distance over the radius and the largest gap over it, at 20,000 random points. */
static void check_promises(const bench_case *c, const parian_surface_samples *samples,
                           double *least, double *gap)
{
    parian_point_grid grid;
    point_set set = set_of_samples(c, samples, samples->count, true);
    double squared, r = samples->radius_m;
    *least = 1.5;
    *gap = 0;
    if (parian_point_grid_create(NULL, 1.5 * r, set.count, &grid) != PARIAN_OK) {
        abort();
    }
    for (uint32_t i = 0; i < set.count; i++) {
        parian_point_grid_put(NULL, &grid, &set.point[i]);
    }
    for (uint32_t i = 0; i < set.count; i++) {
        parian_point_grid_nearest(&grid, &set.point[i], 1.5 * r, i, &squared);
        *least = fmin(*least, sqrt(squared) / r);
    }
    for (uint32_t i = 0; i < 20000; i++) {
        parian_random random = parian_random_stream(5, i, 0, 0);
        double share = parian_random_unit(&random), u = parian_random_unit(&random);
        parian_point p = point_by_area(c, share * c->area, u, parian_random_unit(&random));
        parian_point_grid_nearest(&grid, &p, 1.5 * r, PARIAN_NO_POINT, &squared);
        *gap = fmax(*gap, sqrt(squared) / r);
    }
    parian_point_grid_free(NULL, &grid);
    free_set(&set);
}

static void bench_set(const parian_env *env, bench_case *c, uint32_t count)
{
    parian_surface_samples large;
    parian_samples_report report;
    parian_samples_desc desc = {.count = count};
    double start = parian_seconds(), least, gap;
    if (parian_stage_samples(env, &c->surface, &desc, &large, &report) != PARIAN_OK) {
        return;
    }
    double seconds = parian_seconds() - start;
    check_promises(c, &large, &least, &gap);
    printf(
        "%s: %u triangles, %u samples in %.2f s, %u tries, radius %.4g mm, N r^2 / A %.3f, least "
        "distance %.6f r, largest gap %.4f r, uncovered %.2g of the area\n\n",
        c->name, c->surface.triangle_count, large.count, seconds, report.tries,
        1e3 * large.radius_m, large.count * large.radius_m * large.radius_m / c->area, least, gap,
        report.uncovered_m2 / c->area);
    printf("| model | set | samples | flux error %% | B error %% |\n|---|---|---|---|---|\n");
    bench_integrals(env, c, &large);
    printf("\n");
    parian_surface_samples_free(env, &large);
}

static void bench_mesh(const parian_env *env, const char *name, const parian_mesh *mesh,
                       uint32_t count)
{
    static const uint32_t green = 1;
    bench_case c = {.name = name};
    float(*vertex)[3] = NULL;
    double low[3], high[3], extent = 0;
    parian_mesh_bounds(mesh, low, high);
    for (int k = 0; k < 3; k++) {
        extent = fmax(extent, high[k] - low[k]);
    }
    if (!PARIAN_NEW(env, vertex, mesh->vertex_count) ||
        !PARIAN_NEW(env, c.until, mesh->triangle_count)) {
        abort();
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            vertex[v][k] = (float)((mesh->position[v][k] - (low[k] + high[k]) / 2) * 0.05 / extent);
        }
    }
    c.surface = (parian_sampled_surface){mesh->triangle_count, (const float(*)[3])vertex,
                                         (const uint32_t(*)[3])mesh->triangle};
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *i = mesh->triangle[t];
        c.area += parian_triangle_area(vertex[i[0]], vertex[i[1]], vertex[i[2]]);
        c.until[t] = c.area;
    }
    c.dipole = parian_dipole_make(parian_media_find("marble"), green, false);
    for (int k = 0; k < RECEIVERS; k++) {
        parian_random random = parian_random_stream(1, 2, (uint64_t)k, 0);
        double share = parian_random_unit(&random), u = parian_random_unit(&random);
        c.receiver[k] = point_by_area(&c, share * c.area, u, parian_random_unit(&random));
    }
    find_truth(&c);
    bench_set(env, &c, count);
    parian_free(env, c.until);
    parian_free(env, vertex);
}

static void bench_model(const parian_env *env, const char *path, uint32_t count)
{
    parian_source_scene scene;
    parian_surface_report report;
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    parian_result result = parian_import(env, path, &scene);
    if (result != PARIAN_OK) {
        printf("%s: %s\n", name, parian_result_text(result));
        return;
    }
    result = parian_stage_surface(env, &scene.parts[0].mesh, &report);
    if (result == PARIAN_OK) {
        bench_mesh(env, name, &scene.parts[0].mesh, count);
    }
    parian_source_scene_free(env, &scene);
}

int main(int argc, char **argv)
{
    const parian_env *env = test_env(0);
    uint32_t count = 20000;
    int first = 1;
    if (argc > 2 && strcmp(argv[1], "--count") == 0) {
        count = (uint32_t)strtoul(argv[2], NULL, 10);
        first = 3;
    }
    for (int i = first; i < argc; i++) {
        bench_model(env, argv[i], count);
    }
    if (first >= argc) {
        parian_mesh sphere;
        if (test_sphere(env, 0.025, 70, &sphere) == PARIAN_OK) {
            bench_mesh(env, "sphere", &sphere, count);
            parian_mesh_free(env, &sphere);
        }
    }
    return 0;
}
