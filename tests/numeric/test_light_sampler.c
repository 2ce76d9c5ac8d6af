/* test_light_sampler.c - light samples and radiance of every type against closed forms and against
 * each other; E with shadows.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/reference/rays.h"
#include "bake/reference/reference_scene.h"
#include "core/fresnel.h"
#include "core/memory.h"

static const double pi = 3.14159265358979323846, golden = 0.61803398874989484820;

static char said[512];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(said, sizeof said, "%s", text);
    }
}

static const parian_env listening = {.log = keep_error};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void assert_close(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected))) {
        print_error("found %.12g, expected %.12g within %g\n", found, expected, relative);
        fail();
    }
}

/* Even points of the unit square, and of the sphere. */
static void square_point(size_t i, size_t count, double *u, double *v)
{
    *u = ((double)i + 0.5) / (double)count;
    *v = golden * (double)i - floor(golden * (double)i);
}

static void sphere_point(size_t i, size_t count, double direction[3])
{
    double u, v;
    square_point(i, count, &u, &v);
    double z = 1 - 2 * u, s = sqrt(1 - z * z);
    direction[0] = s * cos(2 * pi * v);
    direction[1] = s * sin(2 * pi * v);
    direction[2] = z;
}

/* Irradiance on a plane of this normal (no Fresnel) by count samples of one light. */
static void plane_irradiance(const parian_light_sampler *sampler, const double x[3],
                             const double normal[3], size_t count, double E[3])
{
    E[0] = E[1] = E[2] = 0;
    for (size_t i = 0; i < count; i++) {
        parian_light_sample sample;
        double u, v;
        square_point(i, count, &u, &v);
        if (parian_light_sampler_sample(sampler, 0, x, u, v, &sample)) {
            double cosine = fmax(0, dot(sample.direction, normal));
            for (int c = 0; c < 3; c++) {
                E[c] += cosine * sample.irradiance[c] / (double)count;
            }
        }
    }
}

/* The same from radiance over all directions. */
static void radiance_irradiance(const parian_light_sampler *sampler, const double x[3],
                                const double normal[3], size_t count, double E[3])
{
    E[0] = E[1] = E[2] = 0;
    for (size_t i = 0; i < count; i++) {
        double direction[3], L[3];
        sphere_point(i, count, direction);
        parian_light_sampler_radiance(sampler, PARIAN_RAY_NONE, x, direction, L, NULL);
        double cosine = fmax(0, dot(direction, normal));
        for (int c = 0; c < 3; c++) {
            E[c] += cosine * L[c] * 4 * pi / (double)count;
        }
    }
}

static parian_light_sampler *make_sampler(const parian_light *light)
{
    parian_light_sampler *sampler = NULL;
    assert_int_equal(parian_light_sampler_create(NULL, light, 1, &sampler), PARIAN_OK);
    return sampler;
}

/* ---- lights without extent ---- */

static void point_and_directional(void **state)
{
    (void)state;
    const parian_light point = {
        .type = PARIAN_LIGHT_POINT, .position = {1, 2, 3}, .color = {4, 5, 6}};
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, -3, 4}, .color = {7, 8, 9}};
    parian_light_sample sample;
    const double x[3] = {1, 2, 1};
    parian_light_sampler *sampler = make_sampler(&point);
    assert_true(parian_light_sampler_sample(sampler, 0, x, 0, 0, &sample));
    assert_true(sample.distance == 2 && sample.direction[2] == 1 && sample.irradiance[0] == 1);
    assert_true(parian_light_is_delta(parian_light_sampler_light(sampler, 0)));
    const double at[3] = {1, 2, 3};
    assert_false(parian_light_sampler_sample(sampler, 0, at, 0, 0, &sample));
    const double by[3] = {1, 2, 3 - 1e-15};
    assert_true(parian_light_sampler_sample(sampler, 0, by, 0, 0, &sample) &&
                isfinite(sample.irradiance[2]));
    parian_light_sampler_destroy(sampler);
    sampler = make_sampler(&sun);
    assert_true(parian_light_sampler_sample(sampler, 0, x, 0, 0, &sample));
    assert_true(sample.distance == INFINITY && sample.irradiance[2] == 9);
    assert_close(sample.direction[1], 0.6, 1e-12);
    assert_close(sample.direction[2], -0.8, 1e-12);
    parian_light_sampler_destroy(sampler);
}

