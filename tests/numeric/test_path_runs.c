/* test_path_runs.c - path tracing as a program: threads, interruptions, checkpoints, hard lights,
 * every scale, bad input, no memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "support/path_outcome.h"

/* ---- threads, interruptions, files ---- */

typedef struct interrupted_env {
    parian_env env;
    long calls, limit;
} interrupted_env;

static bool cancel_after(void *user)
{
    interrupted_env *mine = user;
    return mine->limit > 0 && ++mine->calls > mine->limit;
}

static void two_lights(parian_reference_scene *scene)
{
    const parian_light light[2] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .color = {3, 3, 3}},
        path_case_sky};
    parian_mesh mesh = {0};
    assert_int_equal(test_sphere(test_env(2), 1 * MM, 6, &mesh), PARIAN_OK);
    path_case_scene(test_env(2), &mesh, &path_case_marble, light, 2, scene);
}

static bool same_bytes(const parian_reference_result *a, const parian_reference_result *b,
                       size_t count)
{
    size_t size = count * sizeof *a->radiosity;
    return memcmp(a->radiosity, b->radiosity, size) == 0 &&
           memcmp(a->standard_error, b->standard_error, size) == 0 &&
           memcmp(a->unscattered, b->unscattered, size) == 0 &&
           memcmp(a->irradiance, b->irradiance, size) == 0 &&
           memcmp(a->in, b->in, sizeof a->in) == 0 && memcmp(a->out, b->out, sizeof a->out) == 0 &&
           memcmp(a->absorbed, b->absorbed, sizeof a->absorbed) == 0 &&
           a->scattering_events == b->scattering_events && a->samples == b->samples;
}

static void same_bytes_for_any_threads(void **state)
{
    (void)state;
    static const unsigned threads[] = {1, 2, 7};
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result[3];
    parian_path_desc desc = {.samples = 300, .standard_error = 0.05, .seed = 11};
    two_lights(&scene);
    path_case_spread(test_env(2), &scene, 20, &receivers);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(
            parian_reference_path(test_env(threads[i]), &scene, &receivers, &desc, &result[i]),
            PARIAN_OK);
        assert_true(same_bytes(&result[0], &result[i], 20));
    }
    for (int i = 0; i < 3; i++) {
        parian_reference_result_free(test_env(2), &result[i]);
    }
    parian_receivers_free(test_env(2), &receivers);
    parian_reference_scene_free(test_env(2), &scene);
}

/* Interrupt again and again, each time a little later; the last run goes to the end. */
static void resumed_runs_end_alike(void **state)
{
    (void)state;
    const char *file = test_scratch("run.checkpoint");
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result whole, parts;
    parian_path_desc desc = {.samples = 300, .seed = 12};
    interrupted_env mine = {.env = {.cancelled = cancel_after, .user = &mine}};
    int interruptions = 0;
    two_lights(&scene);
    path_case_spread(test_env(2), &scene, 20, &receivers);
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &whole),
                     PARIAN_OK);
    desc.checkpoint = file;
    unlink(file);
    for (long limit = 150;; limit += 40) {
        mine.calls = 0;
        mine.limit = limit;
        parian_result r = parian_reference_path(&mine.env, &scene, &receivers, &desc, &parts);
        if (r == PARIAN_OK) {
            break;
        }
        assert_int_equal(r, PARIAN_E_INTERRUPTED);
        parian_reference_result_free(&mine.env, &parts);
        interruptions++;
    }
    print_message("interrupted %d times\n", interruptions);
    assert_true(interruptions >= 3);
    assert_true(same_bytes(&whole, &parts, 20));
    assert_true(access(file, F_OK) != 0);
    parian_reference_result_free(test_env(2), &whole);
    parian_reference_result_free(test_env(2), &parts);
    parian_receivers_free(test_env(2), &receivers);
    parian_reference_scene_free(test_env(2), &scene);
}

static void damage(const char *file, long at)
{
    FILE *f = fopen(file, "r+b");
    assert_non_null(f);
    fseek(f, at, SEEK_SET);
    int byte = fgetc(f);
    fseek(f, at, SEEK_SET);
    fputc(byte ^ 1, f);
    fclose(f);
}

