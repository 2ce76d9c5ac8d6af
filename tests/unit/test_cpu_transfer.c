/* test_cpu_transfer.c - restriction, product, filter and gutter against plain sums in double; what
 * is recomputed; pictures without a GPU.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/half.h"
#include "core/kernel.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"

static const parian_light light = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-0.4f, -0.2f, -1}, .color = {3, 2, 1}};

typedef float (*float3_array)[3];
typedef double (*double3_array)[3];

/* Single-precision sums of up to a few thousand terms against double. */
static const double tolerance = 2e-5;

static void assert_same(const float (*a)[3], const double (*b)[3], size_t count)
{
    double peak = 0.0;
    for (size_t i = 0; i < 3 * count; i++) {
        peak = fmax(peak, fabs(b[i / 3][i % 3]));
    }
    assert_true(peak > 0.0);
    for (size_t i = 0; i < 3 * count; i++) {
        assert_true(fabs((double)a[i / 3][i % 3] - b[i / 3][i % 3]) <= tolerance * peak);
    }
}

static double beta_of(const parian_body *body, uint32_t t, int corner)
{
    double b0 = (double)body->texel_barycentric[t][0], b1 = (double)body->texel_barycentric[t][1];
    return corner == 0 ? b0 : corner == 1 ? b1 : 1.0 - b0 - b1;
}

/* Phi and D by scattering from texels. */
static void scatter(const parian_body *body, const float (*e)[3], double3_array flux,
                    double3_array direct)
{
    for (uint32_t t = 0; t < body->texel_count; t++) {
        for (int k = 0; k < 3; k++) {
            uint32_t v = body->triangle[body->texel_triangle[t]][k];
            double beta = beta_of(body, t, k), share = body->paper_form ? 4.0 * beta - 1.0 : beta;
            for (int c = 0; c < 3; c++) {
                flux[v][c] += share * (double)body->texel_area[t] * (double)e[t][c];
                direct[v][c] +=
                    (double)parian_half_to_float(body->blend_weight[t][k][c]) * (double)e[t][c];
            }
        }
    }
}

static void transport(const parian_operator *op, const double (*x)[3], double3_array y)
{
    for (uint32_t row = 0; row < op->row_count; row++) {
        for (uint32_t r = op->run_offset[row]; r < op->run_offset[row + 1]; r++) {
            for (uint32_t k = 0; k < op->run_count[r]; k++) {
                for (int c = 0; c < 3; c++) {
                    y[row][c] +=
                        (double)op->scale[row][c] *
                        (double)parian_half_to_float(op->factor[op->run_factor[r] + k][c]) *
                        x[op->run_column[r] + k][c];
                }
            }
        }
    }
}

static void filter(const parian_body *body, const parian_kernels *kernels, const float (*e)[3],
                   double3_array local)
{
    uint32_t interior = 0, width = body->kernel_width;
    for (uint32_t t = 0; t < body->texel_count; t++) {
        uint32_t border = body->texel_border[t];
        bool window = border == PARIAN_NO_BORDER;
        uint32_t count =
            window ? width * width : body->border_offset[border + 1] - body->border_offset[border];
        for (uint32_t k = 0; k < count; k++) {
            const parian_half *tap;
            uint32_t from;
            if (window) {
                uint32_t u = body->texel_index[t] % body->atlas_size + k % width - width / 2;
                uint32_t v = body->texel_index[t] / body->atlas_size + k / width - width / 2;
                from = body->texel_at[v * body->atlas_size + u];
                tap = kernels->interior[(size_t)interior * width * width + k];
            } else {
                from = body->border_neighbour[body->border_offset[border] + k];
                tap = kernels->border[body->border_offset[border] + k];
            }
            for (int c = 0; c < 3; c++) {
                local[t][c] += (double)kernels->channel_scale[c] *
                               (double)parian_half_to_float(tap[c]) * (double)e[from][c];
            }
        }
        interior += window;
    }
}

typedef struct expectation {
    double3_array flux, vertex, local, global;
} expectation;

static void expect(const parian_env *env, const parian_body *body, const float (*e)[3],
                   expectation *want)
{
    parian_kernels kernels = {0};
    assert_true(PARIAN_NEW0(env, want->flux, body->vertex_count) &&
                PARIAN_NEW0(env, want->vertex, body->vertex_count) &&
                PARIAN_NEW0(env, want->local, body->texel_count) &&
                PARIAN_NEW0(env, want->global, body->texel_count));
    assert_int_equal(parian_kernels_build(env, body, &kernels), PARIAN_OK);
    scatter(body, e, want->flux, want->vertex);
    transport(&body->operators[0], (const double(*)[3])want->flux, want->vertex);
    filter(body, &kernels, e, want->local);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        for (int k = 0; k < 9; k++) {
            uint32_t v = body->triangle[body->texel_triangle[t]][k / 3];
            want->global[t][k % 3] += beta_of(body, t, k / 3) * want->vertex[v][k % 3];
        }
    }
    parian_kernels_free(env, &kernels);
}

