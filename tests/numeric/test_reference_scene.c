/* test_reference_scene.c - scenes of references from models and assets, and the receivers on them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/reference/rays.h"
#include "bake/reference/reference_scene.h"
#include "core/body_file.h"
#include "core/memory.h"
#include "core/random.h"
#include "support/tiny_body.h"
#include "tool/files.h"

static char said[512];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(said, sizeof said, "%s", text);
    }
}

static const parian_env listening = {.log = keep_error};

static const parian_medium marble = {
    .sigma_s_prime = {2190, 2620, 3000}, .sigma_a = {2.1, 4.1, 7.1}, .eta = 1.5};

/* A scene of one mesh (taken over) and up to one more body. */
static void make_scene(parian_mesh first, const parian_mesh *second, parian_reference_scene *scene)
{
    parian_reference_body *bodies;
    assert_true(PARIAN_NEW0(NULL, bodies, 2));
    bodies[0] = (parian_reference_body){.mesh = first, .medium = marble};
    if (second) {
        bodies[1] = (parian_reference_body){.mesh = *second, .medium = marble};
    }
    assert_int_equal(
        parian_reference_scene_make(NULL, bodies, second ? 2 : 1, NULL, 0, NULL, 0, scene),
        PARIAN_OK);
}

static void scene_knows_its_box_and_what_is_closed(void **state)
{
    (void)state;
    parian_mesh ball, plane;
    parian_reference_scene scene;
    assert_int_equal(test_sphere(NULL, 0.02, 8, &ball), PARIAN_OK);
    assert_int_equal(test_plane(NULL, 0.1, 4, &plane), PARIAN_OK);
    make_scene(ball, &plane, &scene);
    assert_true(scene.bodies[0].closed);
    assert_false(scene.bodies[1].closed);
    assert_non_null(scene.bodies[0].mesh.corner_normal);
    assert_true(fabs(scene.extent - 0.1) < 1e-15);
    assert_true(scene.lower[0] == -0.05 && scene.upper[2] > 0.0199);
    parian_reference_scene_free(NULL, &scene);
}

/* Shares are equal, so the areas sum to the surface to rounding, for one receiver as for many. */
static void areas_sum_to_the_surface(void **state)
{
    static const size_t counts[] = {1, 7, 1000, 20000};
    (void)state;
    parian_mesh ball, box;
    parian_reference_scene scene;
    assert_int_equal(test_sphere(NULL, 0.02, 8, &ball), PARIAN_OK);
    assert_int_equal(test_box(NULL, 0.01, 0.02, 0.03, 1, &box), PARIAN_OK);
    double area = parian_mesh_area(&ball) + parian_mesh_area(&box);
    make_scene(ball, &box, &scene);
    for (size_t n = 0; n < sizeof counts / sizeof *counts; n++) {
        parian_receivers receivers;
        assert_int_equal(parian_receivers_spread(NULL, &scene, counts[n], 3, &receivers),
                         PARIAN_OK);
        assert_int_equal(receivers.count, counts[n]);
        double sum = 0;
        for (size_t i = 0; i < receivers.count; i++) {
            sum += receivers.area[i];
        }
        assert_true(fabs(sum / area - 1) < 1e-12);
        parian_receivers_free(NULL, &receivers);
    }
    parian_reference_scene_free(NULL, &scene);
}

/* What every receiver must satisfy: it lies where its barycentrics say, on its triangle, with unit
 * normals. */
static void check_receivers(const parian_reference_scene *scene, const parian_receivers *receivers)
{
    for (size_t i = 0; i < receivers->count; i++) {
        const parian_mesh *mesh = &scene->bodies[receivers->body[i]].mesh;
        const uint32_t *corner = mesh->triangle[receivers->triangle[i]];
        const double *b = receivers->barycentric[i];
        double normal2 = 0, smooth2 = 0, off = 0;
        assert_true(b[0] >= 0 && b[1] >= 0 && b[2] >= 0 && fabs(b[0] + b[1] + b[2] - 1) < 1e-12);
        for (int k = 0; k < 3; k++) {
            double at = 0;
            for (int c = 0; c < 3; c++) {
                at += b[c] * mesh->position[corner[c]][k];
            }
            assert_true(fabs(at - receivers->position[i][k]) < 1e-12 * scene->extent);
            off += receivers->normal[i][k] * (at - mesh->position[corner[0]][k]);
            normal2 += receivers->normal[i][k] * receivers->normal[i][k];
            smooth2 += receivers->smooth_normal[i][k] * receivers->smooth_normal[i][k];
        }
        assert_true(fabs(off) < 1e-12 * scene->extent);
        assert_true(fabs(normal2 - 1) < 1e-12 && fabs(smooth2 - 1) < 1e-12);
        parian_place place;
        parian_receiver_place(receivers, i, &place);
        assert_int_equal(place.triangle, receivers->triangle[i]);
        assert_memory_equal(place.position, receivers->position[i], sizeof place.position);
        assert_memory_equal(place.smooth_normal, receivers->smooth_normal[i],
                            sizeof place.smooth_normal);
    }
}

