/* test_path_tracing.c - volumetric path tracing in meshes against Monte Carlo totals, closed forms
 * and itself.
 *
 * Tolerances: k standard errors as the run itself states them (seeds are fixed, so a test that
 * passes keeps passing), plus what a mesh differs from the round body, or a patch from a point.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bake/reference/reference_scene.h"
#include "core/fresnel.h"
#include "support/path_outcome.h"

/* Total flux out per flux in of spheres of 1, 2, 5 mean free paths:
 * ../shared/oracles/mc/sph_mar_*.txt (about 1e6 photons: 1e-4). 0.1 % for the mesh, whose radius is
 * 0.1 % short on average. */
static const struct {
    double radius, total, ballistic;
} sphere_total[] = {{1, 0.994922, 0.159327}, {2, 0.989803, 0.027605}, {5, 0.974852, 0.000166}};

static void spheres_under_a_uniform_sky(void **state)
{
    (void)state;
    double incident = PARIAN_PI * parian_fresnel_exit_norm(1.5);
    for (size_t i = 0; i < sizeof sphere_total / sizeof *sphere_total; i++) {
        parian_path_desc desc = {.samples = 128, .seed = 1};
        outcome o = trace_sphere(sphere_total[i].radius * MM, 24, &path_case_marble, &path_case_sky,
                                 100, &desc);
        double error = path_case_error(&o.result, o.count, 0) / incident;
        assert_near("sphere under a sky", mean_b(&o, 0) / incident, sphere_total[i].total,
                    3 * error + 0.001);
        assert_near("  unscattered", mean_unscattered(&o, 0) / incident, sphere_total[i].ballistic,
                    0.012);
        assert_near("  E", path_case_mean((const double(*)[3])o.result.irradiance, o.count, 0),
                    incident, 0.005 * incident);
        assert_books(&o.result);
        release(&o);
    }
}

/* By symmetry a sphere gives back the same share of a directional light. Connections and the
 * remainder make up the adjoint number; 1,500 receivers in equal shares of the area sample a B that
 * varies by a few: 1 %. */
static void spheres_under_a_directional_light(void **state)
{
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {1, -2, 3}, .color = {4, 4, 4}};
    double incident = parian_fresnel_exit_norm(1.5);
    for (size_t i = 0; i < sizeof sphere_total / sizeof *sphere_total; i++) {
        parian_path_desc desc = {.samples = 6, .seed = 2};
        outcome o =
            trace_sphere(sphere_total[i].radius * MM, 12, &path_case_marble, &sun, 1500, &desc);
        double b = (mean_b(&o, 0) + mean_b(&o, 1) + mean_b(&o, 2)) / 3 / incident;
        double error = path_case_error(&o.result, o.count, 0) / incident / sqrt(3);
        assert_near("sphere under a directional light", b, sphere_total[i].total, 3 * error + 0.01);
        assert_books(&o.result);
        release(&o);
    }
}

/* The environment above the horizon alone: rows from top to bottom. */
static void make_upper_sky(float (*pixel)[3], uint32_t width, uint32_t height)
{
    for (uint32_t i = 0; i < width * height; i++) {
        pixel[i][0] = pixel[i][1] = pixel[i][2] = i < width * height / 2 ? 1 : 0;
    }
}

/* A box of thickness t along y, much wider than that, with receivers in the middle of both faces.
 */
static void make_slab(double side, double t, const parian_medium *medium, const parian_light *light,
                      parian_reference_scene *scene, outcome *o)
{
    parian_mesh mesh = {0};
    size_t found[2] = {0};
    assert_int_equal(test_box(test_env(2), side, t, side, 4, &mesh), PARIAN_OK);
    path_case_scene(test_env(2), &mesh, medium, light, 1, scene);
    const parian_mesh *m = &scene->bodies[0].mesh;
    double middle = 0.5 * (scene->lower[1] + scene->upper[1]);
    o->count = 16;
    path_case_receivers(test_env(2), o->count, &o->receivers);
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        double x[3] = {0};
        for (int k = 0; k < 9; k++) {
            x[k % 3] += m->position[m->triangle[i][k / 3]][k % 3] / 3;
        }
        double ax = fabs(x[0] - 0.5 * (scene->lower[0] + scene->upper[0]));
        double az = fabs(x[2] - 0.5 * (scene->lower[2] + scene->upper[2]));
        int below = x[1] < middle;
        if (ax < 0.3 * side && az < 0.3 * side &&
            found[below] < 8) { /* corner nearest to the middle */
            path_case_put(scene, &o->receivers, (size_t)below * 8 + found[below]++, i, 1.0 / 3,
                          1.0 / 3);
        }
    }
    assert_true(found[0] == 8 && found[1] == 8);
}

