/* test_bssrdf_pbd.c - photon beam diffusion against direct integration, its totals, and every model
 * in hard cases.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "bake/reference/bssrdf.h"
#include "bake/reference/bssrdf_models.h"
#include "bake/reference/half_space.h"
#include "core/fresnel.h"
#include "core/small_maths.h"

static const parian_medium marble = {
    .sigma_s_prime = {2190, 2620, 3000}, .sigma_a = {2.1, 4.1, 7.1}, .eta = 1.5};
static const parian_medium skin = {
    .sigma_s_prime = {740, 880, 1010}, .sigma_a = {32, 170, 480}, .eta = 1.3};

static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};

static void assert_close(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected))) {
        print_error("found %.15g, expected %.15g within %g\n", found, expected, relative);
        fail();
    }
}

static parian_bssrdf_model *make(const parian_medium *medium, parian_reference_model model,
                                 bool normalise)
{
    parian_bssrdf_desc desc = {.model = model, .normalise = normalise};
    parian_bssrdf_model *made = NULL;
    assert_int_equal(parian_bssrdf_create(NULL, medium, &desc, &made), PARIAN_OK);
    return made;
}

/* The model as it is written down, and its medium, m^-1. */
typedef struct beam {
    double s, a, t; /* sigma_s', sigma_a, and their sum */
    double eta, c1, c2;
} beam;

/* Exitance of a source at depth z, m, per unit of the beam's power. */
static double multiple_scattering(const beam *b, double r, double z)
{
    double D = (2 * b->a + b->s) / (3 * b->t * b->t), tr = sqrt(b->a / D), rho = b->s / b->t;
    double z_v = -z - 4 * D * (1 + 3 * b->c2) / (1 - 2 * b->c1);
    double d_r = sqrt(r * r + z * z), d_v = sqrt(r * r + z_v * z_v);
    double fluence = (exp(-tr * d_r) / d_r - exp(-tr * d_v) / d_v) / (4 * PARIAN_PI * D);
    double flux = (z * (1 + tr * d_r) * exp(-tr * d_r) / pow(d_r, 3) -
                   z_v * (1 + tr * d_v) * exp(-tr * d_v) / pow(d_v, 3)) /
                  (4 * PARIAN_PI);
    double kappa = 1 - exp(-2 * b->t * (d_r + z));
    return rho * rho * kappa * ((1 - 2 * b->c1) / 4 * fluence + (1 - 3 * b->c2) / 2 * flux);
}

/* Isotropic, z beyond the critical depth. */
static double single_scattering(const beam *b, double r, double z)
{
    double d = sqrt(r * r + z * z), cosine = z / d;
    return b->s / b->t * exp(-b->t * d) / (d * d) / (4 * PARIAN_PI) *
           (1 - parian_fresnel_reflectance(cosine, 1 / b->eta)) * cosine;
}

/* Midpoint rule over depth, drawn as a beam loses light. */
static double integrate_beam(double s, double a, double eta, double r)
{
    enum { N = 20000 };
    beam b = {s, a, s + a, eta, parian_fresnel_c1(1 / eta), parian_fresnel_c2(1 / eta)};
    double critical = eta > 1 ? r * sqrt(eta * eta - 1) : 0, sum = 0;
    for (int i = 0; i < N; i++) {
        double depth = -log(1 - (i + 0.5) / N) / b.t;
        sum += multiple_scattering(&b, r, depth);
        sum += exp(-b.t * critical) * single_scattering(&b, r, critical + depth);
    }
    return sum / N;
}

/* 1e-4 is what the table promises; the midpoint rule is good to 2e-5 from a tenth of the mean free
 * path on. Radii between the table's places. */
static void table_matches_direct_integration(void **state)
{
    static const double radius[] = {0.11, 0.3, 0.77, 1.9, 5.3, 17, 40};
    parian_medium dense = marble;
    const parian_medium *media[] = {&marble, &skin, &dense};
    (void)state;
    dense.eta = 0.8;
    for (size_t k = 0; k < sizeof media / sizeof *media; k++) {
        parian_bssrdf_model *model = make(media[k], PARIAN_REFERENCE_PBD, false);
        for (size_t i = 0; i < sizeof radius / sizeof *radius; i++) {
            double s = media[k]->sigma_s_prime[1], a = media[k]->sigma_a[1], R[3];
            double x_o[3] = {0, radius[i] / (s + a), 0};
            parian_bssrdf_value(model, origin, up, up, x_o, up, R);
            assert_close(R[1], integrate_beam(s, a, media[k]->eta, x_o[1]), 1e-4);
        }
        parian_bssrdf_destroy(NULL, model);
    }
}

