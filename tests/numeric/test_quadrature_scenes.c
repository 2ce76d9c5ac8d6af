/* test_quadrature_scenes.c - the quadrature where bodies, lights of extent and options meet: each
 * against a closed form or a ratio in which the noise cancels.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "bake/reference/half_space.h"
#include "bake/reference/reference_scene.h"
#include "bake/reference/surface_quadrature.h"
#include "bake/reference/surface_strata.h"
#include "core/dipole.h"
#include "core/fresnel.h"
#include "core/memory.h"
#include "core/small_maths.h"

/* On a plane 0.2 m wide both are endless: sigma_tr is above 250 per metre. */
static const parian_medium low_index = {.name = "low",
                                        .sigma_s_prime = {740, 880, 1010},
                                        .sigma_a = {32, 170, 480},
                                        .eta = 1.3,
                                        .reduced_only = true};
static const parian_medium high_index = {.name = "high",
                                         .sigma_s_prime = {500, 600, 700},
                                         .sigma_a = {100, 50, 40},
                                         .eta = 2,
                                         .reduced_only = true};
static const parian_light down = {
    .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 2, 0.5f}};
static const parian_light sky = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 0.5f, 2}};

/* Planes side by side, the first around the origin, each of its own medium. */
static void plane_scene(const parian_medium *const *medium, uint32_t count,
                        const parian_light *light, parian_reference_scene *scene)
{
    parian_reference_body *body;
    assert_true(PARIAN_NEW0(NULL, body, count));
    for (uint32_t b = 0; b < count; b++) {
        assert_int_equal(test_plane(NULL, 0.2, 64, &body[b].mesh), PARIAN_OK);
        for (uint32_t v = 0; v < body[b].mesh.vertex_count; v++) {
            body[b].mesh.position[v][0] += 0.3 * b;
        }
        assert_int_equal(parian_mesh_make_corner_normals(NULL, &body[b].mesh, 50), PARIAN_OK);
        body[b].medium = *medium[b];
    }
    memset(scene, 0, sizeof *scene);
    assert_int_equal(parian_reference_scene_make(NULL, body, count, NULL, 0, light, 1, scene),
                     PARIAN_OK);
}

static void solve(const parian_reference_scene *scene, const parian_receivers *receivers,
                  const parian_bssrdf_desc *bssrdf, uint64_t seed, parian_reference_result *result)
{
    const parian_reference_quadrature_desc desc = {.bssrdf = *bssrdf, .seed = seed};
    assert_int_equal(parian_reference_quadrature(test_env(0), scene, receivers, &desc, result),
                     PARIAN_OK);
}

static void at_points(const parian_reference_scene *scene, const double (*point)[3], size_t count,
                      parian_receivers *receivers)
{
    memset(receivers, 0, sizeof *receivers);
    assert_int_equal(parian_receivers_nearest(NULL, scene, point, count, receivers), PARIAN_OK);
}

/* Two planes of different indices and coefficients under one light: E and B of each are those of
 * its own medium, and what enters is E times the area, which is exact here. */
