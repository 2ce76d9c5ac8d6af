/* test_view_camera.c - the player's camera: framing, orbits, files, matrices, motions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "runtime/player/view_camera.c"

#include <stdio.h>

#include "support/test_support.h"

/* A body of 60 x 40 x 20 mm off the origin, and surroundings ten times as large. */
static parian_view_extent make_extent(void)
{
    const parian_scene_info info = {.body_lower = {0.07f, 0.01f, -0.01f},
                                    .body_upper = {0.13f, 0.05f, 0.01f},
                                    .lower = {-0.2f, -0.2f, -0.2f},
                                    .upper = {0.4f, 0.3f, 0.2f}};
    return parian_view_extent_of(&info);
}

/* Clip coordinates of a point; returns w. */
static double project(const parian_camera *camera, const double p[3], double clip[3])
{
    double eye[4], out[4];
    for (int row = 0; row < 4; row++) {
        eye[row] = camera->view[12 + row];
        for (int c = 0; c < 3; c++) {
            eye[row] += (double)camera->view[c * 4 + row] * p[c];
        }
    }
    for (int row = 0; row < 4; row++) {
        out[row] = 0;
        for (int c = 0; c < 4; c++) {
            out[row] += (double)camera->projection[c * 4 + row] * eye[c];
        }
    }
    for (int c = 0; c < 3; c++) {
        clip[c] = out[c] / out[3];
    }
    return out[3];
}

/* Every corner of the bodies is in the picture, and one comes near its edge: within a fifth. */
static void test_framing_fits(void **state)
{
    static const double aspects[] = {0.3, 1, 1.7777, 5};
    const parian_view_extent extent = make_extent();
    (void)state;
    for (size_t a = 0; a < sizeof aspects / sizeof aspects[0]; a++) {
        parian_view_camera camera;
        double largest = 0;
        assert_int_equal(parian_view_camera_make(NULL, NULL, &extent, aspects[a], &camera),
                         PARIAN_OK);
        const parian_camera matrices = parian_view_camera_matrices(&camera, &extent, aspects[a]);
        for (unsigned corner = 0; corner < 8; corner++) {
            double p[3], clip[3];
            for (int c = 0; c < 3; c++) {
                p[c] = corner >> c & 1 ? extent.body_upper[c] : extent.body_lower[c];
            }
            assert_true(project(&matrices, p, clip) > 0);
            assert_true(fabs(clip[0]) < 1 && fabs(clip[1]) < 1 && fabs(clip[2]) < 1);
            largest = fmax(largest, fmax(fabs(clip[0]), fabs(clip[1])));
        }
        assert_true(largest > 0.85);
    }
}

static void check_point(const double p[3], double x, double y, double z)
{
    if (!(fabs(p[0] - x) < 1e-7 && fabs(p[1] - y) < 1e-7 && fabs(p[2] - z) < 1e-7)) {
        fail_msg("(%g, %g, %g) is not (%g, %g, %g)", p[0], p[1], p[2], x, y, z);
    }
}

static void test_orbits(void **state)
{
    const parian_view_extent extent = make_extent();
    const double radius = sqrt(0.03 * 0.03 + 0.02 * 0.02 + 0.01 * 0.01);
    parian_view_camera camera;
    (void)state;
    assert_int_equal(parian_view_camera_make(NULL, "orbit:0,0,1m", &extent, 1, &camera), PARIAN_OK);
    check_point(camera.eye, 0.1, 0.03, 1);
    assert_int_equal(parian_view_camera_make(NULL, "orbit:90,0,2", &extent, 1, &camera), PARIAN_OK);
    check_point(camera.eye, 0.1 + 2 * radius, 0.03, 0);
    assert_int_equal(parian_view_camera_make(NULL, "orbit:0,90,20cm", &extent, 1, &camera),
                     PARIAN_OK);
    check_point(camera.eye, 0.1, 0.23, 0);
    double right[3], up[3], back[3];
    parian_view_camera_axes(&camera, right, up, back);
    check_point(right, 1, 0, 0); /* from above: +x is right and -z is up */
    check_point(up, 0, 0, -1);
    assert_int_equal(parian_view_camera_make(NULL, "orbit:0,-90,20cm", &extent, 1, &camera),
                     PARIAN_OK);
    parian_view_camera_axes(&camera, right, up, back);
    check_point(right, 1, 0, 0);
    check_point(up, 0, 0, 1);
}

