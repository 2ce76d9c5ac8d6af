/* test_walk.c - the core of random walks against closed forms: logarithm, angles, scattering,
 * boundary, roulette.
 *
 * Seeds are fixed, so nothing here is left to chance; where a bound is a number of standard errors,
 * four of them leave room for the few dozen comparisons made (one in 16,000 goes beyond by chance).
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <float.h>
#include <math.h>

#include "bake/reference/walk.h"
#include "core/fresnel.h"

static void assert_within(double found, double expected, double bound, const char *what)
{
    if (!(fabs(found - expected) <= bound)) {
        print_error("%s: found %.15g, expected %.15g within %g\n", what, found, expected, bound);
        fail();
    }
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The C library's logarithm is right to an ulp; ours adds three roundings. */
static void logarithm_matches(void **state)
{
    (void)state;
    parian_random random = parian_random_stream(1, 0, 0, 0);
    for (int i = 0; i < 2000000; i++) {
        double u = parian_random_unit(&random), x = i % 3 == 0   ? u
                                                    : i % 3 == 1 ? 1 - u * 1e-9
                                                                 : u * 0x1p-40;
        if (x > 0) {
            double expected = log(x);
            assert_within(parian_walk_log(x), expected, 4 * DBL_EPSILON * fabs(expected), "log");
        }
    }
    assert_true(parian_walk_log(1) == 0);
    assert_within(parian_walk_log(0x1p-53), -53 * log(2), 1e-13, "log of the least number drawn");
}

/* Flights are exponential: mean 1/sigma, share beyond x exp(-sigma x). */
static void flights_are_exponential(void **state)
{
    (void)state;
    enum { N = 1000000 };
    parian_random random = parian_random_stream(2, 0, 0, 0);
    double sum = 0, beyond = 0;
    for (int i = 0; i < N; i++) {
        double flight = parian_walk_flight(250, &random) * 250;
        sum += flight;
        beyond += flight > 3;
    }
    assert_within(sum / N, 1, 4 / sqrt(N), "mean flight");
    assert_within(beyond / N, exp(-3), 4 * sqrt(exp(-3) / N), "flights beyond three mean ones");
    assert_true(parian_walk_flight(0, &random) == INFINITY);
}

static void azimuths_are_uniform(void **state)
{
    (void)state;
    enum { N = 1000000, SECTORS = 16 };
    parian_random random = parian_random_stream(3, 0, 0, 0);
    int count[SECTORS] = {0};
    for (int i = 0; i < N; i++) {
        double c, s;
        parian_walk_azimuth(&random, &c, &s);
        assert_within(c * c + s * s, 1, 4 * DBL_EPSILON, "length");
        int sector = (int)floor((atan2(s, c) / (2 * M_PI) + 0.5) * SECTORS);
        count[sector < SECTORS ? sector : 0]++;
    }
    double square = 0, share = (double)N / SECTORS;
    for (int i = 0; i < SECTORS; i++) {
        square += (count[i] - share) * (count[i] - share) / share;
    }
    assert_true(square < 37.7); /* chi squared of 15 degrees: one in a thousand lies beyond */
}

static const double all_g[] = {-0.99, -0.5, -1e-5, -1e-300, 0,      1e-9,
                               1e-5,  0.3,  0.9,   0.995,   0.99999};
enum { G_COUNT = sizeof all_g / sizeof *all_g };

/* Means of the Legendre polynomials are g and g^2. The midpoint rule over the number drawn errs by
 * at most the whole rise and fall of what it sums, over the number of points: 2 and 3. */
static void polar_angles_have_their_moments(void **state)
{
    (void)state;
    enum { N = 400000 };
    for (int k = 0; k < G_COUNT; k++) {
        double g = all_g[k], first = 0, second = 0;
        for (int i = 0; i < N; i++) {
            double c, s;
            parian_walk_polar(g, (i + 0.5) / N, &c, &s);
            assert_true(c >= -1 && c <= 1 && s >= 0 && s <= 1);
            assert_within(c * c + s * s, 1, 1e-13 / (1 - fabs(g)), "cos^2 + sin^2");
            first += c / N;
            second += (1.5 * c * c - 0.5) / N;
        }
        assert_within(first, g, 2.0 / N, "mean cosine");
        assert_within(second, g * g, 3.0 / N, "second moment");
    }
}

