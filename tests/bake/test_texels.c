/* test_texels.c - areas, centroids and gutters of texels against sums, sampling and linear
 * functions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/atlas_picture.h"
#include "bake/stages/texels.h"
#include "support/atlas_case.h"

/* Atlas and texels of a mesh, which is freed. */
static double make_texels(const parian_env *env, parian_mesh *mesh, uint32_t side,
                          parian_body *body)
{
    parian_atlas_desc desc = {.atlas_size = side};
    parian_atlas_report report;
    assert_int_equal(atlas_case_body(env, mesh, body), PARIAN_OK);
    assert_int_equal(parian_stage_atlas(env, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, body), PARIAN_OK);
    parian_mesh_free(env, mesh);
    return report.texel_edge_m;
}

static void texel_uv(const parian_body *body, uint32_t texel, double uv[2])
{
    uint32_t t = body->texel_triangle[texel];
    double a = (double)body->texel_barycentric[texel][0],
           b = (double)body->texel_barycentric[texel][1];
    for (int d = 0; d < 2; d++) {
        uv[d] = a * (double)body->corner_uv[t][0][d] + b * (double)body->corner_uv[t][1][d] +
                (1.0 - a - b) * (double)body->corner_uv[t][2][d];
    }
}

/* L-2, L-3 and the place of every centroid. */
static void check_texels(const parian_body *body)
{
    double sum = 0.0, area = atlas_case_area(body);
    uint32_t outside = 0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *beta = body->texel_barycentric[i];
        double uv[2];
        assert_true(body->texel_triangle[i] < body->triangle_count);
        assert_true(beta[0] >= 0.0f && beta[1] >= 0.0f && beta[0] + beta[1] <= 1.0f);
        assert_true(body->texel_area[i] >= 0.0f);
        assert_true(i == 0 || body->texel_index[i] > body->texel_index[i - 1]);
        assert_int_equal(body->texel_at[body->texel_index[i]], i);
        sum += (double)body->texel_area[i];
        texel_uv(body, i, uv);
        double du = fabs(uv[0] - body->texel_index[i] % body->atlas_size - 0.5);
        double dv = fabs(uv[1] - body->texel_index[i] / body->atlas_size - 0.5);
        /* A centroid of pieces that lie apart may fall between them; then the nearest one counts.
         */
        assert_true(du < 1.0 && dv < 1.0);
        outside += du > 0.5001 || dv > 0.5001;
    }
    assert_true(fabs(sum / area - 1.0) < 1e-6);
    assert_true(outside <= body->texel_count / 1000);
}

static void check_gutter(const parian_body *body)
{
    for (uint32_t g = 0; g < body->gutter_count; g++) {
        float sum = 0.0f;
        assert_true(g == 0 || body->gutter_index[g] > body->gutter_index[g - 1]);
        assert_int_equal(body->texel_at[body->gutter_index[g]], 0xFFFFFFFFu);
        for (int k = 0; k < PARIAN_GUTTER_SOURCES; k++) {
            assert_true(body->gutter_source[g][k] < body->texel_count);
            assert_true(body->gutter_weight[g][k] >= 0.0f);
            sum += body->gutter_weight[g][k];
        }
        assert_true(fabsf(sum - 1.0f) < 1e-5f);
    }
}

static void sums_and_places(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    for (int shape = 0; shape < 5; shape++) {
        parian_result made = shape == 0   ? test_sphere(NULL, 0.025, 30, &mesh)
                             : shape == 1 ? test_box(NULL, 0.05, 0.03, 0.0004, 20, &mesh)
                             : shape == 2 ? test_plane(NULL, 0.05, 9, &mesh)
                             : shape == 3 ? test_sphere(NULL, 1000.0, 1, &mesh)
                                          : test_sphere(NULL, 1e-5, 60, &mesh);
        assert_int_equal(made, PARIAN_OK);
        /* The last one has triangles smaller than texels. */
        make_texels(NULL, &mesh, shape == 4 ? 64 : 256, &body);
        check_texels(&body);
        check_gutter(&body);
        parian_body_free(NULL, &body);
    }
}

/* Share of a texel's square in triangles, by 32 x 32 points, weighted by surface over atlas area.
 */
