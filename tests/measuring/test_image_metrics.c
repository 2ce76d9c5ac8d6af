/* test_image_metrics.c - RMSE, relMSE, PSNR by hand; FLIP against closed forms and an independent
 * evaluation.
 *
 * The quoted FLIP values were made with a second program, written after the papers alone:
 * two-dimensional filters summed directly. What is left is the rounding of maps to float and of
 * printed constants: 1e-6 of a value in [0, 1].
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tests/measure/flip.h"
#include "tests/measure/image_metrics.h"

enum { WIDTH = 37, HEIGHT = 29, COUNT = WIDTH * HEIGHT, SIDE = 5, SMALL = SIDE * SIDE };

static const double TOLERANCE = 1e-6;

/* Waves of several lengths and a square with sharp edges; the other one is tinted, with a bar and a
 * dot. */
static void make_pictures(float image[COUNT][4], float reference[COUNT][4])
{
    for (int i = 0; i < COUNT; i++) {
        int x = i % WIDTH, y = i / WIDTH;
        double r[3] = {.5 + .45 * sin(.31 * x + .17 * y), .5 + .4 * sin(.11 * x * y / 8 + 1),
                       .45 + .44 * cos(.4 * y - .05 * x)};
        if (y >= 8 && y < 14 && x >= 20 && x < 31) {
            memcpy(r, (const double[3]){.9, .1, .05}, sizeof r);
        }
        double t[3] = {r[0] * .8, r[1], r[2] + .05};
        if (y >= 5 && y < 7 && x >= 5 && x < 30) {
            memcpy(t, (const double[3]){.1, .7, .9}, sizeof t);
        }
        if (y == 20 && x == 10) {
            memcpy(t, (const double[3]){1, 1, 1}, sizeof t);
        }
        for (int c = 0; c < 4; c++) {
            reference[i][c] = c < 3 ? (float)r[c] : 1;
            image[i][c] = c < 3 ? (float)t[c] : 0.25f; /* alpha must not matter */
        }
    }
}

static void fill(float picture[SMALL][4], float r, float g, float b)
{
    for (int i = 0; i < SMALL; i++) {
        memcpy(picture[i], (const float[4]){r, g, b, 1}, sizeof picture[i]);
    }
}

#define CLOSE(value, expected, tolerance) assert_true(fabs((value) - (expected)) <= (tolerance))
#define PIXELS(p)                         ((const float(*)[4])(p))

static parian_image_metrics measure(const float (*image)[4], const float (*reference)[4],
                                    uint32_t side)
{
    parian_image_metrics m;
    assert_int_equal(parian_image_measure(test_env(1), side, side, image, reference, &m, NULL),
                     PARIAN_OK);
    return m;
}

static void test_equal_pictures(void **state)
{
    static float image[COUNT][4], reference[COUNT][4], map[COUNT];
    parian_image_metrics m;
    (void)state;
    make_pictures(image, reference);
    assert_int_equal(parian_image_measure(test_env(2), WIDTH, HEIGHT, PIXELS(reference),
                                          PIXELS(reference), &m, map),
                     PARIAN_OK);
    assert_true(m.rmse == 0 && m.rel_mse == 0 && isinf(m.psnr) && m.psnr > 0);
    assert_true(m.flip_mean == 0 && m.flip_p95 == 0 && m.hdr_flip_mean == 0 && m.hdr_flip_p95 == 0);
    for (int i = 0; i < COUNT; i++) {
        assert_true(map[i] == 0);
    }
}

/* Four values by hand: I - R = 0.1 in one channel of one pixel of 25, R = 0.5 everywhere. */
static void test_values_by_hand(void **state)
{
    float image[SMALL][4], reference[SMALL][4];
    (void)state;
    fill(reference, 0.5f, 0.5f, 0.5f);
    fill(image, 0.5f, 0.5f, 0.5f);
    image[7][1] = 0.6f;
    parian_image_metrics m = measure(PIXELS(image), PIXELS(reference), SIDE);
    CLOSE(m.rmse, 0.1 / sqrt(75), 1e-8);               /* float 0.6 */
    CLOSE(m.rel_mse, 0.01 / (0.25 * 1.01) / 75, 1e-9); /* R^2 + 1e-2 mean^2 = 0.2525 */
    /* sRGB: 1.055 (0.6^(1/2.4) - 0.5^(1/2.4)) = 0.062441... */
    double e = 1.055 * (pow(0.6, 1 / 2.4) - pow(0.5, 1 / 2.4));
    CLOSE(m.psnr, -10 * log10(e * e / 75), 1e-5);
    fill(image, 1, 1, 1);
    fill(reference, 0, 0, 0);
    CLOSE(measure(PIXELS(image), PIXELS(reference), SIDE).psnr, 0,
          1e-12);         /* white for black: 0 dB */
    fill(image, 7, 7, 7); /* clamped: still white */
    m = measure(PIXELS(image), PIXELS(reference), SIDE);
    CLOSE(m.psnr, 0, 1e-12);
    CLOSE(m.rmse, 7, 1e-12);
    assert_true(isinf(m.rel_mse)); /* black reference */
}

