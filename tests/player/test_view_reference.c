/* test_view_reference.c - nearest points against brute force, errors against known ones, atlases
 * against their texels, and files that changed.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_reference.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "support/lit_scene.h"
#include "tool/files.h"
#include "view_atlas.h"
#include "view_loader.h"

enum { FROM = 3000, TO = 700 };

static float spread(uint32_t index, uint32_t axis)
{
    const uint32_t hash = (index * 3 + axis + 1) * 2654435761u;
    return (float)((hash ^ hash >> 15) * 2246822519u >> 8) / (float)(1 << 24);
}

static size_t brute(const parian_view_points *from, size_t i, const parian_view_points *to)
{
    size_t best = 0;
    float nearest = INFINITY;
    for (size_t k = 0; k < to->count; k++) {
        float squared = 0;
        for (int c = 0; c < 3; c++) {
            const float d = to->position[k][c] - from->position[i][c];
            squared += d * d;
        }
        if (squared < nearest) {
            nearest = squared;
            best = k;
        }
    }
    return best;
}

static void test_nearest(void **state)
{
    static float a[FROM][3], b[TO][3];
    static uint32_t found[FROM];
    const parian_view_points from = {FROM, (const float(*)[3])a, NULL};
    const parian_view_points to = {TO, (const float(*)[3])b, NULL};
    (void)state;
    for (uint32_t i = 0; i < FROM; i++) {
        for (uint32_t c = 0; c < 3; c++) {
            a[i][c] =
                3 * spread(i, c) - 1; /* a third of the box of b in each axis, and around it */
            if (i < TO) {
                b[i][c] = c == 2 ? 0.1f * spread(i + FROM, c) : spread(i + FROM, c);
            }
        }
    }
    assert_int_equal(parian_view_nearest(test_env(0), &from, &to, found), PARIAN_OK);
    for (size_t i = 0; i < FROM; i++) {
        assert_int_equal(found[i], brute(&from, i, &to));
    }
    const parian_view_points one = {1, to.position, NULL};
    assert_int_equal(parian_view_nearest(NULL, &from, &one, found), PARIAN_OK);
    assert_int_equal(found[FROM - 1], 0);
}

/* A thin wall: the near point is on the other side, the right one a little farther. */
static void test_two_sides(void **state)
{
    static const float at[2][3] = {{0, 0, 0}, {0.0012f, 0, 0.001f}},
                       normal[2][3] = {{0, 0, -1}, {0, 0, 1}};
    static const float query[1][3] = {{0, 0, 0.001f}}, up[1][3] = {{0, 0, 1}};
    const parian_view_points from = {1, query, up}, to = {2, at, normal}, plain = {2, at, NULL};
    uint32_t found;
    (void)state;
    assert_int_equal(parian_view_nearest(NULL, &from, &to, &found), PARIAN_OK);
    assert_int_equal(found, 1);
    assert_int_equal(parian_view_nearest(NULL, &from, &plain, &found), PARIAN_OK);
    assert_int_equal(found, 0);
}

static void write_points(const char *folder, const char *name, const float *value, uint64_t count)
{
    const uint64_t shape[2] = {count, 3};
    assert_int_equal(parian_npy_write(NULL, folder, name, PARIAN_ELEMENT_F32, 2, shape, value),
                     PARIAN_OK);
}

