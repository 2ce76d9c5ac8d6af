/* test_mesh.c - area, bounds, adjacency and corner normals of meshes against closed forms.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "core/memory.h"

static double corner_length(const float n[3])
{
    return sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
}

static void area_and_bounds_of_a_plane(void **state)
{
    (void)state;
    parian_mesh mesh;
    double lower[3], upper[3];
    assert_int_equal(test_plane(NULL, 0.3, 7, &mesh), PARIAN_OK);
    assert_true(fabs(parian_mesh_area(&mesh) - 0.09) < 1e-14);
    parian_mesh_bounds(&mesh, lower, upper);
    for (int d = 0; d < 3; d++) {
        assert_true(fabs(upper[d] - lower[d] - (d < 2 ? 0.3 : 0.0)) < 1e-15);
    }
    parian_mesh_free(NULL, &mesh);
    parian_mesh_bounds(&mesh, lower, upper);
    assert_true(lower[0] == 0.0 && upper[2] == 0.0);
    parian_mesh_free(NULL, NULL);
}

static void area_of_a_sphere_converges(void **state)
{
    (void)state;
    double error[2];
    for (unsigned i = 0; i < 2; i++) {
        parian_mesh mesh;
        assert_int_equal(test_sphere(NULL, 2.0, 10u << i, &mesh), PARIAN_OK);
        error[i] = 16.0 * 3.14159265358979323846 - parian_mesh_area(&mesh);
        assert_true(error[i] > 0.0); /* inscribed */
        parian_mesh_free(NULL, &mesh);
    }
    /* Second order: half the edge, a quarter of the error. */
    assert_true(fabs(error[0] / error[1] - 4.0) < 0.1);
}

static void neighbours_are_mutual(void **state)
{
    (void)state;
    parian_mesh mesh;
    assert_int_equal(test_sphere(NULL, 1.0, 9, &mesh), PARIAN_OK);
    uint32_t(*neighbour)[3];
    assert_true(PARIAN_NEW(NULL, neighbour, mesh.triangle_count));
    assert_int_equal(parian_triangle_neighbours(NULL, mesh.vertex_count, mesh.triangle_count,
                                                (const uint32_t(*)[3])mesh.triangle, neighbour),
                     PARIAN_OK);
    for (uint32_t h = 0; h < 3 * mesh.triangle_count; h++) {
        uint32_t other = neighbour[h / 3][h % 3];
        assert_true(other < 3 * mesh.triangle_count);
        assert_int_equal(neighbour[other / 3][other % 3], h);
        assert_int_equal(mesh.triangle[h / 3][h % 3],
                         mesh.triangle[other / 3][(other % 3 + 1) % 3]);
    }
    parian_free(NULL, neighbour);
    parian_mesh_free(NULL, &mesh);
}

static void edges_without_a_partner(void **state)
{
    (void)state;
    /* Three triangles on edge 0-1, one of them the wrong way round; two that disagree on edge 3-4.
     */
    const uint32_t triangle[5][3] = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {3, 4, 5}, {3, 4, 6}};
    uint32_t neighbour[5][3];
    assert_int_equal(parian_triangle_neighbours(NULL, 7, 5, triangle, neighbour), PARIAN_OK);
    for (int h = 0; h < 15; h++) {
        assert_int_equal(neighbour[h / 3][h % 3], PARIAN_NO_NEIGHBOUR);
    }
    /* A fan of 40 triangles around one vertex takes the other sort. */
    uint32_t fan[40][3], across[40][3];
    for (uint32_t i = 0; i < 40; i++) {
        fan[i][0] = 0;
        fan[i][1] = 1 + i;
        fan[i][2] = 1 + (i + 1) % 40;
    }
    assert_int_equal(parian_triangle_neighbours(NULL, 41, 40, (const uint32_t(*)[3])fan, across),
                     PARIAN_OK);
    for (uint32_t i = 0; i < 40; i++) {
        assert_int_equal(across[i][2], 3 * ((i + 1) % 40));
        assert_int_equal(across[i][1], PARIAN_NO_NEIGHBOUR);
    }
}

