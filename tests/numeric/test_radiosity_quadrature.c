/* test_radiosity_quadrature.c - B of a baked body against brute-force quadrature over all texels,
 * both ways of the plan, hard media and surfaces, threads.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "bake/stages/texels.h"
#include "bake/stages/transport.h"
#include "support/transport_case.h"

enum { RECEIVERS = 50 };

static void make_surface(const parian_env *env, double size, unsigned cuts, uint32_t atlas,
                         bool bumpy, const parian_medium *medium, parian_body *body)
{
    parian_mesh mesh = {0};
    parian_atlas_desc desc = {.atlas_size = atlas};
    parian_atlas_report report;
    assert_int_equal(test_sphere(env, size / 2, cuts, &mesh), PARIAN_OK);
    if (bumpy) {
        case_bump(&mesh, size / 2);
    }
    case_body(env, &mesh, body);
    parian_mesh_free(env, &mesh);
    body->medium = *medium;
    assert_int_equal(parian_stage_atlas(env, &desc, body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, body), PARIAN_OK);
}

static void bake_transport(const parian_env *env, const parian_plan_desc *plan_desc,
                           parian_body *body, parian_plan *plan, parian_kernels *kernels)
{
    assert_int_equal(parian_stage_plan(env, plan_desc, body, plan), PARIAN_OK);
    assert_int_equal(parian_stage_global(env, NULL, body, NULL), PARIAN_OK);
    assert_int_equal(parian_blend_make(env, body, NULL), PARIAN_OK);
    assert_int_equal(parian_stage_local(env, body), PARIAN_OK);
    assert_int_equal(parian_kernels_build(env, body, kernels), PARIAN_OK);
}

static void check_error(const char *what, const case_error *error, double l2, double energy)
{
    print_message("%-28s l2 %.4f %.4f %.4f energy %.4f %.4f %.4f least %.1e\n", what, error->l2[0],
                  error->l2[1], error->l2[2], error->energy[0], error->energy[1], error->energy[2],
                  error->least);
    for (int c = 0; c < 3; c++) {
        assert_true(error->l2[c] <= l2);
        assert_true(fabs(error->energy[c] - 1) <= energy);
    }
    assert_true(error->least >= -1e-3);
}

static void check_lights(const parian_body *body, const parian_kernels *kernels, double size,
                         const char *what, double smooth, double checker)
{
    static const char *const name[] = {"uniform", "directional", "point", "checker"};
    const parian_env *env = test_env(0);
    case_light light;
    case_light_make(env, body, &light);
    for (int kind = CASE_UNIFORM; kind <= CASE_CHECKER; kind++) {
        char label[96];
        snprintf(label, sizeof label, "%s, %s", what, name[kind]);
        case_illuminate(body, (case_light_kind)kind, size, light.e);
        case_evaluate(env, body, kernels, &light);
        case_error error = case_compare(env, body, &light, RECEIVERS);
        check_error(label, &error, kind == CASE_CHECKER ? checker : smooth, 0.01);
    }
    case_light_free(env, &light);
}

/* The limits that the method promises are 2 % and 5 %; what it reaches, with a margin, is demanded
 * here. */
static void check_medium(const parian_medium *medium, parian_local_form form, double smooth,
                         double checker)
{
    const parian_env *env = test_env(0);
    parian_body body;
    parian_plan plan;
    parian_kernels kernels;
    parian_plan_desc desc = {.local_form = form};
    char what[80];
    make_surface(env, 0.05, 22, 320, true, medium, &body);
    bake_transport(env, &desc, &body, &plan, &kernels);
    assert_true(plan.local && plan.global && body.local_form == form);
    snprintf(what, sizeof what, "%s form %d", medium->name, form);
    check_lights(&body, &kernels, 0.05, what, smooth, checker);
    parian_kernels_free(env, &kernels);
    parian_body_free(env, &body);
}

static void marble_rebuilt(void **state)
{
    (void)state;
    check_medium(&case_marble, PARIAN_LOCAL_REBUILT, 0.01, 0.015);
}

static void marble_bytes(void **state)
{
    (void)state;
    check_medium(&case_marble, PARIAN_LOCAL_U8, 0.01, 0.015);
}

static void marble_split(void **state)
{
    (void)state;
    check_medium(&case_marble, PARIAN_LOCAL_SPLIT, 0.01, 0.025);
}

static void skimmilk_f16(void **state)
{
    (void)state;
    check_medium(&case_skimmilk, PARIAN_LOCAL_F16, 0.01, 0.015);
}

/* A lens 1.5 vertex edges thick in its middle, farther than a window reaches, lit from one side:
 * each side keeps the energy that is its own. Factors prefiltered as if both sides lay in one plane
 * move it from the dark side to the lit one and err by several per cent. */
