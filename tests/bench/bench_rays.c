/* bench_rays.c - rays per second in a ball of triangles, and how many leak.
 *
 *   bench_rays [CUTS]
 *
 * A ball of 50 mm whose edges are cut CUTS times (default 71: 100,820 triangles). Walks from the
 * surface inwards with isotropic scattering at three mean free paths, as path tracing asks for
 * rays; rays at random places, which no cache foresees; rays from the surface inwards without end,
 * of which none may miss; and rays aimed exactly at corners. Seconds are of processor time, so
 * per core.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "bake/reference/rays.h"
#include "core/random.h"

enum { RAYS = 3000000, EVENTS_MAX = 2000 };
static const double pi = 3.14159265358979323846, radius = 0.025;

static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void random_direction(parian_random *random, double out[3])
{
    double z = 2 * parian_random_unit(random) - 1, phi = 2 * pi * parian_random_unit(random);
    double s = sqrt(1 - z * z);
    out[0] = s * cos(phi);
    out[1] = s * sin(phi);
    out[2] = z;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A ray from a random place of the surface into the inside (a ball's facets face away from its
 * centre). */
static parian_ray inward_ray(const parian_mesh *mesh, parian_random *random)
{
    uint32_t t = (uint32_t)(parian_random_unit(random) * mesh->triangle_count);
    const uint32_t *corner = mesh->triangle[t];
    double u = sqrt(parian_random_unit(random)), v = parian_random_unit(random), e[2][3];
    parian_ray ray = {.length = INFINITY, .mesh = 0, .triangle = t};
    for (int k = 0; k < 3; k++) {
        e[0][k] = mesh->position[corner[1]][k] - mesh->position[corner[0]][k];
        e[1][k] = mesh->position[corner[2]][k] - mesh->position[corner[0]][k];
        ray.origin[k] = mesh->position[corner[0]][k] + u * (1 - v) * e[0][k] + u * v * e[1][k];
    }
    const double normal[3] = {e[0][1] * e[1][2] - e[0][2] * e[1][1],
                              e[0][2] * e[1][0] - e[0][0] * e[1][2],
                              e[0][0] * e[1][1] - e[0][1] * e[1][0]};
    random_direction(random, ray.direction);
    for (int k = 0, turn = dot(ray.direction, normal) > 0; turn && k < 3; k++) {
        ray.direction[k] = -ray.direction[k];
    }
    return ray;
}

static void time_walks(const parian_rays *rays, const parian_mesh *mesh, double mean_free_path)
{
    parian_random random = parian_random_stream(1, 0, 0, 0);
    size_t count = 0;
    double start = cpu_seconds();
    while (count < RAYS) {
        parian_ray ray = inward_ray(mesh, &random);
        parian_ray_hit hit;
        for (int event = 0; event < EVENTS_MAX; event++) {
            ray.length = -log(1 - parian_random_unit(&random)) * mean_free_path;
            count++;
            if (parian_rays_nearest(rays, &ray, 0, &hit)) {
                break;
            }
            for (int k = 0; k < 3; k++) {
                ray.origin[k] += ray.length * ray.direction[k];
            }
            ray.mesh = ray.triangle = PARIAN_RAY_NONE;
            random_direction(&random, ray.direction);
        }
    }
    printf("walks, mean free path %4.1f mm      %6.2f million a second\n", 1e3 * mean_free_path,
           1e-6 * (double)count / (cpu_seconds() - start));
}

static void time_strewn_rays(const parian_rays *rays, double length)
{
    parian_random random = parian_random_stream(2, 0, 0, 0);
    size_t hits = 0;
    double start = cpu_seconds();
    for (size_t i = 0; i < RAYS; i++) {
        parian_ray ray = {.length = length, .mesh = PARIAN_RAY_NONE, .triangle = PARIAN_RAY_NONE};
        parian_ray_hit hit;
        random_direction(&random, ray.origin);
        random_direction(&random, ray.direction);
        double r = 0.99 * radius * cbrt(parian_random_unit(&random));
        for (int k = 0; k < 3; k++) {
            ray.origin[k] *= r;
        }
        hits += parian_rays_nearest(rays, &ray, 0, &hit);
    }
    printf("strewn rays of %4.1f mm             %6.2f million a second, %.1f %% hit\n",
           1e3 * length, 1e-6 * RAYS / (cpu_seconds() - start), 100.0 * (double)hits / RAYS);
}

static void count_leaks(const parian_rays *rays, const parian_mesh *mesh)
{
    parian_random random = parian_random_stream(3, 0, 0, 0);
    size_t missed = 0, entered = 0;
    double start = cpu_seconds();
    for (size_t i = 0; i < RAYS; i++) {
        parian_ray ray = inward_ray(mesh, &random);
        parian_ray_hit hit;
        if (!parian_rays_nearest(rays, &ray, 0, &hit)) {
            missed++;
        } else {
            entered += dot(hit.normal, ray.direction) <= 0;
        }
    }
    printf("from the surface, without end       %6.2f million a second, %zu of %d missed, %zu from "
           "outside\n",
           1e-6 * RAYS / (cpu_seconds() - start), missed, RAYS, entered);
}

static void count_misses_at_corners(const parian_rays *rays, const parian_mesh *mesh)
{
    parian_random random = parian_random_stream(4, 0, 0, 0);
    size_t missed = 0;
    for (size_t i = 0; i < RAYS; i++) {
        parian_ray ray = {.length = INFINITY, .mesh = PARIAN_RAY_NONE, .triangle = PARIAN_RAY_NONE};
        parian_ray_hit hit;
        const double *to = mesh->position[i % mesh->vertex_count];
        for (int k = 0; k < 3; k++) {
            ray.origin[k] = 0.5 * radius * (2 * parian_random_unit(&random) - 1);
            ray.direction[k] = to[k] - ray.origin[k];
        }
        double length = sqrt(dot(ray.direction, ray.direction));
        for (int k = 0; k < 3; k++) {
            ray.direction[k] /= length;
        }
        missed += !parian_rays_nearest(rays, &ray, 0, &hit);
    }
    printf("aimed exactly at corners            %zu of %d missed\n", missed, RAYS);
}

int main(int argc, char **argv)
{
    unsigned cuts = argc > 1 ? (unsigned)strtoul(argv[1], NULL, 10) : 71;
    parian_mesh mesh = {0};
    parian_rays *rays = NULL;
    const parian_mesh *meshes[1] = {&mesh};
    if (cuts < 1 || cuts > 1000 || test_sphere(NULL, radius, cuts, &mesh) != PARIAN_OK) {
        fprintf(stderr, "bench_rays: no ball of %u cuts (1 to 1000)\n", cuts);
        return EXIT_FAILURE;
    }
    double start = cpu_seconds();
    if (parian_rays_create(test_env(1), meshes, 1, &rays) != PARIAN_OK) {
        fprintf(stderr, "bench_rays: no rays\n");
        return EXIT_FAILURE;
    }
    printf("%u triangles, tree in %.2f s\n", mesh.triangle_count, cpu_seconds() - start);
    time_walks(rays, &mesh, 0.1e-3);
    time_walks(rays, &mesh, 0.4e-3);
    time_walks(rays, &mesh, 2e-3);
    time_strewn_rays(rays, 0.1e-3);
    time_strewn_rays(rays, 1e-3);
    count_leaks(rays, &mesh);
    count_misses_at_corners(rays, &mesh);
    parian_rays_destroy(rays);
    parian_mesh_free(NULL, &mesh);
    return EXIT_SUCCESS;
}
