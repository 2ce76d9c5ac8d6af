/* test_refracted_flux.c - refracted paths against closed forms, flux and what an edge shares.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>

#include "core/fresnel.h"
#include "support/refracted_case.h"

/* ---- closed forms ---- */

static void a_flat_facet_refracts_by_snell(void **state)
{
    (void)state;
    static const double etas[] = {1, 1.3, 1.5, 0.7};
    parian_mesh mesh;
    make_facet(&mesh);
    for (int e = 0; e < 4; e++) {
        parian_refractor *refractor = NULL;
        assert_int_equal(parian_refractor_create(NULL, &mesh, etas[e], &refractor), PARIAN_OK);
        for (double i = 0; i < 1.5; i += 0.1) {
            double sine = sin(i) / etas[e], depth = 0.7;
            found_list list;
            list.count = 0;
            parian_light_point light = {.at_infinity = true, .direction = {sin(i), 0, cos(i)}};
            double x[3] = {0.1, -0.2, -depth};
            parian_refracted_paths(refractor, x, &light, 3, PARIAN_REFRACTOR_NO_SKIP, collect,
                                   &list);
            double t = asin(sine), path = depth / cos(t);
            assert_int_equal(list.count, sine < 1 && path < 3);
            if (list.count) {
                const parian_refracted_path *p = list.path;
                assert_true(fabs(p->entry[0] - (x[0] + depth * tan(t))) < 1e-13);
                assert_true(fabs(p->entry[1] - x[1]) < 1e-14 && fabs(p->entry[2]) < 1e-14);
                assert_true(fabs(p->length - path) < 1e-13 * path && isinf(p->light_distance));
                assert_true(fabs(p->into[2] + cos(t)) < 1e-14 && fabs(p->into[0] + sine) < 1e-14);
                double factor = parian_fresnel_transmittance(cos(i), etas[e]) * cos(i) / cos(t);
                assert_true(fabs(p->factor - factor) < 1e-12);
            }
        }
        parian_refractor_destroy(refractor);
    }
    parian_mesh_free(NULL, &mesh);
}

/* A ray that leaves the light at angle i fixes x; the factor is the flux of a narrow tube around it
 * over the tube's section at x, by central differences of step 1e-5: 1e-8 of truncation and
 * rounding, times 10. */
static void a_point_light_spreads_as_its_tube(void **state)
{
    (void)state;
    static const double etas[] = {1, 1.3, 1.5, 0.7}, depths[] = {1e-6, 0.01, 0.5, 4};
    parian_mesh mesh;
    make_facet(&mesh);
    for (int c = 0; c < 16; c++) {
        double eta = etas[c / 4], h1 = 0.8, h2 = depths[c % 4], step = 1e-5;
        parian_refractor *refractor = NULL;
        assert_int_equal(parian_refractor_create(NULL, &mesh, eta, &refractor), PARIAN_OK);
        parian_light_point light = {.position = {0.3, -0.4, h1}};
        for (double i = 0.05; i < 1.2 && sin(i) < 0.97 * eta; i += 0.1) {
            double t = asin(sin(i) / eta), r[2];
            for (int k = 0; k < 2; k++) {
                double j = i + (k ? step : -step);
                r[k] = h1 * tan(j) + h2 * tan(asin(sin(j) / eta));
            }
            double reach = h1 * tan(i) + h2 * tan(t),
                   x[3] = {0.3 + 0.6 * reach, -0.4 + 0.8 * reach, -h2};
            found_list list;
            list.count = 0;
            parian_refracted_paths(refractor, x, &light, 100, PARIAN_REFRACTOR_NO_SKIP, collect,
                                   &list);
            assert_int_equal(list.count, 1);
            double tube = sin(i) * 2 * step / (reach * (r[1] - r[0]) * cos(t));
            double factor = tube * parian_fresnel_transmittance(cos(i), eta);
            const parian_refracted_path *p = list.path;
            assert_true(fabs(p->factor - factor) < 1e-7 * factor);
            assert_true(fabs(p->entry[0] - (0.3 + 0.6 * h1 * tan(i))) < 1e-12);
            assert_true(fabs(p->to_light[2] - cos(i)) < 1e-12 && fabs(p->into[2] + cos(t)) < 1e-12);
            assert_true(fabs(p->light_distance - h1 / cos(i)) < 1e-12);
        }
        double below[3] = {0.3, -0.4, -h2}; /* the limit r -> 0 */
        found_list list;
        list.count = 0;
        parian_refracted_paths(refractor, below, &light, 100, PARIAN_REFRACTOR_NO_SKIP, collect,
                               &list);
        assert_int_equal(list.count, 1);
        double factor = parian_fresnel_transmittance(1, eta) / pow(h1 + h2 / eta, 2);
        assert_true(fabs(list.path[0].factor - factor) < 1e-13 * factor);
        parian_refractor_destroy(refractor);
    }
    parian_mesh_free(NULL, &mesh);
}