/* Interpolation against the profile itself: a table of 20 places for each factor e of distance,
 * between which the cubic is off by less than 1e-5 until the value has fallen by 1e-40. */
static void interpolation(void **state)
{
    (void)state;
    for (int c = 0; c < 3; c++) {
        parian_medium medium = skin;
        medium.g[c] = -0.7 + 0.7 * c;
        parian_bssrdf_channel channel = parian_bssrdf_channel_make(&medium, c);
        parian_exitance exitance = parian_exitance_make(medium.eta, false);
        parian_pbd_profile profile;
        assert_int_equal(parian_pbd_profile_make(NULL, &channel, &profile), PARIAN_OK);
        for (double r = 2e-3; r < 50; r *= 1.37) {
            double direct =
                parian_pbd_multiple(&channel, &exitance, r) + parian_pbd_single(&channel, r);
            double unit = profile.unit;
            assert_close(parian_pbd_profile_value(&profile, r * unit) * unit * unit, direct, 1e-5);
        }
        parian_pbd_profile_free(NULL, &profile);
    }
}

/* Energy that leaves within a radius, by Gauss-Legendre in panels of the logarithm of the radius;
 * below 1e-9 m the value is constant. */
static double plane_total(const parian_bssrdf_model *model, int channel)
{
    enum { PANELS = 60, NODES = 16 };
    double node[NODES], weight[NODES], R[3], low = log(1e-9), width = log(1e13) / PANELS;
    parian_gauss_legendre(NODES, node, weight);
    parian_bssrdf_value(model, origin, up, up, origin, up, R);
    double sum = PARIAN_PI * 1e-18 * R[channel];
    for (int p = 0; p < PANELS * NODES; p++) {
        double r = exp(low + width * (p / NODES + node[p % NODES])), x_o[3] = {r, 0, 0};
        parian_bssrdf_value(model, origin, up, up, x_o, up, R);
        sum += weight[p % NODES] * width * 2 * PARIAN_PI * r * r * R[channel];
    }
    return sum;
}

/* Totals of independent code, isotropic and normal incidence: 0.819 for marble and 0.228 for skin.
 * 1 %: its 64 depths and its grid of radii. */
static void raw_totals(void **state)
{
    (void)state;
    parian_bssrdf_model *model = make(&marble, PARIAN_REFERENCE_PBD, false);
    assert_close(plane_total(model, 1), 0.819, 0.01);
    assert_true(parian_bssrdf_scale(model, 1) == 1 && !parian_bssrdf_is_directional(model));
    parian_bssrdf_destroy(NULL, model);
    model = make(&skin, PARIAN_REFERENCE_PBD, false);
    assert_close(plane_total(model, 1), 0.228, 0.01);
    parian_bssrdf_destroy(NULL, model);
}

/* Normalised, a half-space reflects what radiative transfer does, the core included. 1e-3: the kink
 * at the core's rim, which this rule does not know. */
static void normalised_totals(void **state)
{
    static const double eta[] = {0.5, 0.8, 1, 1.3, 2};
    (void)state;
    for (size_t i = 0; i < sizeof eta / sizeof *eta; i++) {
        parian_medium medium = {.sigma_s_prime = {1000, 1000, 50},
                                .sigma_a = {0, 10, 1000},
                                .g = {0.9, -0.6, 0},
                                .eta = eta[i]};
        parian_bssrdf_model *model = make(&medium, PARIAN_REFERENCE_PBD, true);
        for (int c = 0; c < 3; c++) {
            parian_bssrdf_channel channel = parian_bssrdf_channel_make(&medium, c);
            double target = parian_half_space_reflectance(channel.albedo, channel.g, channel.eta);
            assert_close(plane_total(model, c), target, 1e-3);
        }
        parian_bssrdf_destroy(NULL, model);
    }
}

/* Models of distance do not care which end is lit. The directional and the flux form do. */
static void reciprocity(void **state)
{
    const double a[3] = {1e-4, -2e-4, 5e-4}, b[3] = {7e-4, 3e-4, -1e-4};
    const double n_a[3] = {0.6, 0, 0.8}, n_b[3] = {0, -0.8, 0.6};
    static const parian_reference_model models[] = {PARIAN_REFERENCE_DIPOLE, PARIAN_REFERENCE_PBD};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        parian_bssrdf_model *model = make(&marble, models[i], true);
        double R[3], Q[3];
        parian_bssrdf_value(model, a, n_a, up, b, n_b, R);
        parian_bssrdf_value(model, b, n_b, up, a, n_a, Q);
        for (int c = 0; c < 3; c++) {
            assert_true(R[c] > 0 && R[c] == Q[c]);
        }
        parian_bssrdf_destroy(NULL, model);
    }
}

