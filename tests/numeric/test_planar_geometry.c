/* test_planar_geometry.c - flights in slab and ball: landing on the boundary, and many reflections
 * taken at once against the same reflections taken one by one.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "bake/reference/planar_geometry.h"

static void assert_within(double found, double expected, double bound, const char *what)
{
    if (!(fabs(found - expected) <= bound)) {
        print_error("%s: found %.15g, expected %.15g within %g\n", what, found, expected, bound);
        fail();
    }
}

/* From the boundary inwards, reflected by the mirror's law until the length is used up. */
static void hop_one_by_one(parian_planar_shape shape, double size, planar_ray *ray, double length)
{
    for (;;) {
        double distance = planar_distance(shape, size, ray), normal[3];
        if (length < distance) {
            planar_advance(ray, length);
            return;
        }
        planar_advance(ray, distance);
        length -= distance;
        planar_land(shape, size, ray, normal);
        parian_walk_reflect(ray->direction, normal);
    }
}

/* A ray that starts on the boundary, inwards. */
static planar_ray start(parian_planar_shape shape, double size, bool far_side,
                        parian_random *random)
{
    planar_ray ray = {.position = {0.3, -0.2, far_side ? -size : 0}, .direction = {0, 0, 1}};
    double normal[3] = {0, 0, far_side ? -1 : 1};
    if (shape == PARIAN_SPHERE) {
        parian_walk_scatter(normal, 0, random);
        for (int k = 0; k < 3; k++) {
            ray.position[k] = size * normal[k];
        }
    }
    parian_walk_scatter(ray.direction, 0, random);
    if (planar_dot(ray.direction, normal) > 0) {
        parian_walk_reflect(ray.direction, normal);
    }
    return ray;
}

/* Hops turn each other's errors into distance, n^2 1e-16 / cosine after n: 300 hops at a cosine of
 * 0.1 leave 1e-10. */
static void skipping_is_hopping(void **state)
{
    (void)state;
    parian_random random = parian_random_stream(1, 0, 0, 0);
    for (int i = 0; i < 4000; i++) {
        parian_planar_shape shape = i % 2 ? PARIAN_SPHERE : PARIAN_SLAB;
        double size = 0.7, length = (i % 3 ? 3 : 40) * parian_random_unit(&random);
        planar_ray hopped = start(shape, size, i % 4 < 2, &random), skipped = hopped;
        double cosine = shape == PARIAN_SPHERE
                            ? -planar_dot(skipped.position, skipped.direction) / size
                            : fabs(skipped.direction[2]);
        if (cosine < 0.1) {
            continue;
        }
        double rest = shape == PARIAN_SPHERE ? planar_skip_sphere(size, cosine, &skipped, length)
                                             : planar_skip_slab(size, &skipped, length);
        hop_one_by_one(shape, size, &hopped, length);
        hop_one_by_one(shape, size, &skipped, rest);
        for (int k = 0; k < 3; k++) {
            assert_within(skipped.position[k], hopped.position[k], 1e-9, "position");

            assert_within(skipped.direction[k], hopped.direction[k], 1e-9, "direction");
        }
    }
}

/* The limits: along the surface of a ball, and along the planes of a slab. */
static void grazing_creeps(void **state)
{
    (void)state;
    planar_ray ray = {.position = {0, 0, 2}, .direction = {1, 0, 0}};
    assert_true(planar_skip_sphere(2, 0, &ray, M_PI) == 0);
    assert_within(ray.position[0], 2, 1e-15, "a quarter turn");
    assert_within(ray.position[2], 0, 1e-15, "a quarter turn");
    assert_within(ray.direction[2], -1, 1e-15, "direction after it");
    planar_ray flat = {.position = {0, 0, -0.5}, .direction = {0, 1, 0}};
    assert_true(planar_distance(PARIAN_SLAB, 1, &flat) == INFINITY);
    assert_true(planar_skip_slab(1, &flat, 1e9) == 1e9);
}

static void landing_is_exact(void **state)
{
    (void)state;
    parian_random random = parian_random_stream(2, 0, 0, 0);
    for (int i = 0; i < 10000; i++) {
        parian_planar_shape shape = i % 2 ? PARIAN_SPHERE : PARIAN_SLAB;
        planar_ray ray = start(shape, 3e-5, i % 4 < 2, &random);
        planar_advance(&ray, planar_distance(shape, 3e-5, &ray) * parian_random_unit(&random));
        parian_walk_scatter(ray.direction, 0, &random);
        double distance = planar_distance(shape, 3e-5, &ray), normal[3];
        assert_true(distance >= 0);
        planar_advance(&ray, distance);
        planar_land(shape, 3e-5, &ray, normal);
        assert_within(planar_dot(normal, normal), 1, 1e-14, "normal");
        assert_true(planar_dot(normal, ray.direction) >= 0);
        if (shape == PARIAN_SPHERE) {
            assert_within(sqrt(planar_dot(ray.position, ray.position)), 3e-5, 1e-19, "radius");
        } else {
            assert_true(ray.position[2] == (normal[2] > 0 ? 0 : -3e-5));
        }
    }
    double pole[3] = {0, 0, -2};
    assert_within(planar_reach(PARIAN_SPHERE, 2, pole), 2 * M_PI, 1e-15, "arc to the far pole");
    double place[3] = {3, 4, -9};
    assert_within(planar_reach(PARIAN_SLAB, 9, place), 5, 1e-15, "radius on a plane");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skipping_is_hopping),
        cmocka_unit_test(grazing_creeps),
        cmocka_unit_test(landing_is_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