/* What is drawn is what is evaluated: p(cos) 2 pi dcos/du = 1, by central differences (error of
 * second order in the step, relative to 1 - |g|). */
static void phase_is_the_density_of_polar_angles(void **state)
{
    (void)state;
    for (int k = 0; k < G_COUNT; k++) {
        double g = all_g[k], step = 1e-4 * (1 - fabs(g));
        for (int i = 1; i < 100; i++) {
            double u = i / 100.0, c, s, ahead, behind;
            parian_walk_polar(g, u, &c, &s);
            parian_walk_polar(g, u + step, &ahead, &s);
            parian_walk_polar(g, u - step, &behind, &s);
            if (ahead - behind > 1e-9) { /* else the difference itself is rounding */
                double slope = (ahead - behind) / (2 * step);
                assert_within(parian_walk_phase(g, c) * 2 * M_PI * slope, 1, 1e-5, "p dcos/du");
            }
        }
    }
    assert_within(parian_walk_phase(0, 0.3), 1 / (4 * M_PI), 1e-16, "isotropic phase");
}

static void polar_angles_at_the_ends(void **state)
{
    (void)state;
    for (int k = 0; k < G_COUNT; k++) {
        double c, s;
        parian_walk_polar(all_g[k], 0, &c, &s);
        assert_true(c == -1 && s == 0);
        parian_walk_polar(all_g[k], 1 - 0x1p-53, &c, &s);
        assert_true(c > 0.99 && s >= 0 && s < 0.2);
    }
}

/* The frame has no pole: directions at any angle about any axis, the poles and their neighbours
 * too. */
static void turns_keep_angle_and_length(void **state)
{
    (void)state;
    static const double axes[][3] = {
        {0, 0, 1},      {0, 0, -1},     {1, 0, 0},          {0, -1, 0},    {1e-9, 0, -1},
        {0, 1e-200, 1}, {0.6, 0, -0.8}, {-0.48, 0.64, 0.6}, {0.6, 0.8, 0}, {0.8, -0.6, -0.0}};
    for (size_t k = 0; k < sizeof axes / sizeof *axes; k++) {
        double mean[3] = {0, 0, 0};
        for (int i = 0; i < 360; i++) {
            double angle = i * M_PI / 180, out[3];
            parian_walk_turn(axes[k], 0.28, 0.96, cos(angle), sin(angle), out);
            assert_within(dot(out, out), 1, 4 * DBL_EPSILON, "length");
            assert_within(dot(out, axes[k]), 0.28, 4 * DBL_EPSILON, "cosine");
            for (int j = 0; j < 3; j++) {
                mean[j] += out[j] / 360;
            }
        }
        for (int j = 0; j < 3; j++) {
            assert_within(mean[j], 0.28 * axes[k][j], 1e-14, "mean direction");
        }
    }
}

/* The mean direction after n events is g^n times the first; lengths do not drift. */
static void scattering_forgets_the_direction(void **state)
{
    (void)state;
    enum { N = 200000, EVENTS = 3 };
    static const double g_of[] = {0, 0.8, -0.6};
    const double start[3] = {0.36, -0.48, 0.8};
    for (size_t k = 0; k < sizeof g_of / sizeof *g_of; k++) {
        parian_random random = parian_random_stream(4, k, 0, 0);
        double sum[3] = {0, 0, 0};
        for (int i = 0; i < N; i++) {
            double d[3] = {start[0], start[1], start[2]};
            for (int e = 0; e < EVENTS; e++) {
                parian_walk_scatter(d, g_of[k], &random);
            }
            for (int j = 0; j < 3; j++) {
                sum[j] += d[j];
            }
        }
        for (int j = 0; j < 3; j++) { /* a component's deviation is below 1 */
            assert_within(sum[j] / N, pow(g_of[k], EVENTS) * start[j], 4 / sqrt(N),
                          "mean direction");
        }
    }
    parian_random random = parian_random_stream(5, 0, 0, 0);
    double d[3] = {0, 0, 1};
    for (int i = 0; i < 1000000; i++) {
        parian_walk_scatter(d, 0.9, &random);
    }
    assert_within(dot(d, d), 1, 1e-15, "length after a million events");
}

