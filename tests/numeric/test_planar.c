/* test_planar.c - random walks in half-space, slab and sphere against closed forms and independent
 * numbers.
 *
 * Seeds are fixed, so nothing here is left to chance. Bounds in standard errors: three where two
 * runs are compared for one number, four where many bins are. The same comparisons with a hundred
 * times the photons are in bench_walks.c.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "bake/reference/half_space.h"
#include "core/fresnel.h"
#include "core/memory.h"
#include "support/planar_oracles.h"

static void assert_within(double found, double expected, double bound, const char *what)
{
    if (!(fabs(found - expected) <= bound)) {
        print_error("%s: found %.9g, expected %.9g within %g\n", what, found, expected, bound);
        fail();
    }
}

static parian_planar_profile make(const parian_planar_desc *desc)
{
    const parian_env *env = test_env(0);
    parian_planar_profile profile;
    assert_int_equal(parian_planar_profile_make(env, desc, &profile), PARIAN_OK);
    assert_within(parian_walk_books_gap(&profile.books), 0, 1e-12, "books");
    assert_within(profile.books.left, (profile.total[0] + profile.total[1]) * (double)desc->photons,
                  1e-12 * (double)desc->photons, "what left");
    return profile;
}

static void drop(parian_planar_profile *profile)
{
    parian_planar_profile_free(test_env(0), profile);
}

/* Standard error of a difference to an oracle's value, whose own error is that of as many photons
 * of ours. */
static double combined(double error, uint64_t photons)
{
    return error * sqrt(1 + (double)photons / PLANAR_ORACLE_PHOTONS);
}

static void totals_match_the_oracle(void **state)
{
    (void)state;
    for (size_t i = 0; i < PLANAR_ORACLE_COUNT; i++) {
        const planar_oracle *o = &planar_oracles[i];
        parian_planar_desc desc =
            planar_oracle_desc(o, o->shape == PARIAN_HALF_SPACE ? 60000 : 150000, i + 1);
        parian_planar_profile p = make(&desc);
        for (int side = 0; side < 2; side++) {
            assert_within(p.total[side], o->total[side],
                          3 * combined(p.total_error[side], desc.photons), o->name);
        }
        /* The oracle prints six decimals. */
        assert_within(p.unscattered, o->unscattered,
                      3 * combined(p.unscattered_error, desc.photons) + 1e-6, o->name);
        drop(&p);
    }
}

typedef struct profile_oracle {
    planar_oracle shape;
    int side;
    double bin_width;
    uint32_t count;
    double bin[16];
} profile_oracle;

/* From the same files, bins added up; the last takes the rest. */
static const profile_oracle profiles[] = {
    {{"half-space", PARIAN_HALF_SPACE, 0, false, {0, 0}, 0},
     0,
     1,
     12,
     {0.155006, 0.113406, 0.093158, 0.075040, 0.060310, 0.048231, 0.039305, 0.032307, 0.026589,
      0.022046, 0.018416, 0.121131}},
    {{"slab 20, lit side", PARIAN_SLAB, 20, false, {0, 0}, 0},
     0,
     2,
     12,
     {0.268384, 0.167840, 0.108668, 0.071286, 0.047929, 0.033036, 0.023554, 0.016989, 0.012593,
      0.009250, 0.006970, 0.022019}},
    {{"slab 20, far side", PARIAN_SLAB, 20, false, {0, 0}, 0},
     1,
     4,
     12,
     {0.005767, 0.014610, 0.017368, 0.015709, 0.012250, 0.008578, 0.005562, 0.003555, 0.002162,
      0.001328, 0.000778, 0.001128}},
    {{"sphere 2", PARIAN_SPHERE, 2, false, {0, 0}, 0},
     0,
     0.5,
     13,
     {0.105978, 0.102332, 0.105401, 0.106227, 0.104388, 0.098828, 0.092668, 0.088816, 0.072091,
      0.054305, 0.036601, 0.019218, 0.002950}},
    {{"sphere 10", PARIAN_SPHERE, 10, false, {0, 0}, 0},
     0,
     2,
     16,
     {0.290877, 0.197937, 0.135539, 0.092665, 0.064621, 0.046340, 0.033852, 0.025160, 0.019120,
      0.014501, 0.010892, 0.008008, 0.005788, 0.003790, 0.002045, 0.000407}},
};

