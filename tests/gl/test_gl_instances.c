/* test_gl_instances.c - copies of a scene that stand elsewhere, in GL and in C.
 *
 * GL against C: 1e-3 of the largest value, as in test_gl_passes.c, with 0.5 % of the texels allowed
 * to differ at shadow edges. What must not change when everything is turned or scaled is compared
 * to 1e-4 of the largest value: single precision of positions that went through a matrix.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/egl_context.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

typedef float (*float3_array)[3];

static parian_renderer *make(const parian_env *env, const parian_scene *scene, bool gl)
{
    parian_renderer_desc desc = {.backend = gl ? PARIAN_BACKEND_GL : PARIAN_BACKEND_CPU,
                                 .get_proc_address = test_egl_address,
                                 .shadow_size = 512};
    parian_renderer *renderer = NULL;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    return renderer;
}

/* Turn about an axis by an angle, scale, move. */
static parian_instance place(const float axis[3], float angle, float scale, float x, float y,
                             float z)
{
    parian_instance made = {{0}};
    float length = sqrtf(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    float u[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    float c = cosf(angle), s = sinf(angle);
    for (int column = 0; column < 3; column++) {
        int next = (column + 1) % 3, last = (column + 2) % 3;
        made.transform[5 * column] = c;
        made.transform[4 * column + next] = s * u[last];
        made.transform[4 * column + last] = -s * u[next];
        for (int row = 0; row < 3; row++) {
            made.transform[4 * column + row] += (1.0f - c) * u[row] * u[column];
            made.transform[4 * column + row] *= scale;
        }
    }
    made.transform[12] = x, made.transform[13] = y, made.transform[14] = z;
    made.transform[15] = 1.0f;
    return made;
}

static void turn(const parian_instance *by, const float from[3], float w, float to[3])
{
    for (int c = 0; c < 3; c++) {
        to[c] = w * by->transform[12 + c];
        for (int k = 0; k < 3; k++) {
            to[c] += by->transform[4 * k + c] * from[k];
        }
    }
}

static float3_array read_radiosity(const parian_env *env, parian_renderer *renderer,
                                   uint32_t instance, bool irradiance)
{
    size_t count = (size_t)renderer->scene->info.texel_count;
    float3_array made = parian_zalloc(env, count, sizeof *made);
    parian_texel_arrays arrays = {.instance = instance};
    assert_non_null(made);
    *(irradiance ? &arrays.irradiance : &arrays.radiosity) = made;
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    return made;
}

/* Share of values that differ by more than tolerance of the largest; frees both. */
static double differing(const parian_env *env, float3_array a, float3_array b, size_t count,
                        double tolerance)
{
    double peak = 0.0;
    size_t off = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(isfinite(a[i / 3][i % 3]) && isfinite(b[i / 3][i % 3]));
        peak = fmax(peak, fabs((double)b[i / 3][i % 3]));
    }
    assert_true(peak > 1e-20);
    for (size_t i = 0; i < 3 * count; i++) {
        off += fabs((double)a[i / 3][i % 3] - (double)b[i / 3][i % 3]) > tolerance * peak;
    }
    parian_free(env, a);
    parian_free(env, b);
    return (double)off / (3.0 * (double)count);
}

/* Smooth ball with a local and a global part. */
static parian_scene *ball_scene(const parian_env *env)
{
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 6,
                          .form = PARIAN_LOCAL_F16,
                          .kernel_width = 3,
                          .smooth_sphere = true,
                          .transport = true};
    assert_int_equal(test_sphere(env, 0.01, 7, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    return lit_scene(env, &mesh, &desc);
}

static parian_scene *tiny_scene(const parian_env *env)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

/* ---- GL against C ---- */

enum { WIDTH = 120, HEIGHT = 90 };

static double picture_difference(parian_renderer *gl, parian_renderer *cpu)
{
    static float a[WIDTH * HEIGHT][4], b[WIDTH * HEIGHT][4];
    const float eye[3] = {0.06f, 0.09f, 0.16f};
    const parian_draw_desc draw = {.camera = lit_camera(eye, WIDTH, HEIGHT),
                                   .width = WIDTH,
                                   .height = HEIGHT,
                                   .framebuffer = UINT32_MAX};
    double off = 0.0, sum = 0.0;
    int covered = 0;
    assert_int_equal(parian_renderer_draw(gl, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(cpu, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(gl, a, NULL), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(cpu, b, NULL), PARIAN_OK);
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++) {
        off += fabs((double)a[i / 4][i % 4] - (double)b[i / 4][i % 4]);
        sum += fabs((double)b[i / 4][i % 4]);
        covered += i % 4 == 3 && b[i / 4][3] > 0.5f;
    }
    assert_true(covered > WIDTH * HEIGHT / 20);
    return off / sum;
}

static void test_against_c(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = tiny_scene(env);
    const float axis[3] = {1, 2, -0.5f};
    const parian_instance instances[3] = {{{0}},
                                          place(axis, 0.8f, 1.5f, -0.05f, 0.01f, 0.02f),
                                          place(axis, -0.4f, 0.5f, 0.01f, 0.0f, 0.025f)};
    const parian_light lights[3] = {
        {.type = PARIAN_LIGHT_POINT,
         .position = {0.01f, 0.03f, 0.06f},
         .color = {.01f, .02f, .01f}},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {0.3f, 0.4f, 0.5f}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-.4f, -.2f, -1}, .color = {3, 2, 1}}};
    parian_renderer *gl = make(env, scene, true), *cpu = make(env, scene, false);
    parian_renderer *both[2] = {gl, cpu};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(parian_renderer_set_lights(both[k], lights, 3), PARIAN_OK);
        assert_int_equal(parian_renderer_set_instances(both[k], instances, 3), PARIAN_OK);
    }
    for (uint32_t i = 0; i < 3; i++) {
        for (int e = 0; e < 2; e++) {
            float3_array a = read_radiosity(env, gl, i, e), b = read_radiosity(env, cpu, i, e);
            assert_true(differing(env, a, b, scene->info.texel_count, 1e-3) <= 0.005);
        }
    }
    static const parian_view_mode views[3] = {PARIAN_VIEW_COMBINED, PARIAN_VIEW_NORMALS,
                                              PARIAN_VIEW_IRRADIANCE};
    for (int v = 0; v < 3; v++) {
        parian_settings settings = {.view = views[v]};
        assert_int_equal(parian_renderer_set_settings(gl, &settings), PARIAN_OK);
        assert_int_equal(parian_renderer_set_settings(cpu, &settings), PARIAN_OK);
        assert_true(picture_difference(gl, cpu) < 0.003);
    }
    parian_renderer_destroy(gl);
    parian_renderer_destroy(cpu);
    parian_scene_close(scene);
    (void)state;
}