static double face_mean(const double (*value)[3], int below, int channel)
{
    return path_case_mean(value + (size_t)below * 8, 8, channel);
}

/* Reflectance and transmittance of slabs, ../shared/oracles/mc/slab_mar_*.txt, diffuse light. 0.5
 * %: the picture's rows at the horizon, and what leaves at the rim. */
static void slabs_under_half_a_sky(void **state)
{
    (void)state;
    static const double total[][3] = {
        {1, 0.358216, 0.634124}, {2, 0.480810, 0.503962}, {5, 0.635578, 0.327175}};
    static float pixel[256 * 4][3];
    make_upper_sky(pixel, 4, 256);
    parian_light sky = path_case_sky;
    sky.image = (parian_light_image){4, 256, (const float(*)[3])pixel};
    double incident = PARIAN_PI * parian_fresnel_exit_norm(1.5);
    for (int i = 0; i < 3; i++) {
        parian_path_desc desc = {.samples = 2048, .seed = 3};
        parian_reference_scene scene;
        outcome o;
        make_slab(80 * MM, total[i][0] * MM, &path_case_marble, &sky, &scene, &o);
        assert_int_equal(parian_reference_path(test_env(2), &scene, &o.receivers, &desc, &o.result),
                         PARIAN_OK);
        double error = path_case_error(&o.result, o.count, 0) / incident * sqrt(2);
        const double(*b)[3] = (const double(*)[3])o.result.radiosity;
        assert_near("slab, reflected", face_mean(b, 0, 0) / incident, total[i][1],
                    3 * error + 0.005);
        assert_near("slab, transmitted", face_mean(b, 1, 0) / incident, total[i][2],
                    3 * error + 0.005);
        assert_books(&o.result);
        release(&o);
        parian_reference_scene_free(test_env(2), &scene);
    }
}

/* Radiance 1 everywhere and no absorption: radiance eta^2 everywhere inside, B = pi (1 - 2 C1)
 * exactly, whatever the phase function and the convex shape. Every walk counts pi T of its first
 * crossing: a small error. */
static void white_furnace(void **state)
{
    (void)state;
    static const double eta[] = {1.5, 1, 0.8}, g[] = {0, 0.8, -0.5};
    for (int i = 0; i < 3; i++) {
        parian_medium medium = {.sigma_s_prime = {1000, 2000, 300}, .eta = eta[i]};
        medium.g[0] = medium.g[1] = medium.g[2] = g[i];
        parian_path_desc desc = {.samples = 64, .seed = 4};
        parian_mesh mesh = {0};
        parian_reference_scene scene;
        assert_int_equal(test_box(test_env(2), 3 * MM, 1 * MM, 2 * MM, 3, &mesh), PARIAN_OK);
        path_case_scene(test_env(2), &mesh, &medium, &path_case_sky, 1, &scene);
        outcome o = trace(&scene, 100, &desc);
        for (int c = 0; c < 3; c++) {
            double exact = PARIAN_PI * parian_fresnel_exit_norm(eta[i]);
            double error = path_case_error(&o.result, o.count, c);
            assert_near("white furnace", mean_b(&o, c), exact, 3.5 * error + 1e-9);
            assert_true(error <= 0.01 * exact);
            assert_true(o.result.absorbed[c] == 0);
        }
        assert_books(&o.result);
        release(&o);
    }
}

/* Walks against the light and photons from it are two estimates of one number that share no
 * sampling of paths: this is reciprocity. On a sphere of 5 mean free paths a patch of 0.2 mm moves
 * B by less than 2 %. */
