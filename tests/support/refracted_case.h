/* refracted_case.h - meshes, lights and lists of paths for the tests of refracted paths.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_REFRACTED_CASE_H
#define PARIAN_TEST_REFRACTED_CASE_H

#include <math.h>
#include <string.h>

#include "bake/reference/refracted_paths.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/small_maths.h"

enum { FOUND_MAX = 512 };

static inline void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] - b[k];
    }
}

static inline double norm(const double a[3])
{
    return sqrt(parian_dot3(a, a));
}

static inline void normalise(double a[3])
{
    double length = norm(a);
    for (int k = 0; k < 3; k++) {
        a[k] /= length;
    }
}

static inline double uniform(parian_random *random, double low, double high)
{
    return low + (high - low) * parian_random_unit(random);
}

static inline void random_direction(parian_random *random, double out[3])
{
    do {
        for (int k = 0; k < 3; k++) {
            out[k] = uniform(random, -1, 1);
        }
    } while (norm(out) > 1 || norm(out) < 0.1);
    normalise(out);
}

/* What a search found; only the first count are set. */
typedef struct found_list {
    size_t count;
    parian_refracted_path path[FOUND_MAX];
} found_list;

static inline void collect(void *context, const parian_refracted_path *path)
{
    found_list *list = context;
    assert_true(list->count < FOUND_MAX);
    list->path[list->count++] = *path;
}

static inline double factor_sum(const found_list *list)
{
    double sum = 0;
    for (size_t i = 0; i < list->count; i++) {
        sum += list->path[i].factor;
    }
    return sum;
}

static inline void check_finite(const parian_refracted_path *path)
{
    for (int k = 0; k < 3; k++) {
        assert_true(isfinite(path->entry[k]) && isfinite(path->to_light[k]) &&
                    isfinite(path->into[k]));
    }
    assert_true(isfinite(path->factor) && path->factor >= 0 && path->length >= 0 &&
                path->light_distance > 0);
}

static inline void get_corners(const parian_mesh *mesh, uint32_t t, double v[3][3])
{
    for (int c = 0; c < 3; c++) {
        memcpy(v[c], mesh->position[mesh->triangle[t][c]], sizeof v[c]);
    }
}

static inline void make_mesh(uint32_t vertices, uint32_t triangles, parian_mesh *mesh)
{
    *mesh = (parian_mesh){.vertex_count = vertices, .triangle_count = triangles};
    assert_true(PARIAN_NEW0(NULL, mesh->position, vertices) &&
                PARIAN_NEW0(NULL, mesh->triangle, triangles));
}

/* A sphere with dents and hills; flat: its height over its width. */
static inline void make_blob(unsigned cuts, double depth, double waves, double flat,
                             parian_mesh *mesh)
{
    assert_int_equal(test_sphere(NULL, 0.5, cuts, mesh), PARIAN_OK);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double *p = mesh->position[i];
        double scale = 1 + depth * sin(waves * 2 * p[0]) * cos(waves * 2 * p[1] + 1) *
                               sin(waves * 2 * p[2] + 2);
        for (int k = 0; k < 3; k++) {
            p[k] *= scale * (k == 2 ? flat : 1);
        }
    }
}

static inline void random_light(parian_random *random, int kind, parian_light_point *light)
{
    static const double range[] = {0, 0.7, 3, 40, 1e5};
    random_direction(random, light->direction);
    light->at_infinity = kind == 0;
    for (int k = 0; k < 3; k++) {
        light->position[k] = light->direction[k] * range[kind];
    }
}

/* One facet of side about 20 in the plane z = 0, facing up. */
static inline void make_facet(parian_mesh *mesh)
{
    static const double corner[3][3] = {{-10, -8, 0}, {12, -9, 0}, {-1, 13, 0}};
    make_mesh(3, 1, mesh);
    memcpy(mesh->position, corner, sizeof corner);
    for (uint32_t k = 0; k < 3; k++) {
        mesh->triangle[0][k] = k;
    }
}

#endif
