/* test_picture.c - PNG and OpenEXR: round trips, every element type and layout, hostile files.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"
#include "tool/picture.h"

enum { WIDTH = 19, HEIGHT = 37, FILE_MAX = 1 << 16 };

static void test_srgb(void **state)
{
    (void)state;
    for (int code = 0; code < 256; code++) {
        assert_int_equal(parian_srgb_encode(parian_srgb_decode((uint8_t)code)), code);
    }
    assert_int_equal(parian_srgb_encode(NAN), 0);
    assert_int_equal(parian_srgb_encode(-INFINITY), 0);
    assert_int_equal(parian_srgb_encode(INFINITY), 255);
    assert_true(fabsf(parian_srgb_decode(188) - 0.5028865f) < 1e-6f); /* IEC 61966-2-1 */
}

static void test_png_round_trip(void **state)
{
    static uint8_t rgba[HEIGHT * WIDTH][4];
    uint32_t width, height;
    float(*rgb)[3];
    (void)state;
    for (size_t i = 0; i < HEIGHT * WIDTH; i++) {
        for (size_t c = 0; c < 4; c++) {
            rgba[i][c] = (uint8_t)(i * 7 + c * 61);
        }
    }
    const char *path = test_scratch("a.png");
    assert_int_equal(parian_png_write(NULL, path, WIDTH, HEIGHT, (const uint8_t(*)[4])rgba),
                     PARIAN_OK);
    assert_int_equal(parian_picture_read_linear(NULL, path, &width, &height, &rgb), PARIAN_OK);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    for (size_t i = 0; i < HEIGHT * WIDTH; i++) {
        for (size_t c = 0; c < 3; c++) {
            assert_int_equal(parian_srgb_encode(rgb[i][c]), rgba[i][c]);
        }
    }
    parian_free(NULL, rgb);
    assert_int_equal(parian_png_write(NULL, path, 0, HEIGHT, (const uint8_t(*)[4])rgba),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_png_write(NULL, path, 16385, 1, (const uint8_t(*)[4])rgba),
                     PARIAN_E_ARGUMENT);
}

/* 2 x 2 grey with 16 bits: 0, 0x8000, 0xffff, 0x0001; made by hand, deflate stored. */
static void test_png_of_16_bit_grey(void **state)
{
    static const uint8_t png[] = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49,
        0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x10, 0x00,
        0x00, 0x00, 0x00, 0x07, 0x4d, 0x8e, 0xbb, 0x00, 0x00, 0x00, 0x15, 0x49, 0x44,
        0x41, 0x54, 0x78, 0x01, 0x01, 0x0a, 0x00, 0xf5, 0xff, 0x00, 0x00, 0x00, 0x80,
        0x00, 0x00, 0xff, 0xff, 0x00, 0x01, 0x0a, 0x84, 0x02, 0x80, 0xd5, 0x44, 0x7e,
        0x77, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    uint32_t width, height;
    float(*rgb)[3];
    (void)state;
    assert_int_equal(parian_file_write(NULL, test_scratch("grey16.png"), png, sizeof png),
                     PARIAN_OK);
    parian_result result =
        parian_png_read_linear(test_env(1), test_scratch("grey16.png"), &width, &height, &rgb);
    if (result == PARIAN_OK) {
        assert_true(fabsf(rgb[1][0] - parian_srgb_to_linear(32768 / 65535.0f)) < 1e-6f);
        assert_true(fabsf(rgb[2][1] - 1) < 1e-6f);
        parian_free(NULL, rgb);
    }
    assert_int_equal(result, PARIAN_OK);
}

