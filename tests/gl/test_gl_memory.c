/* test_gl_memory.c - GL memory before and after upload, budgets, uploads in slices, pictures of all
 * sizes, and frames without end.
 *
 * Estimates are exact here, since they and the renderer describe the same textures; a driver may
 * round up what it keeps.
 *
 * SPDX-License-Identifier: MIT
 */
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "gl/fault_gl.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

enum { WIDTH = 120, HEIGHT = 90, GL_SECONDS = 3, GL_RELIGHTS_MIN = 200 };
#ifdef __SANITIZE_ADDRESS__
enum { CPU_RELIGHTS = 500 };
#else
enum { CPU_RELIGHTS = 10000 };
#endif

static const parian_light sun = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}};

/* A log that keeps the last line of at least warnings. */
typedef struct kept_log {
    char line[512];
    int count;
} kept_log;

static void keep_line(void *user, parian_log_level level, const char *text)
{
    kept_log *log = user;
    if (level <= PARIAN_LOG_WARNING) {
        snprintf(log->line, sizeof log->line, "%s", text);
        log->count++;
    }
}

static parian_scene *tiny_scene(const parian_env *env)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

/* A ball of 492 vertices. */
static parian_scene *ball_scene(const parian_env *env)
{
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 2,
                          .form = PARIAN_LOCAL_F16,
                          .kernel_width = 3,
                          .smooth_sphere = true,
                          .transport = true};
    assert_int_equal(test_sphere(env, 0.01, 7, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    return lit_scene(env, &mesh, &desc);
}

static parian_draw_desc view_of(uint32_t width, uint32_t height)
{
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    return (parian_draw_desc){.camera = lit_camera(eye, width, height),
                              .width = width,
                              .height = height,
                              .exposure_auto = true,
                              .framebuffer = UINT32_MAX};
}

static parian_renderer *make(const parian_env *env, const parian_scene *scene,
                             const parian_renderer_desc *desc)
{
    parian_renderer *renderer = NULL;
    assert_int_equal(parian_renderer_create(env, scene, desc, &renderer), PARIAN_OK);
    return renderer;
}

/* ---- estimate ---- */

static void test_estimate(void **state)
{
    enum { SIDE = 24 };
    static float pixel[SIDE * SIDE][3];
    const parian_light lights[2] = {sun,
                                    {.type = PARIAN_LIGHT_SPOT,
                                     .position = {0, 0.02f, 0.09f},
                                     .direction = {0, -0.2f, -1},
                                     .color = {1, 1, 1},
                                     .inner_deg = 12,
                                     .outer_deg = 20,
                                     .image = {SIDE, SIDE, (const float(*)[3])pixel}}};
    const parian_env *env = test_env(0);
    parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 512};
    parian_memory_desc frame = {lights, 2, 1, WIDTH, HEIGHT, false};
    parian_draw_desc draw = view_of(WIDTH, HEIGHT);
    parian_scene *scenes[2] = {tiny_scene(env), ball_scene(env)};
    for (int s = 0; s < 2; s++) {
        parian_memory before, after;
        assert_int_equal(parian_renderer_estimate_memory(env, scenes[s], &desc, &frame, &before),
                         PARIAN_OK);
        parian_renderer *renderer = make(env, scenes[s], &desc);
        assert_int_equal(parian_renderer_set_lights(renderer, lights, 2), PARIAN_OK);
        assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
        after = parian_renderer_get_memory(renderer);
        for (int p = 0; p < PARIAN_MEMORY_PART_COUNT; p++) {
            assert_int_equal(before.bytes[p], after.bytes[p]);
            assert_true(after.bytes[p] > 0);
        }
        assert_int_equal(before.total, after.total);
        assert_int_equal(after.total, parian_renderer_memory(renderer));
        parian_renderer_destroy(renderer);
        desc.backend = PARIAN_BACKEND_CPU;
        assert_int_equal(parian_renderer_estimate_memory(env, scenes[s], &desc, &frame, &before),
                         PARIAN_OK);
        assert_int_equal(before.total, 0);
        desc.backend = PARIAN_BACKEND_GL;
        parian_scene_close(scenes[s]);
    }
    (void)state;
}

