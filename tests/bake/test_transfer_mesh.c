/* test_transfer_mesh.c - the transfer-mesh stage on surfaces whose area, volume and shape are
 * known.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/stages/transfer_mesh.h"
#include "core/memory.h"
#include "core/small_maths.h"

static const uint32_t targets[] = {500, 2000, 10000};
enum { TARGET_COUNT = 3 };

/* ---- independent checks ------------------------------------------------------------------------
 */

static int compare_edges(const void *left, const void *right)
{
    uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return a < b ? -1 : a > b;
}

typedef struct topology {
    uint32_t boundary_edges;
    int euler;
} topology;

/* An oriented 2-manifold has each directed edge at most once, and around each vertex one fan: as
 * many triangles as edges, or one fewer with exactly two boundary edges. */
static topology check_manifold(const parian_mesh *mesh)
{
    size_t half_count = 3 * (size_t)mesh->triangle_count;
    uint64_t *directed = malloc(half_count * sizeof *directed);
    uint32_t *boundary_at = calloc(mesh->vertex_count, sizeof *boundary_at);
    uint32_t *triangles_at = calloc(mesh->vertex_count, sizeof *triangles_at);
    topology found = {0};
    for (size_t i = 0; i < half_count; i++) {
        uint64_t a = mesh->triangle[i / 3][i % 3], b = mesh->triangle[i / 3][(i + 1) % 3];
        assert_true(a < mesh->vertex_count && b < mesh->vertex_count && a != b);
        directed[i] = a << 32 | b;
        triangles_at[a]++;
    }
    qsort(directed, half_count, sizeof *directed, compare_edges);
    for (size_t i = 0; i < half_count; i++) {
        uint64_t opposite = directed[i] << 32 | directed[i] >> 32;
        assert_true(i == 0 || directed[i] != directed[i - 1]);
        if (!bsearch(&opposite, directed, half_count, sizeof opposite, compare_edges)) {
            found.boundary_edges++;
            boundary_at[directed[i] >> 32]++;
            boundary_at[directed[i] & 0xFFFFFFFFu]++;
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        assert_true(triangles_at[v] > 0);
        assert_true(boundary_at[v] == 0 || boundary_at[v] == 2);
    }
    found.euler = (int)mesh->vertex_count - (int)((half_count + found.boundary_edges) / 2) +
                  (int)mesh->triangle_count;
    free(directed);
    free(boundary_at);
    free(triangles_at);
    return found;
}

static double triangle_area(const parian_mesh *mesh, uint32_t t)
{
    double e[2][3], n[3];
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++) {
            e[i][k] = mesh->position[mesh->triangle[t][i + 1]][k] -
                      mesh->position[mesh->triangle[t][0]][k];
        }
    }
    parian_cross3(e[0], e[1], n);
    return 0.5 * sqrt(parian_dot3(n, n));
}

static double volume(const parian_mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double n[3];
        parian_cross3(mesh->position[mesh->triangle[t][1]], mesh->position[mesh->triangle[t][2]],
                      n);
        sum += parian_dot3(mesh->position[mesh->triangle[t][0]], n) / 6.0;
    }
    return sum;
}

static void check_no_slivers(const parian_mesh *mesh)
{
    double mean = parian_mesh_area(mesh) / mesh->triangle_count;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        assert_true(triangle_area(mesh, t) > 1e-6 * mean);
    }
}

static void check_count(const parian_mesh *mesh, uint32_t target)
{
    assert_true(fabs((double)mesh->vertex_count - target) <= 0.05 * target);
}

static parian_mesh transfer_of(const parian_env *env, const parian_mesh *source, uint32_t target,
                               parian_transfer_mesh_report *report)
{
    parian_mesh made;
    parian_transfer_mesh_desc desc = {.vertex_target = target};
    assert_int_equal(parian_stage_transfer_mesh(env, source, &desc, &made, report), PARIAN_OK);
    assert_int_equal(report->vertex_count, made.vertex_count);
    assert_int_equal(report->triangle_count, made.triangle_count);
    check_count(&made, target);
    check_no_slivers(&made);
    return made;
}