/* Power through a sphere around a spot, by 400,000 directions: 2 pi I (1 - (cos inner + cos outer)
 * / 2), which is what a smoothstep in the cosine gives exactly; the rule is good to 1e-4. */
static void spot_has_its_flux(void **state)
{
    enum { COUNT = 400000 };
    (void)state;
    static const float cones[][2] = {{10, 40}, {20, 20.01f}, {0, 80}, {30, 45}};
    for (size_t k = 0; k < sizeof cones / sizeof *cones; k++) {
        const parian_light light = {.type = PARIAN_LIGHT_SPOT,
                                    .direction = {1, -2, 0.5f},
                                    .color = {1, 2, 3},
                                    .inner_deg = cones[k][0],
                                    .outer_deg = cones[k][1]};
        parian_light_sampler *sampler = make_sampler(&light);
        double flux = 0;
        for (size_t i = 0; i < COUNT; i++) {
            double x[3];
            parian_light_sample sample;
            sphere_point(i, COUNT, x);
            if (parian_light_sampler_sample(sampler, 0, x, 0, 0, &sample)) {
                flux += sample.irradiance[1] * 4 * pi / COUNT;
            }
        }
        double inner = cos((double)cones[k][0] * pi / 180),
               outer = cos((double)cones[k][1] * pi / 180);
        assert_close(flux, 2 * 2 * pi * (1 - 0.5 * (inner + outer)), 1e-3);
        parian_light_sampler_destroy(sampler);
    }
}

/* Between the cones smoothstep of the cosine's share: 0 0, 1/4 5/32, 1/2 1/2, 3/4 27/32, 1 1. */
static void spot_fades_by_smoothstep(void **state)
{
    (void)state;
    const parian_light light = {.type = PARIAN_LIGHT_SPOT,
                                .direction = {0, 0, -1},
                                .color = {1, 1, 1},
                                .inner_deg = 20,
                                .outer_deg = 50};
    static const double expected[] = {0, 5.0 / 32, 0.5, 27.0 / 32, 1};
    parian_light_sampler *sampler = make_sampler(&light);
    for (int k = 1; k < 5; k++) {
        double inner = cos(20 * pi / 180), outer = cos(50 * pi / 180);
        double cosine = outer + 0.25 * k * (inner - outer), sine = sqrt(1 - cosine * cosine);
        const double x[3] = {3 * sine, 0, -3 * cosine};
        parian_light_sample sample;
        assert_true(parian_light_sampler_sample(sampler, 0, x, 0, 0, &sample));
        assert_close(sample.irradiance[0], expected[k] / 9, 1e-9);
    }
    parian_light_sampler_destroy(sampler);
}

/* The slide's square stands around the outer cone, its top towards up: a beam along -z with up +y
 * throws the upper right pixel to +x +y, as seen along the beam. Black beyond the square; between
 * centres bilinear. */
