/* test_atlas.c - charts and packing: nothing overlaps, gutters are kept, one density, projections
 * are orthographic.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/stages/atlas.h"
#include "support/atlas_case.h"

enum { NOBODY = 0xFFFFFFFFu, SAMPLES = 4 };

static parian_result make_atlas(parian_mesh *mesh, uint32_t side, parian_body *body,
                                parian_atlas_report *report)
{
    parian_atlas_desc desc = {.atlas_size = side};
    assert_int_equal(atlas_case_body(NULL, mesh, body), PARIAN_OK);
    return parian_stage_atlas(NULL, &desc, body, report);
}

/* The signed distance of p to the inner side of edge k, relative to its length. */
static double inside_edge(float uv[3][2], int k, double x, double y)
{
    const float *a = uv[k], *b = uv[(k + 1) % 3];
    double e[2] = {(double)b[0] - (double)a[0], (double)b[1] - (double)a[1]};
    return (e[0] * (y - (double)a[1]) - e[1] * (x - (double)a[0])) /
           sqrt(e[0] * e[0] + e[1] * e[1]);
}

/* Rasterise every triangle at SAMPLES^2 points a texel, off its edges by a rounding; no point may
 * lie in two triangles. Texels that hold a point are marked with their chart; charts may not share
 * one. */
static uint32_t *rasterise(const parian_body *body)
{
    size_t side = body->atlas_size, fine = SAMPLES * side;
    uint32_t *owner = malloc(fine * fine * sizeof *owner),
             *chart = malloc(side * side * sizeof *chart);
    assert_true(owner && chart);
    memset(owner, 0xFF, fine * fine * sizeof *owner);
    memset(chart, 0xFF, side * side * sizeof *chart);
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        float(*uv)[2] = body->corner_uv[t];
        double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
        for (int k = 0; k < 6; k++) {
            assert_true(isfinite(uv[k / 2][k % 2]));
            low[k % 2] = fmin(low[k % 2], (double)uv[k / 2][k % 2]);
            high[k % 2] = fmax(high[k % 2], (double)uv[k / 2][k % 2]);
        }
        assert_true(low[0] >= 0.0 && low[1] >= 0.0 && high[0] <= side && high[1] <= side);
        for (size_t y = (size_t)(low[1] * SAMPLES); y < fine && y <= high[1] * SAMPLES; y++) {
            for (size_t x = (size_t)(low[0] * SAMPLES); x < fine && x <= high[0] * SAMPLES; x++) {
                double px = (x + 0.5) / SAMPLES, py = (y + 0.5) / SAMPLES;
                if (inside_edge(uv, 0, px, py) > 1e-4 && inside_edge(uv, 1, px, py) > 1e-4 &&
                    inside_edge(uv, 2, px, py) > 1e-4) {
                    assert_int_equal(owner[y * fine + x], NOBODY);
                    owner[y * fine + x] = t;
                    uint32_t *texel = &chart[y / SAMPLES * side + x / SAMPLES];
                    assert_true(*texel == NOBODY || *texel == body->triangle_chart[t]);
                    *texel = body->triangle_chart[t];
                }
            }
        }
    }
    free(owner);
    return chart;
}

/* At least two unowned texels between any two charts, and one at the sides. */
static void check_gaps(const parian_body *body, const uint32_t *chart)
{
    int side = (int)body->atlas_size;
    for (int v = 0; v < side; v++) {
        for (int u = 0; u < side; u++) {
            uint32_t own = chart[v * side + u];
            if (own == NOBODY) {
                continue;
            }
            assert_true(u > 0 && v > 0 && u < side - 1 && v < side - 1);
            for (int y = v - 2; y <= v + 2; y++) {
                for (int x = u - 2; x <= u + 2; x++) {
                    uint32_t other =
                        x < 0 || y < 0 || x >= side || y >= side ? NOBODY : chart[y * side + x];
                    assert_true(other == NOBODY || other == own);
                }
            }
        }
    }
}

