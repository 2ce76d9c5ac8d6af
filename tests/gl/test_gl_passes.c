/* test_gl_passes.c - every shader pass against its C evaluation, on OpenGL and on OpenGL ES.
 *
 * Tolerance 1e-3 of the largest value: operands are the same halves, sums are in single precision
 * on both sides; at shadow edges the two rasterisers may disagree on a shadow texel, for which 0.5
 * % of the texels are allowed to differ in E, and passes behind it are compared where light meets
 * no shadow.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "gl/egl_context.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

static const parian_light open_light = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}};

/* Shadow maps of 512 texels, for speed. */
static parian_renderer *make_gl(const parian_env *env, const parian_scene *scene)
{
    parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 512};
    parian_renderer *renderer = NULL;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    return renderer;
}

/* Share of elements that differ by more than 1e-3 of the largest. */
static double differing(const float (*a)[3], const float (*b)[3], size_t count)
{
    double peak = 1e-30;
    size_t off = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(isfinite(a[i / 3][i % 3]) && isfinite(b[i / 3][i % 3]));
        peak = fmax(peak, fabs((double)b[i / 3][i % 3]));
    }
    for (size_t i = 0; i < 3 * count; i++) {
        off += fabs((double)a[i / 3][i % 3] - (double)b[i / 3][i % 3]) > 1e-3 * peak;
    }
    assert_true(peak > 1e-20); /* two dark results would agree on anything */
    return (double)off / (3.0 * (double)count);
}

typedef float (*float3_array)[3];

static float3_array new_array(const parian_env *env, size_t count)
{
    float3_array made = parian_zalloc(env, count, sizeof *made);
    assert_non_null(made);
    return made;
}

static void compare_registers(const parian_env *env, parian_renderer *gl, parian_renderer *cpu)
{
    const parian_body *body = &gl->scene->data.bodies[0];
    for (uint32_t r = 0; r < 2; r++) {
        uint32_t size = parian_body_register_size(body, r);
        float3_array a = new_array(env, size), b = new_array(env, size);
        assert_int_equal(parian_renderer_read_register(gl, 0, r, a), PARIAN_OK);
        assert_int_equal(parian_renderer_read_register(cpu, 0, r, b), PARIAN_OK);
        bool empty = r == 1 && !body->has_global && !body->blend_weight;
        assert_true(empty || differing((const float(*)[3])a, (const float(*)[3])b, size) == 0.0);
        parian_free(env, a);
        parian_free(env, b);
    }
}

/* E, local, global of both; allowed: share of texels that may differ. */
static void compare_texels(const parian_env *env, parian_renderer *gl, parian_renderer *cpu,
                           double allowed)
{
    const parian_body *body = &gl->scene->data.bodies[0];
    size_t count = (size_t)gl->scene->info.texel_count;
    parian_texel_arrays arrays[2] = {{0}, {0}};
    for (int k = 0; k < 2; k++) {
        arrays[k].irradiance = new_array(env, count);
        arrays[k].radiosity_local = new_array(env, count);
        arrays[k].radiosity_global = new_array(env, count);
        assert_int_equal(parian_renderer_read_texels(k ? cpu : gl, &arrays[k]), PARIAN_OK);
    }
    assert_true(differing((const float(*)[3])arrays[0].irradiance,
                          (const float(*)[3])arrays[1].irradiance, count) <= allowed);
    if (body->local_form != PARIAN_LOCAL_NONE) {
        assert_true(differing((const float(*)[3])arrays[0].radiosity_local,
                              (const float(*)[3])arrays[1].radiosity_local, count) <= allowed);
    }
    if (body->has_global || body->blend_weight) {
        assert_true(differing((const float(*)[3])arrays[0].radiosity_global,
                              (const float(*)[3])arrays[1].radiosity_global, count) <= allowed);
    }
    for (int k = 0; k < 2; k++) {
        parian_free(env, arrays[k].irradiance);
        parian_free(env, arrays[k].radiosity_local);
        parian_free(env, arrays[k].radiosity_global);
    }
}

/* Convex ball under one distant light: no shadow edge anywhere but at the terminator, where E is
 * zero. */
