/* test_rays.c - nearest hits and occlusion against every triangle tried in turn.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <string.h>

#include "bake/reference/rays.h"
#include "core/memory.h"
#include "core/random.h"

static const parian_ray free_ray = {
    .length = INFINITY, .mesh = PARIAN_RAY_NONE, .triangle = PARIAN_RAY_NONE};

static void random_direction(parian_random *random, double out[3])
{
    double z = 2 * parian_random_unit(random) - 1,
           phi = 6.283185307179586 * parian_random_unit(random);
    double s = sqrt(1 - z * z);
    out[0] = s * cos(phi);
    out[1] = s * sin(phi);
    out[2] = z;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double to[3], const double a[3], const double b[3])
{
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

/* Triangles of the size 0.3 strewn over the unit cube, apart from each other. */
static void make_soup(uint32_t count, double scale, const double offset[3], parian_mesh *mesh)
{
    parian_random random = parian_random_stream(7, count, 0, 0);
    memset(mesh, 0, sizeof *mesh);
    mesh->vertex_count = 3 * count;
    mesh->triangle_count = count;
    assert_true(PARIAN_NEW(NULL, mesh->position, mesh->vertex_count));
    assert_true(PARIAN_NEW(NULL, mesh->triangle, count));
    for (uint32_t v = 0; v < 3 * count; v++) {
        static double centre[3];
        mesh->triangle[v / 3][v % 3] = v;
        for (int k = 0; k < 3; k++) {
            centre[k] = v % 3 == 0 ? parian_random_unit(&random) : centre[k];
            double p = centre[k] + 0.3 * (parian_random_unit(&random) - 0.5);
            mesh->position[v][k] = offset[k] + scale * p;
        }
    }
}

/* Distance along a ray to a triangle by the plane and three side tests (not the formula under
 * test), INFINITY for none; margin: the least side test over the triangle's area, which tells hits
 * near edges. */
static double meet(const parian_mesh *mesh, uint32_t t, const parian_ray *ray, double *margin)
{
    const double *corner[3];
    double e[2][3], normal[3], q[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = mesh->position[mesh->triangle[t][k]];
    }
    for (int k = 0; k < 3; k++) {
        e[0][k] = corner[1][k] - corner[0][k];
        e[1][k] = corner[2][k] - corner[0][k];
    }
    cross(normal, e[0], e[1]);
    double height = 0;
    for (int k = 0; k < 3; k++) {
        height += (corner[0][k] - ray->origin[k]) * normal[k];
    }
    double distance = height / dot(normal, ray->direction);
    for (int k = 0; k < 3; k++) {
        q[k] = ray->origin[k] + distance * ray->direction[k];
    }
    *margin = INFINITY;
    for (int s = 0; s < 3; s++) {
        double side[3], to[3], area[3];
        for (int k = 0; k < 3; k++) {
            side[k] = corner[(s + 1) % 3][k] - corner[s][k];
            to[k] = q[k] - corner[s][k];
        }
        cross(area, side, to);
        *margin = fmin(*margin, dot(area, normal) / dot(normal, normal));
    }
    return distance > 0 && distance < ray->length && *margin >= 0 ? distance : INFINITY;
}

typedef struct brute_hit {
    double distance, second;
    uint32_t triangle;
    bool doubtful; /* an edge is so near that floats may see it differently */
} brute_hit;

static brute_hit try_all(const parian_mesh *mesh, const parian_ray *ray)
{
    brute_hit hit = {INFINITY, INFINITY, PARIAN_RAY_NONE, false};
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double margin, distance = t == ray->triangle ? INFINITY : meet(mesh, t, ray, &margin);
        if (t == ray->triangle) {
            continue;
        }
        hit.doubtful = hit.doubtful || fabs(margin) < 1e-4;
        if (distance < hit.distance) {
            hit.second = hit.distance;
            hit.distance = distance;
            hit.triangle = t;
        } else if (distance < hit.second) {
            hit.second = distance;
        }
    }
    return hit;
}

/* Hits must be the same triangle and, being refined in doubles, the same distance to 1e-9 of the
 * extent. Rays that pass within 1e-4 of an edge (in barycentrics), or whose two nearest hits are
 * closer than 1e-5, are left out (floats may choose otherwise there): far from all rays. */