static void walks_and_photons_agree(void **state)
{
    (void)state;
    const parian_light light[] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_POINT,
         .position = {0.006f, 0.002f, 0.001f},
         .color = {1e-5f, 1e-5f, 1e-5f}},
        {.type = PARIAN_LIGHT_SPOT,
         .position = {0, 0.02f, 0},
         .direction = {0, -1, 0},
         .inner_deg = 5,
         .outer_deg = 14,
         .color = {1e-4f, 1e-4f, 1e-4f}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 0, -0.01f},
         .axis_u = {0.005f, 0, 0},
         .axis_v = {0, 0.005f, 0},
         .color = {1, 1, 1}}};
    parian_medium medium = path_case_marble;
    medium.reduced_only = false;
    for (int c = 0; c < 3; c++) {
        medium.g[c] = 0.4;
    }
    for (size_t i = 0; i < sizeof light / sizeof *light; i++) {
        parian_path_desc desc[2] = {
            {.samples = 96, .seed = 5, .walk = PARIAN_WALK_ADJOINT},
            {.samples = 192, .seed = 6, .walk = PARIAN_WALK_FORWARD, .patch = 0.2 * MM}};
        double b[2] = {0}, error[2];
        for (int k = 0; k < 2; k++) {
            outcome o = trace_sphere(4 * MM, 12, &medium, &light[i], 200, &desc[k]);
            for (int c = 0; c < 3; c++) {
                b[k] += mean_b(&o, c) / 3;
            }
            error[k] = path_case_error(&o.result, o.count, 0) / sqrt(3);
            assert_books(&o.result);
            release(&o);
        }
        assert_near("walks and photons", b[0], b[1], 3 * hypot(error[0], error[1]) + 0.02 * b[1]);
    }
}

/* A sun is met by walks, byte for byte; a lamp of 0.3 mm a side, which walks that leave by chance
 * hardly ever find, by photons: 20 times less variance is asked for, about 100 is seen. Both kinds
 * estimate one number. */
static void the_better_walk_is_kept(void **state)
{
    (void)state;
    const parian_light light[2] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_RECT,
         .position = {0, 0, 0.008f},
         .axis_u = {0, 0.00015f, 0},
         .axis_v = {0.00015f, 0, 0},
         .color = {1, 1, 1}}};
    for (int i = 0; i < 2; i++) {
        outcome o[2];
        for (int k = 0; k < 2; k++) {
            parian_path_desc desc = {.samples = 128,
                                     .seed = 11,
                                     .patch = 0.2 * MM,
                                     .walk = k ? PARIAN_WALK_ADJOINT : PARIAN_WALK_AUTO};
            o[k] = trace_sphere(4 * MM, 12, &path_case_marble, &light[i], 200, &desc);
        }
        double automatic = path_case_error(&o[0].result, o[0].count, 0);
        double adjoint = path_case_error(&o[1].result, o[1].count, 0);
        if (i == 0) {
            assert_memory_equal(o[0].result.radiosity, o[1].result.radiosity,
                                o[0].count * sizeof *o[0].result.radiosity);
        } else {
            assert_true(automatic * automatic * 20 < adjoint * adjoint);
            assert_near("photons for a small lamp", mean_b(&o[0], 0), mean_b(&o[1], 0),
                        3 * hypot(automatic, adjoint) + 0.02 * mean_b(&o[0], 0));
        }
        release(&o[0]);
        release(&o[1]);
    }
}

/* A lamp of 3 um, and of one channel alone: no walk of the pilot leaves towards it, so that photons
 * must be taken because they found it at all. They are those of a run that was told to. */
static void lamps_that_walks_never_find(void **state)
{
    (void)state;
    const parian_light light = {.type = PARIAN_LIGHT_RECT,
                                .position = {0, 0, 0.008f},
                                .axis_u = {0, 1.5e-6f, 0},
                                .axis_v = {1.5e-6f, 0, 0},
                                .color = {0, 0, 1}};
    outcome o[2];
    for (int k = 0; k < 2; k++) {
        parian_path_desc desc = {.samples = 128,
                                 .seed = 11,
                                 .patch = 0.2 * MM,
                                 .walk = k ? PARIAN_WALK_FORWARD : PARIAN_WALK_AUTO};
        o[k] = trace_sphere(4 * MM, 12, &path_case_marble, &light, 60, &desc);
    }
    assert_true(mean_b(&o[0], 0) == 0 && mean_b(&o[0], 2) > 0);
    assert_memory_equal(o[0].result.radiosity, o[1].result.radiosity,
                        o[0].count * sizeof *o[0].result.radiosity);
    release(&o[0]);
    release(&o[1]);
}