static void test_exr_round_trip(void **state)
{
    static float rgba[HEIGHT * WIDTH][4];
    uint32_t width, height;
    float(*rgb)[3];
    (void)state;
    for (size_t i = 0; i < HEIGHT * WIDTH; i++) {
        for (size_t c = 0; c < 4; c++) {
            rgba[i][c] = (float)i * 1.37f - 11.0f * (float)c;
        }
    }
    rgba[5][1] = 3e38f;
    rgba[6][2] = INFINITY;
    const char *path = test_scratch("a.exr");
    assert_int_equal(parian_exr_write(NULL, path, WIDTH, HEIGHT, (const float(*)[4])rgba),
                     PARIAN_OK);
    assert_int_equal(parian_picture_read_linear(test_env(1), path, &width, &height, &rgb),
                     PARIAN_OK);
    assert_int_equal(width, WIDTH);
    assert_int_equal(height, HEIGHT);
    for (size_t i = 0; i < HEIGHT * WIDTH; i++) {
        assert_memory_equal(rgb[i], rgba[i], sizeof rgb[i]);
    }
    parian_free(NULL, rgb);
}

/* ---- OpenEXR files made by hand: no compression, any element type, scanlines or tiles
 * ------------ */
typedef struct builder {
    uint8_t data[FILE_MAX];
    size_t size;
} builder;

