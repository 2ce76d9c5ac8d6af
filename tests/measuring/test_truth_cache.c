/* test_truth_cache.c - receivers among texels, the names of truths, and truths that are kept.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/reference/reference_scene.h"
#include "core/memory.h"
#include "core/random.h"
#include "support/test_support.h"
#include "tests/measure/nearest_point.h"
#include "tests/measure/truth.h"

/* ---- texels
 * ---------------------------------------------------------------------------------------------------
 */
enum { SIDE = 60, TEXELS = SIDE * SIDE };
typedef struct texels {
    float position[TEXELS][3], area[TEXELS];
    double whole;
} texels;

/* A square of texels; those of the left half are three times as large in area. */
static texels *make_texels(void)
{
    texels *t = calloc(1, sizeof *t);
    for (int i = 0; i < TEXELS; i++) {
        t->position[i][0] = (float)(i % SIDE);
        t->position[i][1] = (float)(i / SIDE);
        t->area[i] = i % SIDE < SIDE / 2 ? 3e-6f : 1e-6f;
        t->whole += t->area[i];
    }
    return t;
}

static void test_choice_is_by_area(void **state)
{
    (void)state;
    texels *t = make_texels();
    for (uint64_t seed = 0; seed < 3; seed++) {
        parian_texel_choice choice;
        assert_int_equal(parian_texels_choose(NULL, (const float(*)[3])t->position, t->area, TEXELS,
                                              400, seed, &choice),
                         PARIAN_OK);
        double sum = 0, left = 0;
        for (size_t i = 0; i < choice.count; i++) {
            sum += choice.area[i];
            left += choice.texel[i] % SIDE < SIDE / 2 ? choice.area[i] : 0;
        }
        assert_int_equal(choice.count, 400); /* no texel is larger than a share */
        assert_true(fabs(sum / t->whole - 1) < 1e-12);
        /* Three quarters of the area, met to a few shares: systematic along a curve that crosses
         * the middle often, each crossing costing at most one share; at random it would be 8.7 of
         * 400 in one standard deviation. */
        assert_true(fabs(left / t->whole - 0.75) < 0.02);
        parian_texel_choice_free(NULL, &choice);
    }
    free(t);
}

static void test_choice_covers(void **state)
{
    (void)state;
    texels *t = make_texels();
    parian_texel_choice choice;
    assert_int_equal(
        parian_texels_choose(NULL, (const float(*)[3])t->position, t->area, TEXELS, 0, 0, &choice),
        PARIAN_OK);
    assert_int_equal(choice.count, TEXELS);
    parian_texel_choice_free(NULL, &choice);
    /* 900 choices among 60 x 60: no block of 12 x 12 texels is missed. */
    bool met[25] = {false};
    assert_int_equal(parian_texels_choose(NULL, (const float(*)[3])t->position, t->area, TEXELS,
                                          900, 1, &choice),
                     PARIAN_OK);
    for (size_t i = 0; i < choice.count; i++) {
        met[choice.texel[i] / SIDE / 12 * 5 + choice.texel[i] % SIDE / 12] = true;
    }
    for (int b = 0; b < 25; b++) {
        assert_true(met[b]);
    }
    parian_texel_choice_free(NULL, &choice);
    /* A texel larger than a share stands for several. */
    t->area[100] = 1;
    assert_int_equal(
        parian_texels_choose(NULL, (const float(*)[3])t->position, t->area, TEXELS, 50, 1, &choice),
        PARIAN_OK);
    double sum = 0;
    for (size_t i = 0; i < choice.count; i++) {
        sum += choice.area[i];
    }
    assert_true(choice.count < 50 && fabs(sum / (t->whole + 1 - 1e-6) - 1) < 1e-6);
    parian_texel_choice_free(NULL, &choice);
    free(t);
}

