/* test_gl_faults.c - what a renderer does when OpenGL or memory fails: an error and a line, a state
 * that still works where that is promised, and nothing left behind.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "core/body_file.h"
#include "gl/fault_gl.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

enum { WIDTH = 32, HEIGHT = 24 };

static const parian_light sun = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}};
static const parian_light lamp = {
    .type = PARIAN_LIGHT_POINT, .position = {0.01f, 0.03f, 0.06f}, .color = {0.01f, 0.02f, 0.01f}};

/* Error lines, and the last of them. */
typedef struct error_log {
    char line[512];
    int count;
} error_log;

static error_log errors;

static void keep_errors(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(errors.line, sizeof errors.line, "%s", text);
        errors.count++;
    }
}

static const parian_env logging = {.log = keep_errors};

static parian_scene *tiny_scene(const parian_env *env)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 12, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

static parian_renderer_desc small_desc(void)
{
    return (parian_renderer_desc){.get_proc_address = fault_address, .shadow_size = 64};
}

static parian_draw_desc view_of(uint32_t width, uint32_t height)
{
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    return (parian_draw_desc){.camera = lit_camera(eye, width, height),
                              .width = width,
                              .height = height,
                              .framebuffer = UINT32_MAX};
}

static parian_renderer *make(const parian_scene *scene)
{
    parian_renderer_desc desc = small_desc();
    parian_renderer *renderer = NULL;
    if (parian_renderer_create(&logging, scene, &desc, &renderer) != PARIAN_OK) {
        fail_msg("%s", errors.line);
    }
    return renderer;
}

/* Light, and draw, and read. */
static parian_result show(parian_renderer *renderer, const parian_light *light, uint8_t (*srgb)[4])
{
    parian_draw_desc draw = view_of(WIDTH, HEIGHT);
    parian_result result = parian_renderer_set_lights(renderer, light, 1);
    if (result == PARIAN_OK) {
        result = parian_renderer_draw(renderer, &draw);
    }
    return result == PARIAN_OK ? parian_renderer_read_picture(renderer, NULL, srgb) : result;
}

/* ---- creation ---- */

/* Creation fails with a result, one line or more that say why, and nothing left. */
static void refuse(const parian_scene *scene, parian_result expected, const char *reason)
{
    parian_renderer_desc desc = small_desc();
    parian_renderer *renderer = NULL;
    errors = (error_log){.count = 0};
    assert_int_equal(parian_renderer_create(&logging, scene, &desc, &renderer), expected);
    assert_null(renderer);
    assert_int_equal(errors.count, 1);
    if (!strstr(errors.line, reason)) {
        fail_msg("'%s' does not say '%s'", errors.line, reason);
    }
    fault_reset();
    assert_int_equal(fault.live, 0);
}

static void test_requirements(void **state)
{
    parian_scene *scene = tiny_scene(test_env(1));
    static const char *const functions[] = {"glTexImage3D", "glGetError", "glDrawArrays"};
    static const char *const old[] = {"3.2", "2.1 old", "OpenGL ES 2.0"};
    fault_reset();
    for (int i = 0; i < 3; i++) {
        fault.missing = functions[i];
        refuse(scene, PARIAN_E_UNSUPPORTED, functions[i]);
        fault.version = old[i];
        refuse(scene, PARIAN_E_UNSUPPORTED, "expected OpenGL 3.3 or OpenGL ES 3.0");
    }
    fault.version = "OpenGL ES 3.0";
    fault.no_extensions = true;
    refuse(scene, PARIAN_E_UNSUPPORTED, "GL_EXT_color_buffer_float is missing");
    fault.no_compile = true;
    refuse(scene, PARIAN_E_DEVICE, "does not compile");
    fault.no_link = true;
    refuse(scene, PARIAN_E_DEVICE, "does not link");
    fault.lost = true;
    refuse(scene, PARIAN_E_DEVICE, "context was lost");
    parian_scene_close(scene);
    (void)state;
}

/* ---- no memory in OpenGL ---- */

/* Each call for storage fails in turn, in creation and in the first frame. What failed in a frame
 * works when it is tried again. */
