/* test_global_levels.c - coarse levels of the global part: interpolation, and the operators
 * together against one level.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/global_coarse.h"
#include "bake/stages/texels.h"
#include "bake/stages/transport.h"
#include "core/body_schema.h"
#include "support/transport_case.h"

enum { IMPULSES = 40 };

static void make_surface(const parian_env *env, unsigned cuts, parian_local_form form,
                         parian_body *body)
{
    parian_mesh mesh = {0};
    parian_atlas_desc desc = {.atlas_size = 192};
    parian_atlas_report report;
    assert_int_equal(test_sphere(env, 0.025, cuts, &mesh), PARIAN_OK);
    case_bump(&mesh, 0.025);
    case_body(env, &mesh, body);
    parian_mesh_free(env, &mesh);
    body->medium = case_marble;
    assert_int_equal(parian_stage_atlas(env, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, body), PARIAN_OK);
    body->local_form = form;
    body->has_global = true;
    body->split_radius_m = form == PARIAN_LOCAL_SPLIT ? 1e-3f : 0;
}

static void bake_global(const parian_env *env, parian_hierarchy hierarchy, parian_body *body,
                        parian_global_report *report)
{
    parian_global_desc desc = {.hierarchy = hierarchy};
    assert_int_equal(parian_stage_global(env, &desc, body, report), PARIAN_OK);
}

static void apply(const parian_body *body, uint32_t first, const float (*flux)[3], float (*b)[3])
{
    memset(b, 0, body->vertex_count * sizeof *b);
    assert_int_equal(parian_operators_apply(test_env(0), body->operators + first,
                                            body->operator_count - first, flux, b),
                     PARIAN_OK);
}

/* Weights are shares, exact as halfs, of points on the same side: on a sheet a tenth of an edge
 * thick, the other side's points are the nearest of all. */
static void interpolation_stays_on_its_side(void **state)
{
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    parian_body body;
    parian_vertex_frame frame;
    parian_coarse coarse;
    (void)state;
    assert_int_equal(test_sphere(env, 1, 20, &mesh), PARIAN_OK);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        mesh.position[v][2] *= 0.005;
    }
    case_body(env, &mesh, &body);
    parian_mesh_free(env, &mesh);
    assert_int_equal(parian_vertex_frame_make(env, &body, &frame), PARIAN_OK);
    assert_int_equal(parian_coarse_make(env, &body, &frame, NULL, body.vertex_count, 0.1, &coarse),
                     PARIAN_OK);
    assert_true(coarse.count > body.vertex_count / 12 && coarse.count < body.vertex_count / 2);
    double off = 0;
    for (uint32_t i = 0; i < body.vertex_count; i++) {
        double sum = 0, centre[2] = {0};
        for (int k = 0; k < 3; k++) {
            float weight = coarse.weight[i][k];
            uint32_t v = coarse.vertex[coarse.near[i][k]];
            assert_true(weight >= 0 && weight * 2048 == floorf(weight * 2048));
            sum += weight;
            centre[0] += weight * body.vertex_position[v][0];
            centre[1] += weight * body.vertex_position[v][1];
            if (weight > 0) {
                assert_true(frame.normal[v][2] * frame.normal[i][2] > 0 ||
                            fabsf(frame.normal[i][2]) < 0.8f);
            }
        }
        assert_true(sum == 1);
        const float *x = body.vertex_position[i];
        if (x[0] * x[0] + x[1] * x[1] < 0.64f) {
            off = fmax(off, hypot(centre[0] - x[0], centre[1] - x[1]));
        }
    }
    assert_true(off < 2e-3); /* linear functions are reproduced; 2 % of the reach for curvature */
    parian_coarse_free(env, &coarse);
    parian_vertex_frame_free(env, &frame);
    parian_body_free(env, &body);
}

/* Impulses: nothing below zero, energy as with one level (the threshold is 0.4 % of a row; what is
 * dropped has both signs), near vertices not reached by coarse points at all. */