static void compare_with_brute_force(double scale, const double offset[3])
{
    enum { TRIANGLES = 300, RAYS = 20000 };
    parian_mesh mesh;
    make_soup(TRIANGLES, scale, offset, &mesh);
    const parian_mesh *meshes[1] = {&mesh};
    parian_rays *rays;
    assert_int_equal(parian_rays_create(NULL, meshes, 1, &rays), PARIAN_OK);
    parian_random random = parian_random_stream(1, 2, 3, 4);
    size_t compared = 0, hits = 0;
    for (int i = 0; i < RAYS; i++) {
        parian_ray ray = free_ray;
        parian_ray_hit hit;
        for (int k = 0; k < 3; k++) {
            ray.origin[k] = offset[k] + scale * (1.2 * parian_random_unit(&random) - 0.1);
        }
        random_direction(&random, ray.direction);
        ray.length = i % 2 ? INFINITY : 0.5 * scale;
        brute_hit expected = try_all(&mesh, &ray);
        if (expected.doubtful || expected.second - expected.distance < 1e-5 * scale) {
            continue;
        }
        bool found = parian_rays_nearest(rays, &ray, i % 3 ? 0 : PARIAN_RAY_NONE, &hit);
        compared++;
        assert_int_equal(found, isfinite(expected.distance));
        assert_int_equal(parian_rays_blocked(rays, &ray, PARIAN_RAY_NONE), found);
        if (!found) {
            continue;
        }
        hits++;
        assert_int_equal(hit.mesh, 0);
        assert_int_equal(hit.triangle, expected.triangle);
        assert_true(fabs(hit.distance - expected.distance) < 1e-9 * scale);
        for (int k = 0; k < 3; k++) { /* the barycentrics give the same point */
            double at = ray.origin[k] + hit.distance * ray.direction[k];
            for (int c = 0; c < 3; c++) {
                at -= hit.barycentric[c] * mesh.position[mesh.triangle[hit.triangle][c]][k];
            }
            assert_true(fabs(at) < 1e-9 * scale);
        }
        assert_true(fabs(dot(hit.normal, hit.normal) - 1) < 1e-12);
    }
    assert_true(compared > RAYS / 2 && hits > RAYS / 20);
    parian_rays_destroy(rays);
    parian_mesh_free(NULL, &mesh);
}

static void soup_of_any_size_and_place(void **state)
{
    (void)state;
    compare_with_brute_force(1, (const double[3]){0, 0, 0});
    compare_with_brute_force(1e-4, (const double[3]){0, 0, 0});
    compare_with_brute_force(10, (const double[3]){-5, 2, 1});
    compare_with_brute_force(1e-4, (const double[3]){0.3, -0.2, 0.1});
}

/* Inside a closed mesh every ray gets out, and comes out once: rays from inside points, and rays
 * from points of the surface into the inside, aimed at edges and corners as often as anywhere. */