static void slide_is_upright(void **state)
{
    (void)state;
    static const float pixel[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    parian_light light = {.type = PARIAN_LIGHT_SPOT,
                          .direction = {0, 0, -1},
                          .color = {1, 1, 1},
                          .inner_deg = 44.99f,
                          .outer_deg = 45,
                          .image = {2, 2, pixel}};
    parian_light_sampler *sampler = make_sampler(&light);
    static const double x[4][2] = {{-0.5, 0.5}, {0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}};
    parian_light_sample sample;
    for (int k = 0; k < 4; k++) { /* the square is 2 wide at distance 1, pixel centres at +-0.5 */
        const double at[3] = {x[k][0], x[k][1], -1};
        assert_true(parian_light_sampler_sample(sampler, 0, at, 0, 0, &sample));
        for (int c = 0; c < 3; c++) {
            assert_true(fabs(sample.irradiance[c] - (double)pixel[k][c] / 1.5) < 1e-6);
        }
    }
    const double middle[3] = {0, 0, -2};
    assert_true(parian_light_sampler_sample(sampler, 0, middle, 0, 0, &sample));
    assert_close(sample.irradiance[0], 0.5 / 4, 1e-12);
    const double beyond[3] = {0, 1.01, -1}, behind[3] = {0, 0, 1};
    assert_false(parian_light_sampler_sample(sampler, 0, beyond, 0, 0, &sample));
    assert_false(parian_light_sampler_sample(sampler, 0, behind, 0, 0, &sample));
    parian_light_sampler_destroy(sampler);
    light.up[0] = 1; /* the top now points to +x: what was at -x +y is at +x +y */
    sampler = make_sampler(&light);
    const double corner[3] = {0.5, 0.5, -1};
    assert_true(parian_light_sampler_sample(sampler, 0, corner, 0, 0, &sample));
    assert_true(sample.irradiance[0] > 0.6 && sample.irradiance[1] < 1e-6);
    parian_light_sampler_destroy(sampler);
}

/* ---- rectangles ---- */

/* Irradiance of a polygon of radiance 1 that is wholly above the plane.
 * Source  Lambert's formula: half the sum of the angles that edges subtend times their planes'
 * cosines */
static double polygon_irradiance(const double corner[4][3], const double x[3],
                                 const double normal[3])
{
    double sum = 0;
    for (int k = 0; k < 4; k++) {
        double a[3], b[3], n[3];
        for (int c = 0; c < 3; c++) {
            a[c] = corner[k][c] - x[c];
            b[c] = corner[(k + 1) % 4][c] - x[c];
        }
        n[0] = a[1] * b[2] - a[2] * b[1];
        n[1] = a[2] * b[0] - a[0] * b[2];
        n[2] = a[0] * b[1] - a[1] * b[0];
        double length = sqrt(dot(n, n));
        sum += 0.5 * atan2(length, dot(a, b)) * dot(n, normal) / length;
    }
    return fabs(sum);
}

/* Rectangles and a parallelogram above a point, tilted and near; samples converge to 1e-4 with
 * 200,000 (an even rule, smooth integrand), radiance over directions to 2e-3 with 2,000,000 (the
 * rim is a step). */
static void rect_has_its_form_factor(void **state)
{
    (void)state;
    static const parian_light lights[] = {{.type = PARIAN_LIGHT_RECT,
                                           .position = {0, 0, 1},
                                           .axis_u = {0, 1, 0},
                                           .axis_v = {1, 0, 0},
                                           .color = {1, 2, 3}},
                                          {.type = PARIAN_LIGHT_RECT,
                                           .position = {0.5f, 0.2f, 0.6f},
                                           .axis_u = {0, 0.3f, 0.1f},
                                           .axis_v = {0.4f, 0, 0.2f},
                                           .color = {1, 2, 3}},
                                          {.type = PARIAN_LIGHT_RECT,
                                           .position = {-0.1f, 0.1f, 0.5f},
                                           .axis_u = {0.1f, 0.3f, 0},
                                           .axis_v = {0.4f, 0.3f, 0},
                                           .color = {1, 2, 3}}};
    const double x[3] = {0.05, 0.02, 0}, normal[3] = {0, 0, 1}, away[3] = {0, 0, 2};
    for (size_t l = 0; l < sizeof lights / sizeof *lights; l++) {
        const parian_light *light = &lights[l];
        parian_light_sampler *sampler = make_sampler(light);
        double corner[4][3], E[3];
        for (int k = 0; k < 4; k++) {
            for (int c = 0; c < 3; c++) {
                corner[k][c] = (double)light->position[c] +
                               (k == 1 || k == 2 ? 1 : -1) * (double)light->axis_u[c] +
                               (k >= 2 ? 1 : -1) * (double)light->axis_v[c];
            }
        }
        double expected = polygon_irradiance(corner, x, normal);
        plane_irradiance(sampler, x, normal, 200000, E);
        assert_close(E[0], expected, 1e-4);
        assert_close(E[2], 3 * expected, 1e-4);
        radiance_irradiance(sampler, x, normal, 2000000, E);
        assert_close(E[1], 2 * expected, 2e-3);
        plane_irradiance(sampler, away, (const double[3]){0, 0, -1}, 1000, E);
        assert_true(E[0] == 0); /* its back is dark */
        parian_light_sampler_destroy(sampler);
    }
}

/* What a ray sees: the shining side of a rectangle hides the sky behind it, its back hides nothing.
 */
static void rect_hides_the_sky(void **state)
{
    (void)state;
    const parian_light lights[2] = {{.type = PARIAN_LIGHT_ENVIRONMENT, .color = {7, 7, 7}},
                                    {.type = PARIAN_LIGHT_RECT,
                                     .position = {0, 0, 1},
                                     .axis_u = {0, 1, 0},
                                     .axis_v = {1, 0, 0},
                                     .color = {1, 2, 3}}};
    const double below[3] = {0.2, 0.1, 0}, above[3] = {0.2, 0.1, 2}, up[3] = {0, 0, 1},
                 down[3] = {0, 0, -1};
    parian_light_sampler *sampler = NULL;
    double L[3], distance;
    assert_int_equal(parian_light_sampler_create(NULL, lights, 2, &sampler), PARIAN_OK);
    parian_light_sampler_radiance(sampler, PARIAN_RAY_NONE, below, up, L, &distance);
    assert_true(L[0] == 1 && L[1] == 2 && L[2] == 3 && distance == 1);
    parian_light_sampler_radiance(sampler, 0, below, up, L, &distance);
    assert_true(L[0] == 7 && distance == INFINITY); /* the sky alone was asked for */
    parian_light_sampler_radiance(sampler, PARIAN_RAY_NONE, above, down, L, &distance);
    assert_true(L[0] == 7 && L[2] == 7 && distance == INFINITY);
    parian_light_sampler_radiance(sampler, 1, above, down, L, &distance);
    assert_true(L[0] == 0 && distance == INFINITY);
    parian_light_sampler_destroy(sampler);
}

static void rect_stays_finite_on_itself(void **state)
{
    (void)state;
    const parian_light light = {
        .type = PARIAN_LIGHT_RECT, .axis_u = {1, 0, 0}, .axis_v = {0, 1, 0}, .color = {1, 1, 1}};
    parian_light_sampler *sampler = make_sampler(&light);
    for (int k = 0; k < 5; k++) {
        const double x[3] = {0, 0, k * 1e-17}, normal[3] = {0, 0, -1};
        double E[3];
        plane_irradiance(sampler, x, normal, 1000, E);
        assert_true(isfinite(E[0]) && E[0] >= 0);
    }
    parian_light_sampler_destroy(sampler);
}

/* ---- environments ---- */

enum { SKY_WIDTH = 24, SKY_HEIGHT = 12 };

static void paint_sky(float pixel[SKY_HEIGHT * SKY_WIDTH][3])
{
    for (int i = 0; i < SKY_HEIGHT * SKY_WIDTH; i++) {
        int x = i % SKY_WIDTH, y = i / SKY_WIDTH;
        pixel[i][0] = (x * 7 + y * 3) % 11 == 0 ? 9.0f : 0.1f;
        pixel[i][1] = y < 3 ? 2.0f : 0.0f;
        pixel[i][2] = x == 18 && y == 5 ? 50.0f : 0.0f;
    }
}

/* Samples give the sum over pixels of radiance times solid angle, and agree with radiance over
 * directions in irradiance on a tilted plane. */
static void sky_totals_and_agrees(void **state)
{
    enum { COUNT = 1000000 };
    (void)state;
    static float pixel[SKY_HEIGHT * SKY_WIDTH][3];
    paint_sky(pixel);
    const parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT,
                                .color = {0.5f, 1, 2},
                                .rotation_deg = 33,
                                .image = {SKY_WIDTH, SKY_HEIGHT, (const float(*)[3])pixel}};
    parian_light_sampler *sampler = make_sampler(&light);
    double expected[3] = {0}, found[3] = {0};
    size_t differing = 0;
    const double x[3] = {0, 0, 0}, normal[3] = {0.6, 0.64, -0.48};
    for (int i = 0; i < SKY_HEIGHT * SKY_WIDTH; i++) {
        double top = cos(pi * (i / SKY_WIDTH) / SKY_HEIGHT),
               bottom = cos(pi * (i / SKY_WIDTH + 1) / SKY_HEIGHT);
        for (int c = 0; c < 3; c++) {
            expected[c] +=
                (double)light.color[c] * (double)pixel[i][c] * (top - bottom) * 2 * pi / SKY_WIDTH;
        }
    }
    for (size_t i = 0; i < COUNT; i++) {
        parian_light_sample sample;
        double u, v, L[3];
        square_point(i, COUNT, &u, &v);
        assert_true(parian_light_sampler_sample(sampler, 0, x, u, v, &sample));
        assert_true(fabs(dot(sample.direction, sample.direction) - 1) < 1e-12);
        parian_light_sampler_radiance(sampler, 0, x, sample.direction, L, NULL);
        for (int c = 0; c < 3; c++) {
            found[c] += sample.irradiance[c] / COUNT;
            /* radiance is that of the pixel drawn: one factor for all channels */
            differing +=
                L[0] > 0 && fabs(sample.irradiance[c] * L[0] - L[c] * sample.irradiance[0]) >
                                1e-9 * L[0] * sample.irradiance[0];
        }
    }
    assert_true(differing <= 10); /* a few samples lie on borders of pixels to rounding */
    double E[2][3];
    plane_irradiance(sampler, x, normal, COUNT, E[0]);
    radiance_irradiance(sampler, x, normal, 2 * COUNT, E[1]);
    for (int c = 0; c < 3; c++) {
        assert_close(found[c], expected[c], 1e-3);
        assert_close(E[0][c], E[1][c], 5e-3); /* steps between pixels in both rules */
    }
    parian_light_sampler_destroy(sampler);
}