/* ---- budget ---- */

static void test_budget(void **state)
{
    kept_log log = {.count = 0};
    const parian_env env = {.log = keep_line, .user = &log};
    parian_scene *scene = ball_scene(&env);
    parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 1024};
    parian_memory_desc frame = {&sun, 1, 1, WIDTH, HEIGHT, false};
    parian_memory wanted, shrunk, used;
    parian_renderer *renderer = NULL;
    parian_draw_desc draw = view_of(WIDTH, HEIGHT), large = view_of(4 * WIDTH, 4 * HEIGHT),
                     huge = view_of(2000, 2000);
    assert_int_equal(parian_renderer_estimate_memory(&env, scene, &desc, &frame, &wanted),
                     PARIAN_OK);

    /* The scene does not fit: refused before any upload, in one line. */
    desc.memory_budget = wanted.bytes[PARIAN_MEMORY_ATLAS];
    assert_int_equal(parian_renderer_create(&env, scene, &desc, &renderer), PARIAN_E_NOMEM);
    assert_int_equal(log.count, 1);
    assert_non_null(strstr(log.line, "the budget is"));

    /* What is needed exactly: nothing is smaller. */
    desc.memory_budget = wanted.total;
    renderer = make(&env, scene, &desc);
    assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(log.count, 1);
    assert_int_equal(parian_renderer_memory(renderer), wanted.total);
    parian_renderer_destroy(renderer);

    /* Half a shadow map less: a smaller one is taken and said, as estimated. */
    desc.memory_budget = wanted.total - wanted.bytes[PARIAN_MEMORY_SHADOWS] / 2;
    assert_int_equal(parian_renderer_estimate_memory(&env, scene, &desc, &frame, &shrunk),
                     PARIAN_OK);
    renderer = make(&env, scene, &desc);
    assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_non_null(strstr(log.line, "shadow maps of 512 texels"));
    used = parian_renderer_get_memory(renderer);
    assert_int_equal(used.bytes[PARIAN_MEMORY_SHADOWS], wanted.bytes[PARIAN_MEMORY_SHADOWS] / 4);
    assert_int_equal(used.total, shrunk.total);

    /* A larger picture takes from the shadow maps and relights; one too large is refused, and what
     * was drawn can still be read and drawn again. */
    parian_pass_time times[PARIAN_PASS_MAX];
    parian_renderer_destroy(renderer);
    frame.width = large.width;
    frame.height = large.height;
    desc.memory_budget = 0;
    assert_int_equal(parian_renderer_estimate_memory(&env, scene, &desc, &frame, &wanted),
                     PARIAN_OK);
    desc.memory_budget = wanted.total - wanted.bytes[PARIAN_MEMORY_SHADOWS] / 2;
    renderer = make(&env, scene, &desc);
    assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &large), PARIAN_OK);
    parian_renderer_get_times(renderer, times);
    assert_int_equal(times[PARIAN_PASS_SHADOW].runs, 2);
    assert_true(parian_renderer_memory(renderer) <= desc.memory_budget);
    log.count = 0;
    assert_int_equal(parian_renderer_draw(renderer, &huge), PARIAN_E_NOMEM);
    assert_int_equal(log.count, 1);
    assert_non_null(strstr(log.line, "draw smaller"));
    uint8_t(*srgb)[4] = calloc(4 * WIDTH * 4 * HEIGHT, sizeof *srgb);
    assert_int_equal(parian_renderer_read_picture(renderer, NULL, srgb), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &large), PARIAN_OK);
    free(srgb);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* ---- slices ---- */

static void picture_of(parian_renderer *renderer, uint8_t (*srgb)[4])
{
    parian_draw_desc draw = view_of(WIDTH, HEIGHT);
    assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(renderer, NULL, srgb), PARIAN_OK);
}