static void wrong_checkpoints_are_refused(void **state)
{
    (void)state;
    const char *file = test_scratch("wrong.checkpoint");
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result;
    parian_path_desc desc = {.samples = 300, .seed = 13, .checkpoint = file};
    interrupted_env mine = {.env = {.cancelled = cancel_after, .user = &mine}, .limit = 1500};
    two_lights(&scene);
    path_case_spread(test_env(2), &scene, 20, &receivers);
    unlink(file);
    assert_int_equal(parian_reference_path(&mine.env, &scene, &receivers, &desc, &result),
                     PARIAN_E_INTERRUPTED);
    parian_reference_result_free(test_env(2), &result);
    const parian_path_desc others[] = {
        {.samples = 301, .seed = 13, .checkpoint = file},
        {.samples = 300, .seed = 14, .checkpoint = file},
        {.samples = 300, .seed = 13, .checkpoint = file, .standard_error = 1e-3},
        {.samples = 300, .seed = 13, .checkpoint = file, .patch = 1e-4},
        {.samples = 300, .seed = 13, .checkpoint = file, .walk = PARIAN_WALK_ADJOINT}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_int_equal(
            parian_reference_path(test_env(2), &scene, &receivers, &others[i], &result),
            PARIAN_E_FORMAT);
        parian_reference_result_free(test_env(2), &result);
    }
    for (long at = 0; at < 400; at += 57) {
        damage(file, at);
        assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                         PARIAN_E_FORMAT);
        parian_reference_result_free(test_env(2), &result);
        damage(file, at);
    }
    assert_int_equal(truncate(file, 100), 0);
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                     PARIAN_E_FORMAT);
    parian_reference_result_free(test_env(2), &result);
    unlink(file);
    parian_receivers_free(test_env(2), &receivers);
    parian_reference_scene_free(test_env(2), &scene);
}

/* ---- hard lights, hard bodies ---- */

/* A light below the horizon, or inside the body, sends nothing in: B = 0 where E is. One at a
 * vertex is finite. */
static void hard_lights(void **state)
{
    (void)state;
    const parian_light light[] = {
        {.type = PARIAN_LIGHT_POINT, .position = {0, 0, 0}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_POINT, .position = {0.0002f, 0.0003f, 0}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_RECT,
         .axis_u = {0.0001f, 0, 0},
         .axis_v = {0, 0.0001f, 0},
         .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_RECT, /* faces away */
         .position = {0, 0, 0.005f},
         .axis_u = {0.001f, 0, 0},
         .axis_v = {0, 0.001f, 0},
         .color = {1, 1, 1}}};
    parian_path_desc desc = {.samples = 64, .seed = 14};
    for (size_t i = 0; i < sizeof light / sizeof *light; i++) {
        outcome o = trace_sphere(1 * MM, 6, &path_case_marble, &light[i], 30, &desc);
        for (int c = 0; c < 3; c++) {
            assert_true(mean_b(&o, c) == 0 && o.result.in[c] == 0);
        }
        release(&o);
    }
    parian_mesh mesh = {0};
    parian_reference_scene scene;
    parian_light at_vertex = {.type = PARIAN_LIGHT_POINT, .color = {1, 1, 1}};
    assert_int_equal(test_box(test_env(2), 1 * MM, 1 * MM, 1 * MM, 2, &mesh), PARIAN_OK);
    for (int k = 0; k < 3; k++) {
        at_vertex.position[k] = (float)mesh.position[5][k];
    }
    path_case_scene(test_env(2), &mesh, &path_case_marble, &at_vertex, 1, &scene);
    outcome o = trace(&scene, 30, &desc);
    for (size_t i = 0; i < 30 * 3; i++) {
        assert_true(isfinite(o.result.radiosity[i / 3][i % 3]) &&
                    o.result.radiosity[i / 3][i % 3] >= 0);
    }
    release(&o);
}

/* Half of a sphere in the shadow of the horizon: a directional light below it lights no receiver
 * through its own facet, but what leaks through is there. */
static void far_side_is_dark_in_dense_media(void **state)
{
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}};
    parian_medium dense = path_case_marble;
    for (int c = 0; c < 3; c++) {
        dense.sigma_s_prime[c] *= 20;
        dense.sigma_a[c] *= 2000;
    }
    parian_path_desc desc = {.samples = 64, .seed = 15};
    outcome o = trace_sphere(1 * MM, 8, &dense, &sun, 100, &desc);
    for (size_t i = 0; i < o.count; i++) {
        double z = o.receivers.position[i][2] / MM;
        assert_true(z > -0.3 || o.result.radiosity[i][1] < 1e-3);
        assert_true(z < 0.5 || o.result.radiosity[i][1] > 0.01);
    }
    release(&o);
}

/* Tiny, huge and thin bodies, edges and corners: the same numbers at every scale, and no walk lost.
 */
static void every_scale(void **state)
{
    (void)state;
    static const double scale[] = {1e-4, 1e-3, 10};
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -3, -2}, .color = {3, 3, 3}};
    for (int thin = 0; thin < 2; thin++) {
        double b[3];
        for (int i = 0; i < 3; i++) {
            parian_medium medium = path_case_marble;
            for (int c = 0; c < 3; c++) {
                medium.sigma_s_prime[c] *= 3 * MM / scale[i];
                medium.sigma_a[c] *= 3 * MM / scale[i];
            }
            parian_mesh mesh = {0};
            parian_reference_scene scene;
            parian_path_desc desc = {.samples = 64, .seed = 16};
            assert_int_equal(
                test_box(test_env(2), scale[i], scale[i] * (thin ? 1e-3 : 0.5), scale[i], 4, &mesh),
                PARIAN_OK);
            path_case_scene(test_env(2), &mesh, &medium, &sun, 1, &scene);
            outcome o = trace(&scene, 60, &desc);
            b[i] = mean_b(&o, 0);
            assert_books(&o.result);
            release(&o);
        }
        assert_near("huge as small", b[2], b[1], 1e-3 * b[1]);
        assert_near("tiny as small", b[0], b[1], 1e-3 * b[1]);
    }
}

