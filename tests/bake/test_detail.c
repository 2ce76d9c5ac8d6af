/* test_detail.c - normals and surface colour carried to texels, against closed forms; closest
 * points against brute force.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/adapters/cgal_closest.h"
#include "bake/stages/detail.h"
#include "core/memory.h"
#include "core/small_maths.h"
#include "tool/picture.h"

/* ---- closest points ----------------------------------------------------------------------------
 */

/* A repeatable number in [0, 1). */
static double hash01(uint32_t i)
{
    i = (i ^ 61) ^ (i >> 16);
    i *= 9;
    i ^= i >> 4;
    i *= 0x27d4eb2d;
    i ^= i >> 15;
    return i / 4294967296.0;
}

static double segment_distance(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3], d[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ap[k] = p[k] - a[k];
    }
    double t = parian_dot3(ap, ab) / parian_dot3(ab, ab);
    t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    for (int k = 0; k < 3; k++) {
        d[k] = ap[k] - t * ab[k];
    }
    return sqrt(parian_dot3(d, d));
}

/* Distance to a triangle: to its plane where the foot lies inside, else to its nearest side. */
static double triangle_distance(const double p[3], const parian_mesh *mesh, uint32_t t)
{
    const double *c[3];
    double e[2][3], n[3], best = INFINITY;
    bool inside = true;
    for (int k = 0; k < 3; k++) {
        c[k] = mesh->position[mesh->triangle[t][k]];
    }
    for (int k = 0; k < 3; k++) {
        e[0][k] = c[1][k] - c[0][k];
        e[1][k] = c[2][k] - c[0][k];
    }
    parian_cross3(e[0], e[1], n);
    for (int i = 0; i < 3; i++) {
        double side[3], to[3], m[3];
        for (int k = 0; k < 3; k++) {
            side[k] = c[(i + 1) % 3][k] - c[i][k];
            to[k] = p[k] - c[i][k];
        }
        parian_cross3(side, to, m);
        inside = inside && parian_dot3(m, n) >= 0.0;
        best = fmin(best, segment_distance(p, c[i], c[(i + 1) % 3]));
    }
    if (inside) {
        double to[3] = {p[0] - c[0][0], p[1] - c[0][1], p[2] - c[0][2]};
        best = fmin(best, fabs(parian_dot3(to, n)) / sqrt(parian_dot3(n, n)));
    }
    return best;
}

static double brute_force(const double p[3], const parian_mesh *mesh, const double (*normal)[3],
                          const double wanted[3], double cosine_min)
{
    double best = INFINITY;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (!wanted || parian_dot3(normal[t], wanted) > cosine_min) {
            best = fmin(best, triangle_distance(p, mesh, t));
        }
    }
    return best;
}

static void make_triangle_normals(const parian_mesh *mesh, double (*normal)[3])
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double e[2][3];
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 3; k++) {
                e[i][k] = mesh->position[mesh->triangle[t][i + 1]][k] -
                          mesh->position[mesh->triangle[t][0]][k];
            }
        }
        parian_cross3(e[0], e[1], normal[t]);
        double length = sqrt(parian_dot3(normal[t], normal[t]));
        for (int k = 0; k < 3; k++) {
            normal[t][k] /= length;
        }
    }
}

enum { QUERY_COUNT = 600 };

static void check_hits(const parian_mesh *mesh, const parian_closest_query *query,
                       const double (*normal)[3], const parian_closest_hit *hit)
{
    for (size_t i = 0; i < query->count; i++) {
        const double *wanted = query->normal ? query->normal[i] : NULL;
        const uint32_t *corner = mesh->triangle[hit[i].triangle];
        double best = brute_force(query->point[i], mesh, normal, wanted, query->cosine_min);
        assert_true(fabs(hit[i].distance - best) <= 1e-12);
        assert_true(!wanted || parian_dot3(normal[hit[i].triangle], wanted) > query->cosine_min);
        double sum = 0.0, off[3] = {0.0, 0.0, 0.0};
        for (int c = 0; c < 3; c++) {
            assert_true(hit[i].barycentric[c] >= -1e-12);
            sum += hit[i].barycentric[c];
        }
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < 3; c++) {
                off[k] += hit[i].barycentric[c] * mesh->position[corner[c]][k];
            }
            off[k] -= hit[i].point[k];
        }
        assert_true(fabs(sum - 1.0) < 1e-12);
        assert_true(parian_dot3(off, off) < 1e-24);
    }
}