static void compare_form(parian_local_form form, bool paper, uint32_t width)
{
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 8,
                          .form = form,
                          .kernel_width = width,
                          .smooth_sphere = true,
                          .transport = form != PARIAN_LOCAL_ONLY,
                          .paper_form = paper,
                          .detail = true};
    assert_int_equal(test_sphere(env, 0.01, 9, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    parian_renderer *gl = make_gl(env, scene), *cpu = lit_cpu(env, scene, 512);
    assert_int_equal(parian_renderer_set_lights(gl, &open_light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(cpu, &open_light, 1), PARIAN_OK);
    compare_texels(env, gl, cpu, 0.0);
    compare_registers(env, gl, cpu);
    parian_renderer_destroy(gl);
    parian_renderer_destroy(cpu);
    parian_scene_close(scene);
}

static void test_forms(void **state)
{
    compare_form(PARIAN_LOCAL_F16, false, 3);
    compare_form(PARIAN_LOCAL_F16, true, 5);
    compare_form(PARIAN_LOCAL_U8, false, 3);
    compare_form(PARIAN_LOCAL_NONE, false, 3);
    compare_form(PARIAN_LOCAL_ONLY, false, 3);
    compare_form(PARIAN_LOCAL_REBUILT, false, 3);
    compare_form(PARIAN_LOCAL_SPLIT, false, 3);
    compare_form(PARIAN_LOCAL_F16, false, 1);
    (void)state;
}

static void test_light_types(void **state)
{
    enum { SIDE = 24 };
    static float pixel[SIDE * SIDE][3];
    for (int i = 0; i < 3 * SIDE * SIDE; i++) {
        pixel[i / 3][i % 3] = (i / 3 / 3 + i / 3 / SIDE / 3) % 2 ? 1.0f : 0.1f;
    }
    const parian_light lights[] = {
        {.type = PARIAN_LIGHT_POINT, .position = {0.06f, 0.05f, 0.03f}, .color = {1, 2, 3}},
        {.type = PARIAN_LIGHT_POINT, .position = {0, 0.028f, 0.012f}, .color = {1, 2, 3}},
        {.type = PARIAN_LIGHT_SPOT,
         .position = {0, 0.02f, 0.09f},
         .direction = {0, -0.2f, -1},
         .color = {1, 1, 1},
         .inner_deg = 12,
         .outer_deg = 20,
         .image = {SIDE, SIDE, (const float(*)[3])pixel}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 0, 0.07f},
         .axis_u = {0, 0.01f, 0},
         .axis_v = {0.01f, 0, 0},
         .color = {5, 5, 5}},
        {.type = PARIAN_LIGHT_ENVIRONMENT,
         .color = {1, 2, 1},
         .rotation_deg = 30,
         .image = {SIDE, SIDE, (const float(*)[3])pixel}},
    };
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 3};
    assert_int_equal(test_figure(env, 0.02, 10, &mesh), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    parian_renderer *gl = make_gl(env, scene), *cpu = lit_cpu(env, scene, 512);
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        assert_int_equal(parian_renderer_set_lights(gl, &lights[i], 1), PARIAN_OK);
        assert_int_equal(parian_renderer_set_lights(cpu, &lights[i], 1), PARIAN_OK);
        compare_texels(env, gl, cpu, 0.005);
        for (uint32_t set = 1; set < 4; set++) {
            assert_int_equal(parian_renderer_set_count(gl), set);
            assert_int_equal(parian_renderer_refine(gl), PARIAN_OK);
            assert_int_equal(parian_renderer_refine(cpu), PARIAN_OK);
        }
        compare_texels(env, gl, cpu, 0.005);
    }
    parian_renderer_destroy(gl);
    parian_renderer_destroy(cpu);
    parian_scene_close(scene);
    (void)state;
}

enum { WIDTH = 120, HEIGHT = 90 };

/* Mean difference over the mean, of linear pictures. */
static double picture_difference(parian_renderer *gl, parian_renderer *cpu,
                                 const parian_draw_desc *draw)
{
    static float a[WIDTH * HEIGHT][4], b[WIDTH * HEIGHT][4];
    static uint8_t sa[WIDTH * HEIGHT][4], sb[WIDTH * HEIGHT][4];
    double off = 0.0, sum = 0.0;
    int coded = 0, covered = 0;
    assert_int_equal(parian_renderer_draw(gl, draw), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(cpu, draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(gl, a, sa), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(cpu, b, sb), PARIAN_OK);
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++) {
        assert_true(isfinite(a[i / 4][i % 4]));
        off += fabs((double)a[i / 4][i % 4] - (double)b[i / 4][i % 4]);
        sum += fabs((double)b[i / 4][i % 4]);
        coded += abs((int)sa[i / 4][i % 4] - (int)sb[i / 4][i % 4]) > 3;
    }
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        covered += a[i][3] > 0.5f;
    }
    assert_true(covered > WIDTH * HEIGHT / 20 && covered < WIDTH * HEIGHT);
    assert_true(coded < WIDTH * HEIGHT / 50); /* tone curve and exposure agree but at edges */
    return off / sum;
}

