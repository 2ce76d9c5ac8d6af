/* test_view_input.c - the player's mouse, keys, rings and lights on a lit sphere, and what must be
 * computed anew for them.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"
#include "tool/files.h"
#include "view_gizmo.h"
#include "view_input.h"

enum { WIDTH = 400, HEIGHT = 300 };

typedef struct fixture {
    parian_view_options options;
    parian_view_app app;
    parian_view_state state;
} fixture;

static fixture *open_fixture(const char *light)
{
    static fixture f;
    memset(&f, 0, sizeof f);
    f.options = (parian_view_options){.width = WIDTH,
                                      .height = HEIGHT,
                                      .background = {-1, -1, -1},
                                      .display_count = 1,
                                      .error_scale = 0.1};
    if (light) {
        f.options.lights.item[f.options.lights.count++] = light;
    }
    f.app = (parian_view_app){.env = test_env(0), .options = &f.options};
    assert_int_equal(parian_view_app_prepare(&f.app), PARIAN_OK);
    assert_int_equal(parian_view_app_adopt(&f.app, lit_sphere(f.app.env, 0.02f, 4, 3), false),
                     PARIAN_OK);
    f.state = (parian_view_state){.app = &f.app,
                                  .show_gizmos = true,
                                  .dragged = PARIAN_VIEW_NO_LIGHT,
                                  .window_width = WIDTH,
                                  .window_height = HEIGHT,
                                  .area_width = WIDTH};
    return &f;
}

static void close_fixture(fixture *f)
{
    parian_view_app_stop(&f->app);
    parian_view_app_close(&f->app);
}

/* What the window does before a picture; returns how often E was computed so far. */
static uint64_t draw(fixture *f)
{
    parian_pass_time times[PARIAN_PASS_MAX];
    if (f->state.lights_stale) {
        assert_int_equal(parian_view_app_send_lights(&f->app), PARIAN_OK);
    }
    assert_int_equal(parian_view_app_draw(&f->app, 32, 24, UINT32_MAX), PARIAN_OK);
    f->state.lights_stale = f->state.picture_stale = false;
    parian_renderer_get_times(f->app.renderer, times);
    return times[PARIAN_PASS_IRRADIANCE].runs;
}

static void drag(fixture *f, double x, double y, double dx, double dy)
{
    const parian_view_held left = {.left = true};
    parian_view_press(&f->state, x, y);
    parian_view_move(&f->state, x + dx, y + dy, &left);
    parian_view_release(&f->state);
}

/* An orbit moves the eye and asks for a picture, not for light. */
static void test_orbit(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    const parian_view_camera before = f->app.camera;
    const parian_view_held none = {.left = false};
    (void)state;
    assert_int_equal(draw(f), 1);
    drag(f, 30, 250, 40, 10);
    assert_true(f->state.picture_stale && !f->state.lights_stale);
    assert_true(fabs(f->app.camera.eye[0] - before.eye[0]) > 1e-3);
    assert_true(f->app.camera.target[0] == before.target[0]);
    assert_int_equal(draw(f), 1);
    parian_view_move(&f->state, 0, 0, &none);
    assert_false(f->state.picture_stale);
    parian_view_scroll(&f->state, 1);
    assert_true(f->state.picture_stale);
    close_fixture(f);
}

/* A ring that is dragged follows the mouse to within a pixel, and its light is computed anew. */
static void test_drag_light(void **state)
{
    fixture *f = open_fixture("point:0.005,0.012,0.03:intensity=0.01");
    float from[2], to[2];
    bool inside;
    (void)state;
    assert_int_equal(draw(f), 1);
    assert_true(parian_view_ring(&f->state, 0, from, &inside) && inside);
    drag(f, (double)from[0] + 3, (double)from[1] - 4, 35, -20);
    assert_true(f->state.lights_stale && f->state.picture_stale);
    assert_int_equal(f->state.selected, 0);
    assert_true(parian_view_ring(&f->state, 0, to, &inside) && inside);
    assert_true(fabsf(to[0] - from[0] - 35) < 1 && fabsf(to[1] - from[1] + 20) < 1);
    assert_int_equal(draw(f), 2);
    f->state.show_gizmos = false;
    assert_int_equal(parian_view_pick_light(&f->state, (double)to[0], (double)to[1]),
                     PARIAN_VIEW_NO_LIGHT);
    close_fixture(f);
}

