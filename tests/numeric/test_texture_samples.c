/* test_texture_samples.c - texture-space importance sampling: places, flux, unbiasedness, the fall
 * of the error.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "cpu/cpu_texture.h"
#include "support/lit_body.h"
#include "support/transport_case.h"

typedef struct sampled_body {
    parian_body body;
    parian_transport_model model;
    parian_flux_pyramid pyramid;
    float (*e)[3], (*b)[3];
} sampled_body;

static void prepare(const parian_env *env, sampled_body *s)
{
    parian_body *body = &s->body;
    assert_true(PARIAN_NEW0(env, s->e, body->texel_count));
    assert_true(PARIAN_NEW0(env, s->b, body->texel_count));
    assert_int_equal(parian_transport_model_make(env, body, PARIAN_MODEL_FULL, &s->model),
                     PARIAN_OK);
    assert_int_equal(parian_flux_pyramid_create(env, body, &s->pyramid), PARIAN_OK);
}

/* A figure with ears, 20 mm, of charts that leave much of a side of no power of two empty. */
static sampled_body make_figure(const parian_env *env, uint32_t cut, const parian_medium *medium)
{
    sampled_body s = {.model.flux = false};
    parian_mesh mesh = {0};
    assert_int_equal(test_figure(env, 0.01, 6, &mesh), PARIAN_OK);
    assert_int_equal(
        test_lit_body(env, &mesh, &(test_lit_desc){.cut = cut, .form = PARIAN_LOCAL_NONE}, &s.body),
        PARIAN_OK);
    parian_mesh_free(env, &mesh);
    s.body.medium = *medium;
    prepare(env, &s);
    case_illuminate(&s.body, CASE_DIRECTIONAL, 0.02, s.e);
    for (uint32_t t = 0; t < s.body.texel_count; t++) { /* light with a colour that varies */
        s.e[t][0] *= 1 + 20 * fabsf(s.body.texel_position[t][0]);
        s.e[t][2] *= 0.5f;
    }
    return s;
}

static void release(const parian_env *env, sampled_body *s)
{
    parian_flux_pyramid_free(env, &s->pyramid);
    parian_transport_model_free(env, &s->model);
    parian_free(env, s->e);
    parian_free(env, s->b);
    parian_body_free(env, &s->body);
}

/* B by count samples of a seed, into s->b; the samples' flux is added to flux where that is given.
 */
static void sample_radiosity(const parian_env *env, sampled_body *s, uint32_t seed, uint32_t count,
                             double flux[3])
{
    float(*number)[3];
    parian_flux_sample *sample;
    assert_true(PARIAN_NEW(env, number, count) && PARIAN_NEW(env, sample, count));
    parian_texture_numbers(seed, count, number);
    parian_flux_pyramid_build(env, &s->body, (const float(*)[3])s->e, &s->pyramid);
    parian_texture_samples_draw(env, &s->body, &s->pyramid, (const float(*)[3])s->e,
                                (const float(*)[3])number, count, sample);
    for (uint32_t i = 0; flux && i < count; i++) {
        for (int c = 0; c < 3; c++) {
            flux[c] += (double)sample[i].flux[c];
        }
    }
    assert_int_equal(parian_cpu_texture_gather(env, &s->body, &s->model, sample, count, s->b),
                     PARIAN_OK);
    parian_free(env, sample);
    parian_free(env, number);
}

/* The integral that the samples estimate: each texel as 6 x 6 points of the square of its area. */
static void integrate(const sampled_body *s, uint32_t at, double radiosity[3])
{
    const parian_body *body = &s->body;
    memset(radiosity, 0, 3 * sizeof *radiosity);
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *n = body->texel_normal[i];
        double side = sqrt((double)body->texel_area[i]), t[3], b[3], sum[3] = {0};
        double axis[3] = {fabsf(n[0]) < 0.6f, fabsf(n[0]) >= 0.6f, 0};
        double normal[3] = {(double)n[0], (double)n[1], (double)n[2]};
        parian_cross3(normal, axis, t);
        double length = sqrt(parian_dot3(t, t));
        for (int k = 0; k < 3; k++) {
            t[k] /= length;
        }
        parian_cross3(normal, t, b);
        for (int k = 0; k < 36; k++) {
            double u = side * ((k % 6 + 0.5) / 6 - 0.5), v = side * ((k / 6 + 0.5) / 6 - 0.5);
            double r2 = 0;
            for (int c = 0; c < 3; c++) {
                double d = (double)body->texel_position[i][c] + u * t[c] + v * b[c] -
                           (double)body->texel_position[at][c];
                r2 += d * d;
            }
            for (int c = 0; c < 3; c++) {
                sum[c] += parian_dipole_rd(&s->model.dipole[c], r2) / 36;
            }
        }
        for (int c = 0; c < 3; c++) {
            radiosity[c] += sum[c] * (double)body->texel_area[i] * (double)s->e[i][c];
        }
    }
}