static void test_out_of_memory(void **state)
{
    static uint8_t good[WIDTH * HEIGHT][4], again[WIDTH * HEIGHT][4];
    parian_scene *scene = tiny_scene(test_env(1));
    fault_reset();
    parian_renderer *renderer = make(scene);
    const uint64_t uploads = fault.storage;
    assert_int_equal(show(renderer, &sun, good), PARIAN_OK);
    const uint64_t total = fault.storage;
    parian_renderer_destroy(renderer);
    assert_int_equal(fault.live, 0);
    assert_true(uploads > 20 && total > uploads + 5);
    for (uint64_t k = 1; k <= uploads; k++) {
        fault_reset();
        fault.storage_fails_at = k;
        refuse(scene, PARIAN_E_NOMEM, "OpenGL has no memory");
    }
    for (uint64_t k = uploads + 1; k <= total; k++) {
        fault_reset();
        fault.storage_fails_at = k;
        renderer = make(scene);
        errors.count = 0;
        assert_int_equal(show(renderer, &sun, again), PARIAN_E_NOMEM);
        assert_int_equal(errors.count, 1);
        assert_int_equal(show(renderer, &sun, again), PARIAN_OK);
        assert_memory_equal(good, again, sizeof good);
        parian_renderer_destroy(renderer);
        assert_int_equal(fault.live, 0);
    }
    parian_scene_close(scene);
    (void)state;
}

/* Upload in slices with the k-th call for storage failing (0: none); how many there were. */
static uint64_t upload_slices(parian_renderer *renderer, uint64_t k, int *failures)
{
    const uint64_t before = fault.storage;
    uint64_t left = 1;
    *failures = 0;
    fault.storage_fails_at = k ? before + k : 0;
    while (left > 0) {
        parian_result result = parian_renderer_upload(renderer, 20000, &left);
        assert_true(result == PARIAN_OK || result == PARIAN_E_NOMEM);
        *failures += result != PARIAN_OK;
    }
    return fault.storage - before;
}

/* A slice that failed is tried again by the next. */
static void test_failing_slices(void **state)
{
    static uint8_t good[WIDTH * HEIGHT][4], again[WIDTH * HEIGHT][4];
    parian_scene *scene = tiny_scene(test_env(1));
    parian_renderer_desc desc = small_desc();
    uint64_t uploads = 1;
    desc.deferred_upload = true;
    for (uint64_t k = 0; k <= uploads; k += k ? 7 : 1) {
        parian_renderer *renderer = NULL;
        int failures;
        fault_reset();
        assert_int_equal(parian_renderer_create(&logging, scene, &desc, &renderer), PARIAN_OK);
        uint64_t calls = upload_slices(renderer, k, &failures);
        uploads = k ? uploads : calls;
        assert_int_equal(failures, k ? 1 : 0);
        assert_int_equal(show(renderer, &sun, k ? again : good), PARIAN_OK);
        parian_renderer_destroy(renderer);
        assert_int_equal(fault.live, 0);
        assert_true(k == 0 || memcmp(good, again, sizeof good) == 0);
    }
    assert_true(uploads > 20);
    parian_scene_close(scene);
    (void)state;
}

/* ---- framebuffers, lost contexts ---- */

static void test_incomplete(void **state)
{
    static uint8_t good[WIDTH * HEIGHT][4], again[WIDTH * HEIGHT][4];
    parian_scene *scene = tiny_scene(test_env(1));
    parian_draw_desc other = view_of(HEIGHT, WIDTH);
    fault_reset();
    parian_renderer *renderer = make(scene);
    assert_int_equal(show(renderer, &sun, good), PARIAN_OK);
    fault.incomplete = true;
    errors.count = 0;
    assert_int_equal(show(renderer, &lamp, again), PARIAN_E_DEVICE); /* shadow maps */
    assert_int_equal(errors.count, 1);
    fault.incomplete = false;
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    fault.incomplete = true;
    assert_int_equal(parian_renderer_draw(renderer, &other), PARIAN_E_DEVICE); /* picture */
    assert_int_equal(errors.count, 2);
    fault.incomplete = false;
    assert_int_equal(show(renderer, &sun, again), PARIAN_OK);
    assert_memory_equal(good, again, sizeof good);
    parian_renderer_destroy(renderer);
    assert_int_equal(fault.live, 0);
    parian_scene_close(scene);
    (void)state;
}