/* ---- flux ---- */

/* Flux that crosses facet t: integral of T cos_i dA (times 1 / d^2 for a point), n^2 midpoints. */
static double facet_flux(const parian_mesh *mesh, uint32_t t, double eta,
                         const parian_light_point *light, int n)
{
    double v[3][3], ab[3], ac[3], normal[3], sum = 0;
    get_corners(mesh, t, v);
    subtract(v[1], v[0], ab);
    subtract(v[2], v[0], ac);
    parian_cross3(ab, ac, normal);
    double area = 0.5 * norm(normal);
    normalise(normal);
    for (int k = 0; k < n * n; k++) {
        double a = (k / n + 0.5) / n, b = (k % n + 0.5) / n * (1 - a), y[3], to[3],
               share = 2 * (1 - a);
        for (int j = 0; j < 3; j++) {
            y[j] = v[0][j] + a * ab[j] + b * ac[j];
            to[j] = light->at_infinity ? light->direction[j] : light->position[j] - y[j];
        }
        double distance = norm(to), cos_i = parian_dot3(to, normal) / distance;
        double spread = light->at_infinity ? 1 : 1 / (distance * distance);
        sum += cos_i > 0 ? share * area * spread * cos_i * parian_fresnel_transmittance(cos_i, eta)
                         : 0;
    }
    return sum / (n * n);
}

/* The flux through a plane below a facet is what the facet lets in. The lit figure's border on a
 * grid of 700^2 cells is the error: 2e-4 measured. */
static void flux_below_a_facet_is_what_it_lets_in(void **state)
{
    (void)state;
    enum { CELLS = 700 };
    static const double etas[] = {1, 1.3, 1.5, 0.7};
    static const parian_light_point lights[] = {
        {.at_infinity = true, .direction = {0.36, 0.48, 0.8}}, {.position = {-3, 2, 6}}};
    parian_mesh mesh;
    make_facet(&mesh);
    for (int c = 0; c < 8; c++) {
        double eta = etas[c / 2], sum = 0, side = 64.0 / CELLS;
        parian_refractor *refractor = NULL;
        assert_int_equal(parian_refractor_create(NULL, &mesh, eta, &refractor), PARIAN_OK);
        for (int k = 0; k < CELLS * CELLS; k++) {
            double x[3] = {-32 + (k / CELLS + 0.5) * side, -32 + (k % CELLS + 0.5) * side, -1.5};
            found_list list;
            list.count = 0;
            parian_refracted_paths(refractor, x, &lights[c % 2], 100, PARIAN_REFRACTOR_NO_SKIP,
                                   collect, &list);
            for (size_t i = 0; i < list.count; i++) {
                sum += list.path[i].factor * -list.path[i].into[2] * side * side;
            }
        }
        double flux = facet_flux(&mesh, 0, eta, &lights[c % 2], 400);
        if (fabs(sum - flux) >= 1e-3 * flux) {
            fail_msg("case %d: %g crosses the plane, the facet lets in %g", c, sum, flux);
        }
        parian_refractor_destroy(refractor);
    }
    parian_mesh_free(NULL, &mesh);
}

/* Way from y along w to where a convex mesh ends; INFINITY outside of its half-spaces. */
static double convex_way(const parian_mesh *mesh, const double y[3], const double w[3],
                         uint32_t except)
{
    double way = INFINITY;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double v[3][3], ab[3], ac[3], n[3], d[3];
        get_corners(mesh, t, v);
        subtract(v[1], v[0], ab);
        subtract(v[2], v[0], ac);
        parian_cross3(ab, ac, n);
        subtract(v[0], y, d);
        double speed = parian_dot3(w, n);
        if (t != except && speed > 0) {
            way = fmin(way, fmax(parian_dot3(d, n) / speed, 0));
        }
    }
    return way;
}