static void boundary_of_a_plane(void **state)
{
    (void)state;
    parian_mesh mesh;
    uint32_t(*neighbour)[3], open = 0;
    assert_int_equal(test_plane(NULL, 1.0, 6, &mesh), PARIAN_OK);
    assert_true(PARIAN_NEW(NULL, neighbour, mesh.triangle_count));
    assert_int_equal(parian_triangle_neighbours(NULL, mesh.vertex_count, mesh.triangle_count,
                                                (const uint32_t(*)[3])mesh.triangle, neighbour),
                     PARIAN_OK);
    for (uint32_t h = 0; h < 3 * mesh.triangle_count; h++) {
        open += neighbour[h / 3][h % 3] == PARIAN_NO_NEIGHBOUR;
    }
    assert_int_equal(open, 24);
    parian_free(NULL, neighbour);
    parian_mesh_free(NULL, &mesh);
}

static void normals_of_a_sphere_are_radial(void **state)
{
    (void)state;
    parian_mesh mesh;
    double worst = 1.0;
    assert_int_equal(test_sphere(NULL, 0.02, 20, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(NULL, &mesh, 40.0), PARIAN_OK);
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; c++) {
        const float *n = mesh.corner_normal[c / 3][c % 3];
        const double *p = mesh.position[mesh.triangle[c / 3][c % 3]];
        double cosine = (p[0] * (double)n[0] + p[1] * (double)n[1] + p[2] * (double)n[2]) / 0.02;
        worst = fmin(worst, cosine);
        assert_true(fabs(corner_length(n) - 1.0) < 1e-6);
    }
    /* The vertex normals of a geodesic sphere lean by O(h^2), h = 0.06 here: 0.5 degrees. */
    assert_true(worst > cos(0.5 * 3.14159265358979323846 / 180.0));
    parian_mesh_free(NULL, &mesh);
}

static void creases_stay_sharp(void **state)
{
    (void)state;
    parian_mesh mesh;
    for (int smooth = 0; smooth < 2; smooth++) {
        assert_int_equal(test_box(NULL, 1.0, 2.0, 3.0, 4, &mesh), PARIAN_OK);
        assert_int_equal(parian_mesh_make_corner_normals(NULL, &mesh, smooth ? 120.0 : 40.0),
                         PARIAN_OK);
        uint32_t tilted = 0;
        for (uint32_t c = 0; c < 3 * mesh.triangle_count; c++) {
            const float *n = mesh.corner_normal[c / 3][c % 3];
            float most = fmaxf(fabsf(n[0]), fmaxf(fabsf(n[1]), fabsf(n[2])));
            tilted += most < 0.999f;
        }
        assert_true(smooth ? tilted > 0 : tilted == 0);
        parian_mesh_free(NULL, &mesh);
    }
}

static void degenerate_triangles_get_finite_normals(void **state)
{
    (void)state;
    double position[4][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    uint32_t triangle[3][3] = {{0, 1, 2}, {0, 0, 0}, {0, 1, 3}};
    parian_mesh mesh = {
        .vertex_count = 4, .triangle_count = 3, .position = position, .triangle = triangle};
    assert_int_equal(parian_mesh_make_corner_normals(NULL, &mesh, 40.0), PARIAN_OK);
    for (int c = 0; c < 9; c++) {
        assert_true(fabs(corner_length(mesh.corner_normal[c / 3][c % 3]) - 1.0) < 1e-6);
    }
    parian_free(NULL, mesh.corner_normal);
}

static void failing_memory_leaks_nothing(void **state)
{
    (void)state;
    parian_mesh mesh;
    assert_int_equal(test_sphere(NULL, 1.0, 3, &mesh), PARIAN_OK);
    for (size_t k = 0;; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_result result = parian_mesh_make_corner_normals(&env, &mesh, 40.0);
        parian_free(&env, mesh.corner_normal);
        mesh.corner_normal = NULL;
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 4);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(area_and_bounds_of_a_plane),
        cmocka_unit_test(area_of_a_sphere_converges),
        cmocka_unit_test(neighbours_are_mutual),
        cmocka_unit_test(edges_without_a_partner),
        cmocka_unit_test(boundary_of_a_plane),
        cmocka_unit_test(normals_of_a_sphere_are_radial),
        cmocka_unit_test(creases_stay_sharp),
        cmocka_unit_test(degenerate_triangles_get_finite_normals),
        cmocka_unit_test(failing_memory_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