/* A light out of sight has its ring at the edge, from where it turns about the bodies. */
static void test_drag_at_edge(void **state)
{
    fixture *f = open_fixture("point:0.5,0.4,-0.1:intensity=1");
    const double before = sqrt(0.5 * 0.5 + 0.4 * 0.4 + 0.1 * 0.1);
    double after = 0;
    float at[2];
    bool inside;
    (void)state;
    assert_true(parian_view_ring(&f->state, 0, at, &inside) && !inside);
    assert_true(at[0] >= 0 && at[0] <= WIDTH && at[1] >= 0 && at[1] <= HEIGHT);
    drag(f, (double)at[0], (double)at[1], -30, 30);
    for (int c = 0; c < 3; c++) {
        const double position = (double)f->app.lights.light[0].position[c];
        after += position * position;
    }
    assert_true(fabs(sqrt(after) - before) < 1e-5);
    assert_true(fabsf(f->app.lights.light[0].position[0] - 0.5f) > 1e-3f);
    close_fixture(f);
}

static void test_directional(void **state)
{
    fixture *f = open_fixture("directional:0,-0.3,-1:irradiance=1");
    float at[2];
    bool inside;
    (void)state;
    const float before = f->app.lights.light[0].direction[0];
    assert_true(parian_view_ring(&f->state, 0, at, &inside));
    drag(f, (double)at[0], (double)at[1], 40, 0);
    assert_true(fabsf(f->app.lights.light[0].direction[0] - before) > 0.05f);
    assert_true(f->state.lights_stale);
    close_fixture(f);
}

static void test_lights_by_hand(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    (void)state;
    for (int type = PARIAN_LIGHT_POINT; type <= PARIAN_LIGHT_ENVIRONMENT; type++) {
        assert_int_equal(parian_view_add_light(&f->state, (parian_light_type)type), PARIAN_OK);
        assert_int_equal(f->state.selected, type + 1);
        draw(f);
        assert_true(parian_view_lights_brightness(&f->app.lights, f->app.extent.body_centre) > 0);
    }
    f->app.light_off[2] = true;
    f->state.selected = 5;
    parian_view_remove_light(&f->state, 1);
    assert_int_equal(f->app.lights.count, 5);
    assert_true(f->app.light_off[1] && !f->app.light_off[2]); /* the switch moves with its light */
    assert_int_equal(f->app.lights.light[1].type, PARIAN_LIGHT_DIRECTIONAL);
    assert_int_equal(f->state.selected, 4);
    for (int i = 0; i < 6; i++) {
        parian_view_remove_light(&f->state, 0);
    }
    assert_int_equal(f->app.lights.count, 0);
    assert_int_equal(f->state.selected, PARIAN_VIEW_NO_LIGHT);
    draw(f); /* in the dark */
    close_fixture(f);
}

static void test_switched_off(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    float(*lit)[3] = parian_alloc(f->app.env, f->app.info.texel_count, sizeof *lit);
    const parian_texel_arrays arrays = {.irradiance = lit};
    (void)state;
    f->state.selected = 0;
    parian_view_key(&f->state, 'O', false);
    draw(f);
    assert_int_equal(parian_renderer_read_texels(f->app.renderer, &arrays), PARIAN_OK);
    for (uint64_t t = 0; t < f->app.info.texel_count; t++) {
        assert_true(lit[t][0] == 0);
    }
    parian_free(f->app.env, lit);
    close_fixture(f);
}

