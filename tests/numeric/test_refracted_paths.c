/* test_refracted_paths.c - refracted paths through facets against a plain search; hostile input.
 *
 * The plain search shares nothing with what it checks: angles by trigonometry, the point light's
 * root by bisection of Fermat's condition, the inside test by barycentric coordinates.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/fresnel.h"
#include "support/refracted_case.h"

static const parian_refracted_path *find(const found_list *list, uint32_t triangle)
{
    const parian_refracted_path *found = NULL;
    for (size_t i = 0; i < list->count; i++) {
        if (list->path[i].triangle == triangle) {
            assert_null(found); /* no facet carries two */
            found = &list->path[i];
        }
    }
    return found;
}

/* ---- the plain search ---- */

/* What the plain search says of one facet: no path, a path, or too close to the border of one to
 * tell. */
typedef enum verdict { NO_PATH, ONE_PATH, AT_BORDER } verdict;

typedef struct plain_path {
    double entry[3], factor, length;
} plain_path;

/* Fermat's condition sin_i = eta sin_t at way a from the light's foot, by bisection. */
static double entry_way(double h1, double h2, double r, double eta)
{
    double low = 0, high = r;
    for (int i = 0; i < 70; i++) {
        double a = 0.5 * (low + high), b = r - a;
        double excess = a / sqrt(a * a + h1 * h1) - eta * b / sqrt(b * b + h2 * h2);
        low = excess < 0 ? a : low;
        high = excess < 0 ? high : a;
    }
    return 0.5 * (low + high);
}

static double least_barycentric(const double v[3][3], const double n[3], const double y[3])
{
    double ab[3], ac[3], whole[3], least = INFINITY;
    subtract(v[1], v[0], ab);
    subtract(v[2], v[0], ac);
    parian_cross3(ab, ac, whole);
    for (int k = 0; k < 3; k++) {
        double e[3], d[3], part[3];
        subtract(v[(k + 1) % 3], v[k], e);
        subtract(y, v[k], d);
        parian_cross3(e, d, part);
        least = fmin(least, parian_dot3(part, n) / norm(whole));
    }
    return least;
}

/* Angle of refraction inside, NAN at total reflection. */
static double refraction_angle(double i, double eta)
{
    return asin(sin(i) / eta);
}

static verdict plain_facet(const double v[3][3], double eta, const double x[3],
                           const parian_light_point *light, double max_length, plain_path *path)
{
    double ab[3], ac[3], n[3], vx[3], to[3], t, i, spread = 1;
    subtract(v[1], v[0], ab);
    subtract(v[2], v[0], ac);
    parian_cross3(ab, ac, n);
    if (norm(n) == 0) {
        return NO_PATH;
    }
    normalise(n);
    subtract(v[0], x, vx);
    double h2 = parian_dot3(vx, n), size = norm(ab) + norm(ac), along[3];
    if (light->at_infinity) {
        memcpy(to, light->direction, sizeof to);
    } else {
        subtract(light->position, x, to);
    }
    double rise = parian_dot3(to, n);
    if (h2 < -1e-6 * size) {
        return NO_PATH;
    }
    for (int k = 0; k < 3; k++) {
        along[k] = to[k] - rise * n[k];
    }
    double r = norm(along), a = 0, b;
    if (light->at_infinity) {
        if (fabs(rise) < 1e-9) {
            return AT_BORDER;
        }
        i = atan2(r, rise);
        t = refraction_angle(i, eta);
        b = h2 * tan(t);
    } else {
        double h1 = rise - h2;
        if (fabs(h1) < 1e-9) {
            return AT_BORDER;
        }
        a = h2 > 0 && h1 > 0 ? entry_way(h1, h2, r, eta) : r;
        b = r - a;
        i = atan2(a, h1);
        t = refraction_angle(i, eta);
        double dt = cos(i) / (eta * cos(t)), dr = h1 / pow(cos(i), 2) + h2 / pow(cos(t), 2) * dt;
        spread = r > 1e-6 ? sin(i) / (r * dr) / cos(i) : 1 / pow(h1 + h2 / eta, 2);
        rise = h1;
    }
    if (fabs(h2) < 1e-12 * size) {
        return AT_BORDER;
    }
    if (rise <= 0 || h2 < 0 || isnan(t)) {
        return NO_PATH;
    }
    path->length = h2 / cos(t);
    for (int k = 0; k < 3; k++) {
        path->entry[k] = x[k] + h2 * n[k] + (r > 0 ? b / r * along[k] : 0);
    }
    path->factor = parian_fresnel_transmittance(cos(i), eta) * cos(i) / cos(t) * spread;
    double least = least_barycentric(v, n, path->entry), over = path->length - max_length;
    double margin = 1e-7 * (1 + path->length / size);
    if (least < -margin || over > 1e-9 * path->length) {
        return NO_PATH;
    }
    return least > margin && over < -1e-9 * path->length && cos(t) > 1e-4 ? ONE_PATH : AT_BORDER;
}

