/* test_dipole.c - Fresnel moments and the dipole against closed forms and independently computed
 * numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "core/dipole.h"
#include "core/fresnel.h"
#include "core/small_maths.h"

static const parian_medium marble = {
    .sigma_s_prime = {2190, 2620, 3000}, .sigma_a = {2.1, 4.1, 7.1}, .eta = 1.5};
static const parian_medium skimmilk = {
    .sigma_s_prime = {700, 1220, 1900}, .sigma_a = {1.4, 2.5, 14.2}, .eta = 1.3};
static const parian_medium ketchup = {
    .sigma_s_prime = {180, 70, 30}, .sigma_a = {61, 970, 1450}, .eta = 1.3};

static void assert_close(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected))) {
        print_error("found %.15g, expected %.15g within %g\n", found, expected, relative);
        fail();
    }
}

/* The first and second moments for light inside a medium of index eta, computed with 400-point
 * quadrature and rounded to five decimals. */
static void moments_match_table(void **state)
{
    static const double table[][3] = {{1.1, .09717, .02931},
                                      {1.3, .22223, .10009},
                                      {1.5, .29817, .15481},
                                      {2.0, .39507, .23496},
                                      {0.77, .03046, .01172}};
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        assert_true(fabs(parian_fresnel_c1(1 / table[i][0]) - table[i][1]) < 6e-6);
        assert_true(fabs(parian_fresnel_c2(1 / table[i][0]) - table[i][2]) < 6e-6);
    }
    assert_close(parian_fresnel_exit_norm(1.3), 0.9389, 1e-4);
    assert_close(parian_fresnel_exit_norm(1.5), 0.9082, 1e-4);
    assert_true(parian_fresnel_fdr(1) == 0 && parian_fresnel_exit_norm(1) == 1);
}

/* What enters one way leaves the other: (1 - 2 C1(eta)) = eta^2 (1 - 2 C1(1/eta)), from the
 * reversibility of light; an identity, so only quadrature error (1e-9) is left. */
static void moments_are_reversible(void **state)
{
    (void)state;
    for (double eta = 1.05; eta < 3; eta += 0.15) {
        double outside = 1 - 2 * parian_fresnel_c1(eta),
               inside = 1 - 2 * parian_fresnel_c1(1 / eta);
        assert_close(outside, eta * eta * inside, 1e-8);
    }
}

static void reflectance_at_special_angles(void **state)
{
    (void)state;
    assert_close(parian_fresnel_reflectance(1, 1.5), 0.04, 1e-14);
    assert_true(parian_fresnel_reflectance(0, 1.5) == 1);
    assert_true(parian_fresnel_reflectance(0.7, 1 / 1.5) == 1); /* total inside: critical 0.745 */
    double brewster = 1 / sqrt(1 + 1.5 * 1.5), rs = (1 - 1.5 * 1.5) / (1 + 1.5 * 1.5);
    assert_close(parian_fresnel_reflectance(brewster, 1.5), 0.5 * rs * rs, 1e-13);
    for (double mu = 0; mu <= 1; mu += 0.01) {
        double f = parian_fresnel_transmittancef((float)mu, 1.4f);
        assert_true(fabs(f - parian_fresnel_transmittance((float)mu, 1.4f)) < 1e-6);
    }
}

/* Parameters in mm with the printed fit, from independent code. */
static void parameters_match_table(void **state)
{
    (void)state;
    parian_dipole d = parian_dipole_make(&marble, 1, true);
    assert_close(d.sigma_t_prime, 2624.1, 1e-12);
    assert_close(d.albedo, 0.998437559544225, 1e-12);
    assert_close(d.f_dr, 0.596733333333333, 1e-12);
    assert_close(d.a, 3.95949743759299, 1e-12);
    assert_close(d.sigma_tr * 1e-3, 0.179656422095065, 1e-12);
    assert_close(d.z_v * 1e3, 2.39294612125706, 1e-12);
    assert_close(parian_dipole_total(&d), 0.790960196567364, 1e-12);
    d = parian_dipole_make(&skimmilk, 2, true);
    assert_close(parian_dipole_total(&d), 0.682295164737145, 1e-12);
    d = parian_dipole_make(&ketchup, 1, true);
    assert_close(parian_dipole_total(&d), 0.00633693107819686, 1e-12);
}