/* Evenness: one place in each of N shares makes the number in a region that is contiguous along the
 * curve right to two, and in an octant of a sphere, whose rim cuts shares, to a few times the
 * square root of the shares cut. Independent places would miss by sqrt(N/8) = 22 in the octants at
 * one standard deviation; the worst of eight is held to 12. Means over the surface of smooth
 * functions: x^2 of a sphere to 0.3 %, where independent places have a standard error of 0.9
 * sqrt(1/N) = 1.4 %. */
static void spread_is_even(void **state)
{
    enum { COUNT = 4000 };
    (void)state;
    parian_mesh ball;
    parian_reference_scene scene;
    parian_receivers receivers;
    assert_int_equal(test_sphere(NULL, 1, 30, &ball), PARIAN_OK);
    make_scene(ball, NULL, &scene);
    assert_int_equal(parian_receivers_spread(NULL, &scene, COUNT, 11, &receivers), PARIAN_OK);
    check_receivers(&scene, &receivers);
    int octant[8] = {0};
    double square[3] = {0};
    for (size_t i = 0; i < receivers.count; i++) {
        const double *p = receivers.position[i];
        octant[(p[0] > 0) + 2 * (p[1] > 0) + 4 * (p[2] > 0)]++;
        for (int k = 0; k < 3; k++) {
            square[k] += p[k] * p[k] / (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / COUNT;
        }
    }
    for (int o = 0; o < 8; o++) {
        assert_in_range(octant[o], COUNT / 8 - 12, COUNT / 8 + 12);
    }
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(3 * square[k] - 1) < 0.003);
    }
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* Two triangles with a thousand shares each: no 10 x 10 cell of the square is empty or holds more
 * than twice its due (independent places: a standard deviation of 4.5 of 20, so both would happen).
 */