static void reflectance_is_exact(void **state)
{
    (void)state;
    static const double etas[] = {0.1, 0.5, 1 / 1.5, 0.99, 1, 1.000001, 1.3, 1.5, 2.5, 10};
    for (size_t k = 0; k < sizeof etas / sizeof *etas; k++) {
        for (int i = 0; i <= 1000; i++) {
            double cosine = i / 1000.0, beyond, back;
            double r = parian_walk_fresnel(cosine, etas[k], &beyond);
            assert_within(r, parian_fresnel_reflectance(cosine, etas[k]), 1e-14, "reflectance");
            assert_true(r >= 0 && r <= 1 && beyond >= 0 && beyond <= 1);
            /* The way back has the same reflectance and the first angle; near grazing a cosine
             * comes back with rounding / cosine. */
            if (beyond > 0.05 && cosine > 0.05) {
                assert_within(parian_walk_fresnel(beyond, 1 / etas[k], &back), r, 1e-12,
                              "way back");
                assert_within(back, cosine, 1e-12, "angle back");
            }
        }
    }
}

/* A direction refracted in, reversed and refracted out comes back reversed; Snell's law on the way.
 * Cosines from 0.05 keep the conditioning, 1 / cos, below 20. */
static void refraction_is_reversible(void **state)
{
    (void)state;
    parian_random random = parian_random_stream(6, 0, 0, 0);
    for (int i = 0; i < 100000; i++) {
        double normal[3] = {0, 0, 1}, d[3] = {0, 0, 1}, in[3] = {0}, out[3] = {0};
        double eta = 0.5 + 2 * parian_random_unit(&random);
        parian_walk_scatter(normal, 0, &random);
        parian_walk_scatter(d, 0, &random);
        double toward = dot(d, normal);
        if (toward > 0) {
            parian_walk_reflect(d, normal);
            assert_within(dot(d, normal), -toward, 1e-15, "mirrored");
        }
        double reflectance = parian_walk_refract(d, normal, eta, in);
        if (reflectance == 1 || fabs(toward) < 0.05 || dot(in, normal) > -0.05) {
            continue;
        }
        double sine_out = sqrt(1 - toward * toward), along = dot(in, normal);
        assert_within(dot(in, in), 1, 1e-14, "length");
        assert_within(eta * sqrt(fmax(0, 1 - along * along)), sine_out, 1e-7, "Snell");
        double back[3] = {-in[0], -in[1], -in[2]}, inner[3] = {-normal[0], -normal[1], -normal[2]};
        assert_within(parian_walk_refract(back, inner, 1 / eta, out), reflectance, 1e-12,
                      "way back");
        for (int k = 0; k < 3; k++) {
            assert_within(out[k], -d[k], 1e-13, "direction back");
        }
    }
    double d[3] = {0.8, 0, -0.6}, normal[3] = {0, 0, 1}, out[3] = {7, 7, 7};
    assert_true(parian_walk_refract(d, normal, 0.5, out) == 1 && out[0] == 7);
}

/* Both roulettes keep the expectation, and the books say by how much they missed it. */
static void roulettes_are_unbiased(void **state)
{
    (void)state;
    enum { N = 400000 };
    static const struct {
        double weight, deviation; /* of one survivor's weight */
        uint64_t event;
    } cases[] = {
        {0.03, 0.08, 5}, {0.7, 0.5, 5}, {0.7, 0.6, 4096}, {0.05, 0.15, 1024}, {0.7, 0.5, 4097}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        parian_random random = parian_random_stream(7, k, 0, 0);
        parian_walk_books books = {0};
        double sum = 0;
        for (int i = 0; i < N; i++) {
            double weight = cases[k].weight;
            books.started += weight;
            if (parian_walk_continue(&weight, cases[k].event, &random, &books)) {
                sum += weight;
                assert_true(weight >= PARIAN_WALK_THRESHOLD);
            }
        }
        books.left = sum;
        assert_within(sum / N, cases[k].weight, 4 * cases[k].deviation / sqrt(N), "mean weight");
        /* Sums of equal numbers may round the same way each time. */
        assert_within(parian_walk_books_gap(&books), 0, N * DBL_EPSILON / 2, "books");
    }
}

