/* test_surface.c - every kind of damaged surface, mended or refused, and checked independently.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/surface.h"
#include "core/memory.h"
#include "support/sound_surface.h"

static parian_surface_report run(parian_mesh *mesh)
{
    parian_surface_report report;
    assert_int_equal(parian_stage_surface(test_env(1), mesh, &report), PARIAN_OK);
    assert_sound_surface(mesh, &report);
    return report;
}

static double volume(const parian_mesh *mesh)
{
    double sum = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const double *a = mesh->position[mesh->triangle[t][0]],
                     *b = mesh->position[mesh->triangle[t][1]];
        const double *c = mesh->position[mesh->triangle[t][2]];
        sum += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                a[2] * (b[0] * c[1] - b[1] * c[0])) /
               6;
    }
    return sum;
}

/* A mesh of its own memory from plain lists. */
static parian_mesh make(const double (*position)[3], uint32_t vertices,
                        const uint32_t (*triangle)[3], uint32_t triangles)
{
    parian_mesh mesh = {.vertex_count = vertices, .triangle_count = triangles};
    assert_true(PARIAN_NEW(NULL, mesh.position, vertices) &&
                PARIAN_NEW(NULL, mesh.triangle, triangles));
    memcpy(mesh.position, position, vertices * sizeof *position);
    memcpy(mesh.triangle, triangle, triangles * sizeof *triangle);
    return mesh;
}

/* Append a copy of another mesh, scaled and moved. */
static void append(parian_mesh *mesh, const parian_mesh *other, double scale, double x)
{
    parian_mesh sum = {.vertex_count = mesh->vertex_count + other->vertex_count,
                       .triangle_count = mesh->triangle_count + other->triangle_count};
    assert_true(PARIAN_NEW(NULL, sum.position, sum.vertex_count) &&
                PARIAN_NEW(NULL, sum.triangle, sum.triangle_count));
    memcpy(sum.position, mesh->position, mesh->vertex_count * sizeof *sum.position);
    memcpy(sum.triangle, mesh->triangle, mesh->triangle_count * sizeof *sum.triangle);
    for (uint32_t v = 0; v < other->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            sum.position[mesh->vertex_count + v][k] =
                scale * other->position[v][k] + (k == 0 ? x : 0);
        }
    }
    for (uint32_t t = 0; t < other->triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            sum.triangle[mesh->triangle_count + t][i] = other->triangle[t][i] + mesh->vertex_count;
        }
    }
    parian_mesh_free(NULL, mesh);
    *mesh = sum;
}

static void turn(parian_mesh *mesh, uint32_t first, uint32_t step)
{
    for (uint32_t t = first; t < mesh->triangle_count; t += step) {
        uint32_t swapped = mesh->triangle[t][0];
        mesh->triangle[t][0] = mesh->triangle[t][1];
        mesh->triangle[t][1] = swapped;
    }
}

static parian_mesh sphere(void)
{
    parian_mesh mesh = {0};
    assert_int_equal(test_sphere(NULL, 1, 8, &mesh), PARIAN_OK);
    return mesh;
}

static void clean_stays(void **state)
{
    (void)state;
    parian_mesh mesh = sphere();
    double before = volume(&mesh);
    uint32_t vertices = mesh.vertex_count, triangles = mesh.triangle_count;
    parian_surface_report r = run(&mesh);
    assert_true(mesh.vertex_count == vertices && mesh.triangle_count == triangles);
    assert_true(r.closed && r.orientable && !r.inverted && r.components == 1);
    assert_int_equal(r.welded_vertices + r.unreferenced_vertices + r.degenerate_triangles +
                         r.duplicate_triangles + r.split_vertices + r.flipped_triangles +
                         r.self_intersections,
                     0);
    assert_true(volume(&mesh) == before);
    parian_mesh_free(NULL, &mesh);
}

static void orientation(void **state)
{
    (void)state;
    parian_mesh mesh = sphere();
    double expected = volume(&mesh);
    turn(&mesh, 0, 1);
    parian_surface_report r = run(&mesh);
    assert_true(r.inverted && r.closed && r.flipped_triangles == mesh.triangle_count);
    assert_true(fabs(volume(&mesh) - expected) < 1e-12);
    turn(&mesh, 0, 3);
    turn(&mesh, 1, 7);
    r = run(&mesh);
    assert_true(r.flipped_triangles > 0 && r.closed);
    assert_true(fabs(volume(&mesh) - expected) < 1e-12);
    parian_mesh_free(NULL, &mesh);
}

