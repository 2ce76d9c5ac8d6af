/* test_radiosity_metrics.c - errors of B on arrays whose answers are known by hand.
 *
 * Numbers are chosen to be exact in binary where that is possible; where not, 1e-14 is a few
 * roundings of a sum of a thousand terms.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "support/test_support.h"
#include "tests/measure/radiosity_metrics.h"

enum { MANY = 1000 };

#define CLOSE(value, expected) assert_true(fabs((value) - (expected)) <= 1e-14)

typedef const double (*triples)[3];

static void test_by_hand(void **state)
{
    /* Green: T = 4, 2, 1; B - T = 1, -1, 0.5; A = 1, 2, 4. */
    static const double value[3][3] = {{9, 5, 0}, {9, 1, 0}, {9, 1.5, 0}};
    static const double truth[3][3] = {{1, 4, 0}, {1, 2, 0}, {1, 1, 0}};
    static const double error[3][3] = {{0, 0.5, 0}, {0, 0.25, 0}, {0, 0.125, 0}};
    static const double area[3] = {1, 2, 4};
    parian_radiosity_metrics m;
    (void)state;
    assert_int_equal(parian_radiosity_measure(NULL, 3, 1, value, truth, error, area, &m),
                     PARIAN_OK);
    CLOSE(m.l1, 5.0 / 12);            /* (1 + 2 + 2) / (4 + 4 + 4) */
    CLOSE(m.l2, sqrt(4.0 / 28));      /* (1 + 2 + 1) / (16 + 8 + 4) */
    CLOSE(m.energy_ratio, 13.0 / 12); /* (5 + 2 + 6) / 12 */
    CLOSE(m.p999, 7.0 / 12);          /* 1 over the mean 12 / 7 */
    CLOSE(m.minimum, 7.0 / 12);       /* 1 over the mean */
    CLOSE(m.truth_error, sqrt((0.25 + 0.125 + 0.0625) / 7) * 7 / 12);
    assert_int_equal(m.not_finite, 0);
    assert_int_equal(parian_radiosity_measure(NULL, 3, 0, value, truth, NULL, area, &m), PARIAN_OK);
    assert_true(m.l1 == 8 && m.l2 == 8 && m.energy_ratio == 9 && m.p999 == 8 && m.minimum == 9);
    assert_true(m.truth_error == 0);
}

