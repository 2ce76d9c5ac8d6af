/* test_error_map.c - colours of values, the limit, what stands under the picture, values in the
 * EXR, bad input.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tests/measure/bitmap_font.h"
#include "tests/measure/color_map.h"
#include "tests/measure/error_map.h"
#include "tool/files.h"
#include "tool/picture.h"

enum { WIDTH = 600, HEIGHT = 5, COUNT = WIDTH * HEIGHT };

typedef struct picture {
    uint32_t width, height;
    float (*rgb)[3];
} picture;

static picture read_back(const char *path)
{
    picture p;
    assert_int_equal(parian_picture_read_linear(NULL, path, &p.width, &p.height, &p.rgb),
                     PARIAN_OK);
    return p;
}

static void write_map(const char *name, const parian_error_map *map)
{
    assert_int_equal(parian_error_map_write(test_env(1), test_scratch("maps"), name, map),
                     PARIAN_OK);
}

static picture draw(const char *name, const parian_error_map *map)
{
    char file[64];
    write_map(name, map);
    snprintf(file, sizeof file, "maps/%s.png", name);
    return read_back(test_scratch(file));
}

static void assert_color(const picture *p, uint32_t x, uint32_t y, const uint8_t rgb[3])
{
    for (int c = 0; c < 3; c++) {
        assert_int_equal(parian_srgb_encode(p->rgb[(size_t)y * p->width + x][c]), rgb[c]);
    }
}

/* Relative luminance of a colour. */
static double luminance(const uint8_t rgb[3])
{
    return 0.2126 * parian_srgb_decode(rgb[0]) + 0.7152 * parian_srgb_decode(rgb[1]) +
           0.0722 * parian_srgb_decode(rgb[2]);
}

static double lightness(const uint8_t rgb[3])
{
    double y = luminance(rgb);
    return y > 216.0 / 24389 ? 116 * cbrt(y) - 16 : y * 24389 / 27;
}

static void test_color_maps(void **state)
{
    uint8_t rgb[3], other[3];
    (void)state;
    /* Magma rises by 2 to 6.5 of lightness in each twentieth: nowhere flat, nowhere a false edge.
     */
    for (int i = 0; i < 20; i++) {
        parian_color_map_sequential(0.05 * i, rgb);
        parian_color_map_sequential(0.05 * (i + 1), other);
        double rise = lightness(other) - lightness(rgb);
        assert_true(rise > 2 && rise < 6.5);
    }
    /* The diverging map is straight in lightness, which 8-bit codes keep to 1; neither sign looks
     * larger. */
    for (int i = 0; i <= 100; i++) {
        parian_color_map_diverging(0.01 * i, rgb);
        parian_color_map_diverging(-0.01 * i, other);
        assert_true(fabs(lightness(rgb) - (97 - 63 * 0.01 * i)) < 1);
        assert_true(fabs(lightness(rgb) - lightness(other)) < 1);
    }
    parian_color_map_diverging(0, rgb);
    assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2] && rgb[0] > 240);
    parian_color_map_diverging(1, rgb);
    assert_true(rgb[0] > 140 && rgb[2] < 60);
    parian_color_map_diverging(-1, rgb);
    assert_true(rgb[2] > 140 && rgb[0] < 60);
    parian_color_map_sequential(1, rgb);
    parian_color_map_sequential(INFINITY, other);
    assert_memory_equal(rgb, other, sizeof rgb);
}

static void test_pixels(void **state)
{
    static float value[COUNT];
    uint8_t rgb[3];
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        value[i] = (float)(i % WIDTH) / WIDTH - 0.5f;
    }
    value[3] = NAN;
    value[4] = INFINITY;
    value[5] = -INFINITY;
    value[6] = 7;
    parian_error_map map = {WIDTH, HEIGHT, value, 0.25, 1, "a title"};
    picture p = draw("signed", &map);
    assert_int_equal(p.width, WIDTH); /* wide enough: not magnified */
    assert_true(p.height > HEIGHT + 40);
    assert_color(&p, 3, 0, (const uint8_t[3]){0x80, 0x80, 0x80});
    parian_color_map_diverging(1, rgb);
    assert_color(&p, 4, 0, rgb);
    assert_color(&p, 6, 0, rgb);
    assert_color(&p, WIDTH - 1, 2, rgb); /* beyond the limit */
    parian_color_map_diverging(-1, rgb);
    assert_color(&p, 5, 0, rgb);
    parian_color_map_diverging((390.0 / WIDTH - 0.5) / 0.25, rgb);
    assert_color(&p, 390, 4, rgb);
    free(p.rgb);
    map.is_signed = 0;
    map.limit = 0; /* 99th percentile of the size, 0.495: not 7 */
    p = draw("unsigned", &map);
    parian_color_map_sequential((390.0 / WIDTH - 0.5) / 0.495, rgb);
    for (int c = 0; c < 3; c++) {
        assert_true(abs(parian_srgb_encode(p.rgb[4 * WIDTH + 390][c]) - rgb[c]) <=
                    2); /* the rank: 0.4933 to 0.4967 */
    }
    free(p.rgb);
}

/* The EXR has the values, NaN and infinities included. */
static void test_values(void **state)
{
    static float value[COUNT];
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        value[i] = i == 9 ? NAN : i == 10 ? -INFINITY : 1e-3f * (float)i - 1;
    }
    write_map("values", &(parian_error_map){WIDTH, HEIGHT, value, 0, 1, NULL});
    picture p = read_back(test_scratch("maps/values.exr"));
    assert_int_equal(p.width, WIDTH);
    assert_int_equal(p.height, HEIGHT);
    for (int i = 0; i < COUNT; i++) {
        for (int c = 0; c < 3; c++) {
            assert_true(i == 9 ? isnan(p.rgb[i][c]) : p.rgb[i][c] == value[i]);
        }
    }
    free(p.rgb);
}