static double sampled_area(const parian_body *body, uint32_t texel)
{
    double sum = 0.0, u = texel % body->atlas_size, v = texel / body->atlas_size;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        float(*uv)[2] = body->corner_uv[t];
        if (fmin(uv[0][0], fmin(uv[1][0], uv[2][0])) > u + 1 ||
            fmax(uv[0][0], fmax(uv[1][0], uv[2][0])) < u ||
            fmin(uv[0][1], fmin(uv[1][1], uv[2][1])) > v + 1 ||
            fmax(uv[0][1], fmax(uv[1][1], uv[2][1])) < v) {
            continue;
        }
        parian_body one = *body;
        one.triangle_count = 1;
        one.triangle = body->triangle + t;
        double flat = 0.5 * (((double)uv[1][0] - uv[0][0]) * ((double)uv[2][1] - uv[0][1]) -
                             ((double)uv[1][1] - uv[0][1]) * ((double)uv[2][0] - uv[0][0]));
        for (int s = 0; s < 1024; s++) {
            double x = u + (s % 32 + 0.5) / 32, y = v + (s / 32 + 0.5) / 32;
            int inside = 0;
            for (int k = 0; k < 3; k++) {
                const float *a = uv[k], *b = uv[(k + 1) % 3];
                inside +=
                    ((double)b[0] - a[0]) * (y - a[1]) - ((double)b[1] - a[1]) * (x - a[0]) > 0.0;
            }
            sum += inside == 3 ? atlas_case_area(&one) / flat / 1024 : 0.0;
        }
    }
    return sum;
}

static void areas_agree_with_sampling(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    assert_int_equal(test_sphere(NULL, 0.02, 5, &mesh), PARIAN_OK);
    double edge = make_texels(NULL, &mesh, 48, &body), worst = 0.0;
    for (uint32_t i = 0; i < body.texel_count; i++) {
        double sampled = sampled_area(&body, body.texel_index[i]);
        worst = fmax(worst, fabs(sampled - (double)body.texel_area[i]) / (edge * edge));
    }
    print_message("largest difference to 1024 samples: %.4f of a texel\n", worst);
    /* An edge along the rows of samples miscounts up to half a row of 32, 1.6 %, and there may be
     * two. */
    assert_true(worst < 0.033);
    parian_body_free(NULL, &body);
}

/* Value of a linear function (a coordinate) of a texel of the atlas, owned or gutter; false for
 * neither. */
static bool value_at(const parian_body *body, const uint32_t *gutter_at, int64_t u, int64_t v,
                     int axis, double *value)
{
    size_t index = (size_t)v * body->atlas_size + (size_t)u;
    uint32_t texel = body->texel_at[index], gutter = gutter_at[index];
    *value = 0.0;
    if (texel != 0xFFFFFFFFu) {
        *value = (double)body->texel_position[texel][axis];
        return true;
    }
    for (int k = 0; k < PARIAN_GUTTER_SOURCES && gutter != 0xFFFFFFFFu; k++) {
        *value += (double)body->gutter_weight[gutter][k] *
                  (double)body->texel_position[body->gutter_source[gutter][k]][axis];
    }
    return gutter != 0xFFFFFFFFu;
}

typedef struct lookup_error {
    double most, squares;
    uint64_t count;
} lookup_error;

