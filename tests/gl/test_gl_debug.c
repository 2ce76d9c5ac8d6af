/* test_gl_debug.c - every pass in a debug context: the GL may not report an error, nor anything
 * that it calls undefined.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "gl/egl_context.h"
#include "runtime/gl/gl_api.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

typedef struct reports {
    int count;
    char first[256];
} reports;

static void APIENTRY receive(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                             const GLchar *message, const void *user)
{
    reports *found = (reports *)user;
    if (type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR ||
        severity == GL_DEBUG_SEVERITY_HIGH) {
        if (found->count++ == 0) {
            snprintf(found->first, sizeof found->first, "%.*s", (int)length, message);
        }
    }
    (void)source;
    (void)id;
}

/* False where this context cannot report. */
static bool listen(const parian_gl_api *gl, bool es, reports *found)
{
    PFNGLDEBUGMESSAGECALLBACKPROC set = NULL;
    void *address = test_egl_address(es ? "glDebugMessageCallbackKHR" : "glDebugMessageCallback");
    memcpy(&set, &address, sizeof address);
    if (!set) {
        return false;
    }
    set(receive, found);
    gl->Enable(GL_DEBUG_OUTPUT);
    gl->Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    gl->Enable(0xFFFF); /* a mistake must be heard, or silence says nothing */
    bool heard = found->count > 0;
    while (gl->GetError() != GL_NO_ERROR) {
    }
    *found = (reports){0};
    return heard;
}

static parian_scene *tiny_scene(const parian_env *env, parian_local_form form)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(env, form, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

static void expect_silence(const reports *found)
{
    if (found->count > 0) {
        fail_msg("%d reports, the first: %s", found->count, found->first);
    }
}

static void light_and_read(const parian_env *env, parian_renderer *renderer)
{
    enum { SIDE = 8 };
    static const float pixel[SIDE * SIDE][3] = {{1, 2, 3}, {0.5f, 0.5f, 0.5f}};
    const parian_light lights[] = {
        {.type = PARIAN_LIGHT_POINT, .position = {0.06f, 0.05f, 0.03f}, .color = {1, 2, 3}},
        {.type = PARIAN_LIGHT_POINT, .position = {0.01f, 0.01f, 0.0f}, .color = {1, 2, 3}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-.4f, -.2f, -1}, .color = {3, 2, 1}},
        {.type = PARIAN_LIGHT_SPOT,
         .position = {0, 0.02f, 0.09f},
         .direction = {0, -0.2f, -1},
         .color = {1, 1, 1},
         .inner_deg = 12,
         .outer_deg = 20,
         .image = {SIDE, SIDE, pixel}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 0, 0.07f},
         .axis_u = {0, 0.01f, 0},
         .axis_v = {0.01f, 0, 0},
         .color = {5, 5, 5}},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 2, 1}, .image = {SIDE, SIDE, pixel}}};
    const size_t count = (size_t)renderer->scene->info.texel_count;
    parian_texel_arrays arrays = {.radiosity = parian_zalloc(env, count, sizeof(float[3]))};
    assert_non_null(arrays.radiosity);
    for (size_t i = 0; i <= 6; i++) { /* each, none, all */
        const size_t first = i < 6 ? i : 0, many = i < 6 ? 1 : 6;
        assert_int_equal(parian_renderer_set_lights(renderer, lights + first, many), PARIAN_OK);
        assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    }
    assert_int_equal(parian_renderer_set_lights(renderer, NULL, 0), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(renderer, lights, 6), PARIAN_OK);
    assert_int_equal(parian_renderer_set_values(renderer, (const float(*)[3])arrays.radiosity),
                     PARIAN_OK);
    parian_free(env, arrays.radiosity);
}

static void draw_views(const parian_env *env, parian_renderer *renderer, const reports *found)
{
    static const uint32_t sizes[][2] = {{32, 24}, {1, 1}, {60, 7}, {32, 24}};
    static float radiance[32 * 24][4];
    static uint8_t srgb[32 * 24][4];
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    for (int view = 0; view <= PARIAN_VIEW_VALUES; view++) {
        parian_settings settings = {.view = (parian_view_mode)view, .no_albedo = view % 2};
        assert_int_equal(parian_renderer_set_settings(renderer, &settings), PARIAN_OK);
        for (int s = 0; s < 4; s++) {
            const parian_draw_desc draw = {.camera = lit_camera(eye, sizes[s][0], sizes[s][1]),
                                           .width = sizes[s][0],
                                           .height = sizes[s][1],
                                           .exposure_auto = s % 2 == 0,
                                           .framebuffer = UINT32_MAX};
            assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
        }
        assert_int_equal(parian_renderer_read_picture(renderer, radiance, srgb), PARIAN_OK);
        expect_silence(found);
    }
    (void)env;
}

static void run_scene(const parian_env *env, const parian_scene *scene, const reports *found)
{
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 128};
    const parian_instance pair[2] = {
        {{0}}, {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.01f, 0.01f, -0.02f, 1}}};
    parian_renderer *renderer = NULL;
    parian_gl_textures textures;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    parian_renderer_set_timing(renderer, true);
    light_and_read(env, renderer);
    expect_silence(found);
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 2), PARIAN_OK);
    draw_views(env, renderer, found);
    assert_int_equal(parian_renderer_get_gl_textures(renderer, 1, 0, &textures), PARIAN_OK);
    parian_renderer_invalidate(renderer);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(renderer, pair, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    parian_renderer_destroy(renderer);
    expect_silence(found);
}

typedef struct debugged {
    bool es;
    reports found;
} debugged;

static void test_silence(void **state)
{
    debugged *context = *state;
    const parian_env *env = test_env(0);
    parian_gl_api gl;
    assert_int_equal(parian_gl_api_load(NULL, test_egl_address, &gl), PARIAN_OK);
    if (!listen(&gl, context->es, &context->found)) {
        print_message("this context reports nothing\n");
        skip();
    }
    static const parian_local_form forms[] = {PARIAN_LOCAL_F16, PARIAN_LOCAL_ONLY};
    for (size_t f = 0; f < sizeof forms / sizeof *forms; f++) {
        parian_scene *scene = tiny_scene(env, forms[f]);
        run_scene(env, scene, &context->found);
        parian_scene_close(scene);
    }
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

static int run_flavour(bool es)
{
    debugged context = {.es = es};
    const struct CMUnitTest tests[] = {cmocka_unit_test_prestate(test_silence, &context)};
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