/* ---- what must not change ---- */

/* A light that is turned, scaled and moved with the instance: its distance grows by the scale, so
 * its intensity must by the square. */
static parian_light follow(const parian_light *light, const parian_instance *by, float scale)
{
    parian_light made = *light;
    turn(by, light->position, 1.0f, made.position);
    turn(by, light->direction, 0.0f, made.direction);
    for (int c = 0; c < 3 && light->type == PARIAN_LIGHT_POINT; c++) {
        made.color[c] *= scale * scale;
    }
    return made;
}

static void expect_same(const parian_env *env, const parian_scene *scene, parian_renderer *renderer,
                        const parian_light *light, const parian_instance *instance, float scale)
{
    assert_int_equal(parian_renderer_set_instances(renderer, NULL, 0), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(renderer, light, 1), PARIAN_OK);
    float3_array before = read_radiosity(env, renderer, 0, false);
    parian_light moved = follow(light, instance, scale);
    assert_int_equal(parian_renderer_set_instances(renderer, instance, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(renderer, &moved, 1), PARIAN_OK);
    float3_array after = read_radiosity(env, renderer, 0, false);
    assert_true(differing(env, after, before, scene->info.texel_count, 1e-4) == 0.0);
    /* The light alone: another B, or the comparison above says nothing. */
    assert_int_equal(parian_renderer_set_lights(renderer, light, 1), PARIAN_OK);
    float3_array other = read_radiosity(env, renderer, 0, false);
    assert_int_equal(parian_renderer_set_lights(renderer, &moved, 1), PARIAN_OK);
    float3_array again = read_radiosity(env, renderer, 0, false);
    assert_true(differing(env, other, again, scene->info.texel_count, 1e-2) > 0.2);
}

static void test_turned_with_its_light(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    const float axis[3] = {1, -2, 0.7f};
    const parian_light lights[2] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}},
        {.type = PARIAN_LIGHT_POINT, .position = {0.02f, 0.03f, 0.01f}, .color = {3, 2, 1}}};
    for (int gl = 0; gl < 2; gl++) {
        parian_renderer *renderer = make(env, scene, gl);
        for (int l = 0; l < 2; l++) {
            const parian_instance turned = place(axis, 1.3f, 1.0f, 0.2f, -0.1f, 0.05f);
            const parian_instance scaled = place(axis, -0.5f, 3.0f, 0.0f, 0.1f, 0.0f);
            expect_same(env, scene, renderer, &lights[l], &turned, 1.0f);
            expect_same(env, scene, renderer, &lights[l], &scaled, 3.0f);
        }
        parian_renderer_destroy(renderer);
    }
    parian_scene_close(scene);
    (void)state;
}