/* A box beside a black one, 4 um away: photons that leave the first are not counted on the second,
 * and the first's patches are not measured with the second's surface. By walks the same places give
 * the same B: 3 standard errors and 4 % for what patches of 0.1 mm blur; with the neighbour's area
 * it would be 30 % less. */
static void patches_keep_to_their_body(void **state)
{
    enum { COUNT = 24 };
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {1, 1, 1}};
    const parian_medium black = {.sigma_a = {1e7, 1e7, 1e7}, .eta = 1.5};
    parian_reference_body *body;
    parian_reference_scene scene;
    parian_receivers receivers;
    double point[COUNT][3], b[2] = {0}, variance[2] = {0};
    assert_true(PARIAN_NEW0(NULL, body, 2));
    for (uint32_t i = 0; i < 2; i++) {
        assert_int_equal(test_box(NULL, MM, MM, MM, 2, &body[i].mesh), PARIAN_OK);
        for (uint32_t v = 0; v < body[i].mesh.vertex_count; v++) {
            body[i].mesh.position[v][0] += 1.004 * MM * i;
        }
        body[i].medium = i ? black : path_case_marble;
    }
    memset(&scene, 0, sizeof scene);
    assert_int_equal(parian_reference_scene_make(NULL, body, 2, NULL, 0, &sun, 1, &scene),
                     PARIAN_OK);
    for (int i = 0; i < COUNT;
         i++) { /* half of them on each side of the gap, 30 um from the edge */
        point[i][0] = (i % 2 ? 0.534 : 0.47) * MM;
        point[i][1] = (0.03 * i - 0.35) * MM;
        point[i][2] = 0.5 * MM;
    }
    assert_int_equal(
        parian_receivers_nearest(NULL, &scene, (const double(*)[3])point, COUNT, &receivers),
        PARIAN_OK);
    for (int k = 0; k < 2; k++) {
        parian_reference_result result;
        parian_path_desc desc = {.samples = k ? 1024 : 4096,
                                 .seed = 3,
                                 .patch = 0.1 * MM,
                                 .walk = k ? PARIAN_WALK_ADJOINT : PARIAN_WALK_FORWARD};
        assert_int_equal(parian_reference_path(test_env(2), &scene, &receivers, &desc, &result),
                         PARIAN_OK);
        for (int i = 0; i < COUNT; i++) {
            assert_int_equal(receivers.body[i], i % 2);
            for (int c = 0; c < 3; c++) {
                assert_true(i % 2 == 0 || result.radiosity[i][c] == 0);
                b[k] += result.radiosity[i][c];
                variance[k] += result.standard_error[i][c] * result.standard_error[i][c];
            }
        }
        parian_reference_result_free(test_env(2), &result);
    }
    assert_near("patches beside another body", b[0], b[1],
                3 * sqrt(variance[0] + variance[1]) + 0.04 * b[1]);
    assert_true(sqrt(variance[0] + variance[1]) < 0.05 * b[1]);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* Mean free path of 10 sides, and none at all, in a box: nearly all goes straight through, a good
 * part of it after reflection inside, which only the photons of the remainder bring. 2 %: patches
 * at the rims of lit places. */