/* Standard error falls as N^-1/2, and the spread of independent runs is what it says. */
static void errors_are_honest(void **state)
{
    (void)state;
    enum { RUNS = 24 };
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}};
    double spread = 0, stated = 0, mean[RUNS], all = 0;
    for (int i = 0; i < RUNS; i++) {
        parian_path_desc desc = {.samples = 64, .seed = 100 + (uint64_t)i};
        outcome o = trace_sphere(2 * MM, 6, &path_case_marble, &sun, 20, &desc);
        mean[i] = mean_b(&o, 0);
        all += mean[i] / RUNS;
        stated += path_case_error(&o.result, o.count, 0) / RUNS;
        release(&o);
    }
    for (int i = 0; i < RUNS; i++) {
        spread += (mean[i] - all) * (mean[i] - all) / (RUNS - 1);
    }
    assert_near("spread over stated error", sqrt(spread) / stated, 1, 0.45); /* 3 / sqrt(2 * 23) */
    parian_path_desc desc = {.samples = 64 * 16, .seed = 5};
    outcome o = trace_sphere(2 * MM, 6, &path_case_marble, &sun, 20, &desc);
    assert_near("error of 16 times the walks", path_case_error(&o.result, o.count, 0), stated / 4,
                0.2 * stated / 4);
    release(&o);
}

/* A run that stops at an error has reached it in every channel, also in one that is nearly clear
 * and the noisiest. */
static void every_channel_reaches_the_error(void **state)
{
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .color = {3, 3, 3}};
    const parian_medium uneven = {
        .sigma_s_prime = {2000, 1000, 100}, .sigma_a = {1, 1, 1}, .eta = 1.5};
    const parian_path_desc desc = {.standard_error = 0.1, .seed = 3};
    outcome o = trace_sphere(1 * MM, 6, &uneven, &sun, 20, &desc);
    double relative[3];
    for (int c = 0; c < 3; c++) {
        relative[c] =
            path_case_error(&o.result, o.count, c) * sqrt((double)o.count) / mean_b(&o, c);
        print_message("channel %d: %.3f\n", c, relative[c]);
        assert_true(relative[c] <= 0.1 * (1 + 1e-9));
    }
    assert_true(relative[0] < 0.8 * relative[2] ||
                relative[2] < 0.8 * relative[0]); /* else this would tell nothing */
    release(&o);
}

static void bad_input(void **state)
{
    (void)state;
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result;
    parian_path_desc desc = {.samples = 64};
    two_lights(&scene);
    path_case_spread(test_env(2), &scene, 4, &receivers);
    scene.bodies[0].closed = false;
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                     PARIAN_E_FORMAT);
    scene.bodies[0].closed = true;
    receivers.triangle[2] = 1u << 30;
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                     PARIAN_E_ARGUMENT);
    receivers.triangle[2] = 0;
    scene.bodies[0].medium.sigma_a[1] = NAN;
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                     PARIAN_E_ARGUMENT);
    scene.bodies[0].medium.sigma_a[1] = 1;
    desc.standard_error = NAN;
    assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                     PARIAN_E_ARGUMENT);
    parian_receivers_free(test_env(2), &receivers);
    parian_reference_scene_free(test_env(2), &scene);
}

static void memory_failures(void **state)
{
    (void)state;
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_path_desc desc = {.samples = 4, .seed = 1};
    two_lights(&scene);
    path_case_spread(test_env(2), &scene, 4, &receivers);
    for (size_t fail_at = 0;; fail_at++) {
        test_memory memory = {.fail_at = fail_at};
        parian_env env = test_failing_env(&memory);
        parian_reference_result result;
        parian_result r = parian_reference_path(&env, &scene, &receivers, &desc, &result);
        parian_reference_result_free(&env, &result);
        assert_int_equal(memory.live, 0);
        if (r == PARIAN_OK) {
            assert_true(fail_at > 10);
            break;
        }
        assert_int_equal(r, PARIAN_E_NOMEM);
    }
    parian_receivers_free(test_env(2), &receivers);
    parian_reference_scene_free(test_env(2), &scene);
}
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_bytes_for_any_threads),
        cmocka_unit_test(resumed_runs_end_alike),
        cmocka_unit_test(wrong_checkpoints_are_refused),
        cmocka_unit_test(hard_lights),
        cmocka_unit_test(far_side_is_dark_in_dense_media),
        cmocka_unit_test(every_scale),
        cmocka_unit_test(errors_are_honest),
        cmocka_unit_test(every_channel_reaches_the_error),
        cmocka_unit_test(bad_input),
        cmocka_unit_test(memory_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