/* The centre column looks along -z, the right quarter along +x, the upper edge along +y; rotation
 * turns the sky counterclockwise from above: by 90 degrees the centre looks along -x. */
static void sky_is_the_right_way_round(void **state)
{
    (void)state;
    static float pixel[SKY_HEIGHT * SKY_WIDTH][3];
    static const double towards[3][3] = {{0, 0, -1}, {1, 0, 0}, {-1, 0, 0}};
    for (int k = 0; k < 3; k++) {
        int column = k == 1 ? SKY_WIDTH * 3 / 4 : SKY_WIDTH / 2;
        memset(pixel, 0, sizeof pixel);
        pixel[SKY_HEIGHT / 2 * SKY_WIDTH + column][0] = 1;
        pixel[0][1] = 1; /* next to the pole */
        const parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT,
                                    .color = {1, 1, 0},
                                    .rotation_deg = k == 2 ? 90 : 0,
                                    .image = {SKY_WIDTH, SKY_HEIGHT, (const float(*)[3])pixel}};
        parian_light_sampler *sampler = make_sampler(&light);
        const double x[3] = {0, 0, 0};
        double mean[2][3] = {{0}};
        for (int i = 0; i < 1000; i++) {
            parian_light_sample sample;
            double u, v;
            square_point((size_t)i, 1000, &u, &v);
            assert_true(parian_light_sampler_sample(sampler, 0, x, u, v, &sample));
            for (int c = 0; c < 3; c++) {
                mean[sample.irradiance[1] > 0][c] += sample.direction[c];
            }
        }
        /* a pixel is 15 degrees wide, and lies beside the axis by half of that */
        assert_true(dot(mean[0], towards[k]) > 0.97 * sqrt(dot(mean[0], mean[0])));
        assert_true(mean[1][1] > 0.97 * sqrt(dot(mean[1], mean[1])));
        parian_light_sampler_destroy(sampler);
    }
}