/* Scaled with lights that shine through thin ears and from a tenth of a texel away: shadow lifts
 * and the sides of texels must scale too. Shadow maps are the same but for rounding, which may move
 * a shadow's edge at one texel in a thousand. */
static void expect_scaled(const parian_env *env, const parian_scene *scene, bool gl)
{
    const float axis[3] = {0, 1, 0};
    const parian_instance scaled = place(axis, 0.0f, 40.0f, 0.0f, 0.0f, 0.0f);
    const float *near_texel = scene->data.bodies[0].texel_position[0];
    const float *normal = scene->data.bodies[0].texel_normal[0];
    const float side = sqrtf(scene->data.bodies[0].texel_area[0]);
    parian_light lights[2] = {
        {.type = PARIAN_LIGHT_POINT, .color = {3, 2, 1}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.9f, -0.2f, -0.3f}, .color = {3, 2, 1}}};
    for (int c = 0; c < 3; c++) {
        lights[0].position[c] = near_texel[c] + 0.1f * side * normal[c];
    }
    parian_renderer *renderer = make(env, scene, gl);
    for (int l = 0; l < 2; l++) {
        const parian_light moved = follow(&lights[l], &scaled, 40.0f);
        assert_int_equal(parian_renderer_set_instances(renderer, NULL, 0), PARIAN_OK);
        assert_int_equal(parian_renderer_set_lights(renderer, &lights[l], 1), PARIAN_OK);
        float3_array before = read_radiosity(env, renderer, 0, true);
        assert_int_equal(parian_renderer_set_instances(renderer, &scaled, 1), PARIAN_OK);
        assert_int_equal(parian_renderer_set_lights(renderer, &moved, 1), PARIAN_OK);
        float3_array after = read_radiosity(env, renderer, 0, true);
        /* The texel that the first light is near: its side bounds 1 / d^2. */
        assert_true(l == 1 || fabsf(after[0][0] / before[0][0] - 1.0f) < 1e-3f);
        double off = differing(env, after, before, scene->info.texel_count, 1e-3);
        print_message("scaled, light %d: %.5f differ\n", l, off);
        assert_true(off <= 0.001);
    }
    parian_renderer_destroy(renderer);
}

static void test_scaled(void **state)
{
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 6, .form = PARIAN_LOCAL_NONE};
    assert_int_equal(test_figure(env, 0.02, 10, &mesh), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    expect_scaled(env, scene, false);
    expect_scaled(env, scene, true);
    parian_scene_close(scene);
    (void)state;
}

/* ---- instances shadow each other; counters ---- */

static uint64_t runs_of(const parian_renderer *renderer, parian_pass pass)
{
    parian_pass_time times[PARIAN_PASS_MAX];
    parian_renderer_get_times(renderer, times);
    return times[pass].runs;
}