/* Both sides are right to rounding: 1e-12 m on a body of 0.1 m. */
static void test_closest_against_brute_force(void **state)
{
    (void)state;
    const parian_env *env = test_env(2);
    parian_mesh mesh;
    double point[QUERY_COUNT][3], wanted[QUERY_COUNT][3];
    parian_closest_hit hit[QUERY_COUNT];
    parian_closest *closest;
    assert_int_equal(test_box(env, 0.1, 0.06, 0.02, 6, &mesh), PARIAN_OK);
    double(*normal)[3] = malloc(mesh.triangle_count * sizeof *normal);
    make_triangle_normals(&mesh, normal);
    for (uint32_t i = 0; i < QUERY_COUNT; i++) {
        double length = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            point[i][k] = 0.2 * hash01(6 * i + k) - 0.1;
            wanted[i][k] = 2.0 * hash01(6 * i + 3 + k) - 1.0;
            length += wanted[i][k] * wanted[i][k];
        }
        for (int k = 0; k < 3; k++) {
            wanted[i][k] /= sqrt(length);
        }
    }
    assert_int_equal(parian_closest_create(env, &mesh, &closest), PARIAN_OK);
    parian_closest_query query = {.count = QUERY_COUNT, .point = (const double(*)[3])point};
    assert_int_equal(parian_closest_find(env, closest, &query, hit), PARIAN_OK);
    check_hits(&mesh, &query, (const double(*)[3])normal, hit);
    query.normal = (const double(*)[3])wanted;
    query.cosine_min = 0.2;
    assert_int_equal(parian_closest_find(env, closest, &query, hit), PARIAN_OK);
    check_hits(&mesh, &query, (const double(*)[3])normal, hit);
    parian_closest_destroy(closest);
    free(normal);
    parian_mesh_free(env, &mesh);
}

/* ---- detail ------------------------------------------------------------------------------------
 */

/* A body that is texels alone: n x n of them over the square of side s around the origin, facing
 * +z. */
static parian_body make_flat_body(uint32_t n, double s)
{
    parian_body body = {.triangle_count = 2, .texel_count = n * n};
    assert_true(PARIAN_NEW(NULL, body.texel_position, n * n));
    assert_true(PARIAN_NEW(NULL, body.texel_normal, n * n));
    assert_true(PARIAN_NEW(NULL, body.texel_area, n * n));
    for (uint32_t i = 0; i < n * n; i++) {
        body.texel_position[i][0] = (float)(((i % n + 0.5) / n - 0.5) * s);
        body.texel_position[i][1] = (float)(((i / n + 0.5) / n - 0.5) * s);
        body.texel_position[i][2] = 0.0f;
        body.texel_normal[i][0] = body.texel_normal[i][1] = 0.0f;
        body.texel_normal[i][2] = 1.0f;
        body.texel_area[i] = (float)(s / n * s / n);
    }
    return body;
}

static void free_flat_body(parian_body *body)
{
    parian_free(NULL, body->texel_position);
    parian_free(NULL, body->texel_normal);
    parian_free(NULL, body->texel_area);
    parian_free(NULL, body->texel_normal_map);
    parian_free(NULL, body->texel_albedo);
}

enum { FLAT_TEXELS = 64 };

/* The plane moved so that it is around the origin, with bumps of a height that depends on x and y.
 */
static const double bump_height = 2e-4, bump_rate = 400.0;

static parian_mesh make_bumpy_plane(double side, unsigned cuts)
{
    parian_mesh mesh;
    double lower[3], upper[3];
    assert_int_equal(test_plane(NULL, side, cuts, &mesh), PARIAN_OK);
    parian_mesh_bounds(&mesh, lower, upper);
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        double *p = mesh.position[v];
        for (int k = 0; k < 2; k++) {
            p[k] -= 0.5 * (lower[k] + upper[k]);
        }
        p[2] = bump_height * sin(bump_rate * p[0]) * sin(bump_rate * p[1]);
    }
    return mesh;
}

/* The closest point is off the foot by at most height times slope (2e-4 * 0.08 = 1.6e-5 m), over
 * which the normal turns by the second derivative (32 per metre) times that; add the grid's own
 * error of angle-weighted normals, of second order in 0.25 mm: together below 0.003. */
static void test_normal_map_of_bumps(void **state)
{
    (void)state;
    parian_mesh source = make_bumpy_plane(0.05, 200);
    parian_body body = make_flat_body(FLAT_TEXELS, 0.045);
    parian_detail_desc desc = {.source = &source, .material = 0xFFFFFFFFu, .normal_map = true};
    assert_int_equal(parian_stage_detail(test_env(2), &desc, &body), PARIAN_OK);
    assert_non_null(body.texel_normal_map);
    assert_null(body.texel_albedo);
    double slope_max = 0.0;
    for (uint32_t i = 0; i < body.texel_count; i++) {
        double x = bump_rate * body.texel_position[i][0], y = bump_rate * body.texel_position[i][1];
        double n[3] = {-bump_height * bump_rate * cos(x) * sin(y),
                       -bump_height * bump_rate * sin(x) * cos(y), 1.0};
        double length = sqrt(parian_dot3(n, n));
        slope_max = fmax(slope_max, fabs(n[0]));
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(n[k] / length - body.texel_normal_map[i][k]) < 0.003);
        }
    }
    assert_true(slope_max > 0.05); /* there was something to carry over */
    free_flat_body(&body);
    parian_mesh_free(NULL, &source);
}