/* A triangle soup: every corner its own vertex, moved by less than the welding tolerance. */
static void soup_is_welded(void **state)
{
    (void)state;
    parian_mesh from = sphere(), mesh = {.triangle_count = from.triangle_count};
    mesh.vertex_count = 3 * from.triangle_count;
    assert_true(PARIAN_NEW(NULL, mesh.position, mesh.vertex_count) &&
                PARIAN_NEW(NULL, mesh.triangle, mesh.triangle_count) &&
                PARIAN_NEW(NULL, mesh.corner_uv, mesh.triangle_count));
    for (uint32_t c = 0; c < mesh.vertex_count; c++) {
        for (int k = 0; k < 3; k++) {
            mesh.position[c][k] =
                from.position[from.triangle[c / 3][c % 3]][k] + 1e-9 * (double)(c % 7);
        }
        mesh.triangle[c / 3][c % 3] = c;
        mesh.corner_uv[c / 3][c % 3][0] = (float)c;
    }
    parian_surface_report r = run(&mesh);
    assert_int_equal(mesh.vertex_count, from.vertex_count);
    assert_int_equal(r.welded_vertices, 3 * from.triangle_count - from.vertex_count);
    assert_true(r.closed && r.components == 1);
    for (uint32_t c = 0; c < 3 * mesh.triangle_count; c++) {
        assert_true(mesh.corner_uv[c / 3][c % 3][0] ==
                    (float)c); /* attributes stay with their corners */
    }
    parian_mesh_free(NULL, &mesh);
    parian_mesh_free(NULL, &from);
}

static void cavities_and_parts(void **state)
{
    (void)state;
    parian_mesh mesh = sphere(), part = sphere();
    double one = volume(&mesh);
    uint32_t count = part.triangle_count;
    turn(&part, 0, 1);
    append(&mesh, &part, 0.5, 0); /* a hollow ball stays hollow */
    parian_surface_report r = run(&mesh);
    assert_true(r.components == 2 && r.flipped_triangles == 0);
    assert_true(fabs(volume(&mesh) - one * (1 - 0.125)) < 1e-9);
    turn(&mesh, 0, 1); /* and so does one that is inside out as a whole */
    r = run(&mesh);
    assert_true(r.inverted && fabs(volume(&mesh) - one * (1 - 0.125)) < 1e-9);
    append(&mesh, &part, 0.5, 3); /* beside it, the same inverted ball is no cavity */
    r = run(&mesh);
    assert_true(!r.inverted && r.components == 3 && r.flipped_triangles == count);
    assert_true(fabs(volume(&mesh) - one) < 1e-9);
    parian_mesh_free(NULL, &mesh);
    parian_mesh_free(NULL, &part);
}

/* Two cubes that share an edge: four triangles meet there, and each cube stays closed. */
static void shared_edge(void **state)
{
    (void)state;
    parian_mesh mesh = {0}, other = {0};
    assert_int_equal(test_box(NULL, 1, 1, 1, 1, &mesh), PARIAN_OK);
    assert_int_equal(test_box(NULL, 1, 1, 1, 1, &other), PARIAN_OK);
    for (uint32_t v = 0; v < other.vertex_count; v++) {
        other.position[v][1] += 1;
    }
    append(&mesh, &other, 1, 1);
    parian_surface_report r = run(&mesh);
    assert_true(r.closed && r.components == 2 && r.welded_vertices == 2 && r.split_vertices == 2);
    assert_true(fabs(volume(&mesh) - 2) < 1e-12);
    parian_mesh_free(NULL, &mesh);
    parian_mesh_free(NULL, &other);
}

static void shared_vertex(void **state)
{
    (void)state;
    static const double p[7][3] = {{0, 0, 0},  {1, 0, 0},  {0, 1, 0}, {0, 0, 1},
                                   {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    static const uint32_t t[8][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3},
                                     {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}};
    parian_mesh mesh = make(p, 7, t, 8);
    parian_surface_report r = run(&mesh);
    assert_true(r.closed && r.components == 2 && r.split_vertices == 1);
    assert_true(fabs(volume(&mesh) - 2.0 / 6) < 1e-12);
    parian_mesh_free(NULL, &mesh);
}

/* Three half planes at an edge: two make a surface, the third stays beside them. */
static void three_at_an_edge(void **state)
{
    (void)state;
    static const double p[5][3] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    static const uint32_t t[3][3] = {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}};
    parian_mesh mesh = make(p, 5, t, 3);
    parian_surface_report r = run(&mesh);
    assert_int_equal(mesh.triangle_count, 3);
    assert_true(!r.closed && r.components == 2 && r.orientable);
    parian_mesh_free(NULL, &mesh);
}