static double sum_of(const parian_env *env, parian_renderer *renderer, uint32_t instance)
{
    float3_array e = read_radiosity(env, renderer, instance, true);
    double sum = 0.0;
    for (size_t i = 0; i < 3 * renderer->scene->info.texel_count; i++) {
        sum += (double)e[i / 3][i % 3];
    }
    parian_free(env, e);
    return sum;
}

static void expect_shadows(const parian_env *env, const parian_scene *scene, bool gl)
{
    const float axis[3] = {0, 1, 0};
    const parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, 0, 0}, .color = {1, 1, 1}};
    parian_instance pair[2] = {place(axis, 0, 1, 0, 0, 0), place(axis, 0, 2, 0, 0.1f, 0)};
    parian_renderer *renderer = make(env, scene, gl);
    assert_int_equal(parian_renderer_set_lights(renderer, &light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_OK);
    double open = sum_of(env, renderer, 0);
    assert_true(open > 0.0 && fabs(sum_of(env, renderer, 1) / open - 1.0) < 0.02);
    for (int p = 0; p < PARIAN_PASS_SHADE; p++) {
        assert_int_equal(runs_of(renderer, (parian_pass)p), 1);
    }
    /* The larger one moves between the light and the smaller one. */
    pair[1] = place(axis, 0, 2, 0.1f, 0, 0);
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_OK);
    assert_true(sum_of(env, renderer, 0) < 1e-3 * open);
    assert_true(fabs(sum_of(env, renderer, 1) / open - 1.0) < 0.02);
    for (int p = 0; p < PARIAN_PASS_SHADE; p++) {
        assert_int_equal(runs_of(renderer, (parian_pass)p), 2);
    }
    /* Nothing moves. */
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    assert_int_equal(runs_of(renderer, PARIAN_PASS_IRRADIANCE), 2);
    /* It goes away. */
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 1), PARIAN_OK);
    assert_true(fabs(sum_of(env, renderer, 0) / open - 1.0) < 0.02);
    parian_renderer_destroy(renderer);
}

static void test_shadows(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    expect_shadows(env, scene, false);
    expect_shadows(env, scene, true);
    parian_scene_close(scene);
    (void)state;
}

/* ---- arrays, memory, refusals ---- */

static void test_surface_arrays(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    parian_renderer *renderer = make(env, scene, false);
    const float axis[3] = {0, 0, 1};
    const parian_instance pair[2] = {{{0}}, place(axis, 0.6f, 2, 1, 0, 0)};
    const size_t count = (size_t)scene->info.texel_count;
    parian_texel_arrays arrays = {.instance = 1};
    arrays.position = parian_zalloc(env, count, sizeof *arrays.position);
    arrays.normal = parian_zalloc(env, count, sizeof *arrays.normal);
    arrays.area = parian_zalloc(env, count, sizeof *arrays.area);
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_OK);
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    for (size_t t = 0; t < count; t++) {
        const parian_body *body = &scene->data.bodies[0];
        float p[3], n[3];
        turn(&pair[1], body->texel_position[t], 1.0f, p);
        turn(&pair[1], body->texel_normal[t], 0.0f, n);
        for (int c = 0; c < 3; c++) {
            assert_true(fabsf(arrays.position[t][c] - p[c]) < 1e-6f);
            assert_true(fabsf(arrays.normal[t][c] - 0.5f * n[c]) < 1e-6f);
        }
        assert_true(fabsf(arrays.area[t] / body->texel_area[t] - 4.0f) < 1e-4f);
    }
    arrays.instance = 2;
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_E_ARGUMENT);
    parian_free(env, arrays.position);
    parian_free(env, arrays.normal);
    parian_free(env, arrays.area);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

static void expect_refused(parian_renderer *renderer, const parian_instance *bad)
{
    parian_instance pair[2] = {{{0}}, *bad};
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_E_ARGUMENT);
    assert_int_equal(renderer->instance_count, 1);
}