static void check_impulses(const parian_body *one, const parian_body *many)
{
    uint32_t count = one->vertex_count;
    float(*flux)[3] = calloc(count, sizeof *flux), (*a)[3] = calloc(count, sizeof *a);
    float(*b)[3] = calloc(count, sizeof *b), (*far)[3] = calloc(count, sizeof *far);
    assert_true(flux && a && b && far);
    for (uint32_t n = 0; n < IMPULSES; n++) {
        uint32_t u = (uint32_t)((uint64_t)count * n / IMPULSES);
        double energy[2] = {0}, most = 0, least = 0;
        flux[u][0] = flux[u][1] = flux[u][2] = 1;
        apply(one, 0, (const float(*)[3])flux, a);
        apply(many, 0, (const float(*)[3])flux, b);
        apply(many, 1, (const float(*)[3])flux, far);
        for (uint32_t v = 0; v < count; v++) {
            energy[0] += a[v][1];
            energy[1] += b[v][1];
            most = fmax(most, b[v][1]);
            least = fmin(least, fmin(b[v][0], fmin(b[v][1], b[v][2])));
            assert_true(far[v][0] >= 0);
        }
        assert_true(least >= -1e-6 * most); /* rounding of sums */
        assert_true(fabs(energy[1] / energy[0] - 1) < 0.01);
        assert_true(far[u][0] == 0 && far[u][1] == 0 && far[u][2] == 0);
        flux[u][0] = flux[u][1] = flux[u][2] = 0;
    }
    free(flux);
    free(a);
    free(b);
    free(far);
}

/* Smooth and striped flux: relative L2 between the two. */
static void check_flux(const parian_body *one, const parian_body *many)
{
    uint32_t count = one->vertex_count;
    float(*flux)[3] = calloc(count, sizeof *flux), (*a)[3] = calloc(count, sizeof *a);
    float(*b)[3] = calloc(count, sizeof *b);
    assert_true(flux && a && b);
    for (int kind = 0; kind < 3; kind++) {
        double error = 0, whole = 0;
        for (uint32_t v = 0; v < count; v++) {
            float x = one->vertex_position[v][0];
            float e = kind == 0 ? 1 : kind == 1 ? (float)(x > 0) : (float)((int)(x * 400 + 99) & 1);
            flux[v][0] = flux[v][1] = flux[v][2] = e;
        }
        apply(one, 0, (const float(*)[3])flux, a);
        apply(many, 0, (const float(*)[3])flux, b);
        for (uint32_t v = 0; v < 3 * count; v++) {
            double x = a[v / 3][v % 3], y = b[v / 3][v % 3];
            error += (x - y) * (x - y);
            whole += x * x;
        }
        print_message("flux %d: relative L2 %.5f\n", kind, sqrt(error / whole));
        assert_true(sqrt(error / whole) < 0.004); /* measured 0.0015; what is dropped is 0.004 */
    }
    free(flux);
    free(a);
    free(b);
}

static void compare_forms(parian_local_form form)
{
    const parian_env *env = test_env(0);
    parian_body one, many;
    parian_global_report report;
    make_surface(env, 17, form, &one);
    make_surface(env, 17, form, &many);
    bake_global(env, PARIAN_HIERARCHY_OFF, &one, &report);
    assert_true(one.operator_count == 1 && report.level_count == 0);
    uint64_t factors = report.factor_count;
    bake_global(env, PARIAN_HIERARCHY_AUTO, &many, &report);
    print_message("%llu factors, then %llu: %s\n", (unsigned long long)factors,
                  (unsigned long long)report.factor_count, report.hierarchy);
    assert_true(report.level_count >= 1 && many.operator_count == 1 + 3 * report.level_count);
    assert_true(report.factor_count < factors / 3);
    assert_int_equal(parian_operators_check(env, &many, "levels"), PARIAN_OK);
    check_impulses(&one, &many);
    check_flux(&one, &many);
    parian_body_free(env, &one);
    parian_body_free(env, &many);
}

static void levels_agree_with_one_level(void **state)
{
    (void)state;
    compare_forms(PARIAN_LOCAL_REBUILT);
}

static void levels_agree_without_a_local_part(void **state)
{
    (void)state;
    compare_forms(PARIAN_LOCAL_NONE);
}

static void levels_agree_with_a_split(void **state)
{
    (void)state;
    compare_forms(PARIAN_LOCAL_SPLIT);
}

/* Without a local part the diagonal takes what was dropped: uniform flux density gives each vertex
 * its total, but for the rounding of halfs. */