/* Compare one search with the plain one: the same facets, places to 1e-6 of the length, factors to
 * 1e-6 (both from angles whose last digits r -> 0 and grazing incidence cost; in the middle they
 * agree to 1e-12). Returns the number of paths. */
static size_t compare(const parian_mesh *mesh, double eta, const double x[3],
                      const parian_light_point *light, double max_length, uint32_t skip,
                      const found_list *list)
{
    size_t paths = 0, matched = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double v[3][3], off[3];
        plain_path plain = {{0, 0, 0}, 0, 0};
        get_corners(mesh, t, v);
        const parian_refracted_path *path = find(list, t);
        verdict expected = t == skip ? NO_PATH : plain_facet(v, eta, x, light, max_length, &plain);
        matched += path != NULL;
        if (expected == AT_BORDER) {
            continue;
        }
        if ((path != NULL) != (expected == ONE_PATH)) {
            fail_msg("facet %u: %s a path, the plain search says otherwise (eta %g)", t,
                     path ? "has" : "lacks", eta);
        }
        if (path) {
            check_finite(path);
            subtract(path->entry, plain.entry, off);
            assert_true(norm(off) <= 1e-6 * (plain.length + 1e-3));
            assert_true(fabs(path->factor - plain.factor) <= 1e-6 * plain.factor);
            assert_true(fabs(path->length - plain.length) <= 1e-6 * plain.length);
            paths++;
        }
    }
    assert_int_equal(matched, list->count);
    return paths;
}

/* ---- meshes ---- */

/* Unconnected triangles in the unit cube about 0; aspect: length of needles over their width, size:
 * of a side. */
static void make_soup(uint64_t seed, uint32_t count, double size, double aspect, parian_mesh *mesh)
{
    parian_random random = parian_random_stream(seed, count, 0, 0);
    make_mesh(3 * count, count, mesh);
    for (uint32_t t = 0; t < count; t++) {
        double side[2][3];
        double *base = mesh->position[3 * t];
        random_direction(&random, side[0]);
        random_direction(&random, side[1]);
        double mixed = size * pow(10, uniform(&random, -1, 0));
        for (int k = 0; k < 3; k++) {
            base[k] = uniform(&random, -0.5, 0.5);
            mesh->position[3 * t + 1][k] = base[k] + mixed * side[0][k];
            mesh->position[3 * t + 2][k] = base[k] + mixed * side[1][k] / aspect;
            mesh->triangle[t][k] = 3 * t + (uint32_t)k;
        }
    }
}

/* ---- against the plain search ---- */

/* x anywhere, just inside a facet, or on one (and then skip is that facet). */
static uint32_t random_place(parian_random *random, const parian_mesh *mesh, int kind, double x[3])
{
    if (kind == 0) {
        for (int k = 0; k < 3; k++) {
            x[k] = uniform(random, -0.6, 0.6);
        }
        return PARIAN_REFRACTOR_NO_SKIP;
    }
    uint32_t t = (uint32_t)(parian_random_unit(random) * mesh->triangle_count);
    double v[3][3], ab[3], ac[3], n[3], a = uniform(random, 0, 0.5), b = uniform(random, 0, 0.5);
    get_corners(mesh, t, v);
    subtract(v[1], v[0], ab);
    subtract(v[2], v[0], ac);
    parian_cross3(ab, ac, n);
    normalise(n);
    double depth = kind == 1 ? norm(ab) * pow(10, uniform(random, -3, 0.5)) : 0;
    for (int k = 0; k < 3; k++) {
        x[k] = v[0][k] + a * ab[k] + b * ac[k] - depth * n[k];
    }
    return kind == 1 ? PARIAN_REFRACTOR_NO_SKIP : t;
}