static void profiles_match_the_oracle(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof profiles / sizeof *profiles; i++) {
        const profile_oracle *o = &profiles[i];
        parian_planar_desc desc = planar_oracle_desc(&o->shape, i == 0 ? 60000 : 150000, 100 + i);
        desc.bin_count = o->count;
        desc.bin_width = o->bin_width;
        parian_planar_profile p = make(&desc);
        double square = 0, sum = 0;
        for (uint32_t k = 0; k < o->count; k++) {
            double error = combined(p.bin_error[o->side][k], desc.photons);
            assert_within(p.bin[o->side][k], o->bin[k], 4 * error + 5e-7, o->shape.name);
            square += pow((p.bin[o->side][k] - o->bin[k]) / error, 2);
            sum += p.bin[o->side][k];
        }
        assert_true(square <
                    o->count + 3.1 * sqrt(2.0 * o->count)); /* chi squared, about one in 500 */
        assert_within(sum, p.total[o->side], 1e-12, "bins add up");
        drop(&p);
    }
}

/* What leaves both sides without scattering: with R inside at the angle that diffuse light is
 * refracted to and e = exp(-chord), (1 - R) e (1 + R e + ...). Index 0: out of the far side, 1: the
 * lit side after one reflection (together: a sphere). mu = s^2 (3 - 2 s) softens both ends; 20,000
 * points leave below 1e-7. */
static void beer(parian_planar_shape shape, double size, double sigma_t, double eta, double out[2])
{
    enum { N = 20000 };
    double norm = 0, sum[2] = {0, 0};
    for (int i = 0; i < N; i++) {
        double s = (i + 0.5) / N, cone = eta < 1 ? eta * eta : 1, inside;
        double sin2 = cone * (1 - s * s * (3 - 2 * s));
        double weight = 6 * s * (1 - s) * (1 - parian_walk_fresnel(sqrt(1 - sin2), eta, &inside));
        double reflectance = parian_fresnel_reflectance(inside, 1 / eta);
        double e = exp(-sigma_t * (shape == PARIAN_SPHERE ? 2 * size * inside : size / inside));
        double first = (1 - reflectance) * e, again = reflectance * e;
        norm += weight;
        sum[0] += weight * first / (1 - again * again);
        sum[1] += weight * first * again / (1 - again * again);
    }
    out[0] = sum[0] / norm;
    out[1] = sum[1] / norm;
}

/* Without scattering all that leaves is unscattered, and known by side. */
static void absorbers_follow_beer(void **state)
{
    (void)state;
    static const double etas[] = {1, 1.5, 0.7, 2.5};
    for (int k = 0; k < 8; k++) {
        double eta = etas[k / 2], expected[2];
        parian_planar_desc desc = {.shape = k % 2 ? PARIAN_SPHERE : PARIAN_SLAB,
                                   .size = 0.8e-3,
                                   .medium = parian_walk_medium_of(0, 1000, 0, eta),
                                   .photons = 200000,
                                   .seed = (uint64_t)k};
        beer(desc.shape, desc.size, 1000, eta, expected);
        parian_planar_profile p = make(&desc);
        assert_within(p.unscattered, p.total[0] + p.total[1], 1e-12, "all is unscattered");
        assert_within(p.unscattered, expected[0] + expected[1], 3 * p.unscattered_error, "Beer");
        if (desc.shape == PARIAN_SLAB) {
            assert_within(p.total[1], expected[0], 3 * p.total_error[1], "far side");
            assert_within(p.total[0], expected[1], 3 * p.total_error[0], "lit side");
        }
        drop(&p);
    }
}