static void check_form(parian_local_form form, bool paper)
{
    const parian_env *env = test_env(2);
    parian_mesh mesh = {0};
    test_lit_desc desc = {
        .cut = 8, .form = form, .transport = true, .paper_form = paper, .kernel_width = 3};
    assert_int_equal(test_sphere(env, 0.01, 8, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    const parian_body *body = &scene->data.bodies[0];
    float3_array vertex = parian_zalloc(env, body->vertex_count, sizeof *vertex);
    parian_texel_arrays arrays = {0};
    expectation want = {0};
    arrays.radiosity_local = parian_zalloc(env, body->texel_count, sizeof *arrays.radiosity_local);
    arrays.radiosity_global =
        parian_zalloc(env, body->texel_count, sizeof *arrays.radiosity_global);
    arrays.irradiance = lit_irradiance(env, scene, renderer, &light);
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    expect(env, body, (const float(*)[3])arrays.irradiance, &want);
    assert_int_equal(parian_renderer_read_register(renderer, 0, 0, vertex), PARIAN_OK);
    assert_same((const float(*)[3])vertex, (const double(*)[3])want.flux, body->vertex_count);
    assert_int_equal(parian_renderer_read_register(renderer, 0, 1, vertex), PARIAN_OK);
    assert_same((const float(*)[3])vertex, (const double(*)[3])want.vertex, body->vertex_count);
    assert_same((const float(*)[3])arrays.radiosity_local, (const double(*)[3])want.local,
                body->texel_count);
    assert_same((const float(*)[3])arrays.radiosity_global, (const double(*)[3])want.global,
                body->texel_count);
    void *all[] = {vertex,
                   arrays.radiosity_local,
                   arrays.radiosity_global,
                   arrays.irradiance,
                   want.flux,
                   want.vertex,
                   want.local,
                   want.global};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        parian_free(env, all[i]);
    }
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static void test_against_sums(void **state)
{
    check_form(PARIAN_LOCAL_F16, false);
    check_form(PARIAN_LOCAL_F16, true);
    check_form(PARIAN_LOCAL_U8, false);
    (void)state;
}

/* The same bits for any number of threads. */
static void test_threads(void **state)
{
    float3_array result[3];
    parian_scene *scene = lit_sphere(test_env(1), 0.01f, 8, 5);
    static const unsigned threads[3] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        parian_renderer *renderer = lit_cpu(test_env(threads[i]), scene, 256);
        result[i] = lit_irradiance(test_env(1), scene, renderer, &light);
        parian_renderer_destroy(renderer);
        assert_memory_equal(result[i], result[0], scene->info.texel_count * sizeof *result[i]);
    }
    for (int i = 0; i < 3; i++) {
        parian_free(test_env(1), result[i]);
    }
    parian_scene_close(scene);
    (void)state;
}

/* A camera alone shades alone; no light is black; E seen head-on is what the closed form says. */
static void test_pictures(void **state)
{
    enum { SIDE = 64 };
    static float picture[SIDE * SIDE][4];
    const parian_env *env = test_env(2);
    parian_scene *scene = lit_sphere(env, 0.02f, 8, 4);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    const float eye[3] = {1e-4f, 0, 0.15f};
    parian_light head = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}};
    parian_draw_desc draw = {.camera = lit_camera(eye, SIDE, SIDE), .width = SIDE, .height = SIDE};
    parian_settings settings = {.view = PARIAN_VIEW_IRRADIANCE};
    parian_pass_time times[PARIAN_PASS_MAX];
    assert_int_equal(parian_renderer_set_settings(renderer, &settings), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(renderer, picture, NULL), PARIAN_OK);
    assert_true(picture[SIDE * SIDE / 2 + SIDE / 2][3] == 1.0f &&
                picture[SIDE * SIDE / 2 + SIDE / 2][0] == 0.0f);
    assert_int_equal(parian_renderer_set_lights(renderer, &head, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_OK);
    assert_int_equal(parian_renderer_read_picture(renderer, picture, NULL), PARIAN_OK);
    double want = 0.96 / 3.14159265358979; /* F_t(1, 1.5) / pi */
    assert_true(fabs((double)picture[SIDE * SIDE / 2 + SIDE / 2][0] / want - 1.0) < 0.005);
    assert_true(picture[0][3] == 0.0f);
    parian_renderer_get_times(renderer, times);
    assert_int_equal(times[PARIAN_PASS_IRRADIANCE].runs, 2);
    assert_int_equal(times[PARIAN_PASS_SHADE].runs, 2); /* the third draw is of the same picture */
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_against_sums),
                                       cmocka_unit_test(test_threads),
                                       cmocka_unit_test(test_pictures)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