static size_t compare_queries(const parian_mesh *mesh, double eta, unsigned queries, uint64_t seed)
{
    parian_random random = parian_random_stream(seed, mesh->triangle_count, 1, 0);
    parian_refractor *refractor = NULL;
    parian_refractor_index *index = NULL;
    found_list *list = malloc(sizeof *list);
    size_t paths = 0;
    assert_non_null(list);
    assert_int_equal(parian_refractor_create(test_env(0), mesh, eta, &refractor), PARIAN_OK);
    for (unsigned i = 0; i < queries; i++) {
        parian_light_point light;
        double x[3], max_length = i % 3 == 0 ? INFINITY : uniform(&random, 0.01, 1);
        random_light(&random, (int)(i % 5), &light);
        uint32_t skip = random_place(&random, mesh, (int)(i / 5 % 3), x);
        list->count = 0;
        parian_refracted_paths(refractor, x, &light, max_length, skip, collect, list);
        paths += compare(mesh, eta, x, &light, max_length, skip, list);
        if (light.at_infinity) {
            assert_int_equal(parian_refractor_prepare_direction(
                                 test_env(0), refractor, light.direction, max_length, &index),
                             PARIAN_OK);
            list->count = 0;
            parian_refractor_index_paths(index, x, max_length, skip, collect, list);
            paths += compare(mesh, eta, x, &light, max_length, skip, list);
            parian_refractor_index_destroy(index);
        }
    }
    parian_refractor_destroy(refractor);
    free(list);
    return paths;
}

static const double all_etas[] = {1, 1.3, 1.5, 0.7, 1.0001, 0.999, 3, 0.2};
enum { ETA_COUNT = sizeof all_etas / sizeof all_etas[0] };

/* Total reflection leaves few paths at eta = 0.2; fewer than these and the comparison would mean
 * little. */
enum { PATHS_LEAST = 40 };

static void soups_agree_with_the_plain_search(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 5, 17, 64, 500};
    for (int e = 0; e < ETA_COUNT; e++) {
        size_t paths = 0;
        for (int c = 0; c < 7; c++) {
            parian_mesh mesh;
            make_soup(7, counts[c], 1.5, c % 2 ? 1 : 50, &mesh);
            paths += compare_queries(&mesh, all_etas[e], 400, 11 + (uint64_t)c);
            parian_mesh_free(NULL, &mesh);
        }
        assert_true(paths > PATHS_LEAST);
    }
}

static void blobs_agree_with_the_plain_search(void **state)
{
    (void)state;
    static const double shape[][3] = {
        {0, 0, 1}, {0.3, 6, 1}, {0.6, 11, 1}, {0.3, 6, 0.01}, {0.2, 40, 0.5}};
    for (int e = 0; e < ETA_COUNT; e++) {
        size_t paths = 0;
        for (int s = 0; s < 5; s++) {
            parian_mesh mesh;
            make_blob(8, shape[s][0], shape[s][1], shape[s][2], &mesh);
            paths += compare_queries(&mesh, all_etas[e], 120, 5 + (uint64_t)s);
            parian_mesh_free(NULL, &mesh);
        }
        assert_true(paths > PATHS_LEAST);
    }
}

/* A lamp in the very middle of the mesh's ball, as in a bowl or a ring: a sphere turned inside out,
 * from places in the matter around it. */
static void lamp_in_the_middle(void **state)
{
    (void)state;
    const parian_light_point light = {.position = {0, 0, 0}};
    parian_mesh mesh;
    make_blob(8, 0, 1, 1, &mesh);
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        uint32_t kept = mesh.triangle[t][1];
        mesh.triangle[t][1] = mesh.triangle[t][2];
        mesh.triangle[t][2] = kept;
    }
    found_list *list = malloc(sizeof *list);
    assert_non_null(list);
    for (int e = 0; e < ETA_COUNT; e++) {
        parian_refractor *refractor = NULL;
        parian_random random = parian_random_stream(3, (uint64_t)e, 0, 0);
        size_t paths = 0;
        assert_int_equal(parian_refractor_create(NULL, &mesh, all_etas[e], &refractor), PARIAN_OK);
        for (int i = 0; i < 100; i++) {
            double x[3];
            random_direction(&random, x);
            for (int k = 0; k < 3; k++) {
                x[k] *= 0.51 + 0.002 * i;
            }
            list->count = 0;
            parian_refracted_paths(refractor, x, &light, INFINITY, PARIAN_REFRACTOR_NO_SKIP,
                                   collect, list);
            paths +=
                compare(&mesh, all_etas[e], x, &light, INFINITY, PARIAN_REFRACTOR_NO_SKIP, list);
        }
        assert_true(paths > PATHS_LEAST);
        parian_refractor_destroy(refractor);
    }
    free(list);
    parian_mesh_free(NULL, &mesh);
}