/* A torus about z, radii big and small, cut m x n. */
static parian_mesh make_torus(double big, double small, uint32_t m, uint32_t n)
{
    parian_mesh mesh = {.vertex_count = m * n, .triangle_count = 2 * m * n};
    mesh.position = malloc(mesh.vertex_count * sizeof *mesh.position);
    mesh.triangle = malloc(mesh.triangle_count * sizeof *mesh.triangle);
    for (uint32_t i = 0; i < m; i++) {
        for (uint32_t j = 0; j < n; j++) {
            double a = 2.0 * PARIAN_PI * i / m, b = 2.0 * PARIAN_PI * j / n;
            double *p = mesh.position[i * n + j];
            uint32_t i1 = (i + 1) % m * n, j1 = (j + 1) % n, i0 = i * n;
            uint32_t *t = mesh.triangle[2 * (i0 + j)];
            uint32_t corner[6] = {i0 + j, i1 + j, i1 + j1, i0 + j, i1 + j1, i0 + j1};
            p[0] = (big + small * cos(b)) * cos(a);
            p[1] = (big + small * cos(b)) * sin(a);
            p[2] = small * sin(b);
            memcpy(t, corner, sizeof corner);
        }
    }
    return mesh;
}

/* Put b beside a: b moved by `shift` along x; takes the memory of both. */
static parian_mesh append(parian_mesh a, parian_mesh b, double shift)
{
    parian_mesh sum = {.vertex_count = a.vertex_count + b.vertex_count,
                       .triangle_count = a.triangle_count + b.triangle_count};
    sum.position = malloc(sum.vertex_count * sizeof *sum.position);
    sum.triangle = malloc(sum.triangle_count * sizeof *sum.triangle);
    memcpy(sum.position, a.position, a.vertex_count * sizeof *a.position);
    memcpy(sum.position + a.vertex_count, b.position, b.vertex_count * sizeof *b.position);
    memcpy(sum.triangle, a.triangle, a.triangle_count * sizeof *a.triangle);
    for (uint32_t v = a.vertex_count; v < sum.vertex_count; v++) {
        sum.position[v][0] += shift;
    }
    for (uint32_t t = 0; t < b.triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            sum.triangle[a.triangle_count + t][k] = b.triangle[t][k] + a.vertex_count;
        }
    }
    parian_mesh_free(NULL, &a);
    parian_mesh_free(NULL, &b);
    return sum;
}

/* ---- tests -------------------------------------------------------------------------------------
 */

/* A chord of length h of a sphere of radius r sags by h^2 / (8 r), a triangle of edge h by
 * h^2 / (6 r): a mesh on the sphere is nowhere farther from it. One fitted to it is closer; the
 * source itself sags too, and edges reach 4/3 of the mean. */
static void test_sphere_counts_and_distance(void **state)
{
    (void)state;
    const double radius = 0.05;
    const parian_env *env = test_env(2);
    parian_mesh source;
    assert_int_equal(test_sphere(env, radius, 50, &source), PARIAN_OK);
    double source_edge = 1.1 * radius / 50.0;
    for (int i = 0; i < TARGET_COUNT; i++) {
        parian_transfer_mesh_report report;
        parian_mesh mesh = transfer_of(env, &source, targets[i], &report);
        topology found = check_manifold(&mesh);
        double edge = 4.0 / 3.0 * report.edge_mean_m;
        double chord = (edge * edge + source_edge * source_edge) / (6.0 * radius);
        assert_int_equal(found.boundary_edges, 0);
        assert_int_equal(found.euler, 2);
        assert_true(report.quality_mean > 0.93);
        assert_true(report.distance_max_m <= chord);
        assert_true(report.distance_rms_m <= 0.5 * chord);
        assert_true(fabs(report.area_ratio - 1.0) < 0.005);
        /* The fit leaves no bias of first order: half of the sag of an inscribed mesh at most. */
        double sphere_volume = 4.0 / 3.0 * PARIAN_PI * pow(radius, 3.0);
        assert_true(fabs(volume(&mesh) / volume(&source) - 1.0) < 0.002);
        assert_true(volume(&mesh) < 1.001 * sphere_volume);
        assert_int_equal(report.source_is_denser, source.vertex_count > mesh.vertex_count);
        parian_mesh_free(env, &mesh);
    }
    parian_mesh_free(env, &source);
}