static void test_equal_is_zero(void **state)
{
    static double truth[MANY][3], area[MANY];
    parian_radiosity_metrics m;
    (void)state;
    for (int i = 0; i < MANY; i++) {
        truth[i][2] = 0.1 * i;
        area[i] = 1.0 + i % 7;
    }
    assert_int_equal(
        parian_radiosity_measure(NULL, MANY, 2, (triples)truth, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_true(m.l1 == 0 && m.l2 == 0 && m.energy_ratio == 1 && m.p999 == 0 && m.minimum == 0);
}

/* One receiver of 1000 is off: with 1/1000 of the area it is the last 0.1 %, with a little more it
 * is not. */
static void test_percentile_is_by_area(void **state)
{
    static double value[MANY][3], truth[MANY][3], area[MANY];
    parian_radiosity_metrics m;
    (void)state;
    for (int i = 0; i < MANY; i++) {
        truth[i][0] = 2;
        value[i][0] = i == 500 ? 12 : i % 2 ? 2.5 : 1.5;
        area[i] = 1;
    }
    assert_int_equal(
        parian_radiosity_measure(NULL, MANY, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_true(m.p999 == 0.25);
    area[500] = 2;
    assert_int_equal(
        parian_radiosity_measure(NULL, MANY, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_true(m.p999 == 5);
    area[500] = 0; /* no area, no error */
    assert_int_equal(
        parian_radiosity_measure(NULL, MANY, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_true(m.p999 == 0.25);
    CLOSE(m.l1, 0.25);
}

/* A receiver cut into parts of the same values changes nothing; nor does a scale of B and T, or of
 * the areas. */
static void test_invariance(void **state)
{
    static double value[2][2 * MANY][3], truth[2][2 * MANY][3], error[2][2 * MANY][3],
        area[2][2 * MANY];
    parian_radiosity_metrics m[2];
    (void)state;
    for (int i = 0; i < MANY; i++) {
        truth[0][i][0] = 1 + 0.5 * sin(0.3 * i);
        value[0][i][0] = truth[0][i][0] * (1 + 0.05 * cos(1.7 * i)) - 0.6 * (i == 77);
        error[0][i][0] = 0.01 * (1 + i % 3);
        area[0][i] = 1 + i % 5;
        for (int half = 0; half < 2; half++) {
            truth[1][2 * i + half][0] = 1024 * truth[0][i][0];
            value[1][2 * i + half][0] = 1024 * value[0][i][0];
            error[1][2 * i + half][0] = 1024 * error[0][i][0];
            area[1][2 * i + half] = 0.125 * area[0][i] * (half ? 0.75 : 0.25);
        }
    }
    for (int k = 0; k < 2; k++) {
        assert_int_equal(parian_radiosity_measure(NULL, k ? 2 * MANY : MANY, 0, (triples)value[k],
                                                  (triples)truth[k], (triples)error[k], area[k],
                                                  &m[k]),
                         PARIAN_OK);
    }
    CLOSE(m[0].l1, m[1].l1);
    CLOSE(m[0].l2, m[1].l2);
    CLOSE(m[0].energy_ratio, m[1].energy_ratio);
    CLOSE(m[0].p999, m[1].p999);
    CLOSE(m[0].minimum, m[1].minimum);
    CLOSE(m[0].truth_error, m[1].truth_error);
    assert_true(m[0].l1 > 0.01 && m[0].l1 < 0.05);
}

static void test_negative_values(void **state)
{
    static const double value[2][3] = {{-1, 0, 0}, {3, 0, 0}}, truth[2][3] = {{1, 0, 0}, {1, 0, 0}};
    static const double area[2] = {1, 1};
    parian_radiosity_metrics m;
    (void)state;
    assert_int_equal(parian_radiosity_measure(NULL, 2, 0, value, truth, NULL, area, &m), PARIAN_OK);
    assert_true(m.energy_ratio == 1 && m.l1 == 2 && m.l2 == 2 && m.p999 == 2 && m.minimum == -1);
    assert_int_equal(parian_radiosity_measure(NULL, 2, 1, value, truth, NULL, area, &m), PARIAN_OK);
    assert_true(m.energy_ratio == 1 && m.l1 == 0 && m.p999 == 0 &&
                m.minimum == 0); /* dark, and truly so */
    static const double dark[2][3] = {{0, 0, 0}, {0, 0, 0}};
    assert_int_equal(parian_radiosity_measure(NULL, 2, 0, value, dark, NULL, area, &m), PARIAN_OK);
    assert_true(isinf(m.energy_ratio) && isinf(m.l1) && isinf(m.l2) && isinf(m.p999));
    assert_true(m.minimum == -INFINITY);
}

static void test_not_finite(void **state)
{
    double value[3][3] = {{NAN, 0, 0}, {2, 0, 0}, {INFINITY, 0, 0}};
    double truth[3][3] = {{5, 0, 0}, {1, 0, 0}, {7, 0, 0}}, area[3] = {1, 1, 1};
    parian_radiosity_metrics m;
    (void)state;
    assert_int_equal(
        parian_radiosity_measure(NULL, 3, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_int_equal(m.not_finite, 2);
    assert_true(m.l1 == 1 && m.energy_ratio == 2 && m.minimum == 2);
    value[1][0] = -NAN; /* nothing left: that is not an error of zero */
    assert_int_equal(
        parian_radiosity_measure(NULL, 3, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_int_equal(m.not_finite, 3);
    assert_true(isnan(m.l1) && isnan(m.l2) && isnan(m.energy_ratio) && isnan(m.p999) &&
                isnan(m.minimum));
    assert_int_equal(
        parian_radiosity_measure(NULL, 0, 0, (triples)value, (triples)truth, NULL, area, &m),
        PARIAN_OK);
    assert_true(m.l1 == 0 && m.energy_ratio == 1 && m.not_finite == 0);
}

static void test_bad_arguments(void **state)
{
    static const double value[1][3] = {{1, 1, 1}};
    double truth[1][3] = {{1, 1, 1}}, error[1][3] = {{0, 0, 0}}, area[1] = {1};
    parian_radiosity_metrics m = {.l1 = 42};
    test_memory memory = {.fail_at = 0};
    parian_env env = test_failing_env(&memory);
    (void)state;
    assert_int_equal(parian_radiosity_measure(NULL, 1, 3, value, (triples)truth, NULL, area, &m),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_radiosity_measure(NULL, 1, -1, value, (triples)truth, NULL, area, &m),
                     PARIAN_E_ARGUMENT);
    area[0] = -1;
    assert_int_equal(parian_radiosity_measure(NULL, 1, 0, value, (triples)truth, NULL, area, &m),
                     PARIAN_E_ARGUMENT);
    area[0] = 1;
    error[0][0] = INFINITY;
    assert_int_equal(
        parian_radiosity_measure(NULL, 1, 0, value, (triples)truth, (triples)error, area, &m),
        PARIAN_E_ARGUMENT);
    assert_int_equal(parian_radiosity_measure(&env, 1, 0, value, (triples)truth, NULL, area, &m),
                     PARIAN_E_NOMEM);
    truth[0][0] = NAN;
    assert_int_equal(parian_radiosity_measure(NULL, 1, 0, value, (triples)truth, NULL, area, &m),
                     PARIAN_E_ARGUMENT);
    assert_true(m.l1 == 42); /* written only on success */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_by_hand),
        cmocka_unit_test(test_equal_is_zero),
        cmocka_unit_test(test_percentile_is_by_area),
        cmocka_unit_test(test_invariance),
        cmocka_unit_test(test_negative_values),
        cmocka_unit_test(test_not_finite),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