/* Coincident points, points along the normal, far points, light from below, normals every way. */
static void check_finite(const parian_bssrdf_model *model, double length)
{
    static const double direction[][3] = {{0, 0, 1},     {0, 0, -1},     {1, 0, 0},
                                          {0.6, 0, 0.8}, {0, 0.8, -0.6}, {-0.6, 0.8, 0}};
    enum { DIRECTIONS = sizeof direction / sizeof *direction };
    static const double distance[] = {0, 1e-12, 1e-6, 0.1, 1, 30, 1e6};
    for (int i = 0; i < DIRECTIONS * DIRECTIONS * DIRECTIONS * 7; i++) {
        const double *towards = direction[i % DIRECTIONS], *w_i = direction[i / 6 % DIRECTIONS];
        const double *n_o = direction[i / 36 % DIRECTIONS];
        double r = length * distance[i / 216], R[3];
        double x_o[3] = {r * towards[0], r * towards[1], r * towards[2]};
        parian_bssrdf_value(model, origin, up, w_i, x_o, n_o, R);
        for (int c = 0; c < 3; c++) {
            if (!(R[c] >= 0) || !isfinite(R[c])) {
                print_error("%g for light %g,%g,%g at %g m\n", R[c], w_i[0], w_i[1], w_i[2], r);
                fail();
            }
        }
    }
}

static void hard_cases(void **state)
{
    static const double eta[] = {0.5, 0.9, 1, 1.0001, 1.5, 3};
    static const double g[] = {-0.99, 0, 0.9, 1};
    static const double scale[] = {1e-3, 1e3, 1e9};
    (void)state;
    for (int i = 0; i < 6 * 4 * 3; i++) {
        double one = scale[i / 24], mean = g[i / 6 % 4];
        parian_medium medium = {.sigma_s_prime = {one, 1e-9 * one, 0},
                                .sigma_a = {0, one, one},
                                .g = {mean, mean, mean},
                                .eta = eta[i % 6]};
        for (int model = PARIAN_REFERENCE_DIPOLE; model <= PARIAN_REFERENCE_PBD; model++) {
            for (int normalise = 0; normalise < 2; normalise++) {
                parian_bssrdf_model *m = make(&medium, (parian_reference_model)model, normalise);
                double R[3], x_o[3] = {0.5 / one, 0, 0};
                check_finite(m, 1 / one);
                parian_bssrdf_value(m, origin, up, up, x_o, up, R);
                assert_true(R[0] > 0 && R[2] == 0);
                for (int c = 0; c < 3; c++) {
                    assert_true(parian_bssrdf_core_length(m, c) > 0);
                    assert_true(isfinite(parian_bssrdf_scale(m, c)));
                }
                parian_bssrdf_destroy(NULL, m);
            }
        }
    }
}

/* Whatever allocation fails, nothing leaks; nonsense is refused with a line. */
static void failures(void **state)
{
    parian_bssrdf_desc desc = {.model = PARIAN_REFERENCE_PBD};
    parian_bssrdf_model *model = NULL;
    (void)state;
    for (size_t k = 0; k < 4; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        assert_int_equal(parian_bssrdf_create(&env, &marble, &desc, &model), PARIAN_E_NOMEM);
        assert_true(memory.live == 0 && !model);
    }
    parian_medium bad = marble;
    bad.eta = NAN;
    assert_int_equal(parian_bssrdf_create(NULL, &bad, &desc, &model), PARIAN_E_ARGUMENT);
    bad = marble;
    bad.sigma_a[2] = -1;
    assert_int_equal(parian_bssrdf_create(NULL, &bad, &desc, &model), PARIAN_E_ARGUMENT);
    desc.model = PARIAN_REFERENCE_PATH;
    assert_int_equal(parian_bssrdf_create(NULL, &marble, &desc, &model), PARIAN_E_ARGUMENT);
    parian_bssrdf_destroy(NULL, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_matches_direct_integration),
        cmocka_unit_test(interpolation),
        cmocka_unit_test(raw_totals),
        cmocka_unit_test(normalised_totals),
        cmocka_unit_test(reciprocity),
        cmocka_unit_test(hard_cases),
        cmocka_unit_test(failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
