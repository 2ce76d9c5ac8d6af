/* test_gl_medium.c - edited media, tints and tone curves on OpenGL and OpenGL ES against the C
 * evaluation.
 *
 * Tolerance 1e-3 of the largest value: operands are the same halves, sums are in single precision
 * on both sides. Pictures: 2 of 255 in 99 % of the pixels; at silhouettes the two rasterisers
 * differ.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdlib.h>

#include "gl/egl_context.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"

enum { SIDE = 48 };

static const parian_light light = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}};
static const parian_medium_edit milk = {.change_medium = true,
                                        .sigma_s_prime = {700, 1220, 1900},
                                        .sigma_a = {1.4, 2.5, 14.2},
                                        .eta = 1.3};

typedef struct pair {
    parian_scene *scene;
    parian_renderer *gl, *cpu;
    size_t texels;
    float (*b[2])[3];
} pair;

static void open_pair(const parian_env *env, parian_local_form form, pair *p)
{
    parian_mesh mesh = {0};
    parian_renderer_desc desc = {.get_proc_address = test_egl_address, .shadow_size = 256};
    test_lit_desc lit = {
        .cut = 6, .form = form, .smooth_sphere = true, .transport = form != PARIAN_LOCAL_ONLY};
    assert_int_equal(test_sphere(env, 0.01, 7, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    p->scene = lit_scene(env, &mesh, &lit);
    p->texels = (size_t)p->scene->info.texel_count;
    assert_int_equal(parian_renderer_create(env, p->scene, &desc, &p->gl), PARIAN_OK);
    p->cpu = lit_cpu(env, p->scene, 256);
    assert_int_equal(parian_renderer_set_lights(p->gl, &light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_set_lights(p->cpu, &light, 1), PARIAN_OK);
    assert_true(PARIAN_NEW(env, p->b[0], p->texels) && PARIAN_NEW(env, p->b[1], p->texels));
}

static void close_pair(const parian_env *env, pair *p)
{
    parian_free(env, p->b[0]);
    parian_free(env, p->b[1]);
    parian_renderer_destroy(p->gl);
    parian_renderer_destroy(p->cpu);
    parian_scene_close(p->scene);
}

static void read_b(parian_renderer *renderer, float (*b)[3])
{
    parian_texel_arrays arrays = {.radiosity = b};
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
}

static void compare(const pair *p)
{
    double peak = 0;
    read_b(p->gl, p->b[0]);
    read_b(p->cpu, p->b[1]);
    for (size_t i = 0; i < 3 * p->texels; i++) {
        peak = fmax(peak, fabs((double)p->b[1][i / 3][i % 3]));
    }
    assert_true(peak > 1e-20);
    for (size_t i = 0; i < 3 * p->texels; i++) {
        double off = fabs((double)p->b[0][i / 3][i % 3] - (double)p->b[1][i / 3][i % 3]);
        assert_true(off <= 1e-3 * peak);
    }
}

static void set_both(const pair *p, const parian_medium_edit *edit)
{
    assert_int_equal(parian_renderer_set_medium(p->gl, 0, edit, NULL), PARIAN_OK);
    assert_int_equal(parian_renderer_set_medium(p->cpu, 0, edit, NULL), PARIAN_OK);
}

/* Edited, both agree; back again, B is what it was bit for bit; no memory is taken or lost. */
static void edit_form(parian_local_form form)
{
    const parian_env *env = test_env(0);
    float(*before)[3];
    pair p;
    open_pair(env, form, &p);
    assert_true(PARIAN_NEW(env, before, p.texels));
    compare(&p);
    memcpy(before, p.b[0], p.texels * sizeof *before);
    uint64_t memory = parian_renderer_memory(p.gl);
    set_both(&p, &milk);
    compare(&p);
    assert_memory_not_equal(before, p.b[0], p.texels * sizeof *before);
    set_both(&p, NULL);
    compare(&p);
    assert_memory_equal(before, p.b[0], p.texels * sizeof *before);
    assert_int_equal(parian_renderer_memory(p.gl), memory);
    parian_free(env, before);
    close_pair(env, &p);
}

static void test_forms(void **state)
{
    (void)state;
    edit_form(PARIAN_LOCAL_F16);
    edit_form(PARIAN_LOCAL_U8);
    edit_form(PARIAN_LOCAL_REBUILT);
    edit_form(PARIAN_LOCAL_SPLIT);
    edit_form(PARIAN_LOCAL_NONE);
    edit_form(PARIAN_LOCAL_ONLY);
}

static void draw(parian_renderer *renderer, parian_tone tone, uint8_t (*srgb)[4])
{
    parian_draw_desc desc = {.width = SIDE,
                             .height = SIDE,
                             .framebuffer = UINT32_MAX,
                             .exposure_ev = 1.5f,
                             .tone = tone};
    for (int k = 0; k < 4; k++) {
        desc.camera.view[5 * k] = desc.camera.projection[5 * k] = 1;
    }
    desc.camera.projection[0] = desc.camera.projection[5] = 70;
    desc.camera.projection[10] = -20;
    assert_int_equal(parian_renderer_draw(renderer, &desc), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(renderer, NULL, srgb), PARIAN_OK);
}

static void test_pictures(void **state)
{
    (void)state;
    static uint8_t gl[SIDE * SIDE][4], cpu[SIDE * SIDE][4];
    const parian_medium_edit tint = {.tint = {1, 0.5f, 0.25f}};
    parian_pass_time times[PARIAN_PASS_MAX];
    pair p;
    open_pair(test_env(0), PARIAN_LOCAL_SPLIT, &p);
    set_both(&p, &tint);
    for (parian_tone tone = PARIAN_TONE_NEUTRAL; tone <= PARIAN_TONE_REINHARD; tone++) {
        int off = 0, bright = 0;
        draw(p.gl, tone, gl);
        draw(p.cpu, tone, cpu);
        for (int i = 0; i < SIDE * SIDE * 3; i++) {
            off += abs(gl[i / 3][i % 3] - cpu[i / 3][i % 3]) > 2;
            bright += cpu[i / 3][i % 3] > 60;
        }
        assert_true(off <= SIDE * SIDE * 3 / 100);
        assert_true(bright > 300);
    }
    parian_renderer_get_times(p.gl, times);
    assert_int_equal(times[PARIAN_PASS_SHADE].runs, 1); /* another curve is another tone pass */
    assert_int_equal(times[PARIAN_PASS_TONE].runs, 3);
    set_both(&p, NULL);
    draw(p.gl, PARIAN_TONE_NEUTRAL, gl);
    parian_renderer_get_times(p.gl, times);
    assert_int_equal(times[PARIAN_PASS_SHADE].runs, 2); /* another tint shades anew, and no more */
    assert_int_equal(times[PARIAN_PASS_RESTRICT].runs, 1);
    close_pair(test_env(0), &p);
}

static int run_flavour(bool es)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_forms),
                                       cmocka_unit_test(test_pictures)};
    test_egl egl;
    if (!test_egl_open(&egl, es)) {
        test_egl_close(&egl);
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
