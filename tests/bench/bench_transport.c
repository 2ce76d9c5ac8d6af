/* bench_transport.c - seconds of each transport stage, error of B at 1,000 receivers, and the
 * operator product and the kernel filter as fractions of the memory bandwidth measured beside them.
 * Never a verdict.
 *
 *   bench_transport [marble|skimmilk] [size in mm] [rebuilt|f16|u8|split|none|paper] [icosahedron
 * cuts] [auto|off]
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/texels.h"
#include "bake/stages/transport.h"
#include "core/clones.h"
#include "core/lanes.h"
#include "cpu/cpu_transfer.h"
#include "support/transport_case.h"
#include "tool/session.h"

enum { REPEATS = 9, STREAM_SIZE = 256 << 20, STREAM_SLICES = 64, RECEIVERS = 1000 };

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *value)
{
    qsort(value, REPEATS, sizeof *value, compare_doubles);
    return value[REPEATS / 2];
}

typedef struct stream_job {
    const float *data;
    float sum[STREAM_SLICES];
} stream_job;

PARIAN_CLONES
static float sum_slice(const float *data, size_t count)
{
    parian_lanes a, b, s = {0}, t = {0};
    for (size_t i = 0; i < count; i += 32) {
        PARIAN_LANES_LOAD(a, data + i);
        PARIAN_LANES_LOAD(b, data + i + 16);
        s += a;
        t += b;
    }
    s += t;
    return s[0] + s[5];
}

static void stream_slice(void *context, size_t slice)
{
    stream_job *job = context;
    size_t count = STREAM_SIZE / sizeof(float) / STREAM_SLICES;
    job->sum[slice] = sum_slice(job->data + slice * count, count);
}

/* Bytes per second of reading a large array once, all threads. */
static double read_bandwidth(const parian_env *env)
{
    stream_job job;
    double seconds[REPEATS];
    float *data = malloc(STREAM_SIZE);
    if (!data) {
        return 0;
    }
    for (size_t i = 0; i < STREAM_SIZE / sizeof *data; i++) {
        data[i] = (float)(i & 15);
    }
    job.data = data;
    for (int k = 0; k < REPEATS; k++) {
        double start = parian_seconds();
        parian_par(env, STREAM_SLICES, stream_slice, &job);
        seconds[k] = parian_seconds() - start;
    }
    free(data);
    return STREAM_SIZE / median(seconds);
}

/* The local filter with interpolation of the vertices' radiosity, as the runtime's C evaluation
 * does it. */
static void bench_filter(const parian_env *env, const parian_body *body,
                         const parian_kernels *kernels, double stream)
{
    double seconds[REPEATS];
    case_light light;
    float(*radiosity)[3] = calloc(body->vertex_count, sizeof *radiosity);
    if (!radiosity) {
        return;
    }
    case_light_make(env, body, &light);
    case_illuminate(body, CASE_DIRECTIONAL, 0.05, light.e);
    for (int k = 0; k < REPEATS; k++) {
        double start = parian_seconds();
        parian_cpu_filter(env, body, kernels, (const float(*)[3])light.e,
                          (const float(*)[3])radiosity, light.local, light.b);
        seconds[k] = parian_seconds() - start;
    }
    double time = median(seconds);
    double bytes = 6.0 * (double)(kernels->interior_total + kernels->border_total);
    printf(
        "filter    %8.2f ms  %6.2f M taps RGB  %6.2f GB/s of kernels = %.0f %% of %.2f GB/s read\n",
        time * 1e3, bytes / 6e6, bytes / time * 1e-9, 100 * bytes / time / stream, stream * 1e-9);
    case_light_free(env, &light);
    free(radiosity);
}

static void bench_product(const parian_env *env, const parian_body *body, double stream)
{
    double seconds[REPEATS], factors = 0, runs = 0;
    float(*x)[3] = calloc(body->vertex_count, sizeof *x),
    (*y)[3] = calloc(body->vertex_count, sizeof *y);
    if (!x || !y || !body->operator_count) {
        return;
    }
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        x[v][0] = x[v][1] = x[v][2] = 1e-6f;
    }
    for (int k = 0; k < REPEATS; k++) {
        double start = parian_seconds();
        assert_int_equal(parian_operators_apply(env, body->operators, body->operator_count,
                                                (const float(*)[3])x, y),
                         PARIAN_OK);
        seconds[k] = parian_seconds() - start;
    }
    for (uint32_t o = 0; o < body->operator_count; o++) {
        factors += (double)body->operators[o].factor_total;
        runs += body->operators[o].run_total;
    }
    double time = median(seconds), bytes = factors * 6 + runs * 14;
    printf("product   %8.2f ms  %6.2f M factors RGB  %5.1f factors a run  %6.2f GB/s = %.0f %% of "
           "%.2f GB/s read\n",
           time * 1e3, factors * 1e-6, factors / runs, bytes / time * 1e-9,
           100 * bytes / time / stream, stream * 1e-9);
    free(x);
    free(y);
}