static void test_lost(void **state)
{
    static uint8_t picture[WIDTH * HEIGHT][4];
    parian_scene *scene = tiny_scene(test_env(1));
    parian_texel_arrays arrays = {.instance = 0};
    fault_reset();
    parian_renderer *renderer = make(scene);
    if (renderer->backend == &parian_gl_backend) {
        assert_int_equal(show(renderer, &sun, picture), PARIAN_OK);
        fault.lost = true;
        errors.count = 0;
        assert_int_equal(show(renderer, &lamp, picture), PARIAN_E_DEVICE);
        assert_int_equal(errors.count, 1);
        assert_non_null(strstr(errors.line, "context was lost"));
        fault.lost = false; /* reported once by some drivers; it stays lost */
        arrays.irradiance = parian_zalloc(NULL, scene->info.texel_count, sizeof *arrays.irradiance);
        assert_int_equal(show(renderer, &sun, picture), PARIAN_E_DEVICE);
        assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_E_DEVICE);
        parian_free(NULL, arrays.irradiance);
    }
    parian_renderer_destroy(renderer);
    assert_int_equal(fault.live, 0);
    renderer = make(scene); /* another one works */
    assert_int_equal(show(renderer, &sun, picture), PARIAN_OK);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* ---- no memory for us ---- */

/* From opening a file to reading results. */
static parian_result run_all(const parian_env *env, parian_backend backend, const char *path)
{
    static uint8_t picture[WIDTH * HEIGHT][4];
    static float radiosity[4096][3];
    parian_texel_arrays arrays = {.radiosity = radiosity};
    parian_renderer_desc desc = small_desc();
    parian_scene *scene = NULL;
    parian_renderer *renderer = NULL;
    desc.backend = backend;
    parian_result result = parian_scene_open(env, path, &scene);
    if (result == PARIAN_OK) {
        assert_true(scene->info.texel_count <= 4096);
        result = parian_renderer_create(env, scene, &desc, &renderer);
    }
    if (result == PARIAN_OK) {
        result = show(renderer, &sun, picture);
    }
    if (result == PARIAN_OK) {
        result = parian_renderer_read_texels(renderer, &arrays);
    }
    if (renderer && result != PARIAN_OK) { /* there is memory again */
        assert_int_equal(show(renderer, &lamp, picture), PARIAN_OK);
    }
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    return result;
}

/* Each allocation fails in turn: always PARIAN_E_NOMEM, nothing left, and a renderer that exists
 * works once there is memory. */
static void fail_each(parian_backend backend, const char *path)
{
    parian_result result = PARIAN_E_NOMEM;
    size_t k = 0;
    for (; result != PARIAN_OK; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        result = run_all(&env, backend, path);
        assert_int_equal(memory.live, 0);
        assert_int_equal(fault.live, 0);
        assert_true(result == PARIAN_OK || result == PARIAN_E_NOMEM);
    }
    print_message("%zu allocations\n", k - 1);
    assert_true(k > 60);
}

static void test_allocations(void **state)
{
    const parian_env *env = test_env(1);
    const char *path = test_scratch("faults.parian");
    parian_scene_data data = {0};
    parian_writer_desc desc = {.path = path};
    parian_writer *writer = NULL;
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_F16, 12, &data), PARIAN_OK);
    assert_int_equal(parian_writer_begin(env, &desc, &writer), PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, &data), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    parian_scene_data_free(env, &data);
    fault_reset();
    fail_each(PARIAN_BACKEND_GL, path);
    fail_each(PARIAN_BACKEND_CPU, path);
    (void)state;
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_requirements),   cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_failing_slices), cmocka_unit_test(test_incomplete),
        cmocka_unit_test(test_lost),           cmocka_unit_test(test_allocations),
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