static bool convex_holds(const parian_mesh *mesh, const double x[3])
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double v[3][3], ab[3], ac[3], n[3], d[3];
        get_corners(mesh, t, v);
        subtract(v[1], v[0], ab);
        subtract(v[2], v[0], ac);
        parian_cross3(ab, ac, n);
        subtract(v[0], x, d);
        if (parian_dot3(d, n) < 0) {
            return false;
        }
    }
    return true;
}

typedef struct estimate {
    double sum, sum2;
    size_t count;
} estimate;

static void add(estimate *e, double value)
{
    e->sum += value;
    e->sum2 += value * value;
    e->count++;
}

static double mean(const estimate *e)
{
    return e->sum / (double)e->count;
}

/* Squared standard error of the mean. */
static double error2(const estimate *e)
{
    return (e->sum2 / (double)e->count - mean(e) * mean(e)) / (double)e->count;
}

/* Beams refracted forwards at random places of every facet: flux times the way to the other side,
 * and the squared standard error. */
static double follow_beams(const parian_mesh *mesh, double eta, const parian_light_point *light,
                           unsigned each, double *squared_error)
{
    double sum = 0;
    *squared_error = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double v[3][3], ab[3], ac[3], n[3];
        parian_random random = parian_random_stream(3, t, 0, 0);
        estimate e = {0, 0, 0};
        get_corners(mesh, t, v);
        subtract(v[1], v[0], ab);
        subtract(v[2], v[0], ac);
        parian_cross3(ab, ac, n);
        double area = 0.5 * norm(n);
        normalise(n);
        for (unsigned k = 0; k < each; k++) {
            double a = parian_random_unit(&random), b = parian_random_unit(&random), y[3], to[3],
                   w[3];
            a = 1 - sqrt(a);
            b *= 1 - a;
            for (int j = 0; j < 3; j++) {
                y[j] = v[0][j] + a * ab[j] + b * ac[j];
                to[j] = light->at_infinity ? light->direction[j] : light->position[j] - y[j];
            }
            double distance = norm(to), cos_i = parian_dot3(to, n) / distance, value = 0;
            double cos2_t = 1 - (1 - cos_i * cos_i) / (eta * eta);
            if (cos_i > 0 && cos2_t > 0) {
                for (int j = 0; j < 3; j++) {
                    w[j] = -to[j] / distance / eta + (cos_i / eta - sqrt(cos2_t)) * n[j];
                }
                value = cos_i * parian_fresnel_transmittance(cos_i, eta) * area *
                        convex_way(mesh, y, w, t) / (light->at_infinity ? 1 : distance * distance);
            }
            add(&e, value);
        }
        sum += mean(&e);
        *squared_error += error2(&e);
    }
    return sum;
}

/* Without absorption, the integral of irradiance over the inside (each path's on a plane across
 * itself) is the sum over beams of flux times way: an identity of the faceted, convex sphere; 4
 * standard errors, of 1.2 % of the mean or less. */
static void flux_inside_a_sphere_is_that_of_its_beams(void **state)
{
    (void)state;
    enum { SAMPLES = 100000 };
    static const double etas[] = {1, 1.3, 1.5, 0.7};
    static const parian_light_point lights[] = {
        {.at_infinity = true, .direction = {0.36, 0.48, 0.8}}, {.position = {-0.8, 1.4, 2.2}}};
    parian_mesh mesh;
    assert_int_equal(test_sphere(NULL, 1, 4, &mesh), PARIAN_OK);
    found_list *list = malloc(sizeof *list);
    assert_non_null(list);
    for (int c = 0; c < 8; c++) {
        estimate inside = {0, 0, 0};
        parian_refractor *refractor = NULL;
        parian_random random = parian_random_stream(17, 0, 0, 0);
        assert_int_equal(parian_refractor_create(NULL, &mesh, etas[c / 2], &refractor), PARIAN_OK);
        for (size_t i = 0; i < SAMPLES; i++) {
            double x[3] = {uniform(&random, -1, 1), uniform(&random, -1, 1),
                           uniform(&random, -1, 1)};
            list->count = 0;
            if (norm(x) < 0.95 || (norm(x) <= 1 && convex_holds(&mesh, x))) {
                parian_refracted_paths(refractor, x, &lights[c % 2], 10, PARIAN_REFRACTOR_NO_SKIP,
                                       collect, list);
            }
            add(&inside, 8 * factor_sum(list));
        }
        double squared, beams = follow_beams(&mesh, etas[c / 2], &lights[c % 2], 60, &squared);
        double error = sqrt(error2(&inside) + squared);
        if (fabs(mean(&inside) - beams) >= 4 * error || error >= 0.012 * beams) {
            fail_msg("case %d: %g inside, %g by beams, standard error %g", c, mean(&inside), beams,
                     error);
        }
        parian_refractor_destroy(refractor);
    }
    free(list);
    parian_mesh_free(NULL, &mesh);
}