static void print_errors(const parian_env *env, const parian_body *body,
                         const parian_kernels *kernels, double size)
{
    static const char *const name[] = {"uniform", "directional", "point", "checker"};
    case_light light;
    case_light_make(env, body, &light);
    for (int kind = CASE_UNIFORM; kind <= CASE_CHECKER; kind++) {
        case_illuminate(body, (case_light_kind)kind, size, light.e);
        case_evaluate(env, body, kernels, &light);
        case_error e = case_compare(env, body, &light, RECEIVERS);
        printf("error     %-12s L2 %.4f %.4f %.4f  energy %.4f %.4f %.4f  least %.1e\n", name[kind],
               e.l2[0], e.l2[1], e.l2[2], e.energy[0], e.energy[1], e.energy[2], e.least);
    }
    case_light_free(env, &light);
}

static void make_surface(const parian_env *env, double size, unsigned cuts, parian_body *body)
{
    parian_mesh mesh = {0};
    parian_atlas_desc desc = {.atlas_size = 512};
    parian_atlas_report report;
    assert_int_equal(test_sphere(env, size / 2, cuts, &mesh), PARIAN_OK);
    case_bump(&mesh, size / 2);
    case_body(env, &mesh, body);
    parian_mesh_free(env, &mesh);
    assert_int_equal(parian_stage_atlas(env, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, body), PARIAN_OK);
    printf("surface   %u vertices, %u texels, %.1f %% border\n", body->vertex_count,
           body->texel_count, 100.0 * body->border_count / body->texel_count);
}

int main(int argc, char **argv)
{
    static const char *const forms[] = {"none", "rebuilt", "f16", "u8", "split", "only", "paper"};
    const parian_env *env = test_env(0);
    double size = (argc > 2 ? atof(argv[2]) : 50) * 1e-3, at[6];
    int form = 1;
    for (int k = 0; k < 7 && argc > 3; k++) {
        form = strcmp(argv[3], forms[k]) == 0 ? k : form;
    }
    parian_body body;
    parian_plan plan;
    parian_global_desc global_desc = {0};
    parian_global_report global;
    parian_blend_report blend;
    parian_kernels kernels;
    parian_plan_desc desc = {.local_form = (parian_local_form)(form == 6 ? 1 : form)};
    desc.paper_form = form == 6;
    desc.no_local = form == 0;
    desc.no_global = form == 5;
    make_surface(env, size, argc > 4 ? (unsigned)atoi(argv[4]) : 31, &body);
    body.medium = argc > 1 && strcmp(argv[1], "skimmilk") == 0 ? case_skimmilk : case_marble;
    at[0] = parian_seconds();
    assert_int_equal(parian_stage_plan(env, &desc, &body, &plan), PARIAN_OK);
    at[1] = parian_seconds();
    global_desc.hierarchy =
        argc > 5 && strcmp(argv[5], "off") == 0 ? PARIAN_HIERARCHY_OFF : PARIAN_HIERARCHY_AUTO;
    assert_int_equal(parian_stage_global(env, &global_desc, &body, &global), PARIAN_OK);
    at[2] = parian_seconds();
    assert_int_equal(parian_blend_make(env, &body, &blend), PARIAN_OK);
    at[3] = parian_seconds();
    assert_int_equal(parian_stage_local(env, &body), PARIAN_OK);
    at[4] = parian_seconds();
    assert_int_equal(parian_kernels_build(env, &body, &kernels), PARIAN_OK);
    at[5] = parian_seconds();
    printf("plan      %s\n", plan.reason);
    printf("seconds   plan %.3f  global %.3f  blend %.3f  local %.3f  kernels at load %.3f\n",
           at[1] - at[0], at[2] - at[1], at[3] - at[2], at[4] - at[3], at[5] - at[4]);
    printf(
        "factors   %.2f M kept (%.1f %%), lost %.2e mean %.2e max; blend: %u fitted, %u fallback\n",
        (double)global.factor_count * 1e-6, 100 * global.kept_share, global.lost_mean,
        global.lost_max, blend.fitted, blend.fallback);
    printf("hierarchy %s\n", global.hierarchy);
    printf("memory    %.0f MB peak\n", (double)parian_peak_memory() * 1e-6);
    double stream = read_bandwidth(env);
    bench_product(env, &body, stream);
    if (body.local_form != PARIAN_LOCAL_NONE) {
        bench_filter(env, &body, &kernels, stream);
    }
    print_errors(env, &body, &kernels, size);
    parian_kernels_free(env, &kernels);
    parian_body_free(env, &body);
    return 0;
}