static void media_are_reduced_once(void **state)
{
    (void)state;
    parian_medium m = {
        .sigma_s_prime = {200, 300, 400}, .sigma_a = {2, 3, 0}, .g = {0.9, 0, -0.5}, .eta = 1.4};
    parian_walk_medium w = parian_walk_medium_make(&m, 0);
    assert_within(w.sigma_s, 2000, 1e-9, "sigma_s");
    assert_within(w.albedo, 2000.0 / 2002, 1e-15, "albedo");
    assert_within(parian_walk_medium_make(&m, 2).sigma_s, 400 / 1.5, 1e-12, "sigma_s behind");
    assert_true(parian_walk_medium_make(&m, 2).albedo == 1);
    m.reduced_only = true;
    w = parian_walk_medium_make(&m, 0);
    assert_true(w.sigma_s == 200 && w.g == 0 && w.eta == 1.4 && w.sigma_t == 202);
    assert_true(parian_walk_medium_of(0, 0, 0, 1).albedo == 0);
}

/* Analog walks through an index-matched slab of optical thickness 1, from a cosine-weighted
 * direction in one of three equal ranges of the cosine into one of them; counts of what is
 * transmitted. */
static void count_transmitted(double g, double albedo, int walks, double count[3][3])
{
    for (int from = 0; from < 3; from++) {
        for (int i = 0; i < walks; i++) {
            parian_random random = parian_random_stream(8, (uint64_t)from, (uint64_t)i, 0);
            double low = from / 3.0, high = (from + 1) / 3.0, u = parian_random_unit(&random);
            double mu = sqrt(low * low + u * (high * high - low * low));
            double d[3] = {sqrt(1 - mu * mu), 0, mu}, z = 0;
            for (;;) {
                z += parian_walk_flight(1, &random) * d[2];
                if (z < 0 || z > 1 || parian_random_unit(&random) > albedo) {
                    break;
                }
                parian_walk_scatter(d, g, &random);
            }
            if (z > 1) {
                count[from][d[2] < 1 ? (int)(3 * d[2]) : 2] += 1;
            }
        }
    }
}

/* Reciprocity: with m the integral of the cosine over a range, P(a to b) m_a = P(b to a) m_b. */
static void transmission_is_reciprocal(void **state)
{
    (void)state;
    enum { WALKS = 200000 };
    static const double measure[3] = {1, 3, 5}; /* of the cosine over the ranges, times 18 */
    for (int k = 0; k < 3; k++) {
        double count[3][3] = {{0}};
        count_transmitted(k == 0 ? 0 : k == 1 ? 0.8 : -0.5, 0.95, WALKS, count);
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < a; b++) {
                double there = count[a][b] * measure[a], back = count[b][a] * measure[b];
                double error = sqrt(count[a][b] * measure[a] * measure[a] +
                                    count[b][a] * measure[b] * measure[b]);
                assert_within(there, back, 4 * error, "reciprocity");
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(logarithm_matches),
        cmocka_unit_test(flights_are_exponential),
        cmocka_unit_test(azimuths_are_uniform),
        cmocka_unit_test(polar_angles_have_their_moments),
        cmocka_unit_test(phase_is_the_density_of_polar_angles),
        cmocka_unit_test(polar_angles_at_the_ends),
        cmocka_unit_test(turns_keep_angle_and_length),
        cmocka_unit_test(scattering_forgets_the_direction),
        cmocka_unit_test(reflectance_is_exact),
        cmocka_unit_test(refraction_is_reversible),
        cmocka_unit_test(roulettes_are_unbiased),
        cmocka_unit_test(media_are_reduced_once),
        cmocka_unit_test(transmission_is_reciprocal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