static void dark_and_uniform_skies(void **state)
{
    (void)state;
    static float black[4][3];
    parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 2, 3}};
    const double x[3] = {0, 0, 0}, normal[3] = {0, 0.6, 0.8};
    double E[3];
    parian_light_sampler *sampler = make_sampler(&light);
    plane_irradiance(sampler, x, normal, 100000, E);
    assert_close(E[2], 3 * pi, 1e-4);
    radiance_irradiance(sampler, x, normal, 100000, E);
    assert_close(E[1], 2 * pi, 1e-4);
    parian_light_sampler_destroy(sampler);
    light.image = (parian_light_image){2, 2, (const float(*)[3])black};
    sampler = make_sampler(&light);
    parian_light_sample sample;
    assert_false(parian_light_sampler_sample(sampler, 0, x, 0.5, 0.5, &sample));
    parian_light_sampler_destroy(sampler);
}

static void lights_without_sense_are_refused(void **state)
{
    (void)state;
    static const float bad_pixel[1][3] = {{1, -1, 0}}, endless_pixel[1][3] = {{1, INFINITY, 0}};
    const parian_light lights[] = {
        {.type = PARIAN_LIGHT_SPOT, .direction = {0, 0, 1}, .up = {0, NAN, 0}, .outer_deg = 40},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .image = {1, 1, endless_pixel}},
        {.type = (parian_light_type)9},
        {.type = PARIAN_LIGHT_POINT, .color = {NAN, 0, 0}},
        {.type = PARIAN_LIGHT_POINT, .position = {INFINITY, 0, 0}},
        {.type = PARIAN_LIGHT_DIRECTIONAL},
        {.type = PARIAN_LIGHT_SPOT, .direction = {0, 0, 1}, .inner_deg = 50, .outer_deg = 40},
        {.type = PARIAN_LIGHT_RECT, .axis_u = {1, 0, 0}, .axis_v = {2, 0, 0}},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .image = {1, 1, bad_pixel}},
        {.type = PARIAN_LIGHT_ENVIRONMENT, .image = {0, 1, bad_pixel}}};
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        parian_light_sampler *sampler = NULL;
        said[0] = 0;
        assert_int_equal(parian_light_sampler_create(&listening, &lights[i], 1, &sampler),
                         PARIAN_E_ARGUMENT);
        assert_non_null(strstr(said, "light 0"));
        assert_null(sampler);
    }
}