static void sides_of_a_wall_keep_their_energy(void **state)
{
    (void)state;
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    parian_body body;
    parian_plan plan;
    parian_kernels kernels;
    parian_atlas_desc desc = {.atlas_size = 320};
    parian_atlas_report report;
    parian_plan_desc plan_desc = {.local_form = PARIAN_LOCAL_REBUILT};
    case_light light;
    assert_int_equal(test_sphere(env, 0.012, 22, &mesh), PARIAN_OK);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        mesh.position[v][2] *= 0.03;
    }
    case_body(env, &mesh, &body);
    parian_mesh_free(env, &mesh);
    body.medium = case_marble;
    assert_int_equal(parian_stage_atlas(env, &desc, &body, &report), PARIAN_OK);
    assert_int_equal(parian_stage_texels(env, &body), PARIAN_OK);
    bake_transport(env, &plan_desc, &body, &plan, &kernels);
    case_light_make(env, &body, &light);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        for (int c = 0; c < 3; c++) {
            light.e[i][c] = fmaxf(0, body.texel_normal[i][2]);
        }
    }
    case_evaluate(env, &body, &kernels, &light);
    case_error error = case_compare(env, &body, &light, RECEIVERS);
    check_error("lens lit from one side", &error, 0.025, 0.01); /* measured 0.020; broken 0.068 */
    case_light_free(env, &light);
    parian_kernels_free(env, &kernels);
    parian_body_free(env, &body);
}

/* Change of B, relative L2 over all texels and channels, when a part is left out. */
static double change_of_b(const parian_medium *medium, double size, bool drop_local,
                          bool *plan_drops)
{
    const parian_env *env = test_env(0);
    case_light light[2];
    double sum[2] = {0};
    for (int full = 0; full < 2; full++) {
        parian_body body;
        parian_plan plan;
        parian_kernels kernels;
        parian_plan_desc free_desc = {0}, desc = {0};
        desc.force_local = full || !drop_local;
        desc.force_global = full || drop_local;
        desc.no_local = !full && drop_local;
        desc.no_global = !full && !drop_local;
        make_surface(env, size, 16, 256, false, medium, &body);
        assert_int_equal(parian_stage_plan(env, &free_desc, &body, &plan), PARIAN_OK);
        *plan_drops = drop_local ? !plan.local : !plan.global;
        print_message("%s\n", plan.reason);
        bake_transport(env, &desc, &body, &plan, &kernels);
        case_light_make(env, &body, &light[full]);
        case_illuminate(&body, CASE_CHECKER, size, light[full].e);
        case_evaluate(env, &body, &kernels, &light[full]);
        for (size_t k = 0; full && k < (size_t)body.texel_count * 3; k++) {
            double d = light[0].b[k / 3][k % 3] - light[1].b[k / 3][k % 3],
                   b = light[1].b[k / 3][k % 3];
            sum[0] += body.texel_area[k / 3] * d * d;
            sum[1] += body.texel_area[k / 3] * b * b;
        }
        parian_kernels_free(env, &kernels);
        parian_body_free(env, &body);
    }
    case_light_free(env, &light[0]);
    case_light_free(env, &light[1]);
    print_message("change of B: %.4f\n", sqrt(sum[0] / sum[1]));
    return sqrt(sum[0] / sum[1]);
}

/* What the plan leaves out changes B by 0.5 % at most; where it keeps a part, leaving it out would
 * change more than half of that (or the plan would be too careful). */
static void plan_is_right_about_the_local_part(void **state)
{
    bool drops;
    (void)state;
    assert_true(change_of_b(&case_marble, 0.003, true, &drops) <= 0.005 && drops);
    assert_true(change_of_b(&case_marble, 0.012, true, &drops) > 0.0025 && !drops);
}

static void plan_is_right_about_the_global_part(void **state)
{
    parian_medium dense = case_marble;
    bool drops;
    (void)state;
    assert_true(change_of_b(&dense, 0.05, false, &drops) > 0.0025 && !drops);
    for (int c = 0; c < 3; c++) { /* mean free path of a hundredth of the window */
        dense.sigma_s_prime[c] *= 1000;
        dense.sigma_a[c] *= 10000;
    }
    assert_true(change_of_b(&dense, 0.05, false, &drops) <= 0.005 && drops);
}

/* Move some vertices onto one; the texels of what has no area any more have none either. */
static void collapse_triangles(parian_body *body)
{
    double before[2], (*area)[2] = calloc(body->triangle_count, sizeof *area);
    assert_non_null(area);
    for (int after = 0; after < 2; after++) {
        for (uint32_t t = 0; t < body->triangle_count; t++) {
            const uint32_t *c = body->triangle[t];
            const float(*p)[3] = (const float(*)[3])body->vertex_position;
            area[t][after] = parian_triangle_area(p[c[0]], p[c[1]], p[c[2]]);
        }
        for (uint32_t v = 40; v < 44 && !after; v++) {
            memcpy(body->vertex_position[v], body->vertex_position[39],
                   sizeof *body->vertex_position);
        }
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        memcpy(before, area[body->texel_triangle[i]], sizeof before);
        body->texel_area[i] *= (float)(before[1] / before[0]);
    }
    free(area);
}

/* Finite, not negative, and no more energy than the plane gives back; 10 % for hollows, where R_d
 * by distance also carries light through the air. */