static void rows_sum_to_their_totals(void **state)
{
    const parian_env *env = test_env(0);
    parian_body body;
    parian_vertex_frame frame;
    parian_transport_model model;
    (void)state;
    make_surface(env, 17, PARIAN_LOCAL_NONE, &body);
    bake_global(env, PARIAN_HIERARCHY_AUTO, &body, NULL);
    uint32_t count = body.vertex_count;
    float(*flux)[3] = calloc(count, sizeof *flux), (*b)[3] = calloc(count, sizeof *b);
    float(*total)[3] = calloc(count, sizeof *total);
    assert_true(flux && b && total);
    assert_int_equal(parian_vertex_frame_make(env, &body, &frame), PARIAN_OK);
    assert_int_equal(parian_transport_model_make(env, &body, PARIAN_MODEL_FULL, &model), PARIAN_OK);
    assert_int_equal(parian_vertex_totals(env, &body, &model, &frame, false, total), PARIAN_OK);
    for (uint32_t v = 0; v < count; v++) {
        flux[v][0] = flux[v][1] = flux[v][2] = frame.area[v];
    }
    apply(&body, 0, (const float(*)[3])flux, b);
    double worst = 0;
    for (uint32_t v = 0; v < 3 * count; v++) {
        worst = fmax(worst, fabs(b[v / 3][v % 3] / total[v / 3][v % 3] - 1));
    }
    print_message("rows deviate from their totals by %.1e at most\n", worst);
    assert_true(worst < 5e-4); /* half of 2^-10 */
    free(flux);
    free(b);
    free(total);
    parian_transport_model_free(env, &model);
    parian_vertex_frame_free(env, &frame);
    parian_body_free(env, &body);
}

/* Column sums are the transpose of the application: <w, A x> = <A^T w, x>. */
static void column_sums_are_the_transpose(void **state)
{
    const parian_env *env = test_env(0);
    parian_body body;
    (void)state;
    make_surface(env, 14, PARIAN_LOCAL_REBUILT, &body);
    bake_global(env, PARIAN_HIERARCHY_ON, &body, NULL);
    assert_true(body.operator_count > 1);
    uint32_t count = body.vertex_count;
    float(*flux)[3] = calloc(count, sizeof *flux), (*b)[3] = calloc(count, sizeof *b);
    float *weight = calloc(count, sizeof *weight);
    double(*sum)[3] = calloc(count, sizeof *sum), there[3] = {0}, back[3] = {0};
    assert_true(flux && b && weight && sum);
    for (uint32_t v = 0; v < count; v++) {
        weight[v] = (float)(1 + v % 7);
        for (int c = 0; c < 3; c++) {
            flux[v][c] = (float)(1 + (v * 5 + (uint32_t)c) % 11);
        }
    }
    apply(&body, 0, (const float(*)[3])flux, b);
    assert_int_equal(
        parian_operators_column_sums(env, body.operators, body.operator_count, weight, sum),
        PARIAN_OK);
    for (uint32_t v = 0; v < 3 * count; v++) {
        there[v % 3] += (double)weight[v / 3] * b[v / 3][v % 3];
        back[v % 3] += sum[v / 3][v % 3] * flux[v / 3][v % 3];
    }
    for (int c = 0; c < 3; c++) {
        assert_true(fabs(there[c] / back[c] - 1) < 1e-5);
    }
    free(flux);
    free(b);
    free(weight);
    free(sum);
    parian_body_free(env, &body);
}

/* Between vertices of triangles in each other's window or ring, coarse points carry nothing: blend
 * and kernels are made from the first operator alone. */