static void test_slices(void **state)
{
    static uint8_t whole[WIDTH * HEIGHT][4], sliced[WIDTH * HEIGHT][4];
    const parian_env *env = test_env(0);
    parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 512};
    parian_draw_desc draw = view_of(WIDTH, HEIGHT);
    for (int s = 0; s < 2; s++) {
        parian_scene *scene = s ? ball_scene(env) : tiny_scene(env);
        desc.deferred_upload = false;
        parian_renderer *renderer = make(env, scene, &desc);
        uint64_t left = 0, slices = 0, total;
        picture_of(renderer, whole);
        parian_renderer_destroy(renderer);

        desc.deferred_upload = true;
        renderer = make(env, scene, &desc);
        total = renderer->upload_left;
        assert_true(total > 0);
        assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
        do {
            uint64_t before = renderer->upload_left;
            assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_E_ARGUMENT);
            assert_int_equal(parian_renderer_relight(renderer), PARIAN_E_ARGUMENT);
            assert_int_equal(parian_renderer_upload(renderer, 50000, &left), PARIAN_OK);
            assert_true(left <= before);
            assert_true(before - left <= 50000 + 262144);
            slices++;
        } while (left > 0);
        assert_true(slices > total / (50000 + 262144));
        assert_int_equal(parian_renderer_upload(renderer, 0, &left), PARIAN_OK);
        picture_of(renderer, sliced);
        assert_memory_equal(whole, sliced, sizeof whole);
        parian_renderer_destroy(renderer);

        renderer = make(env, scene, &desc); /* given up half way */
        assert_int_equal(parian_renderer_upload(renderer, total / 2, NULL), PARIAN_OK);
        parian_renderer_destroy(renderer);
        parian_scene_close(scene);
    }
    (void)state;
}

/* ---- sizes ---- */

static void test_sizes(void **state)
{
    static const uint32_t size[][2] = {{1, 1},   {640, 480}, {8192, 1}, {1, 8192},
                                       {333, 7}, {257, 129}, {64, 64},  {1, 1}};
    const parian_env *env = test_env(0);
    parian_scene *scene = ball_scene(env);
    parian_renderer_desc desc = {.get_proc_address = fault_address, .shadow_size = 256};
    parian_renderer *renderer = make(env, scene, &desc);
    parian_draw_desc none = view_of(1, 1), beyond = view_of(16385, 1);
    assert_int_equal(parian_renderer_set_lights(renderer, &sun, 1), PARIAN_OK);
    for (size_t i = 0; i < sizeof size / sizeof *size; i++) {
        const uint32_t width = size[i][0], height = size[i][1];
        parian_draw_desc draw = view_of(width, height);
        parian_memory_desc frame = {&sun, 1, 1, width, height, false};
        parian_memory expected;
        uint8_t(*srgb)[4] = calloc((size_t)width * height, sizeof *srgb);
        assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
        assert_int_equal(parian_renderer_read_picture(renderer, NULL, srgb), PARIAN_OK);
        assert_int_equal(parian_renderer_estimate_memory(env, scene, &desc, &frame, &expected),
                         PARIAN_OK);
        /* Nothing is kept of a larger picture. */
        assert_int_equal(parian_renderer_memory(renderer), expected.total);
        free(srgb);
    }
    none.width = 0;
    assert_int_equal(parian_renderer_draw(renderer, &none), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_renderer_draw(renderer, &beyond), PARIAN_E_ARGUMENT);
    parian_renderer_destroy(renderer);
    assert_int_equal(fault.live, 0);
    parian_scene_close(scene);
    (void)state;
}

/* ---- frames without end ---- */

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* A frame with another light, and a picture of it now and then. */
static void run_frame(parian_renderer *renderer, uint32_t i, bool draw)
{
    parian_light light = sun;
    parian_draw_desc desc = view_of(32, 24);
    light.direction[0] = 0.001f * (float)(i % 997);
    assert_int_equal(parian_renderer_set_lights(renderer, &light, 1), PARIAN_OK);
    assert_int_equal(draw ? parian_renderer_draw(renderer, &desc)
                          : parian_renderer_relight(renderer),
                     PARIAN_OK);
}