/* Filters keep constants, there are no features: the error is the colour error in closed form. */
static double flip_of_colors(const float a[3], const float b[3])
{
    float image[SMALL][4], reference[SMALL][4], map[SMALL];
    fill(image, a[0], a[1], a[2]);
    fill(reference, b[0], b[1], b[2]);
    assert_int_equal(parian_flip_ldr(NULL, SIDE, SIDE, PIXELS(image), PIXELS(reference), NULL, map),
                     PARIAN_OK);
    for (int i = 1; i < SMALL; i++) {
        CLOSE(map[i], map[0], 1e-6);
    }
    return map[0];
}

/* L* of a grey of linear value v. */
static double lightness(double v)
{
    return v > 216.0 / 24389 ? 116 * cbrt(v) - 16 : v * 24389 / 27;
}

static void test_flip_of_constants(void **state)
{
    (void)state;
    /* Green and blue in Hunt-adjusted CIELab are 203.30165 apart (HyAB): the largest difference, so
     * error 1. */
    const double largest = pow(203.30165459, 0.7), knee = 0.4 * largest;
    CLOSE(flip_of_colors((const float[3]){0, 1, 0}, (const float[3]){0, 0, 1}), 1, TOLERANCE);
    /* Black and white: 100 apart, above the knee. */
    double white = 0.95 + 0.05 * (pow(100, 0.7) - knee) / (largest - knee);
    CLOSE(white, 0.96738, 1e-5);
    CLOSE(flip_of_colors((const float[3]){1, 1, 1}, (const float[3]){0, 0, 0}), white, TOLERANCE);
    CLOSE(flip_of_colors((const float[3]){0, 0, 0}, (const float[3]){1, 1, 1}), white, TOLERANCE);
    CLOSE(flip_of_colors((const float[3]){9, 9, 9}, (const float[3]){-1, -1, -1}), white,
          TOLERANCE); /* clamped */
    /* Greys have a = b = 0: below the knee 0.95 (dL / knee^(1/0.7))^0.7, in both branches of L*. */
    static const float grey[3][2] = {{0.5f, 0.6f}, {0.002f, 0.006f}, {0.18f, 0.2f}};
    for (int i = 0; i < 3; i++) {
        double d = fabs(lightness(grey[i][0]) - lightness(grey[i][1])),
               expected = 0.95 * pow(d, 0.7) / knee;
        const float a = grey[i][0], b = grey[i][1];
        CLOSE(flip_of_colors((const float[3]){a, a, a}, (const float[3]){b, b, b}), expected,
              TOLERANCE);
    }
    /* A red against a grey: the independent evaluation. */
    CLOSE(flip_of_colors((const float[3]){.5f, .1f, .1f}, (const float[3]){.2f, .2f, .2f}),
          0.52853127, TOLERANCE);
}

static void test_flip_of_pictures(void **state)
{
    static float image[COUNT][4], reference[COUNT][4], map[COUNT];
    parian_image_metrics m;
    (void)state;
    make_pictures(image, reference);
    assert_int_equal(
        parian_image_measure(test_env(2), WIDTH, HEIGHT, PIXELS(image), PIXELS(reference), &m, map),
        PARIAN_OK);
    CLOSE(m.flip_mean, 0.315535906, TOLERANCE);
    CLOSE(m.flip_p95, 0.511290175, TOLERANCE);
    CLOSE(map[6 * WIDTH + 5], 0.502821099, TOLERANCE);
    CLOSE(map[20 * WIDTH + 10], 0.402000266, TOLERANCE);
    CLOSE(map[0], 0.265997881, TOLERANCE);
    CLOSE(map[COUNT - 1], 0.329644225, TOLERANCE);
    CLOSE(m.rmse, 0.11208503008408167, 1e-9); /* summed in another order */
    CLOSE(m.rel_mse, 0.09775153848572658, 1e-9);
    CLOSE(m.psnr, 21.699308387547532, 1e-7);
}