static void moebius(void **state)
{
    (void)state;
    enum { N = 40 };
    double p[2 * N][3];
    uint32_t t[2 * N][3];
    for (uint32_t i = 0; i < N; i++) {
        double a = 2 * 3.14159265358979 * i / N;
        for (uint32_t k = 0; k < 2; k++) {
            double w = (k ? 0.3 : -0.3);
            p[2 * i + k][0] = (1 + w * cos(a / 2)) * cos(a);
            p[2 * i + k][1] = (1 + w * cos(a / 2)) * sin(a);
            p[2 * i + k][2] = w * sin(a / 2);
        }
        bool last = i == N - 1;
        uint32_t n0 = last ? 1 : 2 * i + 2, n1 = last ? 0 : 2 * i + 3;
        uint32_t quad[2][3] = {{2 * i, n0, 2 * i + 1}, {n0, n1, 2 * i + 1}};
        memcpy(t[2 * i], quad, sizeof quad);
    }
    parian_mesh mesh = make((const double(*)[3])p, 2 * N, (const uint32_t(*)[3])t, 2 * N);
    parian_surface_report r = run(&mesh);
    assert_true(!r.orientable && r.components == 1 && mesh.triangle_count == 2 * N);
    assert_int_equal(mesh.vertex_count, 2 * N + 2); /* cut once across */
    parian_mesh_free(NULL, &mesh);
}

/* A flat triangle in a closed surface is mended: a vertex is put on an edge of one side only. */
static void flat_triangles(void **state)
{
    (void)state;
    static const double p[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.4, 0, 0}};
    static const uint32_t t[8][3] = {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 3, 2},
                                     {1, 2, 3}, {0, 1, 4}, {0, 0, 1}, {1, 2, 3}};
    parian_mesh mesh = make(p, 5, t, 8);
    parian_surface_report r = run(&mesh);
    assert_true(r.closed && r.degenerate_triangles == 2 && r.duplicate_triangles == 1);
    assert_int_equal(mesh.triangle_count, 6);
    assert_true(fabs(volume(&mesh) - 1.0 / 6) < 1e-12);
    parian_mesh_free(NULL, &mesh);
}

static void crossings(void **state)
{
    (void)state;
    parian_mesh mesh = sphere(), part = sphere();
    append(&mesh, &part, 1, 0.7);
    parian_surface_report r = run(&mesh);
    assert_true(r.self_intersections > 10 && r.components == 2 && r.closed);
    parian_mesh_free(NULL, &mesh);
    parian_mesh_free(NULL, &part);
}

static void open_surfaces(void **state)
{
    (void)state;
    parian_mesh mesh = {0};
    assert_int_equal(test_plane(NULL, 1, 4, &mesh), PARIAN_OK);
    parian_surface_report r = run(&mesh);
    assert_true(!r.closed && r.boundary_edges == 16 && r.flipped_triangles == 0);
    parian_mesh_free(NULL, &mesh);
    mesh = sphere();
    turn(&mesh, 0, 1);
    mesh.triangle_count -= 5; /* nearly closed and inside out: turned */
    r = run(&mesh);
    assert_true(!r.closed && volume(&mesh) > 0);
    parian_mesh_free(NULL, &mesh);
}

static void refuse(const double (*p)[3], uint32_t vertices, const uint32_t (*t)[3],
                   uint32_t triangles)
{
    parian_mesh mesh = make(p, vertices, t, triangles);
    parian_surface_report report;
    assert_int_equal(parian_stage_surface(NULL, &mesh, &report), PARIAN_E_FORMAT);
    parian_mesh_free(NULL, &mesh);
}

static void refusals(void **state)
{
    (void)state;
    static const double point[3][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    static const double line[3][3] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    static const uint32_t t[1][3] = {{0, 1, 2}};
    refuse(point, 3, t, 1);
    refuse(line, 3, t, 1);
    parian_mesh empty = {0};
    parian_surface_report report;
    assert_int_equal(parian_stage_surface(NULL, &empty, &report), PARIAN_E_FORMAT);
}

static void out_of_memory(void **state)
{
    (void)state;
    for (size_t k = 0;; k++) {
        test_memory memory = {.fail_at = SIZE_MAX};
        parian_env env = test_failing_env(&memory);
        parian_mesh mesh = {0};
        parian_surface_report report;
        assert_int_equal(test_sphere(&env, 1, 2, &mesh), PARIAN_OK);
        memory.fail_at = memory.calls + k;
        parian_result result = parian_stage_surface(&env, &mesh, &report);
        parian_mesh_free(&env, &mesh);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            assert_true(k > 10);
            break;
        }
        assert_int_equal(result, PARIAN_E_NOMEM);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clean_stays),      cmocka_unit_test(orientation),
        cmocka_unit_test(soup_is_welded),   cmocka_unit_test(cavities_and_parts),
        cmocka_unit_test(shared_edge),      cmocka_unit_test(shared_vertex),
        cmocka_unit_test(three_at_an_edge), cmocka_unit_test(moebius),
        cmocka_unit_test(flat_triangles),   cmocka_unit_test(crossings),
        cmocka_unit_test(open_surfaces),    cmocka_unit_test(refusals),
        cmocka_unit_test(out_of_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