static void put(builder *b, const void *data, size_t size)
{
    assert_true(b->size + size <= FILE_MAX);
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

static void put_u32(builder *b, uint32_t value)
{
    put(b, &value, sizeof value);
}

static void put_attribute(builder *b, const char *name, const char *type, const void *value,
                          size_t size)
{
    put(b, name, strlen(name) + 1);
    put(b, type, strlen(type) + 1);
    put_u32(b, (uint32_t)size);
    put(b, value, size);
}

enum { TYPE_UINT = 0, TYPE_HALF = 1, TYPE_FLOAT = 2, W = 5, H = 3, TILE = 4 };

static void put_header(builder *b, const char *channels, int type, bool tiled)
{
    builder list = {.size = 0};
    const int32_t window[4] = {10, -3, 10 + W - 1, -3 + H - 1};
    const float one = 1, centre[2] = {0, 0};
    const uint8_t none = 0;
    const uint8_t tiles[9] = {TILE, 0, 0, 0, TILE, 0, 0, 0, 0};
    for (const char *c = channels; *c; c++) {
        const char name[2] = {*c, 0};
        put(&list, name, 2);
        put_u32(&list, (uint32_t)type);
        put_u32(&list, 0);
        put_u32(&list, 1);
        put_u32(&list, 1);
    }
    put(&list, &none, 1);
    put_u32(b, 20000630);
    put_u32(b, tiled ? 2 | 0x200 : 2);
    put_attribute(b, "channels", "chlist", list.data, list.size);
    put_attribute(b, "compression", "compression", &none, 1);
    put_attribute(b, "dataWindow", "box2i", window, sizeof window);
    put_attribute(b, "displayWindow", "box2i", window, sizeof window);
    put_attribute(b, "lineOrder", "lineOrder", &none, 1);
    put_attribute(b, "pixelAspectRatio", "float", &one, 4);
    put_attribute(b, "screenWindowCenter", "v2f", centre, 8);
    put_attribute(b, "screenWindowWidth", "float", &one, 4);
    if (tiled) {
        put_attribute(b, "tiles", "tiledesc", tiles, sizeof tiles);
    }
    put(b, &none, 1);
}

/* The value of a channel at a pixel: small whole numbers, exact in each type. */
static uint32_t pixel_value(char channel, unsigned x, unsigned y)
{
    return (unsigned)channel % 16 * 16 + y * W + x;
}

static void put_pixels(builder *b, const char *channels, int type, unsigned x0, unsigned y,
                       unsigned count)
{
    for (const char *c = channels; *c; c++) {
        for (unsigned x = x0; x < x0 + count; x++) {
            const uint32_t value = pixel_value(*c, x, y);
            const float real = (float)value;
            const uint16_t half = parian_half_from_float(real);
            put(b,
                type == TYPE_UINT   ? (const void *)&value
                : type == TYPE_HALF ? (const void *)&half
                                    : &real,
                type == TYPE_HALF ? 2 : 4);
        }
    }
}

static void put_scanlines(builder *b, const char *channels, int type)
{
    const size_t line = W * strlen(channels) * (type == TYPE_HALF ? 2 : 4);
    const uint64_t first = b->size + H * 8;
    for (unsigned y = 0; y < H; y++) {
        const uint64_t offset = first + y * (8 + line);
        put(b, &offset, 8);
    }
    for (unsigned y = 0; y < H; y++) {
        put_u32(b, y - 3u);
        put_u32(b, (uint32_t)line);
        put_pixels(b, channels, type, 0, y, W);
    }
}

static void put_tiles(builder *b, const char *channels, int type)
{
    const size_t element = strlen(channels) * (type == TYPE_HALF ? 2 : 4);
    uint64_t offset = b->size + 2 * 8;
    put(b, &offset, 8);
    offset += 20 + TILE * H * element;
    put(b, &offset, 8);
    for (unsigned tile = 0; tile < 2; tile++) {
        const unsigned width = tile ? W - TILE : TILE;
        put_u32(b, tile);
        put_u32(b, 0);
        put_u32(b, 0);
        put_u32(b, 0);
        put_u32(b, (uint32_t)(width * H * element));
        for (unsigned y = 0; y < H; y++) {
            put_pixels(b, channels, type, tile * TILE, y, width);
        }
    }
}

static void build(builder *b, const char *channels, int type, bool tiled)
{
    b->size = 0;
    put_header(b, channels, type, tiled);
    if (tiled) {
        put_tiles(b, channels, type);
    } else {
        put_scanlines(b, channels, type);
    }
}

static void check_made_by_hand(const char *channels, int type, bool tiled)
{
    static builder b;
    uint32_t width, height;
    float(*rgb)[3];
    const bool grey = strchr(channels, 'Y') != NULL;
    build(&b, channels, type, tiled);
    const char *path = test_scratch("hand.exr");
    assert_int_equal(parian_file_write(NULL, path, b.data, b.size), PARIAN_OK);
    assert_int_equal(parian_exr_read(test_env(1), path, &width, &height, &rgb), PARIAN_OK);
    assert_int_equal(width, W);
    assert_int_equal(height, H);
    for (unsigned y = 0; y < H; y++) {
        for (unsigned x = 0; x < W; x++) {
            for (unsigned c = 0; c < 3; c++) {
                const float expected = (float)pixel_value(grey ? 'Y' : "RGB"[c], x, y);
                if (fabsf(rgb[y * W + x][c] - expected) > 0) {
                    fail_msg("%s type %d tiled %d at %u,%u,%u: %g, not %g", channels, type, tiled,
                             x, y, c, (double)rgb[y * W + x][c], (double)expected);
                }
            }
        }
    }
    parian_free(NULL, rgb);
}

static void test_exr_types_and_layouts(void **state)
{
    (void)state;
    for (int type = TYPE_UINT; type <= TYPE_FLOAT; type++) {
        for (int tiled = 0; tiled < 2; tiled++) {
            check_made_by_hand("BGR", type, tiled);
            check_made_by_hand("ABGRZ", type, tiled);
            check_made_by_hand("Y", type, tiled);
        }
    }
}

static void test_exr_unsupported(void **state)
{
    static builder b;
    uint32_t width, height;
    float(*rgb)[3];
    (void)state;
    build(&b, "GR", TYPE_HALF, false);
    assert_int_equal(parian_file_write(NULL, test_scratch("gr.exr"), b.data, b.size), PARIAN_OK);
    assert_int_equal(parian_exr_read(NULL, test_scratch("gr.exr"), &width, &height, &rgb),
                     PARIAN_E_UNSUPPORTED);
}

/* ---- hostile files ------------------------------------------------------------------------------
 */
/* Reads damaged bytes; the result must be a picture or an error, never a crash. */
static parian_result read_damaged(const uint8_t *data, size_t size)
{
    uint32_t width, height;
    float(*rgb)[3] = NULL;
    const char *path = test_scratch("damaged");
    FILE *file = fopen(path, "wb"); /* no fsync: there are thousands of these */
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
    parian_result result = parian_picture_read_linear(NULL, path, &width, &height, &rgb);
    if (result == PARIAN_OK) {
        parian_free(NULL, rgb);
    }
    return result;
}

static void damage(const char *path, bool every_end_refused)
{
    uint8_t *data;
    size_t size;
    assert_int_equal(parian_file_read(NULL, path, FILE_MAX, &data, &size), PARIAN_OK);
    for (size_t end = 0; end < size; end += end < 400 ? 1 : 7) {
        parian_result result = read_damaged(data, end);
        if (every_end_refused) {
            assert_int_not_equal(result, PARIAN_OK);
        }
    }
    for (size_t i = 0; i < size && i < 600; i++) {
        for (int bit = 0; bit < 8; bit += 3) {
            data[i] ^= (uint8_t)(1 << bit);
            (void)read_damaged(data, size);
            data[i] ^= (uint8_t)(1 << bit);
        }
    }
    parian_free(NULL, data);
}

static void test_damaged_files(void **state)
{
    static uint8_t rgba[HEIGHT * WIDTH][4];
    static float real[HEIGHT * WIDTH][4];
    static builder b;
    (void)state;
    assert_int_equal(
        parian_png_write(NULL, test_scratch("d.png"), WIDTH, HEIGHT, (const uint8_t(*)[4])rgba),
        PARIAN_OK);
    assert_int_equal(
        parian_exr_write(NULL, test_scratch("d.exr"), WIDTH, HEIGHT, (const float(*)[4])real),
        PARIAN_OK);
    build(&b, "BGR", TYPE_HALF, true);
    assert_int_equal(parian_file_write(NULL, test_scratch("t.exr"), b.data, b.size), PARIAN_OK);
    damage(test_scratch("d.png"), true);
    damage(test_scratch("d.exr"), true);
    damage(test_scratch("t.exr"), true);
}

static void test_lying_sizes(void **state)
{
    static builder b;
    const int32_t side = 1 << 24;
    uint8_t *data;
    size_t size;
    static const uint8_t rgba[1][4];
    (void)state;
    build(&b, "BGR", TYPE_HALF, false);
    for (size_t i = 0; i + 4 < b.size; i++) { /* every place where the window's right edge stands */
        const int32_t right = 10 + W - 1;
        if (memcmp(b.data + i, &right, 4) == 0) {
            memcpy(b.data + i, &side, 4);
        }
    }
    assert_int_not_equal(read_damaged(b.data, b.size), PARIAN_OK);
    assert_int_equal(parian_png_write(NULL, test_scratch("one.png"), 1, 1, rgba), PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("one.png"), FILE_MAX, &data, &size),
                     PARIAN_OK);
    data[17] = 1; /* a width of 65537, with the checksum of width 1 */
    assert_int_equal(read_damaged(data, size), PARIAN_E_FORMAT);
    parian_free(NULL, data);
    assert_int_equal(read_damaged((const uint8_t *)"#?RADIANCE\n", 11), PARIAN_E_FORMAT);
}

