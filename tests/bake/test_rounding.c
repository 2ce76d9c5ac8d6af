/* test_rounding.c - rounded arrays keep the sums that others rely on, and have the zeros that make
 * files small.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/rounding.h"
#include "bake/stages/texels.h"
#include "bake/stages/transport.h"
#include "core/body_schema.h"
#include "core/memory.h"
#include "support/transport_case.h"

static void make_body(const parian_env *env, parian_body *body)
{
    parian_mesh mesh = {0};
    parian_atlas_desc desc = {.atlas_size = 128};
    parian_atlas_report report;
    assert_int_equal(test_sphere(env, 0.025, 10, &mesh), PARIAN_OK);
    case_bump(&mesh, 0.025);
    case_body(env, &mesh, body);
    parian_mesh_free(env, &mesh);
    body->medium = case_marble;
    assert_int_equal(parian_stage_atlas(env, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, body), PARIAN_OK);
    body->local_form = PARIAN_LOCAL_REBUILT;
    body->has_global = true;
}

static double area_of(const parian_body *body)
{
    double sum = 0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        sum += body->texel_area[i];
    }
    return sum;
}

static bool is_multiple(float value, float step)
{
    return value / step == rintf(value / step);
}

/* Tolerances are the stated steps: barycentrics move by at most 2^-12, areas by 2^-14 each. */
static void surfaces_stay_what_they_are(void **state)
{
    (void)state;
    const parian_env *env = test_env(0);
    parian_body body;
    make_body(env, &body);
    float(*position)[3] = malloc(body.texel_count * sizeof *position);
    double area = area_of(&body);
    assert_non_null(position);
    memcpy(position, body.texel_position, body.texel_count * sizeof *position);
    assert_int_equal(parian_stage_rounding(env, &body), PARIAN_OK);
    assert_true(fabs(area_of(&body) / area - 1) < 1e-5);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        const float *beta = body.texel_barycentric[i];
        assert_true(is_multiple(beta[0], 0x1p-12f) && is_multiple(beta[1], 0x1p-12f));
        assert_true(beta[0] >= 0 && beta[1] >= 0 && beta[0] + beta[1] <= 1);
        for (int k = 0; k < 3; k++) { /* two edges of at most 6 mm, a 4096th each */
            assert_float_equal(body.texel_position[i][k], position[i][k], 2 * 0.006 / 4096);
        }
    }
    for (uint32_t i = 0; i < body.gutter_count; i++) {
        const float *w = body.gutter_weight[i];
        assert_true(w[0] + w[1] + w[2] + w[3] == 1);
        assert_true(w[0] >= 0 && w[1] >= 0 && w[2] >= 0 && w[3] >= 0);
    }
    for (size_t i = 0; i < (size_t)body.triangle_count * 3; i++) {
        const float *n = body.corner_normal[i / 3][i % 3];
        assert_float_equal(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 4e-4);
    }
    body.has_global = false; /* not made yet */
    assert_int_equal(parian_body_check(env, &body, "rounded"), PARIAN_OK);
    free(position);
    parian_body_free(env, &body);
}

static void blend_weights_lose_bits_towards_what_is_safe(void **state)
{
    (void)state;
    parian_half weight[3][3] = {{parian_half_from_float(1.0009765625f),
                                 parian_half_from_float(-1.0009765625f),
                                 parian_half_from_float(-3.99f)},
                                {parian_half_from_float(PARIAN_HALF_MAX), 0, 0x8000}};
    parian_body body = {.texel_count = 1, .blend_weight = &weight};
    parian_round_blend(&body);
    assert_float_equal(parian_half_to_float(weight[0][0]), 1, 0);
    assert_float_equal(parian_half_to_float(weight[0][1]), -1, 0);
    assert_float_equal(parian_half_to_float(weight[0][2]), -3.96875, 0);
    assert_float_equal(parian_half_to_float(weight[1][0]), PARIAN_HALF_MAX, 0);
    assert_true((weight[1][1] & 0x7fff) == 0 && (weight[1][2] & 0x7fff) == 0);
}

static double row_sum(const parian_body *body, uint32_t row, int channel)
{
    const parian_operator *op = &body->operators[0];
    double sum = 0;
    for (uint32_t r = op->run_offset[row]; r < op->run_offset[row + 1]; r++) {
        for (uint32_t k = 0; k < op->run_count[r]; k++) {
            sum += parian_half_to_float(op->factor[op->run_factor[r] + k][channel]);
        }
    }
    return sum * op->scale[row][channel];
}

/* One level, whose factors are all positive: rows keep their sums (of factors here; the rounding
 * keeps those of factors times areas, which differ by a few per cent from vertex to vertex) to a
 * tenth of the threshold, and most factors end with zeros. */
static void factors_keep_rows_and_get_zeros(void **state)
{
    (void)state;
    const parian_env *env = test_env(0);
    parian_global_report report;
    parian_body rounded, full;
    make_body(env, &rounded);
    make_body(env, &full);
    const parian_global_desc by_share = {.hierarchy = PARIAN_HIERARCHY_OFF},
                             all = {.hierarchy = PARIAN_HIERARCHY_OFF, .threshold = -1};
    assert_int_equal(parian_stage_global(env, &by_share, &rounded, &report), PARIAN_OK);
    assert_int_equal(parian_stage_global(env, &all, &full, &report), PARIAN_OK);
    const parian_operator *op = &rounded.operators[0];
    uint64_t short_ones = 0, short_before = 0;
    for (uint64_t i = 0; i < op->factor_total; i++) {
        short_ones += (op->factor[i][1] & 15) == 0;
        assert_true(!(op->factor[i][1] & 0x8000) || op->factor[i][1] == 0x8000);
    }
    for (uint64_t i = 0; i < full.operators[0].factor_total; i++) {
        short_before += (full.operators[0].factor[i][1] & 15) == 0;
    }
    assert_true(2 * short_ones > op->factor_total);
    assert_true(4 * short_before < full.operators[0].factor_total);
    for (uint32_t v = 0; v < rounded.vertex_count; v++) {
        double sum = row_sum(&full, v, 1);
        assert_true(row_sum(&rounded, v, 1) / sum > 1 - 0.002 - 4e-4);
        assert_true(row_sum(&rounded, v, 1) / sum < 1 + 4e-4);
    }
    parian_body_free(env, &rounded);
    parian_body_free(env, &full);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_stay_what_they_are),
        cmocka_unit_test(blend_weights_lose_bits_towards_what_is_safe),
        cmocka_unit_test(factors_keep_rows_and_get_zeros),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