static void test_nearest_is_brute_force(void **state)
{
    (void)state;
    enum { POINTS = 700, QUERIES = 900 };
    static float point[POINTS][3], query[QUERIES][3];
    static uint32_t nearest[QUERIES];
    parian_random random = parian_random_stream(5, 0, 0, 0);
    for (int i = 0; i < POINTS * 3; i++) {
        point[i / 3][i % 3] = (float)parian_random_unit(&random) * (i % 3 == 1 ? 0.01f : 1);
    }
    for (int i = 0; i < QUERIES * 3; i++) { /* some outside of the points' box */
        query[i / 3][i % 3] = (float)(1.4 * parian_random_unit(&random) - 0.2);
    }
    assert_int_equal(parian_nearest_points(test_env(0), (const float(*)[3])point, POINTS,
                                           (const float(*)[3])query, QUERIES, nearest),
                     PARIAN_OK);
    for (int q = 0; q < QUERIES; q++) {
        double best = INFINITY, got = 0;
        for (uint32_t p = 0; p < POINTS; p++) {
            double square = 0;
            for (int c = 0; c < 3; c++) {
                double d = (double)point[p][c] - query[q][c];
                square += d * d;
            }
            best = fmin(best, square);
            got = p == nearest[q] ? square : got;
        }
        assert_true(got == best);
    }
    assert_int_equal(parian_nearest_points(NULL, (const float(*)[3])point, 0,
                                           (const float(*)[3])query, 1, nearest),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_nearest_points(NULL, (const float(*)[3])point, 1,
                                           (const float(*)[3])query, 5, nearest),
                     PARIAN_OK);
    assert_int_equal(nearest[4], 0);
}

/* ---- truths
 * ---------------------------------------------------------------------------------------------------
 */
typedef struct truth_case {
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_truth_desc desc;
} truth_case;

static const parian_medium MEDIUM = {
    .sigma_s_prime = {300, 400, 500}, .sigma_a = {1, 2, 4}, .eta = 1.4, .reduced_only = true};

static void make_case(truth_case *t)
{
    parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}};
    parian_reference_body *body = NULL;
    *t = (truth_case){.desc = {.model = PARIAN_REFERENCE_DIPOLE, .samples = 2000}};
    assert_true(PARIAN_NEW0(NULL, body, 1));
    assert_int_equal(test_sphere(NULL, 0.01, 6, &body->mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(NULL, &body->mesh, 50), PARIAN_OK);
    body->medium = MEDIUM;
    body->closed = true;
    assert_int_equal(parian_reference_scene_make(NULL, body, 1, NULL, 0, &light, 1, &t->scene),
                     PARIAN_OK);
    assert_int_equal(parian_receivers_spread(NULL, &t->scene, 20, 0, &t->receivers), PARIAN_OK);
}

static void free_case(truth_case *t)
{
    parian_receivers_free(NULL, &t->receivers);
    parian_reference_scene_free(NULL, &t->scene);
}

static void name_case(const truth_case *t, char name[PARIAN_TRUTH_NAME_MAX])
{
    assert_int_equal(parian_truth_name(NULL, &t->scene, &t->receivers, &t->desc, name), PARIAN_OK);
}