/* The far side of a sheet of 0.2 mm is nearer to a point inside, and faces the other way. */
static void test_far_side_is_not_taken(void **state)
{
    (void)state;
    parian_mesh source;
    parian_body body = make_flat_body(16, 0.04);
    parian_detail_desc desc = {.material = 0xFFFFFFFFu, .normal_map = true};
    assert_int_equal(test_box(NULL, 0.05, 0.05, 0.0002, 10, &source), PARIAN_OK);
    double lower[3], upper[3];
    parian_mesh_bounds(&source, lower, upper);
    for (uint32_t v = 0; v < source.vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            source.position[v][k] -= 0.5 * (lower[k] + upper[k]);
        }
    }
    for (uint32_t i = 0; i < body.texel_count; i++) {
        body.texel_position[i][2] = -0.00005f;
    }
    desc.source = &source;
    assert_int_equal(parian_stage_detail(test_env(2), &desc, &body), PARIAN_OK);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        assert_true(body.texel_normal_map[i][2] > 0.99f);
    }
    free_flat_body(&body);
    parian_mesh_free(NULL, &source);
}

static void give_uv(parian_mesh *mesh, double side)
{
    assert_true(PARIAN_NEW(NULL, mesh->corner_uv, mesh->triangle_count));
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int c = 0; c < 3; c++) {
            const double *p = mesh->position[mesh->triangle[t][c]];
            mesh->corner_uv[t][c][0] = (float)(p[0] / side + 0.5);
            mesh->corner_uv[t][c][1] = (float)(p[1] / side + 0.5);
        }
    }
}

enum { CHECKER_SQUARES = 8, CHECKER_SQUARE_PIXELS = 16 };

static parian_picture make_checker(void)
{
    uint32_t side = CHECKER_SQUARES * CHECKER_SQUARE_PIXELS;
    parian_picture picture = {.width = side, .height = side};
    assert_true(PARIAN_NEW(NULL, picture.pixel, side * side));
    for (uint32_t i = 0; i < side * side; i++) {
        bool white = (i % side / CHECKER_SQUARE_PIXELS + i / side / CHECKER_SQUARE_PIXELS) % 2;
        const uint8_t light[4] = {255, 188, 255, 255}, dark[4] = {0, 0, 0, 255};
        memcpy(picture.pixel[i], white ? light : dark, 4);
    }
    return picture;
}

/* 64 texels over 0.05 m in squares of 8 texels: those not at a square's rim have its colour
 * exactly, dark lifted to 0.02. 188 codes 0.5029 in sRGB. */
static void test_albedo_of_a_checker(void **state)
{
    (void)state;
    parian_mesh source;
    parian_picture picture = make_checker();
    parian_source_material material = {.base_color = {1.0f, 1.0f, 0.5f, 1.0f}};
    assert_int_equal(test_plane(NULL, 0.05, 10, &source), PARIAN_OK);
    double lower[3], upper[3];
    parian_mesh_bounds(&source, lower, upper);
    for (uint32_t v = 0; v < source.vertex_count; v++) {
        for (int k = 0; k < 2; k++) {
            source.position[v][k] -= 0.5 * (lower[k] + upper[k]);
        }
    }
    give_uv(&source, 0.05);
    parian_body body = make_flat_body(FLAT_TEXELS, 0.05);
    parian_detail_desc desc = {.source = &source,
                               .materials = &material,
                               .material_count = 1,
                               .pictures = &picture,
                               .picture_count = 1};
    assert_int_equal(parian_stage_detail(test_env(2), &desc, &body), PARIAN_OK);
    assert_non_null(body.texel_albedo);
    assert_null(body.texel_normal_map);
    const uint32_t square = FLAT_TEXELS / CHECKER_SQUARES;
    double sum = 0.0;
    for (uint32_t i = 0; i < body.texel_count; i++) {
        uint32_t x = i % FLAT_TEXELS, y = i / FLAT_TEXELS;
        uint32_t ix = x % square, iy = y % square;
        bool white = (x / square + y / square) % 2;
        sum += body.texel_albedo[i][0];
        if (ix == 0 || iy == 0 || ix == square - 1 || iy == square - 1) {
            continue;
        }
        assert_true(fabs(body.texel_albedo[i][0] - (white ? 1.0 : 0.02)) < 1e-5);
        assert_true(fabs(body.texel_albedo[i][1] - (white ? 0.5029 : 0.02)) < 2e-4);
        assert_true(fabs(body.texel_albedo[i][2] - (white ? 0.5 : 0.02)) < 1e-5);
    }
    assert_true(fabs(sum / body.texel_count - 0.51) < 0.01);
    free_flat_body(&body);
    parian_free(NULL, picture.pixel);
    parian_mesh_free(NULL, &source);
}

