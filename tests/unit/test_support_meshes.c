/* test_support_meshes.c - the meshes that tests are built on are closed, outward, and of the stated
 * size.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "support/test_support.h"

static const double pi = 3.14159265358979323846;

/* Six times the signed volume: positive when triangles face outward. */
static double volume(const parian_mesh *mesh)
{
    double sum = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const double *a = mesh->position[mesh->triangle[t][0]],
                     *b = mesh->position[mesh->triangle[t][1]],
                     *c = mesh->position[mesh->triangle[t][2]];
        sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return sum / 6;
}

/* Each directed edge occurs once and its opposite occurs once: closed and consistently oriented. */
static void check_closed(const parian_mesh *mesh)
{
    const size_t n = mesh->vertex_count;
    uint8_t *edge = parian_zalloc(NULL, n * n, 1);
    assert_non_null(edge);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            const uint32_t a = mesh->triangle[t][k], b = mesh->triangle[t][(k + 1) % 3];
            assert_true(a < n && b < n && a != b);
            assert_int_equal(edge[a * n + b]++, 0);
        }
    }
    for (size_t a = 0; a < n; a++) {
        for (size_t b = 0; b < n; b++) {
            assert_int_equal(edge[a * n + b], edge[b * n + a]);
        }
    }
    parian_free(NULL, edge);
}

static void test_spheres(void **state)
{
    (void)state;
    for (unsigned cuts = 1; cuts <= 9; cuts++) {
        parian_mesh mesh;
        assert_int_equal(test_sphere(NULL, 0.02, cuts, &mesh), PARIAN_OK);
        assert_int_equal(mesh.vertex_count, 10 * cuts * cuts + 2);
        assert_int_equal(mesh.triangle_count, 20 * cuts * cuts);
        check_closed(&mesh);
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            const double *p = mesh.position[v];
            assert_true(fabs(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 0.02) < 1e-15);
        }
        const double share = volume(&mesh) / (4.0 / 3 * pi * 8e-6);
        assert_true(share > 1 - 0.6 / cuts / cuts &&
                    share < 1); /* inscribed; converges with the square */
        parian_mesh_free(NULL, &mesh);
    }
}

static void test_box_is_closed(void **state)
{
    parian_mesh mesh;
    double lower[3], upper[3];
    (void)state;
    for (unsigned n = 1; n <= 5; n++) {
        assert_int_equal(test_box(NULL, 1, 2, 3, n, &mesh), PARIAN_OK);
        assert_int_equal(mesh.vertex_count, 6 * n * n + 2);
        check_closed(&mesh);
        assert_true(fabs(volume(&mesh) - 6) < 1e-12);
        assert_true(fabs(parian_mesh_area(&mesh) - 22) < 1e-12);
        parian_mesh_bounds(&mesh, lower, upper);
        assert_true(fabs(lower[1] + 1) < 1e-15 && fabs(upper[2] - 1.5) < 1e-15);
        parian_mesh_free(NULL, &mesh);
    }
}

static void test_plane_faces_up(void **state)
{
    parian_mesh mesh;
    (void)state;
    assert_int_equal(test_plane(NULL, 2, 6, &mesh), PARIAN_OK);
    assert_int_equal(mesh.vertex_count, 49);
    assert_true(fabs(parian_mesh_area(&mesh) - 4) < 1e-12);
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        const double *a = mesh.position[mesh.triangle[t][0]],
                     *b = mesh.position[mesh.triangle[t][1]],
                     *c = mesh.position[mesh.triangle[t][2]];
        assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0);
    }
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_box_is_closed),
        cmocka_unit_test(test_plane_faces_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