static void test_refusals(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    parian_renderer *renderer = make(env, scene, false);
    const float axis[3] = {1, 1, 1};
    const parian_instance good = place(axis, 1, 2, 3, 4, 5);
    static const struct {
        int index;
        float value;
    } faults[] = {{0, NAN},   {13, INFINITY}, {3, 0.1f}, {15, 2.0f},
                  {15, 0.0f}, {12, 2e9f},     {4, 9.0f}};
    for (size_t f = 0; f < sizeof faults / sizeof *faults; f++) {
        parian_instance bad = good;
        bad.transform[faults[f].index] = faults[f].value;
        expect_refused(renderer, &bad);
    }
    const float columns[4][3] = {{-1, 1, 1}, {1, 1, 1.01f}, {0, 0, 0}, {1e7f, 1e7f, 1e7f}};
    for (int f = 0; f < 4; f++) { /* mirrored, uneven, flat, vast */
        parian_instance bad = good;
        for (int k = 0; k < 12; k++) {
            bad.transform[k] *= columns[f][k / 4];
        }
        expect_refused(renderer, &bad);
    }
    parian_instance shear = {{1, 0, 0, 0, 0.01f, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    expect_refused(renderer, &shear);
    assert_int_equal(parian_renderer_set_instances(renderer, &good, PARIAN_INSTANCE_MAX + 1),
                     PARIAN_E_LIMIT);
    assert_int_equal(parian_renderer_set_instances(renderer, NULL, 1), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_renderer_set_instances(renderer, &good, 1), PARIAN_OK);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* GL memory grows with the instances, is given back, and the budget holds for them. */
static void test_gl_memory(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    const parian_instance many[8] = {{{0}}};
    parian_renderer *renderer = make(env, scene, true);
    const uint64_t one = parian_renderer_memory(renderer);
    assert_int_equal(parian_renderer_set_instances(renderer, many, 8), PARIAN_OK);
    const uint64_t each = (parian_renderer_memory(renderer) - one) / 7;
    assert_true(each > 0 && each < one);
    assert_int_equal(parian_renderer_set_instances(renderer, many, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_memory(renderer), one);
    parian_renderer_destroy(renderer);
    parian_renderer_desc desc = {
        .get_proc_address = test_egl_address, .shadow_size = 64, .memory_budget = one + 3 * each};
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(renderer, many, 8), PARIAN_E_NOMEM);
    assert_int_equal(parian_renderer_memory(renderer), one);
    assert_int_equal(parian_renderer_set_instances(renderer, many, 3), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* Allocations fail in turn: the old instances stay, with their light. */
static void expect_failing(const parian_scene *scene, bool gl)
{
    const parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, 0, 0}, .color = {1, 1, 1}};
    const parian_instance many[3] = {{{0}}};
    bool done = false;
    for (size_t k = 0; !done; k++) {
        test_memory memory = {.fail_at = SIZE_MAX};
        parian_env env = test_failing_env(&memory);
        parian_renderer *renderer = make(&env, scene, gl);
        assert_int_equal(parian_renderer_set_lights(renderer, &light, 1), PARIAN_OK);
        double before = sum_of(test_env(0), renderer, 0);
        memory.fail_at = memory.calls + k;
        parian_result result = parian_renderer_set_instances(renderer, many, 3);
        memory.fail_at = SIZE_MAX;
        done = result == PARIAN_OK;
        assert_true(done || result == PARIAN_E_NOMEM);
        assert_int_equal(renderer->instance_count, done ? 3 : 1);
        assert_true(sum_of(test_env(0), renderer, 0) == before);
        parian_renderer_destroy(renderer);
        assert_int_equal(memory.live, 0);
        assert_true(k < 100 && (!done || k > 2));
    }
}

static void test_failing_memory(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, 0.02f, 2, 2);
    expect_failing(scene, false);
    expect_failing(scene, true);
    parian_scene_close(scene);
    (void)state;
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_c),      cmocka_unit_test(test_turned_with_its_light),
        cmocka_unit_test(test_scaled),         cmocka_unit_test(test_shadows),
        cmocka_unit_test(test_gl_memory),      cmocka_unit_test(test_failing_memory),
        cmocka_unit_test(test_surface_arrays), cmocka_unit_test(test_refusals),
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