static void large_triangles_are_covered_in_both_directions(void **state)
{
    enum { COUNT = 2000, SIDE = 10 };
    (void)state;
    parian_mesh plane;
    parian_reference_scene scene;
    parian_receivers receivers;
    int cell[SIDE][SIDE] = {{0}};
    assert_int_equal(test_plane(NULL, 1, 1, &plane), PARIAN_OK);
    make_scene(plane, NULL, &scene);
    assert_int_equal(parian_receivers_spread(NULL, &scene, COUNT, 1, &receivers), PARIAN_OK);
    for (size_t i = 0; i < receivers.count; i++) {
        int x = (int)((receivers.position[i][0] + 0.5) * SIDE),
            y = (int)((receivers.position[i][1] + 0.5) * SIDE);
        cell[x < SIDE ? x : SIDE - 1][y < SIDE ? y : SIDE - 1]++;
    }
    for (int c = 0; c < SIDE * SIDE; c++) {
        assert_in_range(cell[c / SIDE][c % SIDE], 12, 30);
    }
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* Two triangles of areas 1 : 3 in one body: each gets its share by one. */
static void areas_decide_not_triangles(void **state)
{
    (void)state;
    parian_mesh mesh = {.vertex_count = 6, .triangle_count = 3};
    static const double position[6][3] = {{0, 0, 0}, {1, 0, 0},  {0, 2, 0},
                                          {9, 0, 0}, {10, 0, 0}, {9, 6, 0}};
    static const uint32_t triangle[3][3] = {
        {0, 1, 2}, {3, 4, 5}, {0, 0, 1}}; /* the third has no area */
    assert_true(PARIAN_NEW(NULL, mesh.position, 6) && PARIAN_NEW(NULL, mesh.triangle, 3));
    memcpy(mesh.position, position, sizeof position);
    memcpy(mesh.triangle, triangle, sizeof triangle);
    parian_reference_scene scene;
    parian_receivers receivers;
    make_scene(mesh, NULL, &scene);
    size_t count[3] = {0};
    assert_int_equal(parian_receivers_spread(NULL, &scene, 400, 5, &receivers), PARIAN_OK);
    check_receivers(&scene, &receivers);
    for (size_t i = 0; i < 400; i++) {
        count[receivers.triangle[i]]++;
    }
    assert_true(count[0] == 100 && count[1] == 300 && count[2] == 0);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
}

/* Seeds move the places; threads do not. */
static void places_are_the_same_for_any_threads(void **state)
{
    static const unsigned threads[] = {1, 2, 7};
    (void)state;
    enum { COUNT = 500 };
    parian_mesh ball;
    parian_reference_scene scene;
    parian_receivers first[2], other;
    double point[COUNT][3];
    parian_random random = parian_random_stream(2, 0, 0, 0);
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            point[i][k] = 2 * parian_random_unit(&random) - 1;
        }
    }
    assert_int_equal(test_sphere(NULL, 1, 12, &ball), PARIAN_OK);
    make_scene(ball, NULL, &scene);
    for (size_t t = 0; t < 3; t++) {
        const parian_env *env = test_env(threads[t]);
        parian_receivers made[2];
        assert_int_equal(parian_receivers_spread(env, &scene, COUNT, 9, &made[0]), PARIAN_OK);
        assert_int_equal(
            parian_receivers_nearest(env, &scene, (const double(*)[3])point, COUNT, &made[1]),
            PARIAN_OK);
        for (int m = 0; m < 2; m++) {
            if (t == 0) {
                first[m] = made[m];
                continue;
            }
            assert_memory_equal(made[m].position, first[m].position, sizeof point);
            assert_memory_equal(made[m].triangle, first[m].triangle,
                                COUNT * sizeof *made[m].triangle);
            parian_receivers_free(env, &made[m]);
        }
    }
    assert_int_equal(parian_receivers_spread(NULL, &scene, COUNT, 10, &other), PARIAN_OK);
    assert_memory_not_equal(other.position, first[0].position, sizeof point);
    parian_receivers_free(NULL, &other);
    parian_receivers_free(NULL, &first[0]);
    parian_receivers_free(NULL, &first[1]);
    parian_reference_scene_free(NULL, &scene);
}

/* The nearest place of two balls is found on the right one: along the line to its centre, to the
 * sagitta of its facets; vertices are given back to a millionth of a triangle, and inside a
 * triangle. */
static void nearest_places_are_nearest(void **state)
{
    (void)state;
    parian_mesh a, b;
    parian_reference_scene scene;
    parian_receivers receivers;
    assert_int_equal(test_sphere(NULL, 1, 20, &a), PARIAN_OK);
    assert_int_equal(test_sphere(NULL, 1, 20, &b), PARIAN_OK);
    double vertex[3];
    for (uint32_t v = 0; v < b.vertex_count; v++) {
        b.position[v][0] += 5;
    }
    memcpy(vertex, b.position[17], sizeof vertex);
    make_scene(a, &b, &scene);
    const double point[4][3] = {
        {2, 0, 0}, {3, 0.1, 0}, {0, -7, 0}, {vertex[0], vertex[1], vertex[2]}};
    assert_int_equal(parian_receivers_nearest(NULL, &scene, point, 4, &receivers), PARIAN_OK);
    check_receivers(&scene, &receivers);
    assert_true(receivers.body[0] == 0 && receivers.body[1] == 1 && receivers.body[2] == 0);
    assert_true(fabs(receivers.position[0][0] - 1) < 2e-3 && fabs(receivers.position[0][1]) < 0.05);
    assert_true(fabs(receivers.position[2][1] + 1) < 2e-3);
    assert_int_equal(receivers.body[3], 1);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(receivers.position[3][k] - vertex[k]) < 1e-6);
        assert_true(receivers.barycentric[3][k] > 5e-7);
    }
    for (int i = 0; i < 4; i++) {
        assert_true(receivers.area[i] == 1);
    }
    parian_receivers_free(NULL, &receivers);
    const double bad[1][3] = {{0, NAN, 0}};
    assert_int_equal(parian_receivers_nearest(&listening, &scene, bad, 1, &receivers),
                     PARIAN_E_ARGUMENT);
    assert_non_null(strstr(said, "receiver 0"));
    assert_int_equal(parian_receivers_spread(&listening, &scene, 0, 1, &receivers),
                     PARIAN_E_ARGUMENT);
    parian_reference_scene_free(NULL, &scene);
}