static void test_hdr_flip(void **state)
{
    static float image[COUNT][4], reference[COUNT][4], map[COUNT];
    parian_flip_exposures e;
    (void)state;
    make_pictures(image, reference);
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0; c < 3; c++) {
            image[i][c] = exp2f(16 * image[i][c] - 8);
            reference[i][c] = exp2f(16 * reference[i][c] - 8);
        }
    }
    assert_int_equal(parian_flip_find_exposures(NULL, WIDTH, HEIGHT, PIXELS(reference), &e),
                     PARIAN_OK);
    CLOSE(e.start, -5.469597433, 1e-5);
    CLOSE(e.stop, -3.307686530, 1e-5);
    assert_int_equal(e.count, 3);
    assert_int_equal(
        parian_flip_hdr(test_env(2), WIDTH, HEIGHT, PIXELS(image), PIXELS(reference), 0, map),
        PARIAN_OK);
    double mean = 0;
    for (int i = 0; i < COUNT; i++) {
        mean += map[i] / COUNT;
    }
    CLOSE(mean, 0.567413566, TOLERANCE);
    CLOSE(map[20 * WIDTH + 10], 0.736990698, TOLERANCE);
    CLOSE(map[6 * WIDTH + 5], 0.806776189, TOLERANCE);
}

/* The filmic curve takes the brightest luminance to 0.85; a median of zero is replaced by that of
 * the lit pixels. */
static void test_exposures(void **state)
{
    float reference[SMALL][4];
    parian_flip_exposures e;
    (void)state;
    fill(reference, 0, 0, 0);
    assert_int_equal(parian_flip_find_exposures(NULL, SIDE, SIDE, PIXELS(reference), &e),
                     PARIAN_OK);
    assert_true(e.start == 0 && e.stop == 0 && e.count == 1); /* all black */
    for (int i = 0; i < 4; i++) {
        for (int c = 0; c < 3; c++) {
            reference[i][c] = i < 3 ? 2.0f : 16.0f; /* lit: 2, 2, 2, 16; 21 pixels are black */
        }
    }
    assert_int_equal(parian_flip_find_exposures(NULL, SIDE, SIDE, PIXELS(reference), &e),
                     PARIAN_OK);
    double x = 16 * exp2(e.start), y = x * (0.9036 * x + 0.018) / (x * (0.8748 * x + 0.354) + 0.14);
    CLOSE(y, 0.85, 1e-6);
    CLOSE(e.stop - e.start, 3, 1e-6);
    assert_in_range(e.count, 3, 4);
    reference[5][0] = NAN; /* counts as black */
    assert_int_equal(parian_flip_find_exposures(NULL, SIDE, SIDE, PIXELS(reference), &e),
                     PARIAN_OK);
    CLOSE(e.stop - e.start, 3, 1e-6);
}

/* The error of the exchanged pictures is the same; that of mirrored and turned ones is mirrored and
 * turned. */
static void test_symmetries(void **state)
{
    static float image[COUNT][4], reference[COUNT][4], map[COUNT], other[COUNT];
    static float turned[2][COUNT][4];
    (void)state;
    make_pictures(image, reference);
    assert_int_equal(
        parian_flip_ldr(NULL, WIDTH, HEIGHT, PIXELS(image), PIXELS(reference), NULL, map),
        PARIAN_OK);
    assert_int_equal(
        parian_flip_ldr(NULL, WIDTH, HEIGHT, PIXELS(reference), PIXELS(image), NULL, other),
        PARIAN_OK);
    assert_memory_equal(map, other, sizeof map);
    for (int i = 0; i < COUNT; i++) { /* x and y exchanged, and mirrored */
        int to = (i % WIDTH) * HEIGHT + HEIGHT - 1 - i / WIDTH;
        memcpy(turned[0][to], image[i], sizeof image[i]);
        memcpy(turned[1][to], reference[i], sizeof reference[i]);
    }
    assert_int_equal(
        parian_flip_ldr(NULL, HEIGHT, WIDTH, PIXELS(turned[0]), PIXELS(turned[1]), NULL, other),
        PARIAN_OK);
    for (int i = 0; i < COUNT; i++) {
        CLOSE(other[(i % WIDTH) * HEIGHT + HEIGHT - 1 - i / WIDTH], map[i], TOLERANCE);
        assert_true(map[i] >= 0 && map[i] <= 1);
    }
}

/* A width above the chunk of pixels that rows are cut into: the picture goes on as if there were no
 * cut. */