static void test_keys(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    const float ev = f->app.exposure_ev;
    (void)state;
    for (int key = '1'; key <= '8'; key++) {
        parian_view_key(&f->state, key, false);
        assert_int_equal(f->app.display, key - '1');
        draw(f);
    }
    parian_view_key(&f->state, '9', false); /* no reference: one line, the view stays */
    assert_int_equal(f->app.display, PARIAN_DISPLAY_RADIOSITY);
    assert_true(strstr(f->state.line, "--reference") != NULL);
    for (int display = PARIAN_DISPLAY_ATLAS_IRRADIANCE; display < PARIAN_DISPLAY_COUNT; display++) {
        parian_view_key(&f->state, '0', false);
        assert_int_equal(f->app.display, display);
        draw(f);
    }
    parian_view_key(&f->state, 'S', false);
    assert_int_equal(f->app.display, PARIAN_DISPLAY_OPAQUE);
    parian_view_key(&f->state, 'S', false);
    assert_int_equal(f->app.display, PARIAN_DISPLAY_ATLAS_CHARTS);
    parian_view_key(&f->state, '+', false);
    assert_true(fabsf(f->app.exposure_ev - ev - 0.25f) < 1e-6f);
    parian_view_key(&f->state, 'P', true);
    assert_true(f->state.requests.save_window && !f->state.requests.save_picture);
    parian_view_key(&f->state, 'H', false);
    assert_true(f->state.show_help && f->state.requests.list_keys);
    parian_view_key(&f->state, PARIAN_KEY_F1, false);
    assert_true(f->state.show_panel);
    parian_view_key(&f->state, PARIAN_KEY_TAB, false);
    assert_int_equal(f->state.selected, 0);
    parian_view_key(&f->state, PARIAN_KEY_ESCAPE, false);
    assert_true(f->state.requests.quit);
    parian_view_key(&f->state, 0, false);
    close_fixture(f);
}

/* The panel takes a column where there is room, and the rings follow. */
static void test_layout(void **state)
{
    fixture *f = open_fixture("point:0.005,0.012,0.03:intensity=0.01");
    float at[2];
    bool inside;
    (void)state;
    f->state.show_panel = true;
    f->state.window_width = PARIAN_VIEW_PANEL_WIDTH + WIDTH;
    parian_view_state_lay_out(&f->state);
    assert_int_equal(f->state.area_x, PARIAN_VIEW_PANEL_WIDTH);
    assert_int_equal(f->state.area_width, WIDTH);
    assert_true(parian_view_ring(&f->state, 0, at, &inside) && at[0] > PARIAN_VIEW_PANEL_WIDTH);
    f->state.window_width = PARIAN_VIEW_PANEL_WIDTH;
    parian_view_state_lay_out(&f->state);
    assert_int_equal(f->state.area_x, 0);
    close_fixture(f);
}

/* Dropped files: by their ending; lights replace lights, a bad file changes nothing. */
static void test_drops(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    static const char good[] =
        "{\"lights\":[{\"type\":\"directional\",\"direction\":[0,0,-1],\"irradiance\":2},"
        "{\"type\":\"environment\",\"radiance\":0.1}]}";
    char path[2][512];
    (void)state;
    assert_int_equal(parian_view_drop_kind("/a/b.parian"), PARIAN_DROP_ASSET);
    assert_int_equal(parian_view_drop_kind("/a/b.JSON"), PARIAN_DROP_LIGHTS);
    assert_int_equal(parian_view_drop_kind("/a/parian"), PARIAN_DROP_UNKNOWN);
    snprintf(path[0], sizeof path[0], "%s", test_scratch("good.json"));
    snprintf(path[1], sizeof path[1], "%s", test_scratch("bad.json"));
    assert_int_equal(parian_file_write(NULL, path[0], good, strlen(good)), PARIAN_OK);
    assert_int_equal(parian_file_write(NULL, path[1], good, strlen(good) - 4), PARIAN_OK);
    f->app.light_off[0] = true;
    assert_int_equal(parian_view_app_read_lights(&f->app, path[1]), PARIAN_E_FORMAT);
    assert_true(f->app.lights.count == 1 && f->app.light_off[0]);
    assert_int_equal(parian_view_app_read_lights(&f->app, path[0]), PARIAN_OK);
    assert_true(f->app.lights.count == 2 && !f->app.light_off[0]);
    f->state.lights_stale = true;
    draw(f);
    close_fixture(f);
}