/* An OBJ of a box in millimetres, and the same with a face missing. */
static void models_load_as_a_bake_sees_them(void **state)
{
    static const char text[] =
        "v 0 0 0\nv 10 0 0\nv 10 20 0\nv 0 20 0\nv 0 0 30\nv 10 0 30\nv 10 20 30\n"
        "v 0 20 30\nf 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n";
    static const char last[] = "f 4 1 5 8\n";
    static const char *const material[] = {"skimmilk"};
    const parian_light light = {
        .type = PARIAN_LIGHT_POINT, .position = {0, 0, 1}, .color = {1, 1, 1}};
    (void)state;
    for (int closed = 0; closed < 2; closed++) {
        char whole[512];
        char path[1024];
        int size = snprintf(whole, sizeof whole, "%s%s", text, closed ? last : "");
        snprintf(path, sizeof path, "%s", test_scratch("box.obj"));
        assert_int_equal(parian_file_write(NULL, path, whole, (size_t)size), PARIAN_OK);
        parian_bake_desc desc = {
            .input = path, .material = material, .material_count = 1, .scale_m = 0.06};
        parian_reference_scene scene;
        assert_int_equal(parian_reference_scene_load(NULL, &desc, &light, 1, &scene), PARIAN_OK);
        assert_int_equal(scene.body_count, 1);
        assert_int_equal(scene.bodies[0].closed, closed);
        assert_true(scene.bodies[0].medium.sigma_s_prime[0] == 700);
        assert_true(fabs(scene.extent - 0.06) < 1e-12 && fabs(scene.upper[2] - 0.03) < 1e-12);
        assert_true(fabs(parian_mesh_area(&scene.bodies[0].mesh) - (closed ? 2200 : 1600) * 4e-6) <
                    1e-9);
        assert_int_equal(scene.light_count, 1);
        assert_null(scene.bodies[0].field);
        /* sharp edges keep separate normals */
        const float *n = scene.bodies[0].mesh.corner_normal[0][0];
        assert_true(fmaxf(fmaxf(fabsf(n[0]), fabsf(n[1])), fabsf(n[2])) > 0.999f);
        parian_reference_scene_free(NULL, &scene);
    }
    parian_bake_desc absent = {.input = test_scratch("absent.obj"), .scale_m = 1};
    parian_reference_scene scene;
    assert_int_equal(parian_reference_scene_load(&listening, &absent, NULL, 0, &scene),
                     PARIAN_E_IO);
    absent.input = test_scratch("absent.parian");
    assert_int_equal(parian_reference_scene_load(&listening, &absent, NULL, 0, &scene),
                     PARIAN_E_IO);
}

static void broken_surfaces_are_refused(void **state)
{
    (void)state;
    for (int fault = 0; fault < 3; fault++) {
        parian_mesh mesh;
        parian_reference_body *bodies;
        parian_light light = {
            .type = PARIAN_LIGHT_DIRECTIONAL, .color = {1, 1, 1}, .direction = {0, 0, -1}};
        parian_reference_scene scene;
        assert_int_equal(test_sphere(NULL, 1, 2, &mesh), PARIAN_OK);
        assert_true(PARIAN_NEW0(NULL, bodies, 1));
        if (fault == 0) {
            mesh.position[3][1] = NAN;
        } else if (fault == 1) {
            mesh.triangle_count = 0;
        } else {
            light.direction[2] = 0;
        }
        bodies[0] = (parian_reference_body){.mesh = mesh, .medium = marble};
        said[0] = 0;
        assert_int_not_equal(
            parian_reference_scene_make(&listening, bodies, 1, NULL, 0, &light, 1, &scene),
            PARIAN_OK);
        assert_true(said[0] != 0);
    }
}