/* R_d in mm^-2 at radii in mm, printed fit, double precision of independent code. */
static void values_match_table(void **state)
{
    static const struct {
        const parian_medium *medium;
        double r, rd[3];
    } table[] = {
        {&marble, 0.01, {3.904712542881595e-01, 5.582243431247351e-01, 7.309209004388997e-01}},
        {&marble, 1, {3.484669173791536e-02, 3.433002694713737e-02, 3.367507959133184e-02}},
        {&marble, 20, {1.011867250659959e-05, 3.359233800790413e-06, 8.917210086706758e-07}},
        {&skimmilk, 0.5, {3.457203939500492e-02, 7.892213230720689e-02, 1.186159019090355e-01}},
        {&skimmilk, 10, {3.604257109945278e-04, 2.234971471468509e-04, 4.476318236025486e-05}},
        {&ketchup, 2, {1.903569642881963e-03, 4.875753370377092e-05, 3.580656399084946e-06}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        for (int c = 0; c < 3; c++) {
            parian_dipole d = parian_dipole_make(table[i].medium, c, true);
            double r = table[i].r * 1e-3;
            assert_close(parian_dipole_rd(&d, r * r) * 1e-6, table[i].rd[c], 1e-11);
        }
    }
}

/* C(R) is the integral of 2 pi r R_d; the slope and the Laplacian are its derivatives. Tolerances:
 * the quadrature's 1e-9, the differences' 1e-6. */
static void disc_energy_and_derivatives(void **state)
{
    double node[64], weight[64];
    (void)state;
    parian_gauss_legendre(64, node, weight);
    for (int c = 0; c < 3; c++) {
        parian_dipole d = parian_dipole_make(&marble, c, false);
        for (double radius = 1e-6; radius < 0.1; radius *= 7) {
            double sum = 0, top = asinh(radius / d.z_r);
            for (int i = 0; i < 64; i++) {
                double r = d.z_r * sinh(top * node[i]);
                double step = top * d.z_r * cosh(top * node[i]);
                sum += weight[i] * 2 * PARIAN_PI * r * step * parian_dipole_rd(&d, r * r);
            }
            assert_close(parian_dipole_disc_energy(&d, radius), sum, 1e-9);
            double r2 = radius * radius, h = 1e-4 * (r2 + d.z_r * d.z_r);
            double slope = (parian_dipole_rd(&d, r2 + h) - parian_dipole_rd(&d, r2 - h)) / (2 * h);
            assert_close(parian_dipole_slope(&d, r2), slope, 1e-5);
            double bend =
                (parian_dipole_slope(&d, r2 + h) - parian_dipole_slope(&d, r2 - h)) / (2 * h);
            double scale = fabs(slope) * 4;
            assert_true(fabs(parian_dipole_laplacian(&d, r2) - 4 * (slope + r2 * bend)) <
                        1e-5 * scale);
        }
        assert_close(parian_dipole_disc_energy(&d, 1e3), parian_dipole_total(&d), 1e-5);
    }
}

/* On a plane the flux form is the plain one; on a closed sphere that holds the real source, and not
 * the image, all flux of the real source leaves: with sigma_a = 0 the integral over the sphere is
 * alpha' (Gauss), whatever the radius. 0.5 %: the clamp at zero and the quadrature. */
static void flux_form(void **state)
{
    (void)state;
    parian_medium clear = marble;
    clear.sigma_a[1] = 0;
    parian_dipole d = parian_dipole_make(&clear, 1, false);
    double zero[3] = {0, 0, 0}, up[3] = {0, 0, 1}, there[3] = {1e-3, 2e-3, 0};
    assert_close(parian_dipole_flux(&d, zero, up, there, up), parian_dipole_rd(&d, 5e-6), 1e-12);
    double node[64], weight[64], radius = 40 * d.z_r, sum = 0;
    parian_gauss_legendre(64, node, weight);
    for (int i = 0; i < 64; i++) { /* chord by exp: from z_r / 100 to the far pole */
        double low = log(d.z_r / 100), high = log(2 * radius);
        double chord = exp(low + (high - low) * node[i]),
               mu = 1 - chord * chord / (2 * radius * radius);
        double n[3] = {sqrt(fmax(0, 1 - mu * mu)), 0, mu};
        double x[3] = {radius * n[0], 0, radius * (mu - 1)};
        double area = 2 * PARIAN_PI * chord * chord * (high - low) * weight[i];
        sum += area * parian_dipole_flux(&d, zero, up, x, n);
    }
    assert_close(sum, 1, 0.005);
}

/* Hard cases: eta = 1 and below, no absorption, no scattering, strong absorption: finite and
 * bounded. */
static void hard_cases(void **state)
{
    (void)state;
    for (double eta = 0.7; eta < 3; eta += 0.1) {
        parian_medium m = {.sigma_s_prime = {1e3, 1, 0}, .sigma_a = {0, 1e9, 0}, .eta = eta};
        parian_dipole d = parian_dipole_make(&m, 0, false);
        assert_close(parian_dipole_total(&d), 1, 1e-12); /* conservative: all comes back */
        d = parian_dipole_make(&m, 1, false);
        assert_true(parian_dipole_total(&d) >= 0 && parian_dipole_total(&d) < 1e-9);
        assert_true(isfinite(parian_dipole_rd(&d, 0)) && parian_dipole_rd(&d, 1) == 0);
        d = parian_dipole_make(&m, 2, false);
        assert_true(parian_dipole_rd(&d, 0) == 0 && parian_dipole_total(&d) == 0);
    }
    parian_medium matched = marble;
    matched.eta = 1;
    assert_true(parian_dipole_make(&matched, 0, true).a == 1);
    assert_true(parian_dipole_make(&matched, 0, false).a == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_match_table),
        cmocka_unit_test(moments_are_reversible),
        cmocka_unit_test(reflectance_at_special_angles),
        cmocka_unit_test(parameters_match_table),
        cmocka_unit_test(values_match_table),
        cmocka_unit_test(disc_energy_and_derivatives),
        cmocka_unit_test(flux_form),
        cmocka_unit_test(hard_cases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