/* The unscattered part of a scattering body is the same integral, after any number of inner
 * reflections; and so are the oracle's numbers (three of its standard errors, and its sixth
 * decimal). */
static void unscattered_part_follows_beer(void **state)
{
    (void)state;
    for (size_t i = 0; i < PLANAR_ORACLE_COUNT; i++) {
        const planar_oracle *o = &planar_oracles[i];
        if (o->shape != PARIAN_HALF_SPACE && o->size <= 2) {
            double expected[2];
            parian_planar_desc desc = planar_oracle_desc(o, 200000, 200 + i);
            parian_planar_profile p = make(&desc);
            beer(o->shape, o->size, 1, 1.5, expected);
            double all = expected[0] + expected[1];
            assert_within(p.unscattered, all, 3 * p.unscattered_error, o->name);
            double oracle_error = p.unscattered_error * sqrt(200000 / PLANAR_ORACLE_PHOTONS);
            assert_within(o->unscattered, all, 3 * oracle_error + 1e-6, o->name);
            drop(&p);
        }
    }
}

/* The index-matched half-space with isotropic scattering, by Ambartsumian's equation for H:
 * reflectance of diffuse light 1 - 2 sqrt(1 - albedo) integral of H mu, of a beam along the normal
 * 1 - sqrt(1 - albedo) H(1). */
static void solve_h(double albedo, double *diffuse, double *normal)
{
    enum { N = 100, ROUNDS = 60 };
    static double h[N + 1];
    double root = sqrt(1 - albedo), moment = 0;
    for (int i = 0; i <= N; i++) {
        h[i] = 1;
    }
    for (int round = 0; round < ROUNDS; round++) {
        moment = 0;
        for (int i = 0; i <= N; i++) {
            double mu = i == N ? 1 : (i + 0.5) / N, sum = 0;
            for (int j = 0; j < N; j++) {
                double at = (j + 0.5) / N;
                sum += at * h[j] / (mu + at) / N;
            }
            h[i] = 1 / (root + albedo / 2 * sum);
            moment += i < N ? mu * h[i] / N : 0;
        }
    }
    *diffuse = 1 - 2 * root * moment;
    *normal = 1 - root * h[N];
}

static void half_space_follows_ambartsumian(void **state)
{
    (void)state;
    static const double albedos[] = {0.3, 0.9, 0.99};
    for (int k = 0; k < 6; k++) {
        double albedo = albedos[k / 2], expected[2];
        parian_planar_desc desc = {.shape = PARIAN_HALF_SPACE,
                                   .medium = parian_walk_medium_of(albedo, 1 - albedo, 0, 1),
                                   .normal_incidence = k % 2 == 1,
                                   .photons = 300000,
                                   .seed = 300 + (uint64_t)k};
        solve_h(albedo, &expected[0], &expected[1]);
        parian_planar_profile p = make(&desc);
        /* 100 points and 60 rounds leave 5e-6 (against 400 and 200). */
        assert_within(p.total[0], expected[k % 2], 3 * p.total_error[0] + 5e-6, "half-space");
        assert_true(p.unscattered == 0 && p.total[1] == 0);
        drop(&p);
    }
}

/* A second method, without noise and to 1e-4 up to |g| = 0.9: the same half-space by discrete
 * ordinates. */
static void half_space_agrees_with_discrete_ordinates(void **state)
{
    (void)state;
    static const double cases[][3] = {
        {0.9984376, 0, 1.5}, {0.9, 0.9, 1.3}, {0.99, -0.5, 1.4}, {0.99, 0.8, 0.7}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double albedo = cases[k][0], g = cases[k][1], eta = cases[k][2];
        parian_planar_desc desc = {.shape = PARIAN_HALF_SPACE,
                                   .medium = parian_walk_medium_of(albedo, 1 - albedo, g, eta),
                                   .photons = 60000,
                                   .seed = 350 + k};
        parian_planar_profile p = make(&desc);
        assert_within(p.total[0], parian_half_space_reflectance(albedo, g, eta),
                      3 * p.total_error[0] + 1e-4, "discrete ordinates");
        drop(&p);
    }
}