/* ---- E on bodies ---- */

static void make_scene(parian_mesh body, parian_mesh *surrounding, const parian_light *light,
                       parian_reference_scene *scene)
{
    parian_reference_body *bodies;
    parian_mesh *others;
    assert_true(PARIAN_NEW0(NULL, bodies, 1) && PARIAN_NEW0(NULL, others, 1));
    bodies[0] = (parian_reference_body){.mesh = body, .medium = {.eta = 1.5}};
    if (surrounding) {
        others[0] = *surrounding;
    }
    assert_int_equal(
        parian_reference_scene_make(NULL, bodies, 1, others, surrounding ? 1 : 0, light, 1, scene),
        PARIAN_OK);
}

static void irradiance_at(const parian_reference_scene *scene, const parian_receivers *receivers,
                          size_t i, uint32_t count, double E[3])
{
    parian_place place;
    parian_random random = parian_random_stream(4, i, 0, 0);
    parian_receiver_place(receivers, i, &place);
    E[0] = E[1] = E[2] = 0;
    parian_reference_irradiance(scene, 0, &place, count, &random, E);
}

/* A coarse ball under a sky of radiance 1: E = pi (1 - 2 C1(eta)) everywhere. The ball's own facets
 * hide a little of the sky near the horizon, where cosine and transmittance are small; the mean
 * over receivers is held to 0.1 %. */
static void uniform_sky_on_a_ball(void **state)
{
    enum { PLACES = 200 };
    (void)state;
    const parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 2, 3}};
    parian_mesh ball;
    parian_reference_scene scene;
    parian_receivers receivers;
    assert_int_equal(test_sphere(NULL, 0.03, 6, &ball), PARIAN_OK);
    make_scene(ball, NULL, &light, &scene);
    assert_int_equal(parian_receivers_spread(NULL, &scene, PLACES, 1, &receivers), PARIAN_OK);
    double mean[3] = {0}, expected = pi * parian_fresnel_exit_norm(1.5);
    for (size_t i = 0; i < PLACES; i++) {
        double E[3];
        irradiance_at(&scene, &receivers, i, 2000, E);
        assert_close(E[0], expected, 0.01);
        for (int c = 0; c < 3; c++) {
            mean[c] += E[c] / PLACES;
        }
    }
    for (int c = 0; c < 3; c++) {
        assert_close(mean[c], (c + 1) * expected, 1e-3);
    }
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* A ball of 320 facets under a distant light: E = cosine times transmittance of the smooth normal,
 * up to the horizon, at all but one place in 100 where the offset does not suffice; without it one
 * in nine of the places within 10 degrees of the horizon would be dark. */