/* Even numbers lead to even flux: a texel gets its share of N to within 2, in every level. */
static void texels_get_their_share(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    sampled_body s = make_figure(env, 5, &case_marble);
    enum { COUNT = 20000 };
    float(*number)[3];
    uint32_t *hits;
    assert_true(PARIAN_NEW(env, number, COUNT));
    parian_flux_pyramid_build(env, &s.body, (const float(*)[3])s.e, &s.pyramid);
    assert_true(s.pyramid.side > s.body.atlas_size); /* no power of two */
    parian_texture_numbers(3, COUNT, number);
    for (uint32_t k = 0; k < s.pyramid.level_count; k++) {
        uint32_t side = s.pyramid.side >> k;
        float total = s.pyramid.level[s.pyramid.level_count - 1][0];
        assert_true(PARIAN_NEW0(env, hits, (size_t)side * side));
        for (uint32_t i = 0; i < COUNT; i++) {
            uint32_t place = parian_flux_pyramid_find(&s.pyramid, number[i][0]);
            hits[(place / s.pyramid.side >> k) * side + (place % s.pyramid.side >> k)]++;
        }
        for (uint32_t i = 0; i < side * side; i++) {
            double share = COUNT * (double)(s.pyramid.level[k][i] / total);
            assert_true(fabs(hits[i] - share) < 2.01);
            assert_true(s.pyramid.level[k][i] > 0 || hits[i] == 0);
        }
        parian_free(env, hits);
    }
    parian_free(env, number);
    release(env, &s);
}

/* Samples carry the flux of the light: exactly its mean over the channels, and each channel as well
 * as even shares of it allow. */
static void samples_carry_the_flux(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    sampled_body s = make_figure(env, 5, &case_marble);
    double flux[3] = {0}, truth[3] = {0};
    sample_radiosity(env, &s, 1, 1000, flux);
    for (uint32_t t = 0; t < s.body.texel_count; t++) {
        for (int c = 0; c < 3; c++) {
            truth[c] += (double)s.body.texel_area[t] * (double)s.e[t][c];
        }
    }
    double all = flux[0] + flux[1] + flux[2], should = truth[0] + truth[1] + truth[2];
    assert_true(fabs(all / should - 1) < 1e-5);
    for (int c = 0; c < 3; c++) {
        assert_true(fabs(flux[c] / truth[c] - 1) < 3e-3);
    }
    release(env, &s);
}

/* The mean over 64 seeds is the integral within 3 standard errors (at 20 receivers in three
 * channels; one such number in 370 lies outside by chance, these seeds do not). */
static void mean_of_seeds_is_the_integral(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    const parian_medium *media[] = {&case_marble, &case_skimmilk};
    for (int m = 0; m < 2; m++) {
        sampled_body s = make_figure(env, 4, media[m]);
        enum { SEEDS = 64, RECEIVERS = 20 };
        double sum[RECEIVERS][3] = {{0}}, squares[RECEIVERS][3] = {{0}};
        uint32_t step = s.body.texel_count / RECEIVERS;
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            sample_radiosity(env, &s, seed, 200, NULL);
            for (uint32_t r = 0; r < RECEIVERS; r++) {
                for (int c = 0; c < 3; c++) {
                    sum[r][c] += (double)s.b[r * step][c];
                    squares[r][c] += (double)s.b[r * step][c] * (double)s.b[r * step][c];
                }
            }
        }
        for (uint32_t r = 0; r < RECEIVERS; r++) {
            double truth[3];
            integrate(&s, r * step, truth);
            for (int c = 0; c < 3; c++) {
                double mean = sum[r][c] / SEEDS;
                double variance = fmax(0, squares[r][c] / SEEDS - mean * mean) / (SEEDS - 1);
                /* Points of the integral's 6 x 6 rule are good to a thousandth. */
                assert_true(fabs(mean - truth[c]) < 3 * sqrt(variance) + 1e-3 * truth[c]);
            }
        }
        release(env, &s);
    }
}

/* Root mean square error at receivers over seeds, relative. */
static double error_of(const parian_env *env, sampled_body *s, uint32_t count)
{
    enum { SEEDS = 8, RECEIVERS = 24 };
    uint32_t step = s->body.texel_count / RECEIVERS;
    double truth[RECEIVERS][3], difference = 0, norm = 0;
    for (uint32_t r = 0; r < RECEIVERS; r++) {
        integrate(s, r * step, truth[r]);
    }
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        sample_radiosity(env, s, seed, count, NULL);
        for (uint32_t r = 0; r < RECEIVERS; r++) {
            difference += pow((double)s->b[r * step][1] - truth[r][1], 2);
            norm += truth[r][1] * truth[r][1];
        }
    }
    return sqrt(difference / norm);
}