/* Drawing values before they are given is refused; then a colour for each texel, from its place. */
static void paint_ramp(const parian_scene *scene, parian_renderer *gl, parian_renderer *cpu)
{
    const parian_settings settings = {.view = PARIAN_VIEW_VALUES};
    const parian_draw_desc draw = {.width = 8, .height = 8, .framebuffer = UINT32_MAX};
    const uint64_t count = parian_scene_get_info(scene).texel_count;
    const uint32_t side = parian_scene_get_body(scene, 0).atlas_size;
    uint32_t(*place)[2] = calloc(count, sizeof *place);
    float(*value)[3] = calloc(count, sizeof *value);
    const parian_texel_arrays arrays = {.place = place};
    assert_non_null(place);
    assert_non_null(value);
    assert_int_equal(parian_renderer_set_settings(cpu, &settings), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(cpu, &draw), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_renderer_read_texels(cpu, &arrays), PARIAN_OK);
    for (uint64_t t = 0; t < count; t++) {
        assert_true(place[t][0] < side && place[t][1] < side);
        value[t][0] = (float)place[t][0] / (float)side;
        value[t][1] = (float)place[t][1] / (float)side;
    }
    assert_int_equal(parian_renderer_set_values(gl, (const float(*)[3])value), PARIAN_OK);
    assert_int_equal(parian_renderer_set_values(cpu, (const float(*)[3])value), PARIAN_OK);
    free(place);
    free(value);
}

static void test_pictures(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    parian_light lights[3] = {{.type = PARIAN_LIGHT_POINT,
                               .position = {0.01f, 0.03f, 0.03f},
                               .color = {0.01f, 0.01f, 0.01f}},
                              {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {0.3f, 0.4f, 0.5f}},
                              open_light};
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    parian_renderer *gl = make_gl(env, scene), *cpu = lit_cpu(env, scene, 512);
    assert_int_equal(parian_renderer_set_lights(gl, lights, 3), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(cpu, lights, 3), PARIAN_OK);
    parian_draw_desc draw = {.camera = lit_camera(eye, WIDTH, HEIGHT),
                             .width = WIDTH,
                             .height = HEIGHT,
                             .exposure_auto = true,
                             .framebuffer = UINT32_MAX};
    paint_ramp(scene, gl, cpu);
    for (int view = 0; view <= PARIAN_VIEW_VALUES; view++) {
        parian_settings settings = {.view = (parian_view_mode)view,
                                    .background = {0.01f, 0.02f, 0.03f}};
        assert_int_equal(parian_renderer_set_settings(gl, &settings), PARIAN_OK);
        assert_int_equal(parian_renderer_set_settings(cpu, &settings), PARIAN_OK);
        double off = picture_difference(gl, cpu, &draw);
        print_message("view %d: pictures differ by %.5f\n", view, off);
        assert_true(off < 0.003); /* samples along silhouettes and shadow edges */
    }
    parian_renderer_destroy(gl);
    parian_renderer_destroy(cpu);
    parian_scene_close(scene);
    (void)state;
}

typedef struct run_counts {
    uint64_t relight, shade, tone; /* relight: each of the passes before shading ran as often */
} run_counts;

static run_counts count_runs(const parian_renderer *renderer)
{
    parian_pass_time times[PARIAN_PASS_MAX];
    assert_int_equal(parian_renderer_get_times(renderer, times), PARIAN_PASS_COUNT);
    for (int p = 1; p < PARIAN_PASS_SHADE; p++) {
        assert_int_equal(times[p].runs, times[0].runs);
    }
    return (run_counts){times[0].runs, times[PARIAN_PASS_SHADE].runs, times[PARIAN_PASS_TONE].runs};
}

/* Draw, and expect so many runs since the renderer was made. */
static void draw_and_expect(parian_renderer *renderer, const parian_draw_desc *draw,
                            uint64_t relight, uint64_t shade, uint64_t tone)
{
    assert_int_equal(parian_renderer_draw(renderer, draw), PARIAN_OK);
    run_counts found = count_runs(renderer);
    assert_int_equal(found.relight, relight);
    assert_int_equal(found.shade, shade);
    assert_int_equal(found.tone, tone);
}