static double surface_vector(const parian_body *body, uint32_t t, double n[3])
{
    double u[3], v[3];
    for (int d = 0; d < 3; d++) {
        double a = (double)body->vertex_position[body->triangle[t][0]][d];
        u[d] = (double)body->vertex_position[body->triangle[t][1]][d] - a;
        v[d] = (double)body->vertex_position[body->triangle[t][2]][d] - a;
    }
    n[0] = 0.5 * (u[1] * v[2] - u[2] * v[1]);
    n[1] = 0.5 * (u[2] * v[0] - u[0] * v[2]);
    n[2] = 0.5 * (u[0] * v[1] - u[1] * v[0]);
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/* Every triangle's atlas area is its area seen along its chart's average normal, at the one scale.
 */
static void check_projection(const parian_body *body, const parian_atlas_report *report)
{
    double(*sum)[3] = calloc(body->chart_count, sizeof *sum), n[3];
    assert_non_null(sum);
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        assert_true(body->triangle_chart[t] < body->chart_count);
        surface_vector(body, t, n);
        for (int d = 0; d < 3; d++) {
            sum[body->triangle_chart[t]][d] += n[d];
        }
    }
    double texel = report->texel_edge_m * report->texel_edge_m;
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        const double *s = sum[body->triangle_chart[t]];
        float(*uv)[2] = body->corner_uv[t];
        double flat = 0.5 * (((double)uv[1][0] - uv[0][0]) * ((double)uv[2][1] - uv[0][1]) -
                             ((double)uv[1][1] - uv[0][1]) * ((double)uv[2][0] - uv[0][0]));
        double area = surface_vector(body, t, n);
        double seen = (n[0] * s[0] + n[1] * s[1] + n[2] * s[2]) /
                      sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        /* Single-precision coordinates of up to 512 texels: 3e-5 of a texel along an edge. */
        assert_true(fabs(flat * texel - seen) <= 1e-4 * area + 2e-4 * texel);
    }
    free(sum);
}

static void check_all(parian_mesh *mesh, uint32_t side, parian_atlas_report *report)
{
    parian_body body;
    assert_int_equal(make_atlas(mesh, side, &body, report), PARIAN_OK);
    assert_int_equal(body.atlas_size, side);
    assert_int_equal(body.chart_count, report->chart_count);
    uint32_t *chart = rasterise(&body);
    check_gaps(&body, chart);
    check_projection(&body, report);
    free(chart);
    print_message("%u triangles, side %u: %u charts, occupancy %.3f, stretch %.2f\n",
                  mesh->triangle_count, side, report->chart_count, report->occupancy,
                  report->stretch_max);
    parian_body_free(NULL, &body);
}

static void spheres(void **state)
{
    (void)state;
    const unsigned cuts[] = {4, 20, 44};
    for (int i = 0; i < 3; i++) {
        parian_mesh mesh;
        parian_atlas_report report;
        assert_int_equal(test_sphere(NULL, 0.025, cuts[i], &mesh), PARIAN_OK);
        check_all(&mesh, 512, &report);
        /* A cap of 30 degrees has 1/15 of the sphere: no fewer charts, but not very many more. */
        assert_in_range(report.chart_count, 6, 40);
        assert_true(report.stretch_max < 2.0);
        assert_true(report.occupancy > 0.55);
        parian_mesh_free(NULL, &mesh);
    }
}

static void boxes_have_six_charts(void **state)
{
    (void)state;
    const double thickness[] = {1.0, 0.02};
    for (int i = 0; i < 2; i++) {
        parian_mesh mesh;
        parian_atlas_report report;
        assert_int_equal(test_box(NULL, 1.0, 0.7, thickness[i], 12, &mesh), PARIAN_OK);
        check_all(&mesh, 256, &report);
        assert_int_equal(report.chart_count, 6);
        assert_true(report.stretch_max < 1.0001);
        parian_mesh_free(NULL, &mesh);
    }
}

