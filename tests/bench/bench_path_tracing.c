/* bench_path_tracing.c - scattering events per second in a mesh, and for each type of light the
 * walks against the light compared with photons from it: variance times seconds. Never a verdict.
 *
 *   bench_path_tracing [speed|lights|target] [MODEL] [size in mm] [walks] [material]
 *
 * Without MODEL: a bumpy sphere of 101,250 triangles, 50 mm, in marble.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>

#include "bake/reference/reference_scene.h"
#include "support/path_case.h"
#include "tool/media_file.h"
#include "tool/session.h"

enum { RECEIVERS = 1000 };

typedef struct bench {
    const parian_env *env;
    const char *model, *material;
    double size; /* m */
    uint64_t walks;
} bench;

static void bump(parian_mesh *mesh, double r)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double *p = mesh->position[v], x = p[0] / r, y = p[1] / r, z = p[2] / r;
        double s = 0.8 * (1 + 0.18 * sin(3 * x + 1) * cos(2.5 * y) + 0.1 * sin(5 * z + 2 * x));
        for (int k = 0; k < 3; k++) {
            p[k] *= s;
        }
    }
}

static void load(const bench *b, const parian_light *lights, uint32_t count,
                 parian_reference_scene *scene)
{
    if (b->model) {
        const char *material[1] = {b->material};
        parian_bake_desc desc = {
            .input = b->model, .material = material, .material_count = 1, .scale_m = b->size};
        assert_int_equal(parian_reference_scene_load(b->env, &desc, lights, count, scene),
                         PARIAN_OK);
        return;
    }
    parian_mesh mesh = {0};
    const parian_medium *medium = parian_media_find(b->material);
    assert_non_null(medium);
    assert_int_equal(test_sphere(b->env, b->size / 2, 72, &mesh), PARIAN_OK);
    bump(&mesh, b->size / 2);
    path_case_scene(b->env, &mesh, medium, lights, count, scene);
}

/* Root mean square standard error over the mean of B, of the worst channel. */
static double relative_error(const parian_reference_result *result, size_t count)
{
    double worst = 0;
    for (int c = 0; c < 3; c++) {
        double square = 0;
        for (size_t i = 0; i < count; i++) {
            square += result->standard_error[i][c] * result->standard_error[i][c] / (double)count;
        }
        double mean = path_case_mean((const double(*)[3])result->radiosity, count, c);
        worst = fmax(worst, sqrt(square) / mean);
    }
    return worst;
}

/* Run, print a line, return variance times seconds. */
static double run(const bench *b, const parian_light *lights, uint32_t count,
                  const parian_path_desc *desc, size_t receiver_count, const char *label)
{
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result;
    load(b, lights, count, &scene);
    assert_int_equal(parian_receivers_spread(b->env, &scene, receiver_count, 3, &receivers),
                     PARIAN_OK);
    assert_int_equal(parian_reference_path(b->env, &scene, &receivers, desc, &result), PARIAN_OK);
    double error = relative_error(&result, receivers.count);
    double mean = path_case_mean((const double(*)[3])result.radiosity, receivers.count, 1);
    printf("%-34s B %10.4g  error %6.2f %%  %7.1f s  %6.2f M events/s  error^2 x s %9.4g\n", label,
           mean, error * 100, result.seconds,
           (double)result.scattering_events / result.seconds * 1e-6,
           error * error * result.seconds);
    fflush(stdout);
    double cost = error * error * result.seconds;
    parian_reference_result_free(b->env, &result);
    parian_receivers_free(b->env, &receivers);
    parian_reference_scene_free(b->env, &scene);
    return cost;
}

static void bench_speed(const bench *b)
{
    parian_path_desc desc = {.samples = b->walks, .seed = 1};
    run(b, &path_case_sky, 1, &desc, 200, "uniform sky, all threads");
    bench one = *b;
    one.env = test_env(1);
    run(&one, &path_case_sky, 1, &desc, 200, "uniform sky, 1 thread");
}

static void bench_lights(const bench *b)
{
    float s = (float)b->size;
    static const char *const name[] = {"point", "directional", "spot", "rect", "environment"};
    const parian_light light[] = {
        {.type = PARIAN_LIGHT_POINT, .position = {s, s, s}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -2, -1}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_SPOT,
         .position = {s, s, s},
         .direction = {-1, -1, -1},
         .inner_deg = 5,
         .outer_deg = 15,
         .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 1.5f * s, 0},
         .axis_u = {0.5f * s, 0, 0},
         .axis_v = {0, 0, 0.5f * s},
         .color = {1, 1, 1}},
        path_case_sky};
    for (size_t i = 0; i < sizeof light / sizeof *light; i++) {
        double cost[2];
        for (int forward = 0; forward < 2; forward++) {
            char label[64];
            parian_path_desc desc = {.samples = b->walks,
                                     .seed = 1,
                                     .walk = forward ? PARIAN_WALK_FORWARD : PARIAN_WALK_ADJOINT};
            snprintf(label, sizeof label, "%s, %s", name[light[i].type],
                     forward ? "photons" : "walks from receivers");
            cost[forward] = run(b, &light[i], 1, &desc, 200, label);
        }
        printf("%-34s photons cost %.3g times as much\n", name[light[i].type], cost[1] / cost[0]);
    }
}

/* One directional and one uniform light to a standard error of 2 % of the mean of B. */
static void bench_target(const bench *b)
{
    const parian_light light[2] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -2, -1}, .color = {3, 3, 3}},
        path_case_sky};
    parian_path_desc desc = {.standard_error = 0.02, .seed = 1};
    run(b, light, 2, &desc, RECEIVERS, "directional and sky to 2 %");
    run(b, light, 1, &desc, RECEIVERS, "directional to 2 %");
    run(b, light + 1, 1, &desc, RECEIVERS, "sky to 2 %");
}

int main(int argc, char **argv)
{
    const char *what = argc > 1 ? argv[1] : "speed";
    bench b = {.env = test_env(0),
               .model = argc > 2 && argv[2][0] ? argv[2] : NULL,
               .size = (argc > 3 ? strtod(argv[3], NULL) : 50) * 1e-3,
               .walks = argc > 4 ? strtoull(argv[4], NULL, 10) : 64,
               .material = argc > 5 ? argv[5] : "marble"};
    if (strcmp(what, "lights") == 0) {
        bench_lights(&b);
    } else if (strcmp(what, "target") == 0) {
        bench_target(&b);
    } else {
        bench_speed(&b);
    }
    return 0;
}