/* An asset brings its transfer surface, corner normals, media, surroundings and lights. */
static void assets_bring_their_own(void **state)
{
    (void)state;
    parian_scene_data data = {0};
    parian_writer *writer = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s", test_scratch("tiny.parian"));
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_F16, 4, &data), PARIAN_OK);
    parian_writer_desc to = {.path = path};
    assert_int_equal(parian_writer_begin(NULL, &to, &writer), PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, &data), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    parian_bake_desc desc = {.input = path};
    parian_reference_scene scene;
    parian_receivers receivers;
    assert_int_equal(parian_reference_scene_load(NULL, &desc, NULL, 0, &scene), PARIAN_OK);
    assert_int_equal(scene.body_count, data.body_count);
    assert_int_equal(scene.surrounding_count, data.surrounding_count);
    assert_true(scene.light_count > 0);
    for (uint32_t b = 0; b < scene.body_count; b++) {
        const parian_body *body = &data.bodies[b];
        const parian_mesh *mesh = &scene.bodies[b].mesh;
        assert_string_equal(scene.bodies[b].name, body->name);
        assert_memory_equal(&scene.bodies[b].medium, &body->medium, sizeof body->medium);
        assert_int_equal(mesh->triangle_count, body->triangle_count);
        assert_memory_equal(mesh->triangle, body->triangle,
                            body->triangle_count * sizeof *body->triangle);
        assert_memory_equal(mesh->corner_normal, body->corner_normal,
                            body->triangle_count * sizeof *body->corner_normal);
        assert_true(mesh->position[2][1] == (double)body->vertex_position[2][1]);
        assert_false(scene.bodies[b].closed);
    }
    assert_int_equal(parian_receivers_spread(NULL, &scene, 50, 1, &receivers), PARIAN_OK);
    check_receivers(&scene, &receivers);
    parian_receivers_free(NULL, &receivers);
    parian_reference_scene_free(NULL, &scene);
    const parian_light none = {0};
    assert_int_equal(parian_reference_scene_load(NULL, &desc, &none, 0, &scene), PARIAN_OK);
    assert_int_equal(scene.light_count, 0);
    parian_reference_scene_free(NULL, &scene);
    parian_scene_data_free(NULL, &data);
}

/* What every failed allocation leaves behind is nothing. */
static void failed_allocations_leave_nothing(void **state)
{
    (void)state;
    char path[1024];
    static const char text[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    snprintf(path, sizeof path, "%s", test_scratch("tetrahedron.obj"));
    assert_int_equal(parian_file_write(NULL, path, text, sizeof text - 1), PARIAN_OK);
    parian_bake_desc desc = {.input = path, .scale_m = 0.01};
    const parian_light light = {
        .type = PARIAN_LIGHT_POINT, .position = {1, 1, 1}, .color = {1, 1, 1}};
    for (size_t fail_at = 0;; fail_at++) {
        test_memory memory = {.fail_at = fail_at};
        parian_env env = test_failing_env(&memory);
        parian_reference_scene scene = {0};
        parian_receivers receivers = {0};
        const double point[1][3] = {{1, 0, 0}};
        parian_result r = parian_reference_scene_load(&env, &desc, &light, 1, &scene);
        if (r == PARIAN_OK) {
            r = parian_receivers_spread(&env, &scene, 4, 0, &receivers);
            parian_receivers_free(&env, &receivers);
        }
        if (r == PARIAN_OK) {
            r = parian_receivers_nearest(&env, &scene, point, 1, &receivers);
            parian_receivers_free(&env, &receivers);
        }
        parian_reference_scene_free(&env, &scene);
        assert_int_equal(memory.live, 0);
        if (r == PARIAN_OK) {
            assert_true(fail_at > 20);
            return;
        }
        assert_int_equal(r, PARIAN_E_NOMEM);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scene_knows_its_box_and_what_is_closed),
        cmocka_unit_test(areas_sum_to_the_surface),
        cmocka_unit_test(spread_is_even),
        cmocka_unit_test(large_triangles_are_covered_in_both_directions),
        cmocka_unit_test(areas_decide_not_triangles),
        cmocka_unit_test(places_are_the_same_for_any_threads),
        cmocka_unit_test(nearest_places_are_nearest),
        cmocka_unit_test(models_load_as_a_bake_sees_them),
        cmocka_unit_test(broken_surfaces_are_refused),
        cmocka_unit_test(assets_bring_their_own),
        cmocka_unit_test(failed_allocations_leave_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