/* ---- borders ---- */

/* Every point below a flat grid has one path: at random, and exactly below edges and corners. */
static void shared_edges_count_once(void **state)
{
    (void)state;
    enum { CUTS = 16, POINTS = 40000 };
    static const double etas[] = {1, 1.5, 0.7};
    parian_mesh mesh;
    assert_int_equal(test_plane(NULL, 2, CUTS, &mesh), PARIAN_OK);
    for (int c = 0; c < 3; c++) {
        parian_refractor *refractor = NULL;
        parian_refractor_index *index = NULL;
        parian_random random = parian_random_stream(23, (uint64_t)c, 0, 0);
        parian_light_point light[3] = {{.at_infinity = true, .direction = {0, 0, 1}},
                                       {.at_infinity = true, .direction = {0.28, 0, 0.96}},
                                       {.position = {0.125, 0.25, 1}}};
        assert_int_equal(parian_refractor_create(NULL, &mesh, etas[c], &refractor), PARIAN_OK);
        assert_int_equal(
            parian_refractor_prepare_direction(NULL, refractor, light[0].direction, 1, &index),
            PARIAN_OK);
        for (int i = 0; i < POINTS; i++) {
            double x[3] = {uniform(&random, -0.8, 0.8), uniform(&random, -0.8, 0.8), -0.0625};
            int way = i % 6;
            if (way >= 3) { /* on lines and corners of the grid, halves of its cells */
                x[0] = floor(x[0] * CUTS) / CUTS;
                x[1] = way >= 4 ? floor(x[1] * CUTS) / CUTS : x[1];
            }
            found_list list;
            list.count = 0;
            parian_refracted_paths(refractor, x, &light[i % 3], 1, PARIAN_REFRACTOR_NO_SKIP,
                                   collect, &list);
            assert_int_equal(list.count, 1);
            list.count = 0;
            parian_refractor_index_paths(index, x, 1, PARIAN_REFRACTOR_NO_SKIP, collect, &list);
            assert_int_equal(list.count, 1);
        }
        parian_refractor_index_destroy(index);
        parian_refractor_destroy(refractor);
    }
    parian_mesh_free(NULL, &mesh);
}

/* On its own facet a point has the facet's light at length 0, unless the facet is skipped. */
static void a_point_on_the_surface_is_lit_there(void **state)
{
    (void)state;
    parian_mesh mesh;
    make_facet(&mesh);
    parian_refractor *refractor = NULL;
    assert_int_equal(parian_refractor_create(NULL, &mesh, 1.5, &refractor), PARIAN_OK);
    parian_light_point light[2] = {{.at_infinity = true, .direction = {0.6, 0, 0.8}},
                                   {.position = {1, 2, 3}}};
    double x[3] = {0, 0, 0};
    for (int k = 0; k < 2; k++) {
        found_list list;
        list.count = 0;
        parian_refracted_paths(refractor, x, &light[k], 1, PARIAN_REFRACTOR_NO_SKIP, collect,
                               &list);
        assert_int_equal(list.count, 1);
        double d2 = k ? 14 : 1, cos_i = k ? 3 / sqrt(14) : 0.8,
               cos_t = sqrt(1 - (1 - cos_i * cos_i) / 2.25);
        double factor = parian_fresnel_transmittance(cos_i, 1.5) * cos_i / cos_t / d2;
        assert_true(list.path[0].length == 0 && fabs(list.path[0].factor - factor) < 1e-14);
        list.count = 0;
        parian_refracted_paths(refractor, x, &light[k], 1, 0, collect, &list);
        assert_int_equal(list.count, 0);
    }
    parian_refractor_destroy(refractor);
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_facet_refracts_by_snell),
        cmocka_unit_test(a_point_light_spreads_as_its_tube),
        cmocka_unit_test(flux_below_a_facet_is_what_it_lets_in),
        cmocka_unit_test(flux_inside_a_sphere_is_that_of_its_beams),
        cmocka_unit_test(shared_edges_count_once),
        cmocka_unit_test(a_point_on_the_surface_is_lit_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
