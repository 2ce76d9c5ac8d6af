/* test_medium_field.c - arrays as fields: which axis is which, units, factors, and what is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "bake/reference/medium_field.h"
#include "bake/reference/path_medium.h"
#include "core/memory.h"

enum { X = 4, Y = 3, Z = 2 };
static const parian_medium medium = {
    .sigma_s_prime = {100, 200, 300}, .sigma_a = {1, 2, 3}, .g = {0.5, 0, -0.5}, .eta = 1.3};

static char said[512];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        strncpy(said, text, sizeof said - 1);
    }
}

static const parian_env listening = {.log = keep_error};

/* A box of 6 x 4 x 2 mm about the origin: nodes of the 4 x 3 x 2 grid are 2 mm apart. */
static void make_scene(parian_reference_scene *scene)
{
    memset(scene, 0, sizeof *scene);
    assert_true(PARIAN_NEW0(NULL, scene->bodies, 1));
    assert_int_equal(test_box(NULL, 6e-3, 4e-3, 2e-3, 2, &scene->bodies[0].mesh), PARIAN_OK);
    scene->bodies[0].medium = medium;
    scene->body_count = 1;
}

static void free_scene(parian_reference_scene *scene)
{
    parian_reference_scene_free(NULL, scene);
}

static void coefficients_at(const parian_reference_scene *scene, int x, int y, int z, int channel,
                            double *s, double *a)
{
    const double *lower = scene->bodies[0].field->lower;
    const double at[3] = {lower[0] + 2e-3 * x, lower[1] + 2e-3 * y, lower[2] + 2e-3 * z};
    parian_path_medium m = parian_path_medium_make(&scene->bodies[0], channel);
    parian_path_medium_at(&m, at, s, a);
}

static void assert_close(double found, double expected)
{
    assert_true(fabs(found - expected) <= 1e-5 * fabs(expected)); /* floats */
}

/* Factors [z][y][x] multiply sigma_s' / (1 - g) and sigma_a. */
static void factors_lie_along_their_axes(void **state)
{
    (void)state;
    parian_reference_scene scene;
    double value[Z * Y * X], s, a;
    parian_npy array = {.rank = 3, .shape = {Z, Y, X}, .count = Z * Y * X, .value = value};
    for (int i = 0; i < Z * Y * X; i++) {
        value[i] = 1 + i;
    }
    make_scene(&scene);
    assert_int_equal(parian_medium_field_check(&listening, "f.npy", &array), PARIAN_OK);
    assert_int_equal(parian_medium_field_attach(&listening, "f.npy", &array, &scene), PARIAN_OK);
    for (int i = 0; i < Z * Y * X; i++) {
        for (int c = 0; c < 3; c++) {
            coefficients_at(&scene, i % X, i / X % Y, i / (X * Y), c, &s, &a);
            assert_close(s, value[i] * medium.sigma_s_prime[c] / (1 - medium.g[c]));
            assert_close(a, value[i] * medium.sigma_a[c]);
        }
    }
    free_scene(&scene);
}

/* Values [z][y][x][6] are sigma_s of three channels, then sigma_a, in mm^-1. */
static void values_are_per_millimetre(void **state)
{
    (void)state;
    parian_reference_scene scene;
    double value[Z * Y * X * 6], s, a;
    parian_npy array = {.rank = 4, .shape = {Z, Y, X, 6}, .count = Z * Y * X * 6, .value = value};
    for (int i = 0; i < Z * Y * X * 6; i++) {
        value[i] = 0.25 * i;
    }
    make_scene(&scene);
    assert_int_equal(parian_medium_field_check(&listening, "f.npy", &array), PARIAN_OK);
    assert_int_equal(parian_medium_field_attach(&listening, "f.npy", &array, &scene), PARIAN_OK);
    for (int i = 0; i < Z * Y * X; i++) {
        for (int c = 0; c < 3; c++) {
            coefficients_at(&scene, i % X, i / X % Y, i / (X * Y), c, &s, &a);
            assert_close(s, 1e3 * value[6 * i + c]);
            assert_close(a, 1e3 * value[6 * i + 3 + c]);
        }
    }
    free_scene(&scene);
}

/* Beyond what path tracing takes, in factors and in values: the file is named. */
static void coefficients_without_bounds_are_refused(void **state)
{
    (void)state;
    double value[6 * 8];
    for (int rank = 3; rank < 5; rank++) {
        parian_reference_scene scene;
        parian_npy array = {.rank = (uint32_t)rank,
                            .shape = {2, 2, 2, 6},
                            .count = rank == 3 ? 8 : 48,
                            .value = value};
        for (size_t i = 0; i < array.count; i++) {
            value[i] = i + 1 == array.count ? 1e14 : 1;
        }
        make_scene(&scene);
        assert_int_equal(parian_medium_field_check(&listening, "f.npy", &array), PARIAN_OK);
        assert_int_equal(parian_medium_field_attach(&listening, "f.npy", &array, &scene),
                         PARIAN_E_FORMAT);
        assert_non_null(strstr(said, "f.npy: node 7"));
        free_scene(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(factors_lie_along_their_axes),
        cmocka_unit_test(values_are_per_millimetre),
        cmocka_unit_test(coefficients_without_bounds_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