static void bodies_keep_their_own_media(void **state)
{
    (void)state;
    const parian_medium *const media[2] = {&low_index, &high_index};
    const double point[2][3] = {{0.001, 0.002, 0}, {0.301, -0.002, 0}};
    const parian_bssrdf_desc dipole = {.model = PARIAN_REFERENCE_DIPOLE};
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result;
    plane_scene(media, 2, &down, &scene);
    at_points(&scene, point, 2, &receivers);
    solve(&scene, &receivers, &dipole, 0, &result);
    for (int c = 0; c < 3; c++) {
        double in = 0;
        for (uint32_t b = 0; b < 2; b++) {
            parian_dipole d = parian_dipole_make(media[b], c, false);
            double e = down.color[c] * parian_fresnel_transmittance(1, media[b]->eta);
            in += e * 0.2 * 0.2;
            assert_int_equal(receivers.body[b], b);
            assert_true(fabs(result.irradiance[b][c] / e - 1) < 1e-9);
            assert_true(fabs(result.radiosity[b][c] / (e * parian_dipole_total(&d)) - 1) < 3e-3);
        }
        assert_true(fabs(result.in[c] / in - 1) < 1e-5); /* sums of floats */
    }
    parian_reference_result_free(test_env(0), &result);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* The printed fit of F_dr changes a plane's total by some 1e-4; with the same places the noise of
 * both runs is the same to first order, so that a five-hundredth of the change is seen. */
static void fit_reaches_shared_and_fresh_places(void **state)
{
    (void)state;
    parian_medium usual = low_index;
    const parian_medium *const media[1] = {&usual};
    const double point[1][3] = {{0.001, 0.002, 0}};
    parian_reference_scene scene;
    parian_receivers receivers;
    parian_reference_result result[2];
    usual.eta = 1.5;
    plane_scene(media, 1, &down, &scene);
    at_points(&scene, point, 1, &receivers);
    for (int fit = 0; fit < 2; fit++) {
        const parian_bssrdf_desc dipole = {.model = PARIAN_REFERENCE_DIPOLE, .fit_fdr = fit};
        solve(&scene, &receivers, &dipole, 3, &result[fit]);
    }
    for (int c = 0; c < 3; c++) {
        parian_dipole exact = parian_dipole_make(&usual, c, false),
                      printed = parian_dipole_make(&usual, c, true);
        double change = parian_dipole_total(&printed) / parian_dipole_total(&exact) - 1;
        double found = result[1].radiosity[0][c] / result[0].radiosity[0][c] - 1;
        print_message("fit: %.3e, expected %.3e\n", found, change);
        assert_true(fabs(change) > 2e-5);
        assert_true(fabs(found - change) < 2e-3 * fabs(change));
    }
    parian_reference_result_free(test_env(0), &result[0]);
    parian_reference_result_free(test_env(0), &result[1]);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* A plane under a uniform sky, which has four samples at a shared place: a normalised model gives
 * back what radiative transfer does, by construction. 1 %: errors of the lattice and of the model's
 * tail, measured as 0.4 %. */
static void sky_on_a_plane_for_normalised_models(void **state)
{
    (void)state;
    const parian_reference_model models[] = {PARIAN_REFERENCE_DIRECTIONAL, PARIAN_REFERENCE_PBD};
    const parian_medium *const media[1] = {&low_index};
    const double point[2][3] = {{0.001, 0.002, 0}, {-0.004, 0.003, 0}};
    parian_reference_scene scene;
    parian_receivers receivers;
    plane_scene(media, 1, &sky, &scene);
    at_points(&scene, point, 2, &receivers);
    for (int m = 0; m < 2; m++) {
        const parian_bssrdf_desc desc = {.model = models[m], .normalise = true};
        parian_reference_result result;
        solve(&scene, &receivers, &desc, 5, &result);
        for (int i = 0; i < 6; i++) {
            int c = i % 3;
            double albedo =
                low_index.sigma_s_prime[c] / (low_index.sigma_s_prime[c] + low_index.sigma_a[c]);
            double e = PARIAN_PI * sky.color[c] * parian_fresnel_exit_norm(low_index.eta);
            double truth = e * parian_half_space_reflectance(albedo, 0, low_index.eta);
            print_message("%d %d: %.5f\n", m, c, result.radiosity[i / 3][c] / truth);
            assert_true(fabs(result.radiosity[i / 3][c] / truth - 1) < 3e-3);
        }
        parian_reference_result_free(test_env(0), &result);
    }
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* Another seed takes other shared places (which alone make the flux that enters) and other
 * receivers. */
static void seeds_reach_all_draws(void **state)
{
    (void)state;
    const parian_bssrdf_desc dipole = {.model = PARIAN_REFERENCE_DIPOLE};
    parian_reference_scene scene;
    parian_receivers receivers[2];
    parian_reference_result result[2];
    parian_reference_body *body;
    assert_true(PARIAN_NEW0(NULL, body, 1));
    assert_int_equal(test_sphere(NULL, 0.004, 10, &body->mesh), PARIAN_OK);
    body->medium = low_index;
    assert_int_equal(parian_mesh_make_corner_normals(NULL, &body->mesh, 50), PARIAN_OK);
    memset(&scene, 0, sizeof scene);
    assert_int_equal(parian_reference_scene_make(NULL, body, 1, NULL, 0, &down, 1, &scene),
                     PARIAN_OK);
    for (uint64_t s = 0; s < 2; s++) {
        assert_int_equal(parian_receivers_spread(NULL, &scene, 12, s, &receivers[s]), PARIAN_OK);
        solve(&scene, &receivers[0], &dipole, s, &result[s]);
    }
    assert_true(result[0].in[0] != result[1].in[0]);
    assert_memory_not_equal(result[0].radiosity[0], result[1].radiosity[0],
                            sizeof result[0].radiosity[0]);
    size_t same = 0;
    for (size_t i = 0; i < 12; i++) {
        same += receivers[0].triangle[i] == receivers[1].triangle[i] &&
                receivers[0].barycentric[i][0] == receivers[1].barycentric[i][0];
    }
    assert_int_equal(same, 0);
    for (int s = 0; s < 2; s++) {
        parian_reference_result_free(test_env(0), &result[s]);
        parian_receivers_free(NULL, &receivers[s]);
    }
    parian_reference_scene_free(NULL, &scene);
}

/* Corner normals of a ball point from its centre; so must the smooth normal of any place, of nodes
 * and of pieces. */
static void places_have_interpolated_normals(void **state)
{
    (void)state;
    parian_mesh mesh = {0};
    parian_strata_tree tree;
    assert_int_equal(test_sphere(NULL, 1, 3, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(NULL, &mesh, 50), PARIAN_OK);
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        for (int k = 0; k < 9; k++) {
            mesh.corner_normal[t][k / 3][k % 3] =
                (float)mesh.position[mesh.triangle[t][k / 3]][k % 3];
        }
    }
    assert_int_equal(parian_strata_tree_make(NULL, &mesh, &tree), PARIAN_OK);
    for (int level = 0; level < 12; level += 11) {
        parian_random random = parian_random_stream(1, (uint64_t)level, 0, 0);
        for (int i = 0; i < 200; i++) {
            parian_stratum s, half[2];
            parian_place place;
            parian_stratum_root(&tree, &s);
            for (int l = 0; l < level; l++) {
                parian_stratum_split(&tree, &s, half);
                s = half[parian_random_unit(&random) < 0.5];
            }
            parian_stratum_place(&tree, &s, 0, &random, &place);
            double length = sqrt(parian_dot3(place.position, place.position));
            assert_true(fabs(parian_dot3(place.smooth_normal, place.position) / length - 1) < 1e-6);
        }
    }
    parian_strata_tree_free(NULL, &tree);
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bodies_keep_their_own_media),
        cmocka_unit_test(fit_reaches_shared_and_fresh_places),
        cmocka_unit_test(sky_on_a_plane_for_normalised_models),
        cmocka_unit_test(seeds_reach_all_draws),
        cmocka_unit_test(places_have_interpolated_normals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