/* One texel over 8 x 8 pixels of a fine checker sees its mean, not one of its pixels. */
static void test_fine_texture_is_averaged(void **state)
{
    (void)state;
    parian_mesh source;
    parian_picture picture = {.width = 512, .height = 512};
    parian_source_material material = {.base_color = {1.0f, 1.0f, 1.0f, 1.0f}};
    assert_true(PARIAN_NEW(NULL, picture.pixel, 512 * 512));
    for (uint32_t i = 0; i < 512 * 512; i++) {
        memset(picture.pixel[i], (i % 512 + i / 512) % 2 ? 255 : 0, 4);
    }
    assert_int_equal(test_plane(NULL, 0.05, 10, &source), PARIAN_OK);
    give_uv(&source, 0.05);
    parian_body body = make_flat_body(FLAT_TEXELS, 0.05);
    double lower[3], upper[3];
    parian_mesh_bounds(&source, lower, upper);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        for (int k = 0; k < 2; k++) {
            body.texel_position[i][k] += (float)(0.5 * (lower[k] + upper[k]));
        }
    }
    parian_detail_desc desc = {.source = &source,
                               .materials = &material,
                               .material_count = 1,
                               .pictures = &picture,
                               .picture_count = 1};
    assert_int_equal(parian_stage_detail(test_env(2), &desc, &body), PARIAN_OK);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        assert_true(fabs(body.texel_albedo[i][1] - 0.5) < 0.05);
    }
    free_flat_body(&body);
    parian_free(NULL, picture.pixel);
    parian_mesh_free(NULL, &source);
}

static void test_white_is_no_detail(void **state)
{
    (void)state;
    parian_mesh source;
    parian_source_material material = {.base_color = {1.0f, 1.0f, 1.0f, 1.0f},
                                       .base_color_picture = -1};
    parian_body body = make_flat_body(8, 0.05);
    parian_detail_desc desc = {.materials = &material, .material_count = 1};
    assert_int_equal(test_plane(NULL, 0.05, 2, &source), PARIAN_OK);
    desc.source = &source;
    assert_int_equal(parian_stage_detail(NULL, &desc, &body), PARIAN_OK);
    assert_null(body.texel_albedo);
    assert_null(body.texel_normal_map);
    material.base_color[1] = 0.5f;
    assert_int_equal(parian_stage_detail(NULL, &desc, &body), PARIAN_OK);
    for (uint32_t i = 0; i < body.texel_count; i++) {
        assert_true(body.texel_albedo[i][0] == 1.0f && body.texel_albedo[i][1] == 0.5f);
    }
    free_flat_body(&body);
    parian_mesh_free(NULL, &source);
}

static void test_same_bytes_for_any_threads(void **state)
{
    (void)state;
    const unsigned threads[] = {1, 2, 7};
    parian_mesh source = make_bumpy_plane(0.05, 60);
    parian_body first = make_flat_body(FLAT_TEXELS, 0.06);
    parian_detail_desc desc = {.source = &source, .material = 0xFFFFFFFFu, .normal_map = true};
    assert_int_equal(parian_stage_detail(test_env(threads[0]), &desc, &first), PARIAN_OK);
    for (int i = 1; i < 3; i++) {
        parian_body body = make_flat_body(FLAT_TEXELS, 0.06);
        assert_int_equal(parian_stage_detail(test_env(threads[i]), &desc, &body), PARIAN_OK);
        assert_memory_equal(body.texel_normal_map, first.texel_normal_map,
                            body.texel_count * sizeof *body.texel_normal_map);
        free_flat_body(&body);
    }
    free_flat_body(&first);
    parian_mesh_free(NULL, &source);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closest_against_brute_force),
        cmocka_unit_test(test_normal_map_of_bumps),
        cmocka_unit_test(test_far_side_is_not_taken),
        cmocka_unit_test(test_albedo_of_a_checker),
        cmocka_unit_test(test_fine_texture_is_averaged),
        cmocka_unit_test(test_white_is_no_detail),
        cmocka_unit_test(test_same_bytes_for_any_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