static void check_box(unsigned cuts, uint32_t target)
{
    const double a = 0.05, b = 0.02, c = 0.01;
    const parian_env *env = test_env(2);
    parian_mesh source;
    parian_transfer_mesh_report report;
    assert_int_equal(test_box(env, a, b, c, cuts, &source), PARIAN_OK);
    parian_mesh mesh = transfer_of(env, &source, target, &report);
    topology found = check_manifold(&mesh);
    assert_int_equal(found.boundary_edges, 0);
    assert_int_equal(found.euler, 2);
    /* Creases are kept, so that a box stays one to rounding; 1 % is what transport can bear. */
    assert_true(fabs(volume(&mesh) / (a * b * c) - 1.0) < 0.001);
    assert_true(fabs(parian_mesh_area(&mesh) / (2.0 * (a * b + b * c + c * a)) - 1.0) < 0.001);
    assert_true(report.quality_mean > 0.85);
    parian_mesh_free(env, &mesh);
    parian_mesh_free(env, &source);
}

static void test_box_keeps_its_edges(void **state)
{
    (void)state;
    for (int i = 0; i < TARGET_COUNT; i++) {
        check_box(1, targets[i]); /* 12 triangles */
    }
    check_box(40, 2000); /* 9,602 vertices */
}

static void test_open_plane(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    const unsigned cuts[] = {1, 100};
    for (int i = 0; i < 2; i++) {
        parian_mesh source;
        parian_transfer_mesh_report report;
        assert_int_equal(test_plane(env, 0.1, cuts[i], &source), PARIAN_OK);
        parian_mesh mesh = transfer_of(env, &source, 2000, &report);
        topology found = check_manifold(&mesh);
        assert_int_equal(found.euler, 1);
        assert_true(found.boundary_edges > 100);
        assert_true(fabs(report.area_ratio - 1.0) < 1e-6);
        assert_true(report.distance_max_m < 1e-9);
        assert_true(report.quality_mean > 0.9);
        for (uint32_t t = 0; t < mesh.triangle_count; t++) {
            const uint32_t *v = mesh.triangle[t];
            double x1 = mesh.position[v[1]][0] - mesh.position[v[0]][0];
            double y1 = mesh.position[v[1]][1] - mesh.position[v[0]][1];
            double x2 = mesh.position[v[2]][0] - mesh.position[v[0]][0];
            double y2 = mesh.position[v[2]][1] - mesh.position[v[0]][1];
            assert_true(x1 * y2 - x2 * y1 > 0.0); /* none turned over */
        }
        parian_mesh_free(env, &mesh);
        parian_mesh_free(env, &source);
    }
}

static void test_torus_keeps_its_hole(void **state)
{
    (void)state;
    parian_mesh source = make_torus(0.03, 0.01, 200, 80);
    for (int i = 0; i < TARGET_COUNT; i++) {
        parian_transfer_mesh_report report;
        parian_mesh mesh = transfer_of(test_env(2), &source, targets[i], &report);
        topology found = check_manifold(&mesh);
        assert_int_equal(found.boundary_edges, 0);
        assert_int_equal(found.euler, 0);
        assert_true(fabs(report.area_ratio - 1.0) < 0.02);
        assert_true(fabs(volume(&mesh) / volume(&source) - 1.0) < 0.01);
        parian_mesh_free(test_env(2), &mesh);
    }
    parian_mesh_free(NULL, &source);
}

/* A leaf of 0.8 mm, thinner than an edge of the transfer mesh: both sides must stay apart, facing
 * out. */
static void test_thin_sheet_keeps_its_thickness(void **state)
{
    (void)state;
    const double side = 0.1, thickness = 0.0008;
    const parian_env *env = test_env(2);
    parian_mesh source;
    parian_transfer_mesh_report report;
    assert_int_equal(test_box(env, side, side, thickness, 60, &source), PARIAN_OK);
    for (uint32_t v = 0; v < source.vertex_count; v++) { /* bend it */
        double x = source.position[v][0];
        source.position[v][2] += 0.01 * sin(40.0 * x);
    }
    parian_mesh mesh = transfer_of(env, &source, 2000, &report);
    topology found = check_manifold(&mesh);
    assert_int_equal(found.boundary_edges, 0);
    assert_int_equal(found.euler, 2);
    assert_true(report.edge_mean_m > 2.0 * thickness);
    assert_true(fabs(volume(&mesh) / volume(&source) - 1.0) < 0.05);
    assert_true(fabs(report.area_ratio - 1.0) < 0.02);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        double middle = 0.01 * sin(40.0 * mesh.position[v][0]);
        assert_true(fabs(mesh.position[v][2] - middle) < thickness);
    }
    parian_mesh_free(env, &mesh);
    parian_mesh_free(env, &source);
}

