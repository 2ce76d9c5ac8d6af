/* test_view_sequence.c - names of a sequence's pictures, keyframes, the camera between them, and
 * --view.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_sequence.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support/test_support.h"
#include "tool/files.h"

static void test_names(void **state)
{
    static const struct {
        const char *pattern, *name;
    } good[] = {{"out-%04d.png", "out-0007.png"},
                {"%d/%s.exr", "7/local.exr"},
                {"100%%-%02d%s.png", "100%-07local.png"},
                {"plain.png", "plain.png"}};
    static const char *const bad[] = {"%x.png", "%4d.png", "%04u.png", "%", "%0d.png", "%-d"};
    char name[64];
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(parian_view_sequence_name(good[i].pattern, 7, "local", name, sizeof name));
        assert_string_equal(name, good[i].name);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(parian_view_sequence_name(bad[i], 7, "local", name, sizeof name));
    }
    assert_true(parian_view_sequence_name("%09d", 1234567890, "a", name, sizeof name));
    assert_string_equal(name, "1234567890");
    assert_true(parian_view_sequence_name("abc", 0, "", name, 4));
    assert_false(parian_view_sequence_name("abcd", 0, "", name, 4));
}

static void test_views(void **state)
{
    parian_view_display out[PARIAN_DISPLAY_COUNT];
    const char *unknown = NULL;
    (void)state;
    assert_int_equal(parian_view_display_parse("opaque", out, &unknown), 1);
    assert_int_equal(out[0], PARIAN_DISPLAY_OPAQUE);
    assert_int_equal(parian_view_display_parse("atlas-charts,local", out, &unknown), 2);
    assert_true(out[0] == PARIAN_DISPLAY_ATLAS_CHARTS && out[1] == PARIAN_DISPLAY_LOCAL);
    assert_int_equal(parian_view_display_parse("local,sideways,opaque", out, &unknown), 0);
    assert_int_equal(strncmp(unknown, "sideways", 8), 0);
    assert_int_equal(parian_view_display_parse("", out, &unknown), 0);
    assert_int_equal(parian_view_display_parse("local,", out, &unknown), 0);
}

static parian_result read_path(const char *json, parian_view_path *path)
{
    const parian_view_camera start = {.eye = {0, 0, 1}, .up = {0, 1, 0}, .fov_deg = 40};
    const char *file = test_scratch("path.json");
    assert_int_equal(parian_file_write(NULL, file, json, strlen(json)), PARIAN_OK);
    return parian_view_path_read(NULL, file, &start, path);
}

/* Through every keyframe, straight where they are on a line at even times, between them nowhere
 * near a jump. */
static void test_path(void **state)
{
    parian_view_path path;
    (void)state;
    assert_int_equal(read_path("{\"keyframes\":[{\"eye\":[0,0,1]},{\"eye\":[1,0,1],\"fov_deg\":50},"
                               "{\"eye\":[2,0,1]},{\"eye\":[2,2,1],\"time\":5}]}",
                               &path),
                     PARIAN_OK);
    assert_int_equal(path.count, 4);
    assert_int_equal(path.frames, 125);
    const double times[] = {0, 1, 2, 5};
    for (size_t i = 0; i < 4; i++) {
        const parian_view_camera at = parian_view_path_at(&path, times[i] / 5);
        for (int c = 0; c < 3; c++) {
            assert_true(fabs(at.eye[c] - path.key[i].eye[c]) < 1e-12);
        }
    }
    const parian_view_camera half = parian_view_path_at(&path, 0.1); /* time 0.5, on the line */
    assert_true(fabs(half.eye[0] - 0.5) < 1e-12 && fabs(half.eye[1]) < 1e-12);
    assert_true(fabs(half.fov_deg - 45) < 1e-12);
    double before = 0;
    for (int i = 1; i <= 1000; i++) {
        const parian_view_camera at = parian_view_path_at(&path, i / 1000.0);
        assert_true(fabs(at.eye[0] - before) < 0.02);
        before = at.eye[0];
    }
    parian_view_path_free(NULL, &path);
    assert_int_equal(
        read_path("{\"frames\":3,\"keyframes\":[{\"eye\":[0,0,1]},{\"eye\":[1,0,1]}]}", &path),
        PARIAN_OK);
    assert_int_equal(path.frames, 3);
    assert_true(path.key[0].fov_deg == 40); /* of the camera it starts from */
    parian_view_path_free(NULL, &path);
}

static void test_bad_paths(void **state)
{
    static const char *const bad[] = {
        "",
        "[]",
        "{}",
        "{\"keyframes\":[{\"eye\":[0,0,1]}]}",
        "{\"keyframes\":[{\"eye\":[0,0,1]},{}]}",
        "{\"keyframes\":[{\"eye\":[0,0,1]},3]}",
        "{\"keyframes\":[{\"eye\":[0,0,1],\"time\":1},{\"eye\":[1,0,1],\"time\":1}]}",
        "{\"keyframes\":[{\"eye\":[0,0,1]},{\"eye\":[0,0,\"x\"]}]}",
        "{\"frames\":0,\"keyframes\":[{\"eye\":[0,0,1]},{\"eye\":[1,0,1]}]}",
        "{\"frames\":1e9,\"keyframes\":[{\"eye\":[0,0,1]},{\"eye\":[1,0,1]}]}"};
    parian_view_path path;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(read_path(bad[i], &path), PARIAN_E_FORMAT);
    }
    assert_int_equal(parian_view_path_read(NULL, test_scratch("absent.json"), NULL, &path),
                     PARIAN_E_IO);
}

/* What goes together on the command line, and what does not. */
static void test_check(void **state)
{
    const parian_view_options turn = {.turntable = 4, .image = "a%d.png", .display_count = 1};
    parian_view_options o = turn;
    (void)state;
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_OK);
    o.image = "a.png";
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_E_ARGUMENT);
    o.image = NULL;
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_E_ARGUMENT);
    o = turn;
    o.camera_path = "p.json";
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_E_ARGUMENT);
    o = turn;
    o.frames = 3;
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_E_ARGUMENT);
    o = turn;
    o.display_count = 2;
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_E_ARGUMENT);
    o.image = "%s%d.png";
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_OK);
    o = (parian_view_options){.display_count = 1, .image = "100%.png"}; /* one picture: any name */
    assert_int_equal(parian_view_sequence_check(NULL, &o), PARIAN_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_names),     cmocka_unit_test(test_views), cmocka_unit_test(test_path),
        cmocka_unit_test(test_bad_paths), cmocka_unit_test(test_check),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