/* ---- scale and place ---- */

/* A body a thousand times smaller or larger, anywhere, has the same paths. */
static void scale_and_place_do_not_matter(void **state)
{
    (void)state;
    static const double scales[] = {1e-6, 1e-4, 1, 1e4};
    parian_mesh mesh;
    make_blob(12, 0.3, 6, 1, &mesh);
    found_list *list = malloc(2 * sizeof *list);
    assert_non_null(list);
    for (int s = 0; s < 4; s++) {
        parian_mesh moved;
        make_blob(12, 0.3, 6, 1, &moved);
        parian_refractor *refractor[2];
        for (size_t i = 0; i < 3 * (size_t)mesh.vertex_count; i++) {
            moved.position[i / 3][i % 3] = scales[s] * (mesh.position[i / 3][i % 3] + 5);
        }
        assert_int_equal(parian_refractor_create(NULL, &mesh, 1.4, &refractor[0]), PARIAN_OK);
        assert_int_equal(parian_refractor_create(NULL, &moved, 1.4, &refractor[1]), PARIAN_OK);
        parian_random random = parian_random_stream(29, 0, 0, 0);
        for (int i = 0; i < 2000; i++) {
            double x[2][3];
            parian_light_point light[2];
            random_light(&random, i % 5, &light[0]);
            light[1] = light[0];
            for (int k = 0; k < 3; k++) {
                x[0][k] = uniform(&random, -0.4, 0.4);
                x[1][k] = scales[s] * (x[0][k] + 5);
                light[1].position[k] = scales[s] * (light[0].position[k] + 5);
            }
            for (int k = 0; k < 2; k++) {
                list[k].count = 0;
                parian_refracted_paths(refractor[k], x[k], &light[k], k ? scales[s] : 1,
                                       PARIAN_REFRACTOR_NO_SKIP, collect, &list[k]);
            }
            double unit = light[0].at_infinity ? 1 : scales[s] * scales[s];
            assert_int_equal(list[0].count, list[1].count);
            assert_true(fabs(factor_sum(&list[1]) * unit - factor_sum(&list[0])) <=
                        1e-9 * factor_sum(&list[0]));
        }
        parian_refractor_destroy(refractor[0]);
        parian_refractor_destroy(refractor[1]);
        parian_mesh_free(NULL, &moved);
    }
    free(list);
    parian_mesh_free(NULL, &mesh);
}

/* ---- hostile input ---- */

static void check_path(void *context, const parian_refracted_path *path)
{
    size_t *count = context;
    check_finite(path);
    ++*count;
}

static const double nasty_values[] = {0,     -0.5,   1e-300,   1e300,     NAN,  INFINITY,
                                      -1e30, 5e-324, INFINITY, -INFINITY, 1e17, 0.5};
enum { NASTY_COUNT = sizeof nasty_values / sizeof nasty_values[0] };

static double nasty(parian_random *random, double usual)
{
    double pick = parian_random_unit(random);
    return pick < 0.3 ? nasty_values[(int)(pick / 0.3 * NASTY_COUNT)] : usual;
}

/* Anything may come in; nothing that is not a number comes out. */
static void hostile_numbers_give_no_nan(void **state)
{
    (void)state;
    parian_random random = parian_random_stream(31, 0, 0, 0);
    size_t paths = 0;
    for (int round = 0; round < 150; round++) {
        parian_mesh mesh;
        parian_refractor *refractor = NULL;
        make_blob(3, 0.3, 6, 1, &mesh);
        for (uint32_t i = 0; i < mesh.vertex_count; i += 1 + (uint32_t)round) {
            mesh.position[i][i % 3] = nasty(&random, mesh.position[i][i % 3]);
        }
        assert_int_equal(
            parian_refractor_create(NULL, &mesh, all_etas[round % ETA_COUNT], &refractor),
            PARIAN_OK);
        for (int i = 0; i < 100; i++) {
            double x[3], length = nasty(&random, 1);
            parian_light_point light;
            random_light(&random, i % 5, &light);
            for (int k = 0; k < 3; k++) {
                x[k] = nasty(&random, uniform(&random, -0.5, 0.5));
                light.position[k] = nasty(&random, light.position[k]);
                light.direction[k] =
                    i % 2 ? light.direction[k] : nasty(&random, light.direction[k]);
            }
            if (i % 7 == 0) { /* a corner of the mesh, for both */
                memcpy(x, mesh.position[i % (int)mesh.vertex_count], sizeof x);
                memcpy(light.position, mesh.position[i % 5], sizeof x);
            }
            parian_refracted_paths(refractor, x, &light, length, PARIAN_REFRACTOR_NO_SKIP,
                                   check_path, &paths);
            parian_refractor_index *index = NULL;
            if (light.at_infinity &&
                parian_refractor_prepare_direction(NULL, refractor, light.direction, length,
                                                   &index) == PARIAN_OK) {
                parian_refractor_index_paths(index, x, length, PARIAN_REFRACTOR_NO_SKIP, check_path,
                                             &paths);
                parian_refractor_index_destroy(index);
            }
        }
        parian_refractor_destroy(refractor);
        parian_mesh_free(NULL, &mesh);
    }
    assert_true(paths > 1000);
}