/* A ring-shaped plate of radii 20 and 50 mm whose rims are half rounds of 0.8 mm. */
static parian_mesh make_plate(double half_thickness)
{
    const double inner = 0.02 + half_thickness, outer = 0.05 - half_thickness;
    const double straight = outer - inner, arc = PARIAN_PI * half_thickness;
    const uint32_t m = 240, n = 120;
    parian_mesh mesh = make_torus(0.035, 0.01, m, n);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        double a = 2.0 * PARIAN_PI * (v / n) / m;
        double s = 2.0 * (straight + arc) * (v % n) / n; /* from the middle of the outer rim */
        bool under = s > straight + arc;
        s = under ? 2.0 * (straight + arc) - s : s;
        double turned = fmin(s, 0.5 * arc) + fmax(s - 0.5 * arc - straight, 0.0);
        double along = fmin(fmax(s - 0.5 * arc, 0.0), straight);
        double radius = outer - along + half_thickness * cos(turned / half_thickness);
        double z = half_thickness * sin(turned / half_thickness);
        mesh.position[v][0] = radius * cos(a);
        mesh.position[v][1] = radius * sin(a);
        mesh.position[v][2] = under ? -z : z;
    }
    return mesh;
}

/* Thinner than an edge: triangles across a rim would cut off an edge of it and more (1.3 found).
 * With edges along the rim, its tip is off by the sag of a chord, h^2 / (8 r) or 1/60 of an edge,
 * and the wedge that stands for the round by less than the radius of that. */
static void test_rims_are_smooth(void **state)
{
    (void)state;
    const double half_thickness = 0.0008;
    const parian_env *env = test_env(2);
    parian_mesh source = make_plate(half_thickness);
    parian_transfer_mesh_report report;
    parian_mesh mesh = transfer_of(env, &source, 2000, &report);
    parian_closest_hit *hit = malloc(source.vertex_count * sizeof *hit);
    parian_closest *closest;
    double worst = 0.0, worst_tip = 0.0;
    assert_int_equal(check_manifold(&mesh).euler, 0);
    assert_true(half_thickness < 0.4 * report.edge_mean_m);
    assert_int_equal(parian_closest_create(env, &mesh, &closest), PARIAN_OK);
    parian_closest_query query = {.count = source.vertex_count,
                                  .point = (const double(*)[3])source.position};
    assert_int_equal(parian_closest_find(env, closest, &query, hit), PARIAN_OK);
    for (uint32_t v = 0; v < source.vertex_count; v++) {
        worst = fmax(worst, hit[v].distance);
        if (fabs(source.position[v][2]) < 1e-9) {
            worst_tip = fmax(worst_tip, hit[v].distance);
        }
    }
    assert_true(worst <= half_thickness);
    assert_true(worst_tip <= 0.05 * report.edge_mean_m);
    assert_true(fabs(report.area_ratio - 1.0) < 0.03);
    assert_true(report.quality_mean > 0.95);
    parian_closest_destroy(closest);
    free(hit);
    parian_mesh_free(env, &mesh);
    parian_mesh_free(NULL, &source);
}

static void test_parts_stay_apart(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    parian_mesh big, small, tiny;
    parian_transfer_mesh_report report;
    assert_int_equal(test_sphere(NULL, 0.05, 20, &big), PARIAN_OK);
    assert_int_equal(test_sphere(NULL, 0.002, 8, &small), PARIAN_OK);
    assert_int_equal(test_sphere(NULL, 0.0001, 4, &tiny), PARIAN_OK);
    parian_mesh source = append(append(big, small, 0.1), tiny, 0.2);
    parian_mesh mesh = transfer_of(env, &source, 2000, &report);
    assert_int_equal(check_manifold(&mesh).euler, 6);
    parian_mesh_free(env, &mesh);
    parian_mesh_free(NULL, &source);
}

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    const unsigned threads[] = {1, 2, 7};
    parian_mesh source, first = {0};
    assert_int_equal(test_sphere(NULL, 0.05, 60, &source), PARIAN_OK);
    source = append(source, make_torus(0.03, 0.01, 100, 40), 0.2);
    source = append(source, make_plate(0.0008), 0.4);
    for (int i = 0; i < 3; i++) {
        parian_transfer_mesh_report report;
        parian_mesh mesh = transfer_of(test_env(threads[i]), &source, 3000, &report);
        if (i == 0) {
            first = mesh;
            continue;
        }
        assert_int_equal(mesh.vertex_count, first.vertex_count);
        assert_int_equal(mesh.triangle_count, first.triangle_count);
        assert_memory_equal(mesh.position, first.position,
                            mesh.vertex_count * sizeof *mesh.position);
        assert_memory_equal(mesh.triangle, first.triangle,
                            mesh.triangle_count * sizeof *mesh.triangle);
        parian_mesh_free(NULL, &mesh);
    }
    parian_mesh_free(NULL, &first);
    parian_mesh_free(NULL, &source);
}