static void check_bounded(const parian_medium *medium, double size, bool paper,
                          parian_local_form form, bool damage)
{
    const parian_env *env = test_env(0);
    parian_body body;
    parian_plan plan;
    parian_kernels kernels;
    parian_plan_desc desc = {.force_local = true, .force_global = true, .local_form = form};
    case_light light;
    desc.paper_form = paper;
    make_surface(env, size, 8, 128, true, medium, &body);
    if (damage) { /* some triangles without area, after the atlas */
        collapse_triangles(&body);
        assert_int_equal(parian_body_derive(env, &body), PARIAN_OK);
    }
    bake_transport(env, &desc, &body, &plan, &kernels);
    case_light_make(env, &body, &light);
    case_illuminate(&body, CASE_UNIFORM, size, light.e);
    case_evaluate(env, &body, &kernels, &light);
    double in[3] = {0}, out[3] = {0};
    for (size_t k = 0; k < (size_t)body.texel_count * 3; k++) {
        assert_true(isfinite(light.b[k / 3][k % 3]));
        in[k % 3] += body.texel_area[k / 3] * light.e[k / 3][k % 3];
        out[k % 3] += body.texel_area[k / 3] * light.b[k / 3][k % 3];
    }
    for (int c = 0; c < 3; c++) {
        parian_dipole d = parian_dipole_make(medium, c, false);
        double limit = paper ? 1e30 : 1.1 * parian_dipole_total(&d) + 1e-6;
        if (!(out[c] / in[c] <= limit)) {
            print_error("size %g, form %d, paper %d, channel %d: energy %.4f, limit %.4f\n", size,
                        form, paper, c, out[c] / in[c], limit);
            fail();
        }
        assert_true(out[c] >= -1e-6 * in[c]);
    }
    case_light_free(env, &light);
    parian_kernels_free(env, &kernels);
    parian_body_free(env, &body);
}

static void hard_cases_stay_bounded(void **state)
{
    static const double sizes[] = {1e-6, 1e-3, 0.05, 10};
    (void)state;
    for (size_t k = 0; k < 4; k++) {
        parian_medium medium = case_marble;
        check_bounded(&medium, sizes[k], false, PARIAN_LOCAL_REBUILT, false);
        check_bounded(&medium, sizes[k], false, PARIAN_LOCAL_SPLIT, false);
        check_bounded(&medium, sizes[k], true, PARIAN_LOCAL_REBUILT, false);
        memset(medium.sigma_a, 0, sizeof medium.sigma_a);
        medium.eta = 1;
        check_bounded(&medium, sizes[k], false, PARIAN_LOCAL_F16, false);
        medium.sigma_s_prime[1] = 0; /* a channel that does not scatter */
        medium.sigma_a[1] = 10;
        check_bounded(&medium, sizes[k], false, PARIAN_LOCAL_U8, true);
    }
}

/* The same bytes for one, two and seven threads. */
static void threads_change_nothing(void **state)
{
    static const unsigned threads[] = {1, 2, 7};
    parian_body body[3];
    parian_kernels kernels[3];
    (void)state;
    for (int k = 0; k < 3; k++) {
        const parian_env *env = test_env(threads[k]);
        parian_plan plan;
        make_surface(env, 0.02, 10, 128, true, &case_marble, &body[k]);
        bake_transport(env, NULL, &body[k], &plan, &kernels[k]);
    }
    for (int k = 1; k < 3; k++) {
        const parian_operator *a = &body[0].operators[0], *b = &body[k].operators[0];
        assert_true(a->factor_total == b->factor_total && a->run_total == b->run_total);
        assert_memory_equal(a->factor, b->factor, a->factor_total * sizeof *a->factor);
        assert_memory_equal(a->scale, b->scale, a->row_count * sizeof *a->scale);
        assert_memory_equal(a->run_column, b->run_column, a->run_total * sizeof *a->run_column);
        assert_memory_equal(body[0].blend_weight, body[k].blend_weight,
                            body[0].texel_count * sizeof *body[0].blend_weight);
        assert_memory_equal(kernels[0].interior, kernels[k].interior,
                            kernels[0].interior_total * sizeof *kernels[0].interior);
        assert_memory_equal(kernels[0].border, kernels[k].border,
                            kernels[0].border_total * sizeof *kernels[0].border);
    }
    for (int k = 0; k < 3; k++) {
        parian_kernels_free(test_env(threads[k]), &kernels[k]);
        parian_body_free(test_env(threads[k]), &body[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marble_rebuilt),
        cmocka_unit_test(marble_bytes),
        cmocka_unit_test(marble_split),
        cmocka_unit_test(skimmilk_f16),
        cmocka_unit_test(sides_of_a_wall_keep_their_energy),
        cmocka_unit_test(plan_is_right_about_the_local_part),
        cmocka_unit_test(plan_is_right_about_the_global_part),
        cmocka_unit_test(hard_cases_stay_bounded),
        cmocka_unit_test(threads_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
