/* test_refracted_paths.c - refracted paths through facets against a plain search, closed forms and
 * flux.
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

#include "bake/reference/refracted_paths.h"
#include "core/fresnel.h"
#include "core/memory.h"
#include "core/random.h"
#include "core/small_maths.h"

enum { FOUND_MAX = 512 };

/* ---- vectors and lists
 * ---------------------------------------------------------------------------------- */

static void subtract(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = a[k] - b[k];
    }
}

static double norm(const double a[3])
{
    return sqrt(parian_dot3(a, a));
}

static void normalise(double a[3])
{
    double length = norm(a);
    for (int k = 0; k < 3; k++) {
        a[k] /= length;
    }
}

static double uniform(parian_random *random, double low, double high)
{
    return low + (high - low) * parian_random_unit(random);
}

static void random_direction(parian_random *random, double out[3])
{
    do {
        for (int k = 0; k < 3; k++) {
            out[k] = uniform(random, -1, 1);
        }
    } while (norm(out) > 1 || norm(out) < 0.1);
    normalise(out);
}

/* What a search found; only the first count are set. */
typedef struct found_list {
    size_t count;
    parian_refracted_path path[FOUND_MAX];
} found_list;

static void collect(void *context, const parian_refracted_path *path)
{
    found_list *list = context;
    assert_true(list->count < FOUND_MAX);
    list->path[list->count++] = *path;
}

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

static double factor_sum(const found_list *list)
{
    double sum = 0;
    for (size_t i = 0; i < list->count; i++) {
        sum += list->path[i].factor;
    }
    return sum;
}

static void check_finite(const parian_refracted_path *path)
{
    for (int k = 0; k < 3; k++) {
        assert_true(isfinite(path->entry[k]) && isfinite(path->to_light[k]) &&
                    isfinite(path->into[k]));
    }
    assert_true(isfinite(path->factor) && path->factor >= 0 && path->length >= 0 &&
                path->light_distance > 0);
}

/* ---- the plain search
 * ----------------------------------------------------------------------------------- */

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

static void get_corners(const parian_mesh *mesh, uint32_t t, double v[3][3])
{
    for (int c = 0; c < 3; c++) {
        memcpy(v[c], mesh->position[mesh->triangle[t][c]], sizeof v[c]);
    }
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

/* ---- meshes
 * --------------------------------------------------------------------------------------------- */

static void make_mesh(uint32_t vertices, uint32_t triangles, parian_mesh *mesh)
{
    *mesh = (parian_mesh){.vertex_count = vertices, .triangle_count = triangles};
    assert_true(PARIAN_NEW0(NULL, mesh->position, vertices) &&
                PARIAN_NEW0(NULL, mesh->triangle, triangles));
}

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

/* A sphere with dents and hills; flat: its height over its width. */
static void make_blob(unsigned cuts, double depth, double waves, double flat, parian_mesh *mesh)
{
    assert_int_equal(test_sphere(NULL, 0.5, cuts, mesh), PARIAN_OK);
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        double *p = mesh->position[i];
        double scale = 1 + depth * sin(waves * 2 * p[0]) * cos(waves * 2 * p[1] + 1) *
                               sin(waves * 2 * p[2] + 2);
        for (int k = 0; k < 3; k++) {
            p[k] *= scale * (k == 2 ? flat : 1);
        }
    }
}

/* ---- against the plain search
 * --------------------------------------------------------------------------- */

static void random_light(parian_random *random, int kind, parian_light_point *light)
{
    static const double range[] = {0, 0.7, 3, 40, 1e5};
    random_direction(random, light->direction);
    light->at_infinity = kind == 0;
    for (int k = 0; k < 3; k++) {
        light->position[k] = light->direction[k] * range[kind];
    }
}

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

/* ---- closed forms
 * --------------------------------------------------------------------------------------- */

/* One facet of side about 20 in the plane z = 0, facing up. */
static void make_facet(parian_mesh *mesh)
{
    static const double corner[3][3] = {{-10, -8, 0}, {12, -9, 0}, {-1, 13, 0}};
    make_mesh(3, 1, mesh);
    memcpy(mesh->position, corner, sizeof corner);
    for (uint32_t k = 0; k < 3; k++) {
        mesh->triangle[0][k] = k;
    }
}

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

/* ---- flux
 * -----------------------------------------------------------------------------------------------
 */

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

/* ---- borders
 * -------------------------------------------------------------------------------------------- */

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

/* ---- hostile input
 * -------------------------------------------------------------------------------------- */

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
        cmocka_unit_test(a_flat_facet_refracts_by_snell),
        cmocka_unit_test(a_point_light_spreads_as_its_tube),
        cmocka_unit_test(flux_below_a_facet_is_what_it_lets_in),
        cmocka_unit_test(flux_inside_a_sphere_is_that_of_its_beams),
        cmocka_unit_test(shared_edges_count_once),
        cmocka_unit_test(a_point_on_the_surface_is_lit_there),
        cmocka_unit_test(scale_and_place_do_not_matter),
        cmocka_unit_test(hostile_numbers_give_no_nan),
        cmocka_unit_test(bad_arguments_are_refused),
        cmocka_unit_test(empty_meshes_carry_nothing),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