/* Sixteen times the samples: at most a quarter of the error, less by stratification. */
static void error_falls_as_the_root(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    sampled_body s = make_figure(env, 5, &case_skimmilk);
    double few = error_of(env, &s, 100), many = error_of(env, &s, 1600);
    assert_true(many < few / 4);
    assert_true(many > 0 && many < 0.1);
    release(env, &s);
}

/* On a plane far larger than the light goes, uniform E scatters to R_tot E. */
static void a_plane_reflects_its_total(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    const parian_medium dark = {.name = "dark",
                                .sigma_s_prime = {2190, 2620, 3000},
                                .sigma_a = {600, 800, 1000},
                                .eta = 1.3,
                                .reduced_only = true};
    sampled_body s = {.model.flux = false};
    enum { SIDE = 96 };
    case_plane(env, 12, SIDE / 12, 1e-4, &s.body);
    s.body.medium = dark;
    prepare(env, &s);
    case_illuminate(&s.body, CASE_UNIFORM, 1, s.e);
    double mean[3] = {0};
    for (uint32_t seed = 0; seed < 16; seed++) {
        sample_radiosity(env, &s, seed, 4096, NULL);
        for (int i = 0; i < 64; i++) { /* 8 x 8 texels in the middle, 2 apart */
            uint32_t at =
                (SIDE / 2 - 8 + 2 * ((uint32_t)i / 8)) * SIDE + SIDE / 2 - 8 + 2 * (i % 8);
            for (int c = 0; c < 3; c++) {
                mean[c] += (double)s.b[at][c] / (16 * 64);
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        /* What leaves beyond 4 mm is below 0.1 %. */
        double inside = parian_dipole_disc_energy(&s.model.dipole[c], 4e-3);
        double total = parian_dipole_total(&s.model.dipole[c]);
        assert_true(inside > 0.999 * total);
        assert_true(fabs(mean[c] / total - 1) < 0.01);
    }
    release(env, &s);
}

/* Charts of other sizes: B stays. */
static void charts_do_not_matter(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    double mean[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        sampled_body s = make_figure(env, i ? 9 : 4, &case_skimmilk);
        double area = 0;
        sample_radiosity(env, &s, 5, 6400, NULL);
        for (uint32_t t = 0; t < s.body.texel_count; t++) {
            mean[i] += (double)s.body.texel_area[t] * (double)s.b[t][1];
            area += (double)s.body.texel_area[t];
        }
        mean[i] /= area;
        release(env, &s);
    }
    /* E itself changes by some tenths of a per cent with the texels. */
    assert_true(fabs(mean[1] / mean[0] - 1) < 0.01);
}

static void darkness_and_single_texels(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    sampled_body s = make_figure(env, 4, &case_marble);
    double flux[3] = {0};
    memset(s.e, 0, s.body.texel_count * sizeof *s.e);
    sample_radiosity(env, &s, 0, 50, flux);
    for (uint32_t t = 0; t < s.body.texel_count; t++) {
        assert_true(s.b[t][0] == 0 && s.b[t][1] == 0 && s.b[t][2] == 0);
    }
    uint32_t lit = s.body.texel_count / 3;
    s.e[lit][1] = 7;
    sample_radiosity(env, &s, 0, 50, flux);
    assert_true(flux[0] == 0 && flux[2] == 0);
    assert_true(fabs(flux[1] / (7 * (double)s.body.texel_area[lit]) - 1) < 1e-5);
    release(env, &s);
}

static void same_for_any_threads(void **state)
{
    (void)state;
    sampled_body s = make_figure(test_env(1), 4, &case_marble);
    float(*first)[3];
    assert_true(PARIAN_NEW(NULL, first, s.body.texel_count));
    sample_radiosity(test_env(1), &s, 0, 333, NULL);
    memcpy(first, s.b, s.body.texel_count * sizeof *first);
    sample_radiosity(test_env(3), &s, 0, 333, NULL);
    assert_memory_equal(first, s.b, s.body.texel_count * sizeof *first);
    parian_free(NULL, first);
    release(test_env(1), &s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_get_their_share),        cmocka_unit_test(samples_carry_the_flux),
        cmocka_unit_test(mean_of_seeds_is_the_integral), cmocka_unit_test(error_falls_as_the_root),
        cmocka_unit_test(a_plane_reflects_its_total),    cmocka_unit_test(charts_do_not_matter),
        cmocka_unit_test(darkness_and_single_texels),    cmocka_unit_test(same_for_any_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