static void windows_see_complete_factors(void **state)
{
    const parian_env *env = test_env(0);
    parian_body body;
    (void)state;
    make_surface(env, 17, PARIAN_LOCAL_REBUILT, &body);
    bake_global(env, PARIAN_HIERARCHY_AUTO, &body, NULL);
    assert_true(body.operator_count > 1);
    float(*flux)[3] = calloc(body.vertex_count, sizeof *flux);
    float(*far)[3] = calloc(body.vertex_count, sizeof *far);
    assert_true(flux && far);
    int32_t side = (int32_t)body.atlas_size;
    for (uint32_t n = 0; n < 4 * IMPULSES; n++) {
        uint32_t i = (uint32_t)((uint64_t)body.texel_count * n / (4 * IMPULSES));
        uint32_t u = body.triangle[body.texel_triangle[i]][n % 3], border = body.texel_border[i];
        uint32_t at = body.texel_index[i];
        flux[u][0] = flux[u][1] = flux[u][2] = 1;
        apply(&body, 1, (const float(*)[3])flux, far);
        flux[u][0] = flux[u][1] = flux[u][2] = 0;
        for (int32_t k = 0; k < 121 && border == PARIAN_NO_BORDER; k++) {
            int32_t x = (int32_t)at % side + k % 11 - 5, y = (int32_t)at / side + k / 11 - 5;
            uint32_t o = x >= 0 && y >= 0 && x < side && y < side ? body.texel_at[y * side + x]
                                                                  : PARIAN_NO_BORDER;
            uint32_t t = o == PARIAN_NO_BORDER ? body.texel_triangle[i] : body.texel_triangle[o];
            if (body.triangle_chart[t] == body.triangle_chart[body.texel_triangle[i]]) {
                assert_true(far[body.triangle[t][k % 3]][1] == 0);
            }
        }
        for (uint32_t k = border == PARIAN_NO_BORDER ? 0 : body.border_offset[border];
             border != PARIAN_NO_BORDER && k < body.border_offset[border + 1]; k++) {
            uint32_t t = body.texel_triangle[body.border_neighbour[k]];
            assert_true(far[body.triangle[t][k % 3]][1] == 0);
        }
    }
    free(flux);
    free(far);
    parian_body_free(env, &body);
}

/* Models without symmetry, small bodies, the paper's form. */
static void other_bodies(void **state)
{
    const parian_env *env = test_env(0);
    parian_body body;
    parian_global_report report;
    (void)state;
    make_surface(env, 17, PARIAN_LOCAL_REBUILT, &body);
    body.bssrdf = PARIAN_BSSRDF_DIPOLE_FLUX;
    bake_global(env, PARIAN_HIERARCHY_OFF, &body, &report);
    uint64_t factors = report.factor_count;
    bake_global(env, PARIAN_HIERARCHY_AUTO, &body, &report);
    assert_true(report.level_count >= 1 && report.factor_count < factors / 2);
    body.bssrdf = PARIAN_BSSRDF_DIPOLE;
    body.paper_form = true;
    bake_global(env, PARIAN_HIERARCHY_AUTO, &body, &report);
    assert_true(report.level_count == 0 && body.operator_count == 1);
    parian_body_free(env, &body);
    make_surface(env, 5, PARIAN_LOCAL_REBUILT, &body);
    bake_global(env, PARIAN_HIERARCHY_AUTO, &body, &report);
    assert_true(report.level_count == 0);
    bake_global(env, PARIAN_HIERARCHY_ON, &body, &report);
    assert_true(report.level_count == 1);
    assert_int_equal(parian_operators_check(env, &body, "forced"), PARIAN_OK);
    parian_body_free(env, &body);
}

/* The same bytes for one, two and seven threads. */
static void threads_change_nothing(void **state)
{
    static const unsigned threads[] = {1, 2, 7};
    parian_body body[3];
    (void)state;
    for (int k = 0; k < 3; k++) {
        make_surface(test_env(threads[k]), 11, PARIAN_LOCAL_NONE, &body[k]);
        bake_global(test_env(threads[k]), PARIAN_HIERARCHY_ON, &body[k], NULL);
    }
    for (int k = 1; k < 3; k++) {
        assert_true(body[0].operator_count > 1 && body[k].operator_count == body[0].operator_count);
        for (uint32_t o = 0; o < body[0].operator_count; o++) {
            const parian_operator *a = &body[0].operators[o], *b = &body[k].operators[o];
            assert_true(a->factor_total == b->factor_total && a->run_total == b->run_total);
            assert_memory_equal(a->factor, b->factor, a->factor_total * sizeof *a->factor);
            assert_memory_equal(a->scale, b->scale, a->row_count * sizeof *a->scale);
            assert_memory_equal(a->run_column, b->run_column, a->run_total * sizeof *a->run_column);
        }
    }
    for (int k = 0; k < 3; k++) {
        parian_body_free(test_env(threads[k]), &body[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interpolation_stays_on_its_side),
        cmocka_unit_test(levels_agree_with_one_level),
        cmocka_unit_test(levels_agree_without_a_local_part),
        cmocka_unit_test(levels_agree_with_a_split),
        cmocka_unit_test(rows_sum_to_their_totals),
        cmocka_unit_test(column_sums_are_the_transpose),
        cmocka_unit_test(windows_see_complete_factors),
        cmocka_unit_test(other_bodies),
        cmocka_unit_test(threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