/* Whatever a truth depends on changes its name; what it does not depend on leaves it. */
static void test_names(void **state)
{
    (void)state;
    truth_case t;
    char plain[PARIAN_TRUTH_NAME_MAX], name[PARIAN_TRUTH_NAME_MAX];
    static const float pixel[2][3] = {{1, 2, 3}, {4, 5, 6}};
    make_case(&t);
    name_case(&t, plain);
    strcpy(t.scene.bodies[0].name, "another");
    strcpy(t.scene.bodies[0].medium.name, "another");
    t.desc.cache = "elsewhere";
    name_case(&t, name);
    assert_string_equal(name, plain);
#define CHANGES(lvalue, value)                                                                     \
    do {                                                                                           \
        __typeof__(lvalue) kept = (lvalue);                                                        \
        (lvalue) = (value);                                                                        \
        name_case(&t, name);                                                                       \
        assert_string_not_equal(name, plain);                                                      \
        (lvalue) = kept;                                                                           \
        name_case(&t, name);                                                                       \
        assert_string_equal(name, plain);                                                          \
    } while (0)
    CHANGES(t.desc.samples, 2001);
    CHANGES(t.desc.seed, 1);
    CHANGES(t.desc.model, PARIAN_REFERENCE_PBD);
    CHANGES(t.desc.fit_fdr, true);
    CHANGES(t.desc.normalise, true);
    CHANGES(t.desc.standard_error, 0.01);
    CHANGES(t.scene.bodies[0].medium.eta, 1.5);
    CHANGES(t.scene.bodies[0].medium.g[2], 0.1);
    CHANGES(t.scene.bodies[0].medium.reduced_only, !t.scene.bodies[0].medium.reduced_only);
    CHANGES(t.scene.bodies[0].mesh.corner_normal[5][1][2], 2.0f);
    CHANGES(t.scene.bodies[0].medium.sigma_a[1], 2.0000001);
    CHANGES(t.scene.bodies[0].mesh.position[7][2], 0.00999);
    CHANGES(t.scene.bodies[0].mesh.triangle[3][1], 0);
    CHANGES(t.scene.lights[0].color[1], 1.5f);
    CHANGES(t.scene.lights[0].direction[0], 0.1f);
    CHANGES(t.scene.lights[0].position[2], 1.0f);
    CHANGES(t.scene.lights[0].up[1], 1.0f);
    CHANGES(t.scene.lights[0].axis_u[0], 1.0f);
    CHANGES(t.scene.lights[0].axis_v[0], 1.0f);
    CHANGES(t.scene.lights[0].inner_deg, 1.0f);
    CHANGES(t.scene.lights[0].outer_deg, 1.0f);
    CHANGES(t.scene.lights[0].rotation_deg, 1.0f);
    CHANGES(t.scene.lights[0].type, PARIAN_LIGHT_POINT);
    CHANGES(t.scene.light_count, 0);
    CHANGES(t.receivers.position[3][0], 0.001);
    CHANGES(t.receivers.triangle[3], 1);
    CHANGES(t.receivers.count, 19);
    CHANGES(t.receivers.normal[3][0], 2.0);
    CHANGES(t.receivers.smooth_normal[3][0], 2.0);
    CHANGES(t.receivers.area[3], 2.0);
    CHANGES(t.receivers.barycentric[3][1], 2.0);
    parian_mesh around = {0};
    assert_int_equal(test_plane(NULL, 1, 1, &around), PARIAN_OK);
    t.scene.surroundings = &around;
    CHANGES(t.scene.surrounding_count, 1);
    t.scene.surrounding_count = 1;
    name_case(&t, plain);
    CHANGES(around.position[0][0], 3.0);
    t.scene.surroundings = NULL;
    t.scene.surrounding_count = 0;
    parian_mesh_free(NULL, &around);
    float sigma[2][8][3] = {{{1, 1, 1}}};
    parian_medium_field field = {
        .size = {2, 2, 2}, .upper = {1, 1, 1}, .sigma_s = sigma[0], .sigma_a = sigma[1]};
    name_case(&t, plain);
    CHANGES(t.scene.bodies[0].field, &field);
    t.scene.bodies[0].field = &field;
    name_case(&t, plain);
    CHANGES(field.size[1], 1);
    CHANGES(field.lower[1], -1);
    CHANGES(field.upper[2], 2);
    CHANGES(sigma[0][7][2], 1.0f);
    CHANGES(sigma[1][7][2], 1.0f);
    t.scene.bodies[0].field = NULL;
    t.scene.lights[0].image = (parian_light_image){2, 1, pixel};
    name_case(&t, plain);
    static const float other[2][3] = {{1, 2, 3}, {4, 5, 7}};
    t.scene.lights[0].image.pixel = other; /* the picture's bytes count */
    name_case(&t, name);
    assert_string_not_equal(name, plain);
    t.scene.lights[0].image = (parian_light_image){0};
    free_case(&t);
}