static void bad_arguments_are_refused(void **state)
{
    (void)state;
    static const double etas[] = {0, -1, NAN, INFINITY};
    parian_mesh mesh;
    parian_refractor *refractor = NULL;
    parian_refractor_index *index = NULL;
    make_facet(&mesh);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(parian_refractor_create(NULL, &mesh, etas[k], &refractor),
                         PARIAN_E_ARGUMENT);
    }
    assert_int_equal(parian_refractor_create(NULL, &mesh, 1.5, &refractor), PARIAN_OK);
    double zero[3] = {0, 0, 0}, up[3] = {0, 0, 1}, bad[3] = {0, NAN, 1};
    assert_int_equal(parian_refractor_prepare_direction(NULL, refractor, zero, 1, &index),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_refractor_prepare_direction(NULL, refractor, bad, 1, &index),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_refractor_prepare_direction(NULL, refractor, up, NAN, &index),
                     PARIAN_E_ARGUMENT);
    assert_null(index);
    parian_refractor_destroy(refractor);
    mesh.triangle[0][1] = 3;
    assert_int_equal(parian_refractor_create(NULL, &mesh, 1.5, &refractor), PARIAN_E_ARGUMENT);
    parian_mesh_free(NULL, &mesh);
}

/* No facets at all: none, or only ones without an area. */
static void empty_meshes_carry_nothing(void **state)
{
    (void)state;
    for (uint32_t n = 0; n < 3; n++) {
        parian_mesh mesh;
        parian_refractor *refractor = NULL;
        parian_refractor_index *index = NULL;
        found_list list;
        list.count = 0;
        double x[3] = {0, 0, 0};
        parian_light_point light = {
            .at_infinity = true, .direction = {0, 0, 1}, .position = {0, 0, 1}};
        make_mesh(3, n, &mesh);
        assert_int_equal(parian_refractor_create(NULL, &mesh, 1.5, &refractor), PARIAN_OK);
        assert_int_equal(
            parian_refractor_prepare_direction(NULL, refractor, light.direction, 1, &index),
            PARIAN_OK);
        parian_refracted_paths(refractor, x, &light, 1, PARIAN_REFRACTOR_NO_SKIP, collect, &list);
        parian_refractor_index_paths(index, x, 1, PARIAN_REFRACTOR_NO_SKIP, collect, &list);
        light.at_infinity = false;
        parian_refracted_paths(refractor, x, &light, 1, PARIAN_REFRACTOR_NO_SKIP, collect, &list);
        assert_int_equal(list.count, 0);
        parian_refractor_index_destroy(index);
        parian_refractor_destroy(refractor);
        parian_mesh_free(NULL, &mesh);
    }
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    parian_mesh mesh;
    double up[3] = {0, 0, 1};
    assert_int_equal(test_sphere(NULL, 1, 2, &mesh), PARIAN_OK);
    for (size_t k = 0;; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_refractor *refractor = NULL;
        parian_refractor_index *index = NULL;
        parian_result r = parian_refractor_create(&env, &mesh, 1.5, &refractor);
        if (r == PARIAN_OK) {
            r = parian_refractor_prepare_direction(&env, refractor, up, 1, &index);
        }
        parian_refractor_index_destroy(index);
        parian_refractor_destroy(refractor);
        assert_int_equal(memory.live, 0);
        if (r == PARIAN_OK) {
            assert_true(k > 5);
            break;
        }
        assert_int_equal(r, PARIAN_E_NOMEM);
    }
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soups_agree_with_the_plain_search),
        cmocka_unit_test(blobs_agree_with_the_plain_search),
        cmocka_unit_test(lamp_in_the_middle),
        cmocka_unit_test(scale_and_place_do_not_matter),
        cmocka_unit_test(hostile_numbers_give_no_nan),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(empty_meshes_carry_nothing),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