static void expect_only_what_changed(parian_renderer *renderer)
{
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    parian_draw_desc draw = {
        .camera = lit_camera(eye, 32, 32), .width = 32, .height = 32, .framebuffer = UINT32_MAX};
    parian_settings settings = {.roughness = 0.5f};
    parian_instance instance = {{0}};
    parian_light moved = open_light;
    moved.direction[0] = 0.3f;
    assert_int_equal(parian_renderer_set_lights(renderer, &open_light, 1), PARIAN_OK);
    draw_and_expect(renderer, &draw, 1, 1, 1);
    draw_and_expect(renderer, &draw, 1, 1, 2); /* nothing: shown again */
    draw.exposure_ev = 1.0f;
    draw_and_expect(renderer, &draw, 1, 1, 3);
    draw.camera.view[14] *= 1.01f;
    draw_and_expect(renderer, &draw, 1, 2, 4);
    assert_int_equal(parian_renderer_set_settings(renderer, &settings), PARIAN_OK);
    draw_and_expect(renderer, &draw, 1, 3, 5);
    assert_int_equal(parian_renderer_set_settings(renderer, &settings), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(renderer, &open_light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(renderer, &instance, 1), PARIAN_OK);
    draw_and_expect(renderer, &draw, 1, 3, 6);
    assert_int_equal(parian_renderer_set_lights(renderer, &moved, 1), PARIAN_OK);
    draw_and_expect(renderer, &draw, 2, 4, 7);
    draw.width = 30;
    draw_and_expect(renderer, &draw, 2, 5, 8);
    parian_renderer_invalidate(renderer);
    draw_and_expect(renderer, &draw, 3, 6, 9);
    parian_renderer_destroy(renderer);
}

static void test_only_what_changed(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, 0.02f, 4, 3);
    expect_only_what_changed(make_gl(env, scene));
    expect_only_what_changed(lit_cpu(env, scene, 64));
    parian_scene_close(scene);
    (void)state;
}

/* What the application had bound is bound again, without errors; several renderers share a context.
 */
static void test_manners(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, 0.02f, 4, 3);
    void (*get_integer)(unsigned, int *) = NULL;
    void (*viewport)(int, int, int, int) = NULL;
    unsigned (*get_error)(void) = NULL;
    void *address[3] = {test_egl_address("glGetIntegerv"), test_egl_address("glViewport"),
                        test_egl_address("glGetError")};
    memcpy(&get_integer, &address[0], sizeof get_integer);
    memcpy(&viewport, &address[1], sizeof viewport);
    memcpy(&get_error, &address[2], sizeof get_error);
    viewport(3, 4, 50, 60);
    parian_renderer *a = make_gl(env, scene), *b = make_gl(env, scene);
    assert_true(parian_renderer_memory(a) > 0);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(parian_renderer_set_lights(i ? a : b, &open_light, 1), PARIAN_OK);
        assert_int_equal(parian_renderer_relight(i ? a : b), PARIAN_OK);
    }
    int found[4] = {0};
    get_integer(0x0BA2 /* GL_VIEWPORT */, found);
    assert_true(found[0] == 3 && found[1] == 4 && found[2] == 50 && found[3] == 60);
    get_integer(0x8B8D /* GL_CURRENT_PROGRAM */, found);
    assert_int_equal(found[0], 0);
    assert_int_equal(get_error(), 0);
    parian_renderer_destroy(a);
    parian_renderer_destroy(b);
    assert_int_equal(get_error(), 0);
    parian_scene_close(scene);
    (void)state;
}

static void *no_functions(const char *name)
{
    (void)name;
    return NULL;
}

static void test_refusals(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, 0.02f, 4, 3);
    parian_renderer *renderer = NULL;
    parian_renderer_desc desc = {.get_proc_address = no_functions};
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_E_UNSUPPORTED);
    desc.get_proc_address = NULL;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_E_ARGUMENT);
    desc.get_proc_address = test_egl_address;
    desc.memory_budget = 100000;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_E_NOMEM);
    assert_null(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* Allocations fail, every fifth in turn: an error, no crash, nothing left. */
static void test_failing_memory(void **state)
{
    const parian_env *good = test_env(1);
    parian_scene *scene = lit_sphere(good, 0.02f, 2, 2);
    for (size_t k = 0; k < 400; k += 5) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 64};
        parian_renderer *renderer = NULL;
        parian_result result = parian_renderer_create(&env, scene, &desc, &renderer);
        if (result == PARIAN_OK) {
            result = parian_renderer_set_lights(renderer, &open_light, 1);
        }
        if (result == PARIAN_OK) {
            result = parian_renderer_relight(renderer);
        }
        parian_renderer_destroy(renderer);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 5);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
    parian_scene_close(scene);
    (void)state;
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_light_types),
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_manners),
        cmocka_unit_test(test_only_what_changed),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_failing_memory),
    };
    test_egl egl;
    if (!test_egl_open(&egl, es)) {
        return -1;
    }
    int failed =
        cmocka_run_group_tests_name(es ? "OpenGL ES 3.0" : "OpenGL 3.3", tests, NULL, NULL);
    test_egl_close(&egl);
    return failed;
}

int main(void)
{
    int core = run_flavour(false), es = run_flavour(true);
    if (core < 0 && es < 0) {
        return 77; /* no EGL without a surface here */
    }
    return (core > 0 ? core : 0) + (es > 0 ? es : 0);
}
