/* test_gl_contexts.c - several scenes in one context, one scene in several contexts and threads:
 * what each renderer yields is what it yields alone, byte for byte on the same GL.
 *
 * SPDX-License-Identifier: MIT
 */
#include <pthread.h>

#include "gl/egl_context.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"
#include "support/tiny_body.h"

enum { SIDE = 40, TEXELS_MAX = 8192, STEPS = 3 };

static const parian_light lights[STEPS] = {
    {.type = PARIAN_LIGHT_POINT, .position = {0.01f, 0.03f, 0.06f}, .color = {.01f, .02f, .01f}},
    {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {0.3f, 0.4f, 0.5f}},
    {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-.4f, -.2f, -1}, .color = {3, 2, 1}}};

/* What a renderer yields in each step of its life. */
typedef struct outcome {
    float radiosity[STEPS][TEXELS_MAX][3];
    float radiance[STEPS][SIDE * SIDE][4];
    uint8_t srgb[STEPS][SIDE * SIDE][4];
} outcome;

typedef struct life {
    const test_egl *egl; /* made current before each step; NULL: it is */
    const parian_scene *scene;
    parian_renderer *renderer;
    outcome *out;
} life;

static void use(const life *one)
{
    assert_true(!one->egl || test_egl_use(one->egl));
}

static void begin(life *one)
{
    const parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 256};
    use(one);
    assert_true(one->scene->info.texel_count <= TEXELS_MAX);
    assert_int_equal(parian_renderer_create(NULL, one->scene, &desc, &one->renderer), PARIAN_OK);
}

static void step_light(life *one, int step)
{
    const parian_instance pair[2] = {
        {{0}}, {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.01f, 0.01f, -0.02f, 1}}};
    parian_texel_arrays arrays = {.radiosity = one->out->radiosity[step]};
    use(one);
    assert_int_equal(parian_renderer_set_lights(one->renderer, &lights[step], 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_instances(one->renderer, pair, step == 1 ? 2 : 1),
                     PARIAN_OK);
    assert_int_equal(parian_renderer_read_texels(one->renderer, &arrays), PARIAN_OK);
}

static void step_picture(life *one, int step)
{
    const float eye[3] = {0.05f, 0.06f, 0.12f};
    const parian_draw_desc draw = {.camera = lit_camera(eye, SIDE, SIDE),
                                   .width = SIDE,
                                   .height = SIDE,
                                   .exposure_auto = true,
                                   .framebuffer = UINT32_MAX};
    use(one);
    assert_int_equal(parian_renderer_draw(one->renderer, &draw), PARIAN_OK);
    assert_int_equal(
        parian_renderer_read_picture(one->renderer, one->out->radiance[step], one->out->srgb[step]),
        PARIAN_OK);
}

static void end(life *one)
{
    use(one);
    parian_renderer_destroy(one->renderer);
}

static void live_alone(life *one)
{
    begin(one);
    for (int s = 0; s < STEPS; s++) {
        step_light(one, s);
        step_picture(one, s);
    }
    end(one);
}

/* Steps of all in turn. */
static void live_together(life *all, int count)
{
    for (int i = 0; i < count; i++) {
        begin(&all[i]);
    }
    for (int s = 0; s < STEPS; s++) {
        for (int i = 0; i < count; i++) {
            step_light(&all[i], s);
        }
        for (int i = count - 1; i >= 0; i--) {
            step_picture(&all[i], s);
        }
    }
    for (int i = 0; i < count; i++) {
        end(&all[i]);
    }
}

static void expect_equal(const outcome *a, const outcome *b)
{
    assert_memory_equal(a->radiosity, b->radiosity, sizeof a->radiosity);
    assert_memory_equal(a->radiance, b->radiance, sizeof a->radiance);
    assert_memory_equal(a->srgb, b->srgb, sizeof a->srgb);
    for (int s = 0; s < STEPS; s++) { /* not all black, and not all the same */
        assert_memory_not_equal(a->radiance[s], a->radiance[(s + 1) % STEPS],
                                sizeof a->radiance[s]);
    }
}

static parian_scene *tiny_scene(void)
{
    parian_scene_data data = {0};
    parian_scene *scene = NULL;
    assert_int_equal(test_tiny_scene(test_env(0), PARIAN_LOCAL_F16, 24, &data), PARIAN_OK);
    assert_int_equal(parian_scene_adopt(test_env(0), &data, &scene), PARIAN_OK);
    return scene;
}

static void test_two_scenes(void **state)
{
    static outcome alone[2], together[2];
    parian_scene *scenes[2] = {tiny_scene(), lit_sphere(test_env(0), 0.02f, 4, 3)};
    life all[2] = {{.scene = scenes[0]}, {.scene = scenes[1]}};
    for (int i = 0; i < 2; i++) {
        all[i].out = &alone[i];
        live_alone(&all[i]);
        all[i].out = &together[i];
    }
    live_together(all, 2);
    expect_equal(&alone[0], &together[0]);
    expect_equal(&alone[1], &together[1]);
    parian_scene_close(scenes[0]);
    parian_scene_close(scenes[1]);
    (void)state;
}

/* OpenGL, OpenGL ES and OpenGL again at once. */
static void test_contexts(void **state)
{
    static outcome alone[3], together[3];
    parian_scene *scene = tiny_scene();
    test_egl egl[3];
    life all[3];
    int count = 0;
    for (int i = 0; i < 3; i++) {
        if (test_egl_open(&egl[count], i == 1)) {
            all[count] = (life){.egl = &egl[count], .scene = scene, .out = &alone[count]};
            live_alone(&all[count]);
            all[count].out = &together[count];
            count++;
        }
    }
    if (count < 2) {
        skip();
    }
    live_together(all, count);
    for (int i = 0; i < count; i++) {
        expect_equal(&alone[i], &together[i]);
        test_egl_close(&egl[i]);
    }
    parian_scene_close(scene);
    (void)state;
}

/* ---- threads ---- */

typedef struct worker {
    const parian_scene *scene;
    bool es, opened;
    outcome out;
} worker;

static void *work(void *context)
{
    worker *one = context;
    test_egl egl;
    one->opened = test_egl_open(&egl, one->es);
    if (one->opened) {
        life living = {.egl = &egl, .scene = one->scene, .out = &one->out};
        live_alone(&living);
    }
    test_egl_close(&egl);
    return NULL;
}

/* A thread for each context, one scene for all. */
static void test_threads(void **state)
{
    static worker alone[2], together[2];
    parian_scene *scene = tiny_scene();
    pthread_t thread[2];
    for (int i = 0; i < 2; i++) {
        alone[i] = together[i] = (worker){.scene = scene, .es = i == 1};
        work(&alone[i]);
    }
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pthread_create(&thread[i], NULL, work, &together[i]), 0);
    }
    for (int i = 0; i < 2; i++) {
        pthread_join(thread[i], NULL);
    }
    for (int i = 0; i < 2; i++) {
        assert_true(alone[i].opened == together[i].opened);
        if (alone[i].opened) {
            expect_equal(&alone[i].out, &together[i].out);
        }
    }
    parian_scene_close(scene);
    (void)state;
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_two_scenes)};
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_contexts),
                                       cmocka_unit_test(test_threads)};
    int core = run_flavour(false), es = run_flavour(true);
    if (core < 0 && es < 0) {
        return 77; /* no EGL without a surface here */
    }
    return (core > 0 ? core : 0) + (es > 0 ? es : 0) + cmocka_run_group_tests(tests, NULL, NULL);
}