static void test_bad_orbits(void **state)
{
    static const char *const bad[] = {
        "orbit:",       "orbit:1",     "orbit:1,",      "orbit:1,2,",    "orbit:1,2,0",
        "orbit:1,2,-1", "orbit:1,2,x", "orbit:nan,0,1", "orbit:1,2,3,4", "orbit:1,2,1parsec"};
    const parian_view_extent extent = make_extent();
    parian_view_camera camera;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(parian_view_camera_check(NULL, bad[i]), PARIAN_E_ARGUMENT);
        assert_int_equal(parian_view_camera_make(NULL, bad[i], &extent, 1, &camera),
                         PARIAN_E_ARGUMENT);
    }
    assert_int_equal(parian_view_camera_check(NULL, "orbit:-720,5"), PARIAN_OK);
    assert_int_equal(parian_view_camera_check(NULL, NULL), PARIAN_OK);
}

static parian_result make_from_file(const char *json, parian_view_camera *camera)
{
    const parian_view_extent extent = make_extent();
    const char *path = test_scratch("camera.json");
    assert_int_equal(parian_file_write(NULL, path, json, strlen(json)), PARIAN_OK);
    return parian_view_camera_make(NULL, path, &extent, 1, camera);
}

static void test_files(void **state)
{
    static const char *const bad[] = {"",
                                      "[1]",
                                      "{}",
                                      "{\"eye\":[1,2]}",
                                      "{\"eye\":[1,2,1e99]}",
                                      "{\"eye\":[0,0,0],\"target\":[0,0,0]}",
                                      "{\"eye\":[0,0,1],\"up\":[0,0,0]}",
                                      "{\"eye\":[0,0,1],\"fov_deg\":180}",
                                      "{\"eye\":[0,0,1],\"fov_deg\":\"30\"}"};
    parian_view_camera camera;
    (void)state;
    assert_int_equal(
        make_from_file("{\"eye\":[1,2,3],\"target\":[1,2,0],\"up\":[1,0,0],\"fov_deg\":90}",
                       &camera),
        PARIAN_OK);
    const parian_view_extent extent = make_extent();
    const parian_camera matrices = parian_view_camera_matrices(&camera, &extent, 2);
    const double corner[3] = {4, -4,
                              0}; /* a fov of 90 degrees at distance 3: up +x by 3, right -y by 6 */
    double clip[3];
    project(&matrices, corner, clip);
    assert_true(fabs(clip[0] - 1) < 1e-5 && fabs(clip[1] - 1) < 1e-5);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(make_from_file(bad[i], &camera), PARIAN_E_FORMAT);
    }
}

/* Motions keep what they should: orbit and zoom the target, orbit and pan the distance. */
static void test_motions(void **state)
{
    const parian_view_extent extent = make_extent();
    parian_view_camera camera;
    double arm[3];
    (void)state;
    assert_int_equal(parian_view_camera_make(NULL, "orbit:0,0,1m", &extent, 1, &camera), PARIAN_OK);
    parian_view_camera_orbit(&camera, PI / 2, 0);
    check_point(camera.eye, 1.1, 0.03, 0);
    parian_view_camera_orbit(&camera, 0, PI / 6);
    check_point(camera.eye, 0.1 + cos(PI / 6), 0.53, 0);
    for (int i = 0; i < 100; i++) {
        parian_view_camera_orbit(&camera, 0.01, 0.1); /* over the pole: it stops short */
    }
    vector_add_scaled(camera.eye, -1, camera.target, arm);
    assert_true(fabs(vector_length(arm) - 1) < 1e-9 && arm[1] < 0.9996);
    check_point(camera.target, 0.1, 0.03, 0);
    parian_view_camera_zoom(&camera, 0.5);
    vector_add_scaled(camera.eye, -1, camera.target, arm);
    assert_true(fabs(vector_length(arm) - 0.5) < 1e-9);
    parian_view_camera_pan(&camera, 0.3, -0.2);
    vector_add_scaled(camera.eye, -1, camera.target, arm);
    assert_true(fabs(vector_length(arm) - 0.5) < 1e-9);
}

static void test_empty_scene(void **state)
{
    const parian_scene_info info = {.body_count = 0};
    const parian_view_extent extent = parian_view_extent_of(&info);
    parian_view_camera camera;
    (void)state;
    assert_int_equal(parian_view_camera_make(NULL, NULL, &extent, 1, &camera), PARIAN_OK);
    const parian_camera matrices = parian_view_camera_matrices(&camera, &extent, 1);
    for (int i = 0; i < 16; i++) {
        assert_true(isfinite(matrices.view[i]) && isfinite(matrices.projection[i]));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_framing_fits), cmocka_unit_test(test_orbits),
        cmocka_unit_test(test_bad_orbits),   cmocka_unit_test(test_files),
        cmocka_unit_test(test_motions),      cmocka_unit_test(test_empty_scene),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