/* Pictures as the world makes them: DWA and ZIP compressed halves. */
static void test_shared_environments(void **state)
{
    static const char *const names[] = {"data/env/courtyard_1k_zip.exr",
                                        "data/env/studio_1k_dwab.exr"};
    (void)state;
    for (size_t n = 0; n < sizeof names / sizeof names[0]; n++) {
        uint32_t width, height;
        float(*rgb)[3];
        double mean = 0;
        const char *path = test_shared(names[n]);
        if (!path) {
            skip();
        }
        assert_int_equal(parian_exr_read(test_env(1), path, &width, &height, &rgb), PARIAN_OK);
        assert_int_equal(width, 2 * height);
        for (size_t i = 0; i < (size_t)width * height; i++) {
            mean += (double)rgb[i][1] / ((double)width * height);
        }
        assert_true(mean > 0.01 && mean < 100);
        parian_free(NULL, rgb);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_srgb),
        cmocka_unit_test(test_png_round_trip),
        cmocka_unit_test(test_png_of_16_bit_grey),
        cmocka_unit_test(test_exr_round_trip),
        cmocka_unit_test(test_exr_types_and_layouts),
        cmocka_unit_test(test_exr_unsupported),
        cmocka_unit_test(test_damaged_files),
        cmocka_unit_test(test_lying_sizes),
        cmocka_unit_test(test_shared_environments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