static void test_kept_truth_is_the_same(void **state)
{
    (void)state;
    truth_case t;
    parian_reference_result first, second, third;
    bool cached;
    char folder[512], name[PARIAN_TRUTH_NAME_MAX], path[1024];
    make_case(&t);
    snprintf(folder, sizeof folder, "%s", test_scratch("kept"));
    t.desc.cache = folder;
    name_case(&t, name);
    snprintf(path, sizeof path, "%s/%s.parian", folder, name);
    remove(path);
    assert_int_equal(
        parian_truth_get(test_env(0), &t.scene, &t.receivers, &t.desc, &first, &cached), PARIAN_OK);
    assert_false(cached);
    assert_int_equal(
        parian_truth_get(test_env(0), &t.scene, &t.receivers, &t.desc, &second, &cached),
        PARIAN_OK);
    assert_true(cached);
    size_t size = t.receivers.count * sizeof *first.radiosity;
    assert_memory_equal(first.radiosity, second.radiosity, size);
    assert_memory_equal(first.irradiance, second.irradiance, size);
    assert_memory_equal(first.standard_error, second.standard_error, size);
    assert_true(first.samples == second.samples && first.seconds == second.seconds);
    assert_true(first.radiosity[0][0] >= 0 && isfinite(first.radiosity[0][0]));
    /* A damaged file is computed anew, to the same numbers. */
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, -40, SEEK_END);
    fputs("damage", file);
    fclose(file);
    assert_int_equal(
        parian_truth_get(test_env(0), &t.scene, &t.receivers, &t.desc, &third, &cached), PARIAN_OK);
    assert_false(cached);
    assert_memory_equal(first.radiosity, third.radiosity, size);
    parian_reference_result_free(NULL, &first);
    parian_reference_result_free(NULL, &second);
    parian_reference_result_free(NULL, &third);
    free_case(&t);
}

/* The file carries every field, and is refused for another count. */
static void test_file(void **state)
{
    (void)state;
    parian_reference_result made, read;
    const char *path = test_scratch("truth.parian");
    assert_int_equal(parian_reference_result_init(NULL, 5, true, &made), PARIAN_OK);
    for (int i = 0; i < 15; i++) {
        made.irradiance[i / 3][i % 3] = 1 + i;
        made.radiosity[i / 3][i % 3] = 0.1 * i;
        made.standard_error[i / 3][i % 3] = 1e-3 * i;
        made.unscattered[i / 3][i % 3] = 1e-9 * i;
    }
    made.samples = UINT64_C(1) << 40;
    made.seconds = 3.25;
    made.scattering_events = 77;
    made.in[0] = 1;
    made.out[1] = 2;
    made.absorbed[2] = 3;
    made.roulette_added[0] = 4;
    made.roulette_removed[1] = 5;
    made.lost[2] = 6;
    assert_int_equal(parian_truth_save(NULL, path, 5, &made), PARIAN_OK);
    assert_true(parian_truth_load(NULL, path, 5, &read));
    assert_memory_equal(made.radiosity, read.radiosity, sizeof *made.radiosity * 5);
    assert_memory_equal(made.unscattered, read.unscattered, sizeof *made.radiosity * 5);
    assert_true(read.samples == made.samples && read.seconds == 3.25 &&
                read.scattering_events == 77);
    assert_true(read.in[0] == 1 && read.out[1] == 2 && read.absorbed[2] == 3 &&
                read.roulette_added[0] == 4 && read.roulette_removed[1] == 5 && read.lost[2] == 6 &&
                read.lost[0] == 0);
    parian_reference_result_free(NULL, &read);
    assert_false(parian_truth_load(NULL, path, 6, &read));
    assert_null(read.radiosity);
    assert_false(parian_truth_load(NULL, test_scratch("absent.parian"), 5, &read));
    parian_reference_result_free(NULL, &made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_choice_is_by_area),      cmocka_unit_test(test_choice_covers),
        cmocka_unit_test(test_nearest_is_brute_force), cmocka_unit_test(test_names),
        cmocka_unit_test(test_kept_truth_is_the_same), cmocka_unit_test(test_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