static void facets_do_not_shadow_a_curved_surface(void **state)
{
    enum { PLACES = 4000 };
    (void)state;
    const parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .color = {1, 1, 1}, .direction = {1, -2, 3}};
    const double to_light[3] = {-1 / sqrt(14), 2 / sqrt(14), -3 / sqrt(14)};
    parian_mesh ball;
    parian_reference_scene scene;
    parian_receivers receivers;
    assert_int_equal(test_sphere(NULL, 0.03, 4, &ball), PARIAN_OK);
    make_scene(ball, NULL, &light, &scene);
    assert_int_equal(parian_receivers_spread(NULL, &scene, PLACES, 1, &receivers), PARIAN_OK);
    size_t near_horizon = 0, dark = 0;
    for (size_t i = 0; i < PLACES; i++) {
        double E[3], cosine = dot(receivers.smooth_normal[i], to_light);
        irradiance_at(&scene, &receivers, i, 1, E);
        if (cosine <= 0) {
            assert_true(E[0] == 0);
        } else if (E[0] == 0) {
            assert_true(cosine < sin(10 * pi / 180));
            dark++;
        } else {
            assert_close(E[0], cosine * parian_fresnel_transmittance(cosine, 1.5), 1e-9);
        }
        near_horizon += cosine > 0 && cosine < sin(10 * pi / 180);
    }
    assert_true(near_horizon > 200);
    assert_true(dark * 100 <= near_horizon);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* A disc of 64 corners above a plane, lit at an angle: places of the plane are dark inside the
 * disc's outline moved along the light, by the sagitta of a corner (1 - cos(pi / 64) = 0.12 % of
 * the radius) and rounding. */
static void disc_throws_its_shadow(void **state)
{
    enum { CORNERS = 64, PLACES = 5000 };
    (void)state;
    const parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .color = {1, 1, 1}, .direction = {0.3f, 0, -1}};
    parian_mesh plane, disc = {.vertex_count = CORNERS + 1, .triangle_count = CORNERS};
    parian_reference_scene scene;
    parian_receivers receivers;
    const double height = 0.05, radius = 0.02;
    assert_int_equal(test_plane(NULL, 0.1, 3, &plane), PARIAN_OK);
    assert_true(PARIAN_NEW0(NULL, disc.position, CORNERS + 1) &&
                PARIAN_NEW0(NULL, disc.triangle, CORNERS));
    for (uint32_t k = 0; k <= CORNERS; k++) {
        disc.position[k][0] = k < CORNERS ? radius * cos(2 * pi * k / CORNERS) : 0;
        disc.position[k][1] = k < CORNERS ? radius * sin(2 * pi * k / CORNERS) : 0;
        disc.position[k][2] = height;
        if (k < CORNERS) {
            disc.triangle[k][0] = CORNERS;
            disc.triangle[k][1] = k;
            disc.triangle[k][2] = (k + 1) % CORNERS;
        }
    }
    make_scene(plane, &disc, &light, &scene);
    assert_int_equal(parian_receivers_spread(NULL, &scene, PLACES, 1, &receivers), PARIAN_OK);
    size_t dark = 0;
    for (size_t i = 0; i < PLACES; i++) {
        double E[3], x = receivers.position[i][0] - 0.3 * height, y = receivers.position[i][1];
        double r = hypot(x, y) / radius;
        irradiance_at(&scene, &receivers, i, 1, E);
        if (r < 0.9987 || r > 1.0001) {
            assert_int_equal(E[0] == 0, r < 1);
        }
        dark += E[0] == 0;
    }
    /* evenly spread places measure its area: pi r^2 of 0.01 m^2 to a percent */
    assert_close((double)dark / PLACES, pi * radius * radius / 0.01, 0.01);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* A point light inside a closed ball, below every horizon, and one on a vertex: nothing, and
 * finite. */