/* Numbers printed in the literature: a slab of optical thickness 2 with g = 0.75, and a half-space
 * of index 1.5 with the 4 % that the surface mirrors counted in. */
static void literature_is_met(void **state)
{
    (void)state;
    parian_planar_desc desc = {.shape = PARIAN_SLAB,
                               .size = 2,
                               .medium = parian_walk_medium_of(0.9, 0.1, 0.75, 1),
                               .normal_incidence = true,
                               .photons = 500000,
                               .seed = 3};
    parian_planar_profile p = make(&desc); /* [vandeHulst80], as quoted by [Wang95] */
    assert_within(p.total[0], 0.09739, 3 * p.total_error[0], "reflected by a slab");
    assert_within(p.total[1], 0.66096, 3 * p.total_error[1], "transmitted by a slab");
    drop(&p);
    desc.shape = PARIAN_HALF_SPACE;
    desc.medium = parian_walk_medium_of(0.9, 0.1, 0, 1.5);
    p = make(&desc); /* [Giovanelli55], as quoted by [Wang95] */
    assert_within(0.04 + 0.96 * p.total[0], 0.2600, 3 * 0.96 * p.total_error[0] + 5e-5,
                  "half-space");
    drop(&p);
}

/* Nothing absorbs: all leaves, but for roulette; the half-space's walks have no mean length, and
 * still end. */
static void white_furnace_gives_all_back(void **state)
{
    (void)state;
    static const struct {
        parian_planar_shape shape;
        double size, g, eta;
        uint64_t photons;
    } cases[] = {{PARIAN_HALF_SPACE, 0, 0, 1.5, 15000},   {PARIAN_HALF_SPACE, 0, 0.9, 1, 15000},
                 {PARIAN_SLAB, 5, 0, 1.5, 100000},        {PARIAN_SLAB, 50, 0.995, 0.7, 20000},
                 {PARIAN_SPHERE, 5, 0, 1.3, 100000},      {PARIAN_SPHERE, 20, -0.99, 2, 20000},
                 {PARIAN_SPHERE, 1e-9, 0.5, 1.5, 200000}, {PARIAN_SLAB, 1e-9, 0, 1.5, 200000},
                 {PARIAN_SLAB, 1e-3, 0, 1, 100000}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        parian_planar_desc desc = {.shape = cases[k].shape,
                                   .size = cases[k].size,
                                   .medium = parian_walk_medium_of(1, 0, cases[k].g, cases[k].eta),
                                   .photons = cases[k].photons,
                                   .seed = 400 + k};
        parian_planar_profile p = make(&desc);
        const parian_walk_books *b = &p.books;
        double error = hypot(p.total_error[0], p.total_error[1]);
        assert_within(p.total[0] + p.total[1], 1, 3 * error + 1e-12, "white furnace");
        assert_true(b->absorbed == 0 && b->lost == 0);
        assert_within(b->left + b->roulette_removed - b->roulette_added, (double)desc.photons,
                      1e-12 * (double)desc.photons, "energy with roulette's account");
        drop(&p);
    }
}

/* Thin and empty bodies, and every sign of g and side of eta = 1: finite, within [0, 1], books
 * closed. */