/* The first refinement takes what is estimated, later ones nothing. */
static void refine(const parian_env *env, parian_renderer *renderer, test_memory *memory)
{
    parian_light light = sun; /* as run_frame has it, whatever its direction */
    parian_memory_desc frame = {&light, 1, 1, 32, 24, true};
    parian_memory wanted, used;
    assert_int_equal(parian_renderer_refine(renderer), PARIAN_OK);
    assert_int_equal(
        parian_renderer_estimate_memory(env, renderer->scene, &renderer->desc, &frame, &wanted),
        PARIAN_OK);
    used = parian_renderer_get_memory(renderer);
    assert_memory_equal(&wanted, &used, sizeof used);
    const size_t calls = memory->calls, live = memory->live;
    const uint64_t made = fault.made, storage = fault.storage;
    const uint32_t sets = parian_renderer_set_count(renderer);
    for (uint32_t k = 1; k <= 8; k++) {
        assert_int_equal(parian_renderer_refine(renderer), PARIAN_OK);
        assert_int_equal(parian_renderer_set_count(renderer), sets + k);
    }
    assert_int_equal(memory->calls, calls);
    assert_int_equal(memory->live, live);
    assert_int_equal(fault.made, made);
    assert_int_equal(fault.storage, storage);
}

/* Relight over and over: no memory asked for, no GL object made, nothing grows. */
static void run_frames(parian_backend backend, uint32_t frames, double seconds)
{
    test_memory memory = {.fail_at = SIZE_MAX};
    parian_env env = test_failing_env(&memory);
    parian_scene *scene = ball_scene(&env);
    parian_renderer_desc desc = {
        .backend = backend, .get_proc_address = fault_address, .shadow_size = 64};
    parian_renderer *renderer = make(&env, scene, &desc);
    uint32_t i = 0;
    for (; i < 20; i++) {
        run_frame(renderer, i, true);
    }
    const size_t calls = memory.calls, live = memory.live, heap = mallinfo2().uordblks;
    const uint64_t made = fault.made, storage = fault.storage;
    const parian_memory used = parian_renderer_get_memory(renderer);
    double start = seconds_now();
    for (; i < frames && (seconds_now() - start < seconds || i < GL_RELIGHTS_MIN); i++) {
        run_frame(renderer, i, i % 64 == 0);
    }
    print_message("%s: %u relights in %.1f s\n", parian_renderer_name(renderer), i,
                  seconds_now() - start);
    assert_int_equal(memory.calls, calls);
    assert_int_equal(memory.live, live);
    assert_int_equal(fault.made, made);
    assert_int_equal(fault.storage, storage);
    assert_int_equal(parian_renderer_memory(renderer), used.total);
    /* The driver keeps caches of its own: 1 MB is far less than a byte each would add up to. */
    assert_true(mallinfo2().uordblks < heap + (backend == PARIAN_BACKEND_CPU ? 4096 : 1 << 20));
    refine(&env, renderer, &memory);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    assert_int_equal(memory.live, 0);
    assert_int_equal(fault.live, 0);
}

static void test_gl_frames(void **state)
{
    const char *frames = getenv("PARIAN_TEST_RELIGHTS");
    fault_reset();
    run_frames(PARIAN_BACKEND_GL, frames ? (uint32_t)atoi(frames) : 10000,
               frames ? 1e9 : GL_SECONDS);
    (void)state;
}

static void test_cpu_frames(void **state)
{
    run_frames(PARIAN_BACKEND_CPU, CPU_RELIGHTS, 1e9);
    (void)state;
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_estimate),  cmocka_unit_test(test_budget),
        cmocka_unit_test(test_slices),    cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_gl_frames),
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cpu_frames)};
    int cpu = cmocka_run_group_tests_name("C evaluation", tests, NULL, NULL);
    int core = run_flavour(false), es = run_flavour(true);
    if (core < 0 && es < 0 && cpu == 0) {
        return 77; /* no EGL without a surface here */
    }
    return cpu + (core > 0 ? core : 0) + (es > 0 ? es : 0);
}
