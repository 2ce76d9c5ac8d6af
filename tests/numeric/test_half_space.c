/* test_half_space.c - the reflectance of a half-space against Chandrasekhar's H-function, Monte
 * Carlo and limits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "bake/reference/half_space.h"
#include "core/small_maths.h"

static void assert_near(double found, double expected, double tolerance)
{
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %.9g, expected %.9g within %g\n", found, expected, tolerance);
        fail();
    }
}

/* Mean over diffuse light of Chandrasekhar's plane albedo 1 - H(mu) sqrt(1 - albedo), isotropic
 * scattering, no boundary; H by iterating 1/H(mu) = sqrt(1 - albedo) + albedo/2 integral of x H(x)
 * / (mu + x). */
static double chandrasekhar(double albedo)
{
    enum { N = 64 };
    double x[N], w[N], h[N], root = sqrt(1 - albedo), moment = 0;
    parian_gauss_legendre(N, x, w);
    for (int i = 0; i < N; i++) {
        h[i] = 1;
    }
    for (int pass = 0; pass < 400; pass++) {
        for (int i = 0; i < N; i++) {
            double sum = 0;
            for (int j = 0; j < N; j++) {
                sum += w[j] * x[j] * h[j] / (x[i] + x[j]);
            }
            h[i] = 1 / (root + 0.5 * albedo * sum);
        }
    }
    for (int i = 0; i < N; i++) {
        moment += w[i] * x[i] * h[i];
    }
    return 1 - 2 * root * moment;
}

/* 1e-5: both are quadratures of the same integral equation, of different order. */
static void matched_isotropic_is_chandrasekhar(void **state)
{
    static const double albedo[] = {0.01, 0.3, 0.5, 0.8, 0.9, 0.99, 0.999, 0.99999};
    (void)state;
    for (size_t i = 0; i < sizeof albedo / sizeof *albedo; i++) {
        assert_near(parian_half_space_reflectance(albedo[i], 0, 1), chandrasekhar(albedo[i]), 1e-5);
    }
}

/* First term in albedo: light scattered once, without boundary the integral over both cosines of mu
 * x / (mu + x), which is 2 (1 - ln 2) / 3; what follows is of the order of albedo^2. */
static void single_scattering(void **state)
{
    (void)state;
    assert_near(parian_half_space_reflectance(1e-6, 0, 1) / 1e-6, 2 * (1 - log(2)) / 3, 1e-6);
}

/* Independent walks of photons, isotropic unless g is given, uniform light through a Fresnel
 * boundary. Tolerances: three standard errors, at most sqrt(R (1 - R) / photons); the first is good
 * to 0.3 %. */
static void monte_carlo(void **state)
{
    static const struct {
        double albedo, g, eta, total, tolerance;
    } table[] = {
        {0.9984376, 0, 1.5, 0.804945, 0.0024}, /* marble, green, 1.5 million photons or more */
        {0.9, 0, 0.7, 0.452581, 0.0024},       /* the others: 400,000 */
        {0.99, 0.9, 1.4, 0.272913, 0.0021},    {0.95, -0.9, 1.4, 0.561999, 0.0024},
        {0.999, 0.98, 1.4, 0.386431, 0.006}, /* 60,000 */
    };
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        double total = parian_half_space_reflectance(table[i].albedo, table[i].g, table[i].eta);
        assert_near(total, table[i].total, table[i].tolerance);
    }
}

/* Nothing is lost without absorption, whatever the boundary; near that the loss goes as its root:
 * without boundary as 4 sqrt((1 - albedo) / 3), from the first moment 2 / sqrt(3) of the
 * conservative H. */
static void conservation(void **state)
{
    (void)state;
    for (double eta = 0.5; eta < 3.1; eta += 0.25) {
        for (double g = -0.9; g < 1; g += 0.45) {
            assert_true(parian_half_space_reflectance(1, g, eta) == 1);
            assert_true(parian_half_space_reflectance(0, g, eta) == 0);
            double almost = parian_half_space_reflectance(1 - 1e-9, g, eta);
            assert_true(almost < 1 && almost > 0.997);
        }
    }
    double loss = 1 - parian_half_space_reflectance(1 - 1e-8, 0, 1);
    assert_near(loss / (4 * sqrt(1e-8 / 3)), 1, 2e-4);
}

static double reduced(double albedo_prime, double g, double eta)
{
    double sigma_s = albedo_prime / (1 - g);
    return parian_half_space_reflectance(sigma_s / (sigma_s + 1 - albedo_prime), g, eta);
}

/* Similarity: equal reduced albedo gives nearly equal totals where little is absorbed. The figures
 * are of an independent Monte Carlo run (0.2 % at albedo 0.98; -8 % and +16 % at 0.84). */
static void similarity(void **state)
{
    (void)state;
    assert_near(reduced(0.98, 0.9, 1.4) / reduced(0.98, 0, 1.4), 1, 0.004);
    assert_near(reduced(0.98, -0.5, 1.4) / reduced(0.98, 0, 1.4), 1.02, 0.005);
    assert_near(reduced(0.84, 0.9, 1.4) / reduced(0.84, 0, 1.4), 0.92, 0.01);
    assert_near(reduced(0.84, -0.5, 1.4) / reduced(0.84, 0, 1.4), 1.16, 0.01);
}

/* More scattering reflects more; finite everywhere, also for arguments out of range. */
static void monotone_and_finite(void **state)
{
    static const double eta[] = {0.3, 0.5, 0.999, 1, 1.001, 1.33, 2.4, 4};
    (void)state;
    for (size_t k = 0; k < sizeof eta / sizeof *eta; k++) {
        for (double g = -1; g < 1.01; g += 0.5) {
            double before = -1e-12;
            for (double albedo = -0.25; albedo < 1.3; albedo += 0.25) {
                double total = parian_half_space_reflectance(albedo, g, eta[k]);
                assert_true(isfinite(total) && total <= 1 && total >= before);
                before = total;
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(matched_isotropic_is_chandrasekhar),
        cmocka_unit_test(single_scattering),
        cmocka_unit_test(monte_carlo),
        cmocka_unit_test(conservation),
        cmocka_unit_test(similarity),
        cmocka_unit_test(monotone_and_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