static void a_plane_fills_the_atlas(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_atlas_report report;
    assert_int_equal(test_plane(NULL, 0.05, 30, &mesh), PARIAN_OK);
    check_all(&mesh, 512, &report);
    assert_int_equal(report.chart_count, 1);
    /* 510 x 510 texels would be 0.992; the search stops within half a per cent. */
    assert_true(report.occupancy > 0.98);
    parian_mesh_free(NULL, &mesh);
}

static void a_single_triangle(void **state)
{
    (void)state;
    double position[3][3] = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.02, 0.01}};
    uint32_t triangle[1][3] = {{0, 1, 2}};
    parian_mesh mesh = {
        .vertex_count = 3, .triangle_count = 1, .position = position, .triangle = triangle};
    parian_atlas_report report;
    check_all(&mesh, 16, &report);
    assert_int_equal(report.chart_count, 1);
    parian_free(NULL, mesh.corner_normal);
}

static void degenerate_triangles_stay_finite(void **state)
{
    (void)state;
    double position[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {5, 5, 5}, {6, 6, 6}};
    uint32_t triangle[3][3] = {{0, 1, 2}, {0, 3, 1}, {4, 5, 4}};
    parian_mesh mesh = {
        .vertex_count = 6, .triangle_count = 3, .position = position, .triangle = triangle};
    parian_body body;
    parian_atlas_report report;
    assert_int_equal(make_atlas(&mesh, 32, &body, &report), PARIAN_OK);
    for (int k = 0; k < 18; k++) {
        assert_true(isfinite(body.corner_uv[k / 6][k / 2 % 3][k % 2]));
    }
    parian_body_free(NULL, &body);
    mesh.triangle_count = 1;
    triangle[0][2] = 3;
    parian_free(NULL, mesh.corner_normal);
    mesh.corner_normal = NULL;
    assert_int_equal(make_atlas(&mesh, 32, &body, &report), PARIAN_E_COMPUTE);
    parian_body_free(NULL, &body);
    parian_free(NULL, mesh.corner_normal);
}

/* A ramp that winds three times around the z axis, so flat that no normal leaves the cone of a
 * chart. */
static void make_ramp(parian_mesh *mesh)
{
    enum { STEPS = 120, RINGS = 4 };
    memset(mesh, 0, sizeof *mesh);
    mesh->vertex_count = (STEPS + 1) * (RINGS + 1);
    mesh->triangle_count = 2 * STEPS * RINGS;
    assert_true(PARIAN_NEW(NULL, mesh->position, mesh->vertex_count));
    assert_true(PARIAN_NEW(NULL, mesh->triangle, mesh->triangle_count));
    for (uint32_t i = 0; i <= STEPS; i++) {
        for (uint32_t r = 0; r <= RINGS; r++) {
            double angle = 3.0 * 2.0 * 3.14159265358979323846 * i / STEPS, radius = 1.0 + 0.25 * r;
            double *p = mesh->position[i * (RINGS + 1) + r];
            p[0] = radius * cos(angle);
            p[1] = radius * sin(angle);
            p[2] = 0.05 * angle;
        }
    }
    for (uint32_t i = 0, t = 0; i < STEPS; i++) {
        for (uint32_t r = 0; r < RINGS; r++) {
            uint32_t a = i * (RINGS + 1) + r, b = a + 1, c = a + RINGS + 1, d = c + 1;
            const uint32_t pair[2][3] = {{a, b, d}, {a, d, c}};
            memcpy(mesh->triangle[t], pair, sizeof pair);
            t += 2;
        }
    }
}

static void a_spiral_ramp_is_cut(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_atlas_report report;
    make_ramp(&mesh);
    check_all(&mesh, 256, &report);
    assert_in_range(report.chart_count, 3, 9);
    parian_mesh_free(NULL, &mesh);
}