/* B a tenth too large everywhere: an error of 0.1, and full red where that is the scale. */
static void test_paint(void **state)
{
    static const float at[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const float truth[4][3] = {{1, 1, 1}, {2, 2, 2}, {2, 2, 2}, {3, 3, 3}};
    const parian_view_points texels = {4, at, NULL};
    parian_view_reference reference;
    float value[4][3], color[4][3];
    double error;
    const char *folder = test_scratch("truth");
    (void)state;
    write_points(folder, "receiver_position.npy", at[0], 4);
    assert_int_equal(parian_view_reference_read(NULL, folder, &reference), PARIAN_E_IO);
    write_points(folder, "receiver_radiosity.npy", truth[0], 4);
    assert_int_equal(parian_view_reference_read(NULL, folder, &reference), PARIAN_OK);
    assert_true(reference.count == 4 && fabs(reference.mean - 2) < 1e-6);
    for (int i = 0; i < 12; i++) {
        value[i / 3][i % 3] = 1.1f * truth[i / 3][i % 3];
    }
    assert_int_equal(
        parian_view_reference_paint(NULL, &reference, &texels, truth, 0.1, color, &error),
        PARIAN_OK);
    assert_true(error == 0 && color[3][0] == 1 && color[3][1] == 1 && color[3][2] == 1);
    assert_int_equal(parian_view_reference_paint(NULL, &reference, &texels,
                                                 (const float(*)[3])value, 0.1, color, &error),
                     PARIAN_OK);
    assert_true(fabs(error - 0.1) < 1e-6);
    /* 0.1 of 1 over 0.1 of the mean of 2: half red; 0.1 of 3: beyond the scale. */
    assert_true(color[0][0] == 1 && fabsf(color[0][1] - 0.5f) < 1e-5f);
    assert_true(color[3][0] == 1 && color[3][1] == 0 && color[3][2] == 0);
    parian_view_reference_free(NULL, &reference);
    write_points(folder, "receiver_radiosity.npy", truth[0], 3);
    assert_int_equal(parian_view_reference_read(NULL, folder, &reference), PARIAN_E_FORMAT);
    assert_int_equal(parian_view_reference_read(NULL, test_scratch("absent"), &reference),
                     PARIAN_E_IO);
}

/* Every texel that a pixel of the flat atlas shows has its E, and texels are a good part of it. */
static void test_atlas(void **state)
{
    enum { SIDE = 200 };
    static float picture[SIDE * SIDE][4];
    const parian_env *env = test_env(0);
    const parian_light light = {
        .type = PARIAN_LIGHT_POINT, .position = {0, 0, 0.1f}, .color = {1, 1, 1}};
    parian_scene *scene = lit_sphere(env, 0.02f, 4, 3);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    float(*lit)[3] = lit_irradiance(env, scene, renderer, &light);
    double seen = 0, mean = 0, shown = 0;
    (void)state;
    assert_int_equal(parian_view_atlas_draw(env, scene, renderer, PARIAN_DISPLAY_ATLAS_IRRADIANCE,
                                            SIDE, SIDE, picture),
                     PARIAN_OK);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        seen += (double)picture[i][3];
        shown += (double)picture[i][0] * M_PI;
    }
    for (uint64_t t = 0; t < scene->info.texel_count; t++) {
        mean += (double)lit[t][0] / (double)scene->info.texel_count;
    }
    assert_true(seen > 0.1 * SIDE * SIDE && seen < SIDE * SIDE);
    assert_true(fabs(shown / seen - mean) < 0.05 * mean); /* texels have 3 to 4 pixels a side */
    parian_free(env, lit);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

/* Cells lie in the picture, do not overlap, and fill the larger part of what squares can. */
static void test_cells(void **state)
{
    (void)state;
    for (uint32_t count = 1; count < 12; count++) {
        for (uint32_t a = 0; a < count; a++) {
            const parian_view_cell cell = parian_view_atlas_cell(count, a, 300, 200);
            assert_true(cell.x >= 0 && cell.y >= 0 && cell.x + cell.side <= 300 &&
                        cell.y + cell.side <= 200 && cell.side > 40);
            for (uint32_t b = 0; b < a; b++) {
                const parian_view_cell other = parian_view_atlas_cell(count, b, 300, 200);
                assert_true(fabs(cell.x - other.x) > cell.side ||
                            fabs(cell.y - other.y) > cell.side);
            }
        }
    }
}

static void put(const char *path, const char *text)
{
    assert_int_equal(parian_file_write(NULL, path, text, strlen(text)), PARIAN_OK);
}

/* A file counts as changed at the second look at the new one: whoever writes it has finished by
 * then. */
static void test_watch(void **state)
{
    char path[512];
    parian_view_watch watch;
    (void)state;
    snprintf(path, sizeof path, "%s", test_scratch("watched"));
    put(path, "a");
    parian_view_watch_begin(&watch, path);
    assert_false(parian_view_watch_changed(&watch, path));
    put(path, "bb");
    assert_false(parian_view_watch_changed(&watch, path));
    put(path, "ccc"); /* still growing */
    assert_false(parian_view_watch_changed(&watch, path));
    assert_true(parian_view_watch_changed(&watch, path));
    assert_false(parian_view_watch_changed(&watch, path));
    unlink(path);
    assert_false(parian_view_watch_changed(&watch, path));
    assert_false(parian_view_watch_changed(&watch, path));
    put(path, "dd");
    assert_false(parian_view_watch_changed(&watch, path));
    assert_true(parian_view_watch_changed(&watch, path));
}

static void test_loader(void **state)
{
    static parian_view_loader loader;
    parian_scene *scene = NULL;
    parian_result result = PARIAN_OK;
    (void)state;
    assert_false(parian_view_loader_take(&loader, &result, &scene));
    assert_int_equal(parian_view_loader_begin(&loader, test_env(0), test_scratch("absent.parian")),
                     PARIAN_OK);
    while (!parian_view_loader_take(&loader, &result, &scene)) {
        usleep(1000);
    }
    assert_int_equal(result, PARIAN_E_IO);
    assert_null(scene);
    assert_int_equal(parian_view_loader_begin(&loader, test_env(0), loader.path), PARIAN_OK);
    parian_view_loader_stop(&loader);
    assert_false(parian_view_loader_take(&loader, &result, &scene));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nearest), cmocka_unit_test(test_two_sides),
        cmocka_unit_test(test_paint),   cmocka_unit_test(test_atlas),
        cmocka_unit_test(test_cells),   cmocka_unit_test(test_watch),
        cmocka_unit_test(test_loader),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