static void test_wide_picture(void **state)
{
    enum { WIDE = 600, CUT = 300, ROWS = 3 };
    static float image[WIDE * ROWS][4], reference[WIDE * ROWS][4], part[2][CUT * ROWS][4];
    static float map[WIDE * ROWS], map_of_part[CUT * ROWS];
    (void)state;
    for (int i = 0; i < WIDE * ROWS; i++) {
        for (int c = 0; c < 3; c++) {
            reference[i][c] = (float)(0.5 + 0.4 * sin(0.2 * (i % WIDE) + c + i / WIDE));
            image[i][c] = reference[i][c] * 0.9f;
        }
    }
    for (int i = 0; i < CUT * ROWS; i++) { /* columns 150 to 450 */
        memcpy(part[0][i], image[i / CUT * WIDE + 150 + i % CUT], sizeof part[0][i]);
        memcpy(part[1][i], reference[i / CUT * WIDE + 150 + i % CUT], sizeof part[1][i]);
    }
    assert_int_equal(parian_flip_ldr(NULL, WIDE, ROWS, PIXELS(image), PIXELS(reference), NULL, map),
                     PARIAN_OK);
    assert_int_equal(
        parian_flip_ldr(NULL, CUT, ROWS, PIXELS(part[0]), PIXELS(part[1]), NULL, map_of_part),
        PARIAN_OK);
    for (int i = 0; i < CUT * ROWS; i++) {
        if (i % CUT >= 10 &&
            i % CUT < CUT - 10) { /* beyond the radius of the filters from the border */
            CLOSE(map_of_part[i], map[i / CUT * WIDE + 150 + i % CUT], 1e-6);
        }
    }
}

static void test_not_finite(void **state)
{
    float image[SMALL][4], reference[SMALL][4], map[SMALL];
    parian_image_metrics m;
    (void)state;
    fill(image, 0.5f, 0.5f, 0.5f);
    fill(reference, 0.5f, 0.5f, 0.5f);
    image[12][0] = NAN;
    image[3][2] = INFINITY;
    assert_int_equal(
        parian_image_measure(NULL, SIDE, SIDE, PIXELS(image), PIXELS(reference), &m, map),
        PARIAN_OK);
    assert_int_equal(m.not_finite, 2);
    assert_true(m.rmse == 0 && map[12] == 1 && map[3] == 1 && m.flip_p95 == 1);
    fill(image, NAN, 0, 0);
    assert_int_equal(
        parian_image_measure(NULL, SIDE, SIDE, PIXELS(image), PIXELS(reference), &m, map),
        PARIAN_OK);
    assert_true(isnan(m.rmse) && isnan(m.psnr) && isnan(m.flip_mean) && isnan(m.hdr_flip_p95));
    fill(image, 0, 0, 0);
    reference[1][1] = NAN;
    assert_int_equal(
        parian_image_measure(NULL, SIDE, SIDE, PIXELS(image), PIXELS(reference), &m, map),
        PARIAN_E_ARGUMENT);
    assert_int_equal(parian_image_measure(NULL, 0, SIDE, PIXELS(image), PIXELS(reference), &m, map),
                     PARIAN_E_ARGUMENT);
    parian_flip_desc coarse = {.pixels_per_degree = 0.5};
    assert_int_equal(parian_flip_ldr(NULL, SIDE, SIDE, PIXELS(image), PIXELS(image), &coarse, map),
                     PARIAN_E_ARGUMENT);
    parian_flip_desc fine = {.pixels_per_degree = 400};
    assert_int_equal(parian_flip_ldr(NULL, SIDE, SIDE, PIXELS(image), PIXELS(image), &fine, map),
                     PARIAN_OK);
}

static void test_threads_and_memory(void **state)
{
    static float image[COUNT][4], reference[COUNT][4], map[3][COUNT];
    parian_image_metrics m[3];
    static const unsigned threads[3] = {1, 2, 7};
    (void)state;
    make_pictures(image, reference);
    for (int i = 0; i < 3; i++) {
        memset(&m[i], 0, sizeof m[i]);
        assert_int_equal(parian_image_measure(test_env(threads[i]), WIDTH, HEIGHT, PIXELS(image),
                                              PIXELS(reference), &m[i], map[i]),
                         PARIAN_OK);
        assert_memory_equal(map[0], map[i], sizeof map[0]);
        assert_memory_equal(&m[0], &m[i], sizeof m[0]);
    }
    for (size_t k = 0; k < 100; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_result result = parian_image_measure(&env, WIDTH, HEIGHT, PIXELS(image),
                                                    PIXELS(reference), &m[1], NULL);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            return;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
    fail_msg("no end of allocations");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_equal_pictures),    cmocka_unit_test(test_values_by_hand),
        cmocka_unit_test(test_flip_of_constants), cmocka_unit_test(test_flip_of_pictures),
        cmocka_unit_test(test_hdr_flip),          cmocka_unit_test(test_exposures),
        cmocka_unit_test(test_symmetries),        cmocka_unit_test(test_wide_picture),
        cmocka_unit_test(test_not_finite),        cmocka_unit_test(test_threads_and_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