static void extremes_are_finite(void **state)
{
    (void)state;
    static const double g[] = {-0.99, 0, 1e-5, 0.995}, eta[] = {0.3, 0.999999, 1, 1.33, 5};
    for (int k = 0; k < 4 * 5 * 3; k++) {
        parian_planar_desc desc = {.shape = (parian_planar_shape)(k % 3),
                                   .size = 3e-3,
                                   .medium =
                                       parian_walk_medium_of(990, 10, g[k / 3 % 4], eta[k / 12]),
                                   .photons = 2000,
                                   .seed = (uint64_t)k,
                                   .bin_count = 8,
                                   .bin_width = 1e-3};
        parian_planar_profile p = make(&desc);
        double all = p.total[0] + p.total[1];
        assert_true(all > 0 && all <= 1.03 && p.books.lost_walks == 0);
        for (int bin = 0; bin < 8; bin++) {
            assert_true(isfinite(p.bin[0][bin]) && p.bin[0][bin] >= 0 &&
                        isfinite(p.bin_error[0][bin]));
        }
        drop(&p);
    }
    parian_planar_desc empty = {
        .shape = PARIAN_SPHERE, .size = 1, .medium = {.eta = 1.5}, .photons = 20000};
    parian_planar_profile p = make(&empty); /* a clear ball: all goes through */
    assert_within(p.total[0], 1, 3 * p.total_error[0], "clear ball");
    assert_true(p.books.events == 0);
    drop(&p);
}

/* Errors fall as N^-1/2 and are what the standard error says: 64 seeds at N and at 16 N; each root
 * mean square of 64 has an error of 9 %, their ratio of 12.5 %, and three of those are 37 %. */
static void errors_fall_with_the_root(void **state)
{
    (void)state;
    enum { SEEDS = 64 };
    parian_planar_desc desc = {.shape = PARIAN_SLAB,
                               .size = 1,
                               .medium = parian_walk_medium_of(0.95, 0.05, 0.5, 1.2),
                               .photons = 1000000,
                               .seed = 999};
    parian_planar_profile truth = make(&desc);
    double scatter[2] = {0, 0}, stated[2] = {0, 0};
    for (int level = 0; level < 2; level++) {
        desc.photons = level ? 16000 : 1000;
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            desc.seed = 1000 + seed;
            parian_planar_profile p = make(&desc);
            scatter[level] += pow(p.total[0] - truth.total[0], 2) / SEEDS;
            stated[level] += pow(p.total_error[0], 2) / SEEDS;
            drop(&p);
        }
        assert_within(sqrt(scatter[level] / stated[level]), 1, 0.27, "stated error");
    }
    assert_within(sqrt(scatter[0] / scatter[1]), 4, 4 * 0.37, "fall of the error");
    assert_within(sqrt(stated[0] / stated[1]), 4, 0.1, "fall of the stated error");
    drop(&truth);
}

static void bytes_do_not_depend_on_threads(void **state)
{
    (void)state;
    static const unsigned threads[] = {1, 2, 7};
    parian_planar_desc desc = {.shape = PARIAN_SLAB,
                               .size = 4,
                               .medium = parian_walk_medium_of(0.99, 0.01, 0.3, 1.5),
                               .photons = 20011,
                               .seed = 5,
                               .bin_count = 40,
                               .bin_width = 0.25};
    parian_planar_profile p[3];
    for (int k = 0; k < 3; k++) {
        assert_int_equal(parian_planar_profile_make(test_env(threads[k]), &desc, &p[k]), PARIAN_OK);
    }
    for (int k = 1; k < 3; k++) {
        assert_memory_equal(p[k].total, p[0].total, sizeof p[0].total);
        assert_memory_equal(p[k].total_error, p[0].total_error, sizeof p[0].total_error);
        assert_memory_equal(&p[k].books, &p[0].books, sizeof p[0].books);
        for (int side = 0; side < 2; side++) {
            assert_memory_equal(p[k].bin[side], p[0].bin[side], 40 * sizeof(double));
            assert_memory_equal(p[k].bin_error[side], p[0].bin_error[side], 40 * sizeof(double));
        }
        assert_true(p[k].unscattered == p[0].unscattered);
    }
    desc.seed = 6;
    parian_planar_profile other = make(&desc);
    assert_true(other.total[0] != p[0].total[0]);
    drop(&other);
    for (int k = 0; k < 3; k++) {
        parian_planar_profile_free(test_env(threads[k]), &p[k]);
    }
}

typedef struct watch {
    int calls;
    double last;
} watch;