static void nearly_clear_bodies(void **state)
{
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -3, -2}, .color = {3, 3, 3}};
    const parian_medium medium = {.sigma_s_prime = {100, 0, 0}, .sigma_a = {10, 10, 0}, .eta = 1.5};
    double b[2][3], error[2][3];
    for (int forward = 0; forward < 2; forward++) {
        parian_mesh mesh = {0};
        parian_reference_scene scene;
        parian_path_desc desc = {.samples = forward ? 16 : 64,
                                 .seed = 7,
                                 .patch = 0.04 * MM,
                                 .walk = forward ? PARIAN_WALK_FORWARD : PARIAN_WALK_ADJOINT};
        assert_int_equal(test_box(test_env(2), MM, MM, MM, 4, &mesh), PARIAN_OK);
        path_case_scene(test_env(2), &mesh, &medium, &sun, 1, &scene);
        outcome o = trace(&scene, 1000, &desc);
        for (int c = 0; c < 3; c++) {
            b[forward][c] = mean_b(&o, c);
            error[forward][c] = path_case_error(&o.result, o.count, c);
            assert_true(c == 0 || fabs(mean_unscattered(&o, c) - b[forward][c]) < 1e-12);
        }
        assert_near("clear box lets all out", o.result.out[2], o.result.in[2],
                    0.005 * o.result.in[2]); /* roulette */
        assert_books(&o.result);
        release(&o);
    }
    for (int c = 0; c < 3; c++) {
        assert_near("nearly clear box", b[0][c], b[1][c],
                    3 * hypot(error[0][c], error[1][c]) + 0.02 * b[1][c]);
    }
}

/* ---- heterogeneous media ---- */

static void give_field(parian_reference_scene *scene, uint32_t nodes,
                       void (*fill)(double share, float *sigma_s, float *sigma_a))
{
    parian_reference_body *body = &scene->bodies[0];
    parian_medium_field *field = NULL;
    size_t count = (size_t)nodes * nodes * nodes;
    assert_true(PARIAN_NEW0(test_env(2), field, 1));
    assert_true(PARIAN_NEW(test_env(2), field->sigma_s, count));
    assert_true(PARIAN_NEW(test_env(2), field->sigma_a, count));
    for (int k = 0; k < 3; k++) {
        field->size[k] = nodes;
        field->lower[k] = scene->lower[k];
        field->upper[k] = scene->upper[k];
    }
    for (size_t i = 0; i < count; i++) {
        double share = (double)(i / nodes % nodes) / (double)(nodes - 1);
        for (int c = 0; c < 3; c++) {
            fill(share, &field->sigma_s[i][c], &field->sigma_a[i][c]);
        }
    }
    body->field = field;
}

static void fill_constant(double share, float *sigma_s, float *sigma_a)
{
    (void)share;
    *sigma_s = 998.4376f;
    *sigma_a = 1.5624f;
}

/* A field of constant coefficients is the homogeneous medium: under a sky (delta tracking) and a
 * directional light (connections). */
static void constant_field(void **state)
{
    (void)state;
    const parian_light light[2] = {
        path_case_sky,
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .color = {3, 3, 3}}};
    for (int l = 0; l < 2; l++) {
        double b[2] = {0}, error[2];
        for (int field = 0; field < 2; field++) {
            parian_mesh mesh = {0};
            parian_reference_scene scene;
            parian_path_desc desc = {.samples = 96, .seed = 8 + (uint64_t)field};
            assert_int_equal(test_sphere(test_env(2), 3 * MM, 12, &mesh), PARIAN_OK);
            path_case_scene(test_env(2), &mesh, &path_case_marble, &light[l], 1, &scene);
            if (field) {
                give_field(&scene, 5, fill_constant);
            }
            outcome o = trace(&scene, 150, &desc);
            b[field] = (mean_b(&o, 0) + mean_b(&o, 1) + mean_b(&o, 2)) / 3;
            error[field] = path_case_error(&o.result, o.count, 0) / sqrt(3);
            assert_books(&o.result);
            release(&o);
        }
        assert_near("constant field", b[1], b[0], 3 * hypot(error[0], error[1]));
    }
}

static void fill_layers(double share, float *sigma_s, float *sigma_a)
{
    *sigma_s = 0;
    *sigma_a = share < 0.5 ? 200.0f : 1000.0f;
}

/* Optical depth across fill_layers on 9 nodes: linear between the nodes at 3/8 and 4/8. */
static double layers_depth(double t)
{
    return t * (200 * 3.0 / 8 + 0.5 * (200 + 1000) / 8 + 1000 * 4.0 / 8);
}