static void closed_mesh_has_no_leak(void **state)
{
    enum { RAYS = 200000 };
    (void)state;
    const double sizes[] = {0.05, 1e-4, 10};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        parian_mesh mesh;
        parian_rays *rays;
        assert_int_equal(test_sphere(NULL, sizes[s], 9, &mesh), PARIAN_OK);
        const parian_mesh *meshes[1] = {&mesh};
        assert_int_equal(parian_rays_create(NULL, meshes, 1, &rays), PARIAN_OK);
        parian_random random = parian_random_stream(5, s, 0, 0);
        size_t missed = 0, missed_corners = 0, entered = 0;
        for (int i = 0; i < RAYS; i++) {
            parian_ray ray = free_ray;
            parian_ray_hit hit;
            uint32_t t = (uint32_t)(parian_random_unit(&random) * mesh.triangle_count);
            double u = parian_random_unit(&random), v = parian_random_unit(&random), p[3],
                   length = 0;
            u = i % 4 == 1 ? 0 : u; /* an edge */
            u = i % 4 == 2 ? 0 : u;
            v = i % 4 == 2 ? 0 : v; /* a corner */
            for (int k = 0; k < 3; k++) {
                const double *a = mesh.position[mesh.triangle[t][0]],
                             *b = mesh.position[mesh.triangle[t][1]],
                             *c = mesh.position[mesh.triangle[t][2]];
                p[k] = a[k] + (1 - u) * v * (b[k] - a[k]) + u * (c[k] - a[k]);
                ray.origin[k] = 0.5 * sizes[s] * (parian_random_unit(&random) - 0.5);
                ray.direction[k] = p[k] - ray.origin[k];
            }
            length = sqrt(dot(ray.direction, ray.direction));
            for (int k = 0; k < 3; k++) {
                ray.direction[k] /= length;
            }
            if (!parian_rays_nearest(rays, &ray, 0, &hit)) {
                missed += i % 4 != 2;
                missed_corners += i % 4 == 2;
                continue;
            }
            assert_true(fabs(hit.distance - length) < 1e-6 * sizes[s]);
            entered += dot(hit.normal, ray.direction) <= 0;
            /* From where it arrived back inside: out again elsewhere, for the triangle itself does
             * not count. */
            parian_ray back = {.length = INFINITY, .mesh = 0, .triangle = hit.triangle};
            for (int k = 0; k < 3; k++) {
                back.origin[k] = ray.origin[k] + hit.distance * ray.direction[k];
            }
            random_direction(&random, back.direction);
            if (dot(back.direction, hit.normal) > 0) {
                for (int k = 0; k < 3; k++) {
                    back.direction[k] = -back.direction[k];
                }
            }
            parian_ray_hit again;
            if (!parian_rays_nearest(rays, &back, 0, &again)) {
                /* Allowed only where an edge was aimed at: a point on it may be beyond the
                 * neighbour. */
                missed += i % 4 == 0 || i % 4 == 3;
                continue;
            }
            assert_int_not_equal(again.triangle, hit.triangle);
            entered += dot(again.normal, back.direction) <= 0 && (i % 4 == 0 || i % 4 == 3);
        }
        assert_int_equal(missed, 0);
        assert_int_equal(entered, 0);
        assert_true(missed_corners <= RAYS / 4 / 2000);
        parian_rays_destroy(rays);
        parian_mesh_free(NULL, &mesh);
    }
}

/* A body of 0.1 mm on a floor of 10 m: the trees are apart, so the floor costs the body no
 * precision. */
static void small_body_above_large_floor(void **state)
{
    (void)state;
    parian_mesh ball, floor;
    parian_rays *rays;
    assert_int_equal(test_sphere(NULL, 5e-5, 20, &ball), PARIAN_OK);
    assert_int_equal(test_plane(NULL, 10, 2, &floor), PARIAN_OK);
    for (uint32_t v = 0; v < ball.vertex_count; v++) {
        ball.position[v][2] += 5.1e-5;
    }
    const parian_mesh *meshes[2] = {&ball, &floor};
    assert_int_equal(parian_rays_create(NULL, meshes, 2, &rays), PARIAN_OK);
    parian_ray ray = free_ray;
    parian_ray_hit hit;
    ray.origin[0] = 1.2e-5;
    ray.origin[1] = 1.7e-5;
    ray.origin[2] = 1000;
    ray.direction[2] = -1;
    assert_true(parian_rays_nearest(rays, &ray, PARIAN_RAY_NONE, &hit));
    assert_int_equal(hit.mesh, 0);
    double top = 5.1e-5 + sqrt(5e-5 * 5e-5 - 1.2e-5 * 1.2e-5 - 1.7e-5 * 1.7e-5);
    /* A facet lies at most r (edge / r)^2 / 8 ~ 2e-3 r below the sphere; 1e-12 m is the rounding of
     * 1000 m. */
    assert_true(hit.distance >= 1000 - top - 1e-12 && hit.distance < 1000 - top + 2e-3 * 5e-5);
    assert_true(parian_rays_nearest(rays, &ray, 1, &hit));
    assert_true(hit.mesh == 1 && fabs(hit.distance - 1000) < 1e-12);
    assert_true(hit.normal[2] > 0.999999);
    ray.origin[0] = 1;
    assert_false(parian_rays_nearest(rays, &ray, 0, &hit));
    assert_true(parian_rays_nearest(rays, &ray, PARIAN_RAY_NONE, &hit) && hit.mesh == 1);
    ray.length = 999;
    assert_false(parian_rays_blocked(rays, &ray, PARIAN_RAY_NONE));
    parian_rays_destroy(rays);
    parian_mesh_free(NULL, &ball);
    parian_mesh_free(NULL, &floor);
}