/* Small maps are magnified by whole numbers; all is drawn for one pixel, and for nothing but NaN.
 */
static void test_small_maps(void **state)
{
    static const float one[4] = {0, 1, 2, 4}, none[1] = {NAN};
    uint8_t rgb[3];
    (void)state;
    picture p = draw("small", &(parian_error_map){2, 2, one, 4, 0, "2 x 2"});
    assert_int_equal(p.width, 512);
    uint32_t left = (512 - 2 * 64) / 2;
    assert_color(&p, left - 1, 0, (const uint8_t[3]){255, 255, 255});
    parian_color_map_sequential(0.25, rgb);
    assert_color(&p, left + 64, 0, rgb);
    assert_color(&p, left + 127, 63, rgb);
    parian_color_map_sequential(1, rgb);
    assert_color(&p, left + 64, 64, rgb);
    free(p.rgb);
    p = draw("none", &(parian_error_map){1, 1, none, 0, 0, ""});
    assert_color(&p, 256, 0, (const uint8_t[3]){0x80, 0x80, 0x80});
    free(p.rgb);
}

/* Ink of a text: every letter that can be seen has its own picture; what leaves a picture is cut.
 */
static void test_font(void **state)
{
    enum { SIDE = 16 };
    static uint8_t cell[95][SIDE * SIDE][4];
    (void)state;
    for (int i = 0; i < 95; i++) {
        const char text[2] = {(char)(0x20 + i), 0};
        size_t ink = 0;
        parian_font_draw(SIDE, SIDE, cell[i], 2, 0, 2, (const uint8_t[3]){1, 2, 3}, text, 1);
        for (int p = 0; p < SIDE * SIDE; p++) {
            ink += cell[i][p][0] == 1;
        }
        assert_true(i == 0 ? ink == 0 : ink >= 8 && ink % 4 == 0);
        for (int j = 0; j < i; j++) {
            assert_true(memcmp(cell[i], cell[j], sizeof cell[i]) != 0);
        }
    }
    assert_int_equal(parian_font_length("a\xc3\xa4\xe2\x82\xac\n"), 4);
    assert_int_equal(parian_font_length(NULL), 0);
    parian_font_draw(SIDE, SIDE, cell[0], -9, -5, 7, (const uint8_t[3]){9, 9, 9}, "W\xff\x80\x80",
                     9);
    parian_font_draw(SIDE, SIDE, cell[0], 14, 14, 7, (const uint8_t[3]){9, 9, 9}, "W", 1);
}

static void test_hostile_titles(void **state)
{
    static const float value[4] = {0, 1, -1, 2};
    static char title[4][5000];
    (void)state;
    memset(title[0], 'x', 4999);
    memset(title[1], ' ', 4999);
    memset(title[2], 0x80, 4999); /* not UTF-8: nothing but continuations */
    for (int i = 0; i < 4999; i++) {
        title[3][i] = i % 7 ? (char)(i * 37 + 1) : ' ';
        title[3][i] = title[3][i] ? title[3][i] : 'a';
    }
    for (int i = 0; i < 4; i++) {
        picture p = draw("hostile", &(parian_error_map){2, 2, value, 1, 1, title[i]});
        assert_true(p.height < 128 + 4 * 20 + 120);
        free(p.rgb);
    }
}

static void test_bad_input(void **state)
{
    static const float value[1] = {1};
    parian_error_map map = {1, 1, value, 1, 0, "t"};
    const char *folder = test_scratch("maps");
    (void)state;
    assert_int_equal(parian_error_map_write(NULL, folder, "", &map), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_error_map_write(NULL, folder, "a/b", &map), PARIAN_E_ARGUMENT);
    map.width = 0;
    assert_int_equal(parian_error_map_write(NULL, folder, "a", &map), PARIAN_E_ARGUMENT);
    map.width = 20000;
    assert_int_equal(parian_error_map_write(NULL, folder, "a", &map), PARIAN_E_ARGUMENT);
    map.width = 1;
    assert_int_equal(parian_error_map_write(NULL, "/dev/null/x", "a", &map), PARIAN_E_IO);
    for (size_t k = 0; k < 1000; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_result result = parian_error_map_write(&env, folder, "a", &map);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK && memory.calls <= k) {
            return;
        }
        assert_true(result == PARIAN_E_NOMEM ||
                    result == PARIAN_OK); /* a number of the scale may be missing */
    }
    fail_msg("no end of allocations");
}

static void test_same_bytes_for_any_threads(void **state)
{
    static float value[COUNT];
    uint8_t *data[2];
    size_t size[2];
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        value[i] = sinf((float)i);
    }
    for (int i = 0; i < 2; i++) {
        parian_error_map map = {WIDTH, HEIGHT, value, 0, 1, "threads"};
        assert_int_equal(
            parian_error_map_write(test_env(i ? 7 : 1), test_scratch("maps"), "threads", &map),
            PARIAN_OK);
        assert_int_equal(
            parian_file_read(NULL, test_scratch("maps/threads.png"), 1 << 24, &data[i], &size[i]),
            PARIAN_OK);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    free(data[0]);
    free(data[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_color_maps), cmocka_unit_test(test_pixels),
        cmocka_unit_test(test_values),     cmocka_unit_test(test_small_maps),
        cmocka_unit_test(test_font),       cmocka_unit_test(test_hostile_titles),
        cmocka_unit_test(test_bad_input),  cmocka_unit_test(test_same_bytes_for_any_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