static void lights_in_bad_places_give_nothing_infinite(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        parian_mesh ball;
        parian_reference_scene scene;
        parian_receivers receivers;
        assert_int_equal(test_sphere(NULL, 0.03, 4, &ball), PARIAN_OK);
        parian_light light = {
            .type = PARIAN_LIGHT_POINT, .color = {1, 1, 1}, .position = {0.01f, 0, 0.005f}};
        for (int k = 0; kind >= 1 && k < 3; k++) {
            light.position[k] = (float)(ball.position[5][k] * (kind == 2 ? 1 - 1e-4 : 1));
        }
        if (kind == 3) {
            light.type = PARIAN_LIGHT_RECT;
            light.axis_u[0] = light.axis_v[1] = 0.001f;
        }
        make_scene(ball, NULL, &light, &scene);
        assert_int_equal(parian_receivers_spread(NULL, &scene, 3000, 1, &receivers), PARIAN_OK);
        for (size_t i = 0; i < receivers.count; i++) {
            double E[3];
            irradiance_at(&scene, &receivers, i, 16, E);
            assert_true(isfinite(E[0]) && E[0] >= 0);
            if (kind == 0 || kind == 2) {
                assert_true(E[0] == 0);
            }
        }
        parian_receivers_free(NULL, &receivers);
        const double at[1][3] = {
            {(double)light.position[0], (double)light.position[1], (double)light.position[2]}};
        double E[3];
        assert_int_equal(parian_receivers_nearest(NULL, &scene, at, 1, &receivers), PARIAN_OK);
        irradiance_at(&scene, &receivers, 0, 16, E);
        assert_true(isfinite(E[0]) && E[0] >= 0);
        parian_receivers_free(NULL, &receivers);
        parian_reference_scene_free(NULL, &scene);
    }
}

/* Single samples have the expectation that many at once have: within four standard errors, for each
 * kind. */
static void single_samples_agree_with_many(void **state)
{
    enum { COUNT = 40000 };
    (void)state;
    static float pixel[SKY_HEIGHT * SKY_WIDTH][3];
    paint_sky(pixel);
    const parian_light lights[] = {
        {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_ENVIRONMENT,
         .color = {1, 1, 1},
         .image = {SKY_WIDTH, SKY_HEIGHT, (const float(*)[3])pixel}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 0.01f, 0.08f},
         .axis_u = {0, 0.02f, 0},
         .axis_v = {0.03f, 0, 0},
         .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_POINT, .position = {0, 0.01f, 0.08f}, .color = {1, 1, 1}}};
    for (size_t l = 0; l < sizeof lights / sizeof *lights; l++) {
        parian_mesh ball;
        parian_reference_scene scene;
        parian_receivers receivers;
        assert_int_equal(test_sphere(NULL, 0.03, 6, &ball), PARIAN_OK);
        make_scene(ball, NULL, &lights[l], &scene);
        const double point[1][3] = {{0.01, 0.01, 0.03}};
        assert_int_equal(parian_receivers_nearest(NULL, &scene, point, 1, &receivers), PARIAN_OK);
        parian_place place;
        parian_random random = parian_random_stream(8, l, 0, 0);
        parian_receiver_place(&receivers, 0, &place);
        double E[3], sum = 0, sum2 = 0;
        irradiance_at(&scene, &receivers, 0, COUNT, E);
        for (int i = 0; i < COUNT; i++) {
            double direction[3], one[3];
            parian_reference_light_sample(&scene, 0, &place, &random, direction, one);
            assert_true(fabs(dot(direction, direction) - 1) < 1e-9);
            sum += one[0] / COUNT;
            sum2 += one[0] * one[0] / COUNT;
        }
        assert_true(E[0] > 0);
        assert_true(fabs(sum - E[0]) <= 4 * sqrt(fmax(0, sum2 - sum * sum) / COUNT) + 1e-9 * E[0]);
        parian_receivers_free(NULL, &receivers);
        parian_reference_scene_free(NULL, &scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(point_and_directional),
        cmocka_unit_test(spot_has_its_flux),
        cmocka_unit_test(spot_fades_by_smoothstep),
        cmocka_unit_test(slide_is_upright),
        cmocka_unit_test(rect_has_its_form_factor),
        cmocka_unit_test(rect_hides_the_sky),
        cmocka_unit_test(rect_stays_finite_on_itself),
        cmocka_unit_test(sky_totals_and_agrees),
        cmocka_unit_test(sky_is_the_right_way_round),
        cmocka_unit_test(dark_and_uniform_skies),
        cmocka_unit_test(lights_without_sense_are_refused),
        cmocka_unit_test(uniform_sky_on_a_ball),
        cmocka_unit_test(facets_do_not_shadow_a_curved_surface),
        cmocka_unit_test(disc_throws_its_shadow),
        cmocka_unit_test(lights_in_bad_places_give_nothing_infinite),
        cmocka_unit_test(single_samples_agree_with_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