/* A ray that starts on triangle t of one mesh still meets triangle t of another. */
static void triangles_are_skipped_in_their_own_mesh(void **state)
{
    (void)state;
    parian_mesh mesh[2] = {{0}};
    parian_rays *rays = NULL;
    parian_ray_hit hit;
    for (int m = 0; m < 2; m++) {
        assert_int_equal(test_plane(NULL, 1, 1, &mesh[m]), PARIAN_OK);
        for (uint32_t v = 0; v < mesh[m].vertex_count; v++) {
            mesh[m].position[v][2] += m;
        }
    }
    const parian_mesh *both[2] = {&mesh[0], &mesh[1]};
    assert_int_equal(parian_rays_create(NULL, both, 2, &rays), PARIAN_OK);
    for (uint32_t m = 0; m < 2; m++) {
        for (uint32_t t = 0; t < 2; t++) {
            parian_ray ray = {
                .length = INFINITY, .mesh = m, .triangle = t, .direction = {0, 0, m ? -1 : 1}};
            for (int k = 0; k < 3; k++) {
                for (int c = 0; c < 3; c++) {
                    ray.origin[k] += mesh[m].position[mesh[m].triangle[t][c]][k] / 3;
                }
            }
            assert_true(parian_rays_nearest(rays, &ray, PARIAN_RAY_NONE, &hit));
            assert_true(hit.mesh == 1 - m && hit.triangle == t && fabs(hit.distance - 1) < 1e-12);
            assert_true(parian_rays_blocked(rays, &ray, PARIAN_RAY_NONE));
            assert_false(parian_rays_blocked(rays, &ray, m));
        }
    }
    parian_rays_destroy(rays);
    parian_mesh_free(NULL, &mesh[0]);
    parian_mesh_free(NULL, &mesh[1]);
}

static void what_holds_no_surface_is_never_met(void **state)
{
    (void)state;
    double position[3][3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    uint32_t triangle[1][3] = {{0, 1, 2}};
    parian_mesh empty = {0}, point = {.vertex_count = 3,
                                      .triangle_count = 1,
                                      .position = position,
                                      .triangle = triangle};
    const parian_mesh *meshes[2] = {&empty, &point};
    parian_rays *rays = NULL;
    assert_int_equal(parian_rays_create(NULL, meshes, 2, &rays), PARIAN_OK);
    parian_ray ray = free_ray;
    parian_ray_hit hit;
    ray.direction[0] = 1;
    ray.origin[1] = ray.origin[2] = 1;
    assert_false(parian_rays_nearest(rays, &ray, 0, &hit));
    (void)parian_rays_nearest(rays, &ray, PARIAN_RAY_NONE, &hit); /* finite, whatever is found */
    assert_false(parian_rays_nearest(rays, &ray, 9, &hit));
    parian_rays_destroy(rays);
    assert_int_equal(parian_rays_create(NULL, NULL, 0, &rays), PARIAN_OK);
    assert_false(parian_rays_blocked(rays, &ray, PARIAN_RAY_NONE));
    parian_rays_destroy(rays);
    position[1][1] = NAN;
    rays = NULL;
    assert_int_equal(parian_rays_create(NULL, meshes, 2, &rays), PARIAN_E_ARGUMENT);
    position[1][1] = 2;
    triangle[0][2] = 3;
    assert_int_equal(parian_rays_create(NULL, meshes, 2, &rays), PARIAN_E_ARGUMENT);
    assert_null(rays);
    parian_rays_destroy(NULL);
}

static void every_failed_allocation_is_reported(void **state)
{
    (void)state;
    parian_mesh mesh;
    assert_int_equal(test_sphere(NULL, 1, 3, &mesh), PARIAN_OK);
    const parian_mesh *meshes[1] = {&mesh};
    for (size_t fail_at = 0;; fail_at++) {
        test_memory memory = {.fail_at = fail_at};
        parian_env env = test_failing_env(&memory);
        parian_rays *rays = NULL;
        parian_result r = parian_rays_create(&env, meshes, 1, &rays);
        parian_rays_destroy(rays);
        assert_int_equal(memory.live, 0);
        if (r == PARIAN_OK) {
            assert_true(fail_at >= 4);
            break;
        }
        assert_int_equal(r, PARIAN_E_NOMEM);
    }
    parian_mesh_free(NULL, &mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(soup_of_any_size_and_place),
        cmocka_unit_test(closed_mesh_has_no_leak),
        cmocka_unit_test(small_body_above_large_floor),
        cmocka_unit_test(triangles_are_skipped_in_their_own_mesh),
        cmocka_unit_test(what_holds_no_surface_is_never_met),
        cmocka_unit_test(every_failed_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