static void follow(void *user, const char *stage, double fraction)
{
    watch *w = user;
    assert_non_null(stage);
    assert_true(fraction > w->last && fraction <= 1);
    w->last = fraction;
    w->calls++;
}

static bool stop_after_ten(void *user)
{
    return ((watch *)user)->calls >= 10;
}

static void progress_and_cancel(void **state)
{
    (void)state;
    watch w = {0, 0};
    parian_env env = {.progress = follow, .user = &w};
    parian_planar_desc desc = planar_oracle_desc(&planar_oracles[3], 5000, 1);
    parian_planar_profile p;
    assert_int_equal(parian_planar_profile_make(&env, &desc, &p), PARIAN_OK);
    assert_true(w.calls >= 32 && w.last == 1);
    parian_planar_profile_free(&env, &p);
    w = (watch){0, 0};
    env.cancelled = stop_after_ten;
    assert_int_equal(parian_planar_profile_make(&env, &desc, &p), PARIAN_E_INTERRUPTED);
    assert_true(w.calls == 10 && p.bin[0] == NULL);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    const parian_planar_desc good = {.shape = PARIAN_SLAB,
                                     .size = 1,
                                     .medium = parian_walk_medium_of(1, 0.1, 0, 1.5),
                                     .photons = 100,
                                     .bin_count = 4,
                                     .bin_width = 1};
    parian_planar_desc bad[13];
    for (int k = 0; k < 13; k++) {
        bad[k] = good;
    }
    bad[0].size = 0;
    bad[1].size = NAN;
    bad[2].size = INFINITY;
    bad[3].medium.sigma_s = -1;
    bad[4].medium.sigma_a = NAN;
    bad[5].medium.g = 1;
    bad[6].medium.g = NAN;
    bad[7].medium.eta = 0;
    bad[8].photons = 1;
    bad[9].bin_width = 0;
    bad[10].bin_count = UINT32_MAX;
    bad[11].medium.sigma_s = INFINITY;
    bad[12].shape = PARIAN_HALF_SPACE;
    bad[12].medium.sigma_s = bad[12].medium.sigma_a = 0;
    for (int k = 0; k < 13; k++) {
        parian_planar_profile p;
        memset(&p, 0x55, sizeof p);
        assert_int_equal(parian_planar_profile_make(NULL, &bad[k], &p), PARIAN_E_ARGUMENT);
        assert_true(p.bin[0] == NULL && p.bin_error[1] == NULL);
    }
    parian_planar_profile_free(NULL, NULL);
}

static void no_memory_is_told(void **state)
{
    (void)state;
    parian_planar_desc desc = planar_oracle_desc(&planar_oracles[3], 10, 1);
    desc.bin_count = 3;
    desc.bin_width = 1;
    for (size_t fail_at = 0; fail_at < 20; fail_at++) {
        test_memory memory = {.fail_at = fail_at};
        parian_env env = test_failing_env(&memory);
        parian_planar_profile p;
        parian_result result = parian_planar_profile_make(&env, &desc, &p);
        assert_int_equal(result, fail_at < 6 ? PARIAN_E_NOMEM : PARIAN_OK);
        parian_planar_profile_free(&env, &p);
        assert_int_equal(memory.live, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(totals_match_the_oracle),
        cmocka_unit_test(profiles_match_the_oracle),
        cmocka_unit_test(absorbers_follow_beer),
        cmocka_unit_test(unscattered_part_follows_beer),
        cmocka_unit_test(half_space_follows_ambartsumian),
        cmocka_unit_test(half_space_agrees_with_discrete_ordinates),
        cmocka_unit_test(literature_is_met),
        cmocka_unit_test(white_furnace_gives_all_back),
        cmocka_unit_test(extremes_are_finite),
        cmocka_unit_test(errors_fall_with_the_root),
        cmocka_unit_test(bytes_do_not_depend_on_threads),
        cmocka_unit_test(progress_and_cancel),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(no_memory_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