/* Bilinear look-ups of the position, at points of all edges whose charts differ. */
static void look_up_seams(const parian_body *body, bool seams, lookup_error *error)
{
    size_t cells = (size_t)body->atlas_size * body->atlas_size;
    uint32_t *gutter_at = malloc(cells * sizeof *gutter_at);
    uint32_t(*neighbour)[3] = malloc(body->triangle_count * sizeof *neighbour);
    assert_true(gutter_at && neighbour);
    memset(gutter_at, 0xFF, cells * sizeof *gutter_at);
    for (uint32_t g = 0; g < body->gutter_count; g++) {
        gutter_at[body->gutter_index[g]] = g;
    }
    assert_int_equal(parian_triangle_neighbours(NULL, body->vertex_count, body->triangle_count,
                                                (const uint32_t(*)[3])body->triangle, neighbour),
                     PARIAN_OK);
    memset(error, 0, sizeof *error);
    for (uint32_t h = 0; h < 3 * body->triangle_count; h++) {
        uint32_t t = h / 3, k = h % 3, across = neighbour[t][k];
        bool seam = across != PARIAN_NO_NEIGHBOUR &&
                    body->triangle_chart[across / 3] != body->triangle_chart[t];
        if (seam != seams) {
            continue;
        }
        for (int s = 0; s < 4; s++) {
            double x = (s + 0.5) / 4, uv[2], away2 = 0.0;
            for (int d = 0; d < 2; d++) {
                uv[d] = (1 - x) * (double)body->corner_uv[t][k][d] +
                        x * (double)body->corner_uv[t][(k + 1) % 3][d];
            }
            int64_t u = (int64_t)floor(uv[0] - 0.5), v = (int64_t)floor(uv[1] - 0.5);
            double fu = uv[0] - 0.5 - (double)u, fv = uv[1] - 0.5 - (double)v;
            for (int axis = 0; axis < 3; axis++) {
                double looked = 0.0, value;
                for (int i = 0; i < 4; i++) {
                    assert_true(value_at(body, gutter_at, u + i % 2, v + i / 2, axis, &value));
                    looked += value * (i % 2 ? fu : 1 - fu) * (i / 2 ? fv : 1 - fv);
                }
                double true_value =
                    (1 - x) * (double)body->vertex_position[body->triangle[t][k]][axis] +
                    x * (double)body->vertex_position[body->triangle[t][(k + 1) % 3]][axis];
                away2 += (looked - true_value) * (looked - true_value);
            }
            error->most = fmax(error->most, sqrt(away2));
            error->squares += away2;
            error->count++;
        }
    }
    free(neighbour);
    free(gutter_at);
}

static void look_ups_across_seams_are_linear(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    lookup_error error;
    for (int shape = 0; shape < 2; shape++) {
        assert_int_equal(shape == 0 ? test_sphere(NULL, 0.025, 30, &mesh)
                                    : test_box(NULL, 0.05, 0.03, 0.01, 10, &mesh),
                         PARIAN_OK);
        double edge = make_texels(NULL, &mesh, 256, &body);
        look_up_seams(&body, true, &error);
        assert_true(error.count > 100);
        double rms = sqrt(error.squares / (double)error.count);
        print_message("look-ups at seams: rms %.3f, largest %.3f texel edges (%llu points)\n",
                      rms / edge, error.most / edge, (unsigned long long)error.count);
        /* Without a gutter, a look-up at a seam mixes in values of another place, tens of texels
         * away. What remains is that partly covered texels stand for their centroids, up to half a
         * texel from the middle that the look-up takes them for. */
        assert_true(rms < 0.45 * edge);
        assert_true(error.most < 0.75 * edge);
        parian_body_free(NULL, &body);
    }
}

static void open_boundaries_continue_their_own_chart(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    assert_int_equal(test_plane(NULL, 1.0, 5, &mesh), PARIAN_OK);
    double edge = make_texels(NULL, &mesh, 64, &body);
    check_texels(&body);
    check_gutter(&body);
    assert_true(body.gutter_count > 4 * 60);
    for (uint32_t g = 0; g < body.gutter_count; g++) {
        int u = (int)(body.gutter_index[g] % 64), v = (int)(body.gutter_index[g] / 64);
        for (int k = 0; k < PARIAN_GUTTER_SOURCES; k++) {
            uint32_t source = body.texel_index[body.gutter_source[g][k]];
            assert_true(abs((int)(source % 64) - u) <= 3 && abs((int)(source / 64) - v) <= 3);
        }
    }
    assert_true(edge > 1.0 / 64 && edge < 1.0 / 60);
    parian_body_free(NULL, &body);
}

static bool same_bytes(const void *a, const void *b, size_t count, size_t size)
{
    return memcmp(a, b, count * size) == 0;
}

