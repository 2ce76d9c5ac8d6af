/* path_case.h - scenes of one body for the path tracing tests and benchmark: mesh, medium, lights,
 * receivers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_PATH_CASE_H
#define PARIAN_TEST_PATH_CASE_H

#include <math.h>
#include <string.h>

#include "bake/reference/light_sampler.h"
#include "bake/reference/path_tracing.h"
#include "bake/reference/rays.h"
#include "bake/reference/reference.h"
#include "core/memory.h"
#include "core/small_maths.h"
#include "support/test_support.h"

/* Marble, green, as the planar oracles have it: unit of length = the mean free path = 1 mm,
 * isotropic. */
static const parian_medium path_case_marble = {.name = "marble G",
                                               .sigma_s_prime = {998.4376, 998.4376, 998.4376},
                                               .sigma_a = {1.5624, 1.5624, 1.5624},
                                               .eta = 1.5,
                                               .reduced_only = true};

static const parian_light path_case_sky = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 1, 1}};

/* A scene of one closed body; takes the mesh over. Lights are copied. */
static inline void path_case_scene(const parian_env *env, parian_mesh *mesh,
                                   const parian_medium *medium, const parian_light *lights,
                                   uint32_t light_count, parian_reference_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    assert_true(PARIAN_NEW0(env, scene->bodies, 1));
    assert_true(PARIAN_NEW0(env, scene->lights, light_count));
    assert_int_equal(parian_mesh_make_corner_normals(env, mesh, 50), PARIAN_OK);
    scene->body_count = 1;
    scene->light_count = light_count;
    if (light_count > 0) {
        memcpy(scene->lights, lights, light_count * sizeof *lights);
    }
    strcpy(scene->bodies[0].name, "body");
    scene->bodies[0].mesh = *mesh;
    scene->bodies[0].closed = true;
    scene->bodies[0].medium = *medium;
    memset(mesh, 0, sizeof *mesh);
    parian_mesh_bounds(&scene->bodies[0].mesh, scene->lower, scene->upper);
    for (int k = 0; k < 3; k++) {
        scene->extent = fmax(scene->extent, scene->upper[k] - scene->lower[k]);
    }
    const parian_mesh *all[1] = {&scene->bodies[0].mesh};
    assert_int_equal(parian_rays_create(env, all, 1, &scene->rays), PARIAN_OK);
    assert_int_equal(parian_light_sampler_create(env, scene->lights, light_count, &scene->sampler),
                     PARIAN_OK);
}

static inline void path_case_receivers(const parian_env *env, size_t count,
                                       parian_receivers *receivers)
{
    memset(receivers, 0, sizeof *receivers);
    receivers->count = count;
    assert_true(PARIAN_NEW0(env, receivers->position, count));
    assert_true(PARIAN_NEW0(env, receivers->normal, count));
    assert_true(PARIAN_NEW0(env, receivers->smooth_normal, count));
    assert_true(PARIAN_NEW0(env, receivers->area, count));
    assert_true(PARIAN_NEW0(env, receivers->body, count));
    assert_true(PARIAN_NEW0(env, receivers->triangle, count));
    assert_true(PARIAN_NEW0(env, receivers->barycentric, count));
}

/* Put receiver i on a triangle of body 0. */
static inline void path_case_put(const parian_reference_scene *scene, parian_receivers *receivers,
                                 size_t i, uint32_t triangle, double u, double v)
{
    const parian_mesh *mesh = &scene->bodies[0].mesh;
    const uint32_t *corner = mesh->triangle[triangle];
    double b[3] = {1 - u - v, u, v}, e[2][3];
    for (int k = 0; k < 3; k++) {
        receivers->position[i][k] = b[0] * mesh->position[corner[0]][k] +
                                    b[1] * mesh->position[corner[1]][k] +
                                    b[2] * mesh->position[corner[2]][k];
        receivers->barycentric[i][k] = b[k];
        e[0][k] = mesh->position[corner[1]][k] - mesh->position[corner[0]][k];
        e[1][k] = mesh->position[corner[2]][k] - mesh->position[corner[0]][k];
    }
    double *n = receivers->normal[i];
    parian_cross3(e[0], e[1], n);
    double length = sqrt(parian_dot3(n, n));
    for (int k = 0; k < 3; k++) {
        n[k] /= length;
        receivers->smooth_normal[i][k] = n[k];
    }
    receivers->triangle[i] = triangle;
    receivers->area[i] = 1;
}

/* One place in each of count equal shares of the area, chosen by a fixed random stream; area is the
 * share. */
static inline void path_case_spread(const parian_env *env, const parian_reference_scene *scene,
                                    size_t count, parian_receivers *receivers)
{
    const parian_mesh *mesh = &scene->bodies[0].mesh;
    double total = parian_mesh_area(mesh), sum = 0;
    parian_random random = parian_random_stream(77, count, 0, 0);
    size_t next = 0;
    double at = parian_random_unit(&random) * total / (double)count;
    path_case_receivers(env, count, receivers);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double e[2][3], n[3];
        for (int k = 0; k < 3; k++) {
            const double *a = mesh->position[mesh->triangle[t][0]];
            e[0][k] = mesh->position[mesh->triangle[t][1]][k] - a[k];
            e[1][k] = mesh->position[mesh->triangle[t][2]][k] - a[k];
        }
        parian_cross3(e[0], e[1], n);
        sum += 0.5 * sqrt(parian_dot3(n, n));
        while (next < count && (at < sum || t + 1 == mesh->triangle_count)) {
            double root = sqrt(parian_random_unit(&random)), v = parian_random_unit(&random);
            path_case_put(scene, receivers, next, t, root * (1 - v), root * v);
            receivers->area[next++] = total / (double)count;
            at = ((double)next + parian_random_unit(&random)) * total / (double)count;
        }
    }
}

/* Mean over the receivers of a field of results, and its standard error by those of the receivers.
 */
static inline double path_case_mean(const double (*value)[3], size_t count, int channel)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += value[i][channel];
    }
    return sum / (double)count;
}

static inline double path_case_error(const parian_reference_result *result, size_t count,
                                     int channel)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += result->standard_error[i][channel] * result->standard_error[i][channel];
    }
    return sqrt(sum) / (double)count;
}

#endif