/* count spheres in a row. */
static void make_beads(unsigned count, unsigned cuts, parian_mesh *mesh)
{
    parian_mesh bead;
    memset(mesh, 0, sizeof *mesh);
    assert_int_equal(test_sphere(NULL, 0.4, cuts, &bead), PARIAN_OK);
    mesh->vertex_count = count * bead.vertex_count;
    mesh->triangle_count = count * bead.triangle_count;
    assert_true(PARIAN_NEW(NULL, mesh->position, mesh->vertex_count));
    assert_true(PARIAN_NEW(NULL, mesh->triangle, mesh->triangle_count));
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        memcpy(mesh->position[i], bead.position[i % bead.vertex_count], sizeof bead.position[0]);
        mesh->position[i][0] += i / bead.vertex_count;
    }
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; i++) {
        uint32_t t = i / 3 % bead.triangle_count, copy = i / 3 / bead.triangle_count;
        mesh->triangle[i / 3][i % 3] = bead.triangle[t][i % 3] + copy * bead.vertex_count;
    }
    parian_mesh_free(NULL, &bead);
}

static void many_components(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_atlas_report report;
    make_beads(60, 4, &mesh);
    check_all(&mesh, 512, &report);
    assert_true(report.chart_count >= 120);
    parian_mesh_free(NULL, &mesh);
}

static void too_small_names_the_smallest_side(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    parian_atlas_report report, again;
    make_beads(40, 3, &mesh);
    assert_int_equal(make_atlas(&mesh, 16, &body, &report), PARIAN_E_COMPUTE);
    parian_body_free(NULL, &body);
    assert_in_range(report.smallest_side, 17, 200);
    print_message("40 beads fit from side %u on\n", report.smallest_side);
    parian_free(NULL, mesh.corner_normal);
    mesh.corner_normal = NULL;
    assert_int_equal(make_atlas(&mesh, report.smallest_side - 1, &body, &again), PARIAN_E_COMPUTE);
    parian_body_free(NULL, &body);
    check_all(&mesh, report.smallest_side, &again);
    parian_mesh_free(NULL, &mesh);
}

static void large_atlases_keep_the_gutter(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_atlas_report report;
    assert_int_equal(test_sphere(NULL, 0.025, 12, &mesh), PARIAN_OK);
    check_all(&mesh, 1111, &report);
    assert_true(report.occupancy > 0.5);
    parian_mesh_free(NULL, &mesh);
}

static void wrong_arguments(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_body body;
    parian_atlas_report report;
    assert_int_equal(test_sphere(NULL, 1.0, 2, &mesh), PARIAN_OK);
    assert_int_equal(make_atlas(&mesh, 15, &body, &report), PARIAN_E_ARGUMENT);
    parian_body_free(NULL, &body);
    assert_int_equal(make_atlas(&mesh, 8193, &body, &report), PARIAN_E_ARGUMENT);
    parian_body_free(NULL, &body);
    parian_mesh_free(NULL, &mesh);
}

static void failing_memory_leaks_nothing(void **state)
{
    (void)state;
    parian_mesh mesh;
    parian_atlas_desc desc = {.atlas_size = 32};
    assert_int_equal(test_box(NULL, 1, 1, 1, 2, &mesh), PARIAN_OK);
    for (size_t k = 0;; k++) {
        parian_body body;
        assert_int_equal(atlas_case_body(NULL, &mesh, &body), PARIAN_OK);
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_result result = parian_stage_atlas(&env, &desc, &body, NULL);
        parian_free(&env, body.corner_uv);
        parian_free(&env, body.triangle_chart);
        body.corner_uv = NULL;
        body.triangle_chart = NULL;
        parian_body_free(NULL, &body);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 20);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres),
        cmocka_unit_test(boxes_have_six_charts),
        cmocka_unit_test(a_plane_fills_the_atlas),
        cmocka_unit_test(a_single_triangle),
        cmocka_unit_test(degenerate_triangles_stay_finite),
        cmocka_unit_test(a_spiral_ramp_is_cut),
        cmocka_unit_test(many_components),
        cmocka_unit_test(too_small_names_the_smallest_side),
        cmocka_unit_test(large_atlases_keep_the_gutter),
        cmocka_unit_test(wrong_arguments),
        cmocka_unit_test(failing_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