/* Runs of consecutive indices among the vertices within 5 edges of a vertex: with n of them in an
 * area, a good order needs about 2 sqrt(n) runs or fewer; a random one needs n. */
static void test_near_vertices_have_near_indices(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    parian_mesh source;
    parian_transfer_mesh_report report;
    assert_int_equal(test_sphere(env, 0.05, 40, &source), PARIAN_OK);
    parian_mesh mesh = transfer_of(env, &source, 5000, &report);
    double reach = 5.0 * report.edge_mean_m;
    size_t near = 0, runs = 0;
    for (uint32_t v = 0; v < mesh.vertex_count; v += 50) {
        bool inside = false;
        for (uint32_t u = 0; u < mesh.vertex_count; u++) {
            double d[3];
            for (int k = 0; k < 3; k++) {
                d[k] = mesh.position[u][k] - mesh.position[v][k];
            }
            bool now = parian_dot3(d, d) < reach * reach;
            near += now;
            runs += now && !inside;
            inside = now;
        }
    }
    assert_true((double)near / runs > 3.0);
    for (uint32_t t = 1; t < mesh.triangle_count; t++) {
        assert_true(mesh.triangle[t - 1][0] <= mesh.triangle[t][0]);
    }
    parian_mesh_free(env, &mesh);
    parian_mesh_free(env, &source);
}

static bool always_cancelled(void *user)
{
    (void)user;
    return true;
}

static void test_refusals(void **state)
{
    (void)state;
    parian_mesh source, made = {0};
    parian_transfer_mesh_desc desc = {.vertex_target = 500};
    parian_transfer_mesh_report report;
    parian_mesh empty = {0};
    parian_env env = {.cancelled = always_cancelled};
    assert_int_equal(parian_stage_transfer_mesh(NULL, &empty, &desc, &made, &report),
                     PARIAN_E_COMPUTE);
    assert_int_equal(test_sphere(NULL, 0.05, 10, &source), PARIAN_OK);
    assert_int_equal(parian_stage_transfer_mesh(&env, &source, &desc, &made, &report),
                     PARIAN_E_INTERRUPTED);
    assert_null(made.position);
    parian_mesh_free(NULL, &source);
}

static void test_memory_failures(void **state)
{
    (void)state;
    parian_mesh source;
    parian_transfer_mesh_desc desc = {.vertex_target = 60};
    parian_transfer_mesh_report report;
    assert_int_equal(test_sphere(NULL, 0.05, 4, &source), PARIAN_OK);
    for (size_t fail = 0;; fail++) {
        test_memory memory = {.fail_at = fail};
        parian_env env = test_failing_env(&memory);
        parian_mesh made = {0};
        parian_result result = parian_stage_transfer_mesh(&env, &source, &desc, &made, &report);
        if (result == PARIAN_OK) {
            parian_mesh_free(&env, &made);
            assert_int_equal(memory.live, 0);
            assert_true(fail > 10);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
        assert_int_equal(memory.live, 0);
    }
    parian_mesh_free(NULL, &source);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere_counts_and_distance),
        cmocka_unit_test(test_box_keeps_its_edges),
        cmocka_unit_test(test_open_plane),
        cmocka_unit_test(test_torus_keeps_its_hole),
        cmocka_unit_test(test_thin_sheet_keeps_its_thickness),
        cmocka_unit_test(test_rims_are_smooth),
        cmocka_unit_test(test_parts_stay_apart),
        cmocka_unit_test(test_same_bytes_for_any_threads),
        cmocka_unit_test(test_near_vertices_have_near_indices),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_memory_failures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