/* Two absorbing layers, light along the normal: straight, and reflected to and fro inside. The lit
 * face has what has been reflected once at the far side, the far face what has come straight, and
 * so on: far = T^2 e^-tau / (1 - R^2 e^-2tau),  near = T^2 R e^-2tau / (1 - R^2 e^-2tau). */
static void layers_in_a_beam(void **state)
{
    (void)state;
    const parian_light sun = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, -1, 0}, .color = {1, 1, 1}};
    double r = parian_fresnel_reflectance(1, 1.5), t = 1 - r, decay = exp(-layers_depth(MM));
    double far = t * t * decay / (1 - r * r * decay * decay), near = far * r * decay;
    parian_medium medium = {.sigma_s_prime = {1, 1, 1}, .eta = 1.5};
    parian_reference_scene scene;
    parian_path_desc desc = {.samples = 64 * 4, .seed = 9, .patch = 0.5 * MM};
    outcome o;
    make_slab(8 * MM, 1 * MM, &medium, &sun, &scene, &o);
    give_field(&scene, 9, fill_layers);
    assert_int_equal(parian_reference_path(test_env(2), &scene, &o.receivers, &desc, &o.result),
                     PARIAN_OK);
    const double(*b)[3] = (const double(*)[3])o.result.unscattered;
    double error = path_case_error(&o.result, o.count, 0) * sqrt(2);
    assert_near("layers in a beam, far side", face_mean(b, 1, 0), far, 3 * error + 1e-9);
    assert_near("layers in a beam, lit side", face_mean(b, 0, 0), near, 3 * error + 1e-9);
    assert_true(error < 0.02 * near);
    release(&o);
    parian_reference_scene_free(test_env(2), &scene);
}

/* The same layers under a sky from above: the walk's delta tracking and internal reflections
 * against the integral B = 2 pi int T(mu) mu  T e^-tau/mu' / (1 - R^2 e^-2tau/mu') dmu. */
static void layers_under_half_a_sky(void **state)
{
    (void)state;
    static float pixel[256 * 4][3];
    make_upper_sky(pixel, 4, 256);
    parian_light sky = path_case_sky;
    sky.image = (parian_light_image){4, 256, (const float(*)[3])pixel};
    double node[64], weight[64], expected = 0, tau = layers_depth(MM);
    parian_gauss_legendre(64, node, weight);
    for (int i = 0; i < 64; i++) {
        double mu = node[i], r = parian_fresnel_reflectance(mu, 1.5);
        double decay = exp(-tau / sqrt(1 - (1 - mu * mu) / 2.25));
        expected += 2 * PARIAN_PI * weight[i] * mu * (1 - r) * (1 - r) * decay /
                    (1 - r * r * decay * decay);
    }
    parian_medium medium = {.sigma_s_prime = {1, 1, 1}, .eta = 1.5};
    parian_reference_scene scene;
    parian_path_desc desc = {.samples = 20000, .seed = 10};
    outcome o;
    make_slab(80 * MM, 1 * MM, &medium, &sky, &scene, &o);
    give_field(&scene, 9, fill_layers);
    assert_int_equal(parian_reference_path(test_env(2), &scene, &o.receivers, &desc, &o.result),
                     PARIAN_OK);
    double error = path_case_error(&o.result, o.count, 0) * sqrt(2);
    assert_near("layers under half a sky", face_mean((const double(*)[3])o.result.radiosity, 1, 0),
                expected, 3 * error + 0.003 * expected);
    release(&o);
    parian_reference_scene_free(test_env(2), &scene);
}
int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_under_a_uniform_sky),
        cmocka_unit_test(spheres_under_a_directional_light),
        cmocka_unit_test(slabs_under_half_a_sky),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(walks_and_photons_agree),
        cmocka_unit_test(the_better_walk_is_kept),
        cmocka_unit_test(lamps_that_walks_never_find),
        cmocka_unit_test(patches_keep_to_their_body),
        cmocka_unit_test(nearly_clear_bodies),
        cmocka_unit_test(constant_field),
        cmocka_unit_test(layers_in_a_beam),
        cmocka_unit_test(layers_under_half_a_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