static void the_same_for_any_thread_count(void **state)
{
    (void)state;
    parian_body body[3];
    const unsigned threads[3] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        parian_mesh mesh;
        assert_int_equal(test_sphere(test_env(threads[i]), 0.025, 24, &mesh), PARIAN_OK);
        make_texels(test_env(threads[i]), &mesh, 200, &body[i]);
    }
    for (int i = 1; i < 3; i++) {
        const parian_body *a = &body[0], *b = &body[i];
        assert_int_equal(a->texel_count, b->texel_count);
        assert_int_equal(a->gutter_count, b->gutter_count);
        assert_int_equal(a->border_count, b->border_count);
        assert_true(
            same_bytes(a->corner_uv, b->corner_uv, a->triangle_count, sizeof *a->corner_uv));
        assert_true(same_bytes(a->texel_index, b->texel_index, a->texel_count, 4));
        assert_true(same_bytes(a->texel_triangle, b->texel_triangle, a->texel_count, 4));
        assert_true(same_bytes(a->texel_barycentric, b->texel_barycentric, a->texel_count, 8));
        assert_true(same_bytes(a->texel_area, b->texel_area, a->texel_count, 4));
        assert_true(same_bytes(a->gutter_source, b->gutter_source, a->gutter_count, 16));
        assert_true(same_bytes(a->gutter_weight, b->gutter_weight, a->gutter_count, 16));
        assert_true(same_bytes(a->border_offset, b->border_offset, a->border_count + 1, 4));
        assert_true(same_bytes(a->border_neighbour, b->border_neighbour,
                               a->border_offset[a->border_count], 4));
    }
    for (int i = 0; i < 3; i++) {
        parian_body_free(test_env(threads[i]), &body[i]);
    }
}

static void wrong_input_is_refused(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    assert_int_equal(test_sphere(NULL, 1.0, 3, &mesh), PARIAN_OK);
    make_texels(NULL, &mesh, 32, &body);
    body.kernel_width = 6;
    assert_int_equal(parian_stage_texels(NULL, &body), PARIAN_E_ARGUMENT);
    body.kernel_width = 7;
    body.corner_uv[5][1][0] = NAN;
    assert_int_equal(parian_stage_texels(NULL, &body), PARIAN_E_ARGUMENT);
    body.corner_uv[5][1][0] = 33.0f;
    assert_int_equal(parian_stage_texels(NULL, &body), PARIAN_E_ARGUMENT);
    parian_body_free(NULL, &body);
}

static void failing_memory_leaks_nothing(void **state)
{
    (void)state;
    parian_mesh mesh;
    assert_int_equal(test_sphere(NULL, 1.0, 3, &mesh), PARIAN_OK);
    for (size_t k = 0;; k++) {
        parian_body body;
        parian_atlas_desc desc = {.atlas_size = 32};
        test_memory memory = {.fail_at = SIZE_MAX};
        parian_env env = test_failing_env(&memory);
        assert_int_equal(atlas_case_body(&env, &mesh, &body), PARIAN_OK);
        parian_free(&env, mesh.corner_normal);
        mesh.corner_normal = NULL;
        assert_int_equal(parian_stage_atlas(&env, &desc, &body, NULL), PARIAN_OK);
        memory.fail_at = memory.calls + k;
        parian_result result = parian_stage_texels(&env, &body);
        parian_body_free(&env, &body);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 20);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
    parian_mesh_free(NULL, &mesh);
}

static void the_picture_shows_every_texel(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    uint8_t(*rgba)[4] = calloc((size_t)64 * 64, 4);
    assert_int_equal(test_sphere(NULL, 1.0, 6, &mesh), PARIAN_OK);
    make_texels(NULL, &mesh, 64, &body);
    assert_int_equal(parian_atlas_picture(NULL, &body, rgba), PARIAN_OK);
    uint32_t coloured = 0, grey = 0;
    for (int i = 0; i < 64 * 64; i++) {
        coloured += rgba[i][0] != rgba[i][1] || rgba[i][1] != rgba[i][2];
        grey += rgba[i][0] == 96 && rgba[i][1] == 96 && rgba[i][2] == 96;
    }
    assert_int_equal(coloured, body.texel_count);
    assert_int_equal(grey, body.gutter_count);
    free(rgba);
    parian_body_free(NULL, &body);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_and_places),
        cmocka_unit_test(areas_agree_with_sampling),
        cmocka_unit_test(look_ups_across_seams_are_linear),
        cmocka_unit_test(open_boundaries_continue_their_own_chart),
        cmocka_unit_test(the_same_for_any_thread_count),
        cmocka_unit_test(wrong_input_is_refused),
        cmocka_unit_test(failing_memory_leaks_nothing),
        cmocka_unit_test(the_picture_shows_every_texel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