/* The same asset again keeps camera and lights; another one is framed anew and has its own lights.
 */
static void test_adopting(void **state)
{
    fixture *f = open_fixture(NULL);
    const parian_env *env = f->app.env;
    (void)state;
    draw(f);
    drag(f, 30, 250, 40, 10);
    f->app.lights.light[0].position[0] += 0.01f;
    const parian_view_camera camera = f->app.camera;
    const float x = f->app.lights.light[0].position[0];
    assert_int_equal(parian_view_app_adopt(&f->app, lit_sphere(env, 0.03f, 4, 3), true), PARIAN_OK);
    assert_memory_equal(&camera, &f->app.camera, sizeof camera);
    assert_true(f->app.lights.light[0].position[0] == x);
    assert_int_equal(draw(f), 1);
    assert_int_equal(parian_view_app_adopt(&f->app, lit_sphere(env, 0.03f, 4, 3), false),
                     PARIAN_OK);
    assert_true(f->app.camera.eye[2] != camera.eye[2]);
    assert_true(f->app.lights.light[0].position[0] != x);
    draw(f);
    close_fixture(f);
}

/* A medium edit reaches B and is told; a medium that cannot be changes nothing; a new asset forgets
 * it. */
static void test_medium(void **state)
{
    fixture *f = open_fixture("point:0,0,0.06:intensity=0.01");
    const parian_env *env = f->app.env;
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    assert_int_equal(parian_view_app_adopt(&f->app, scene, true), PARIAN_OK);
    const uint64_t count = f->app.info.texel_count;
    float(*before)[3] = parian_alloc(env, count, sizeof *before);
    float(*after)[3] = parian_alloc(env, count, sizeof *after);
    const parian_scene_body body = parian_scene_get_body(f->app.scene, 0);
    parian_medium_edit edit = {.change_medium = true, .eta = body.eta};
    (void)state;
    for (int c = 0; c < 3; c++) {
        edit.sigma_s_prime[c] = body.sigma_s_prime[c];
        edit.sigma_a[c] = 20 * body.sigma_a[c] + 1;
    }
    const parian_texel_arrays first = {.radiosity = before}, second = {.radiosity = after};
    assert_int_equal(parian_renderer_read_texels(f->app.renderer, &first), PARIAN_OK);
    assert_int_equal(parian_view_app_edit(&f->app, 0, &edit), PARIAN_OK);
    assert_true(f->app.edit[0].change_medium && f->app.report.text[0] && f->app.error_stale);
    assert_int_equal(parian_renderer_read_texels(f->app.renderer, &second), PARIAN_OK);
    double sum[2] = {0, 0};
    for (uint64_t t = 0; t < count; t++) {
        sum[0] += (double)before[t][0];
        sum[1] += (double)after[t][0];
    }
    assert_true(sum[1] < 0.98 * sum[0]); /* it absorbs more */
    edit.eta = 0.5;
    assert_int_equal(parian_view_app_edit(&f->app, 0, &edit), PARIAN_E_ARGUMENT);
    assert_true(f->app.edit[0].eta == body.eta);
    assert_int_equal(parian_view_app_adopt(&f->app, lit_sphere(env, 0.02f, 4, 3), true), PARIAN_OK);
    assert_false(f->app.edit[0].change_medium);
    parian_free(env, before);
    parian_free(env, after);
    close_fixture(f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orbit),          cmocka_unit_test(test_drag_light),
        cmocka_unit_test(test_drag_at_edge),   cmocka_unit_test(test_directional),
        cmocka_unit_test(test_lights_by_hand), cmocka_unit_test(test_switched_off),
        cmocka_unit_test(test_keys),           cmocka_unit_test(test_layout),
        cmocka_unit_test(test_drops),          cmocka_unit_test(test_adopting),
        cmocka_unit_test(test_medium),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
