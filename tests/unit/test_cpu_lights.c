/* test_cpu_lights.c - E against closed forms, shadows against cast rays, and lights that must be
 * refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/fresnel.h"
#include "core/small_maths.h"
#include "support/lit_scene.h"

#define RADIUS 0.02f

enum { TEXEL_STEP = 11 }; /* of the texels whose shadows are compared with rays */

/* Largest relative difference of E to a closed form, over texels that get at least a hundredth of
 * the peak. */
typedef double (*closed_form)(const float p[3], const float n[3]);

static double worst_against(const parian_scene *scene, const float (*e)[3], closed_form expected)
{
    const parian_body *body = &scene->data.bodies[0];
    double peak = 0.0, worst = 0.0;
    for (uint32_t t = 0; t < body->texel_count; t++) {
        peak = fmax(peak, expected(body->texel_position[t], body->texel_normal[t]));
    }
    for (uint32_t t = 0; t < body->texel_count; t++) {
        double want = expected(body->texel_position[t], body->texel_normal[t]);
        double scale = fmax(want, 0.01 * peak);
        worst = fmax(worst, fabs((double)e[t][1] - want) / scale);
    }
    return worst;
}

/* Share of area-weighted E that differs from the closed form. */
static double l1_against(const parian_scene *scene, const float (*e)[3], closed_form expected)
{
    const parian_body *body = &scene->data.bodies[0];
    double sum = 0.0, off = 0.0;
    for (uint32_t t = 0; t < body->texel_count; t++) {
        double want = expected(body->texel_position[t], body->texel_normal[t]);
        double area = (double)body->texel_area[t];
        sum += area * want;
        off += area * fabs((double)e[t][1] - want);
    }
    return off / sum;
}

static double directional_form(const float p[3], const float n[3])
{
    (void)p;
    double cosine = (double)n[2];
    return cosine > 0.0 ? 2.0 * cosine * parian_fresnel_transmittance(cosine, 1.5) : 0.0;
}

static const float point_place[3] = {0.05f, 0.03f, -0.04f};

static double point_form(const float p[3], const float n[3])
{
    double d[3], d2 = 0.0, cosine = 0.0;
    for (int c = 0; c < 3; c++) {
        d[c] = (double)point_place[c] - (double)p[c];
        d2 += d[c] * d[c];
        cosine += d[c] * (double)n[c];
    }
    cosine /= sqrt(d2);
    return cosine > 0.0 ? 3.0 / d2 * cosine * parian_fresnel_transmittance(cosine, 1.5) : 0.0;
}

/* The sphere is round and convex: E is the closed form at the texel's own normal, shadows are the
 * cosine's. At the terminator the flat triangles hide each other, where E is small: hence L1 of 0.5
 * % for all. */
static void test_directional(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 20, 3);
    parian_renderer *renderer = lit_cpu(env, scene, 1024);
    parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -3}, .color = {1, 2, 3}};
    float(*e)[3] = lit_irradiance(env, scene, renderer, &light);
    double off = l1_against(scene, (const float(*)[3])e, directional_form);
    print_message("directional: L1 %.5f, worst %.4f\n", off,
                  worst_against(scene, (const float(*)[3])e, directional_form));
    assert_true(off < 0.005);
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* A source whose relief the transfer surface lost: E follows the source's normals where the asset
 * holds them, and they are the normals that are handed out. Floats: 1e-5; only texels that are far
 * from the terminator, where no facet hides another. */
static void test_relief(void **state)
{
    (void)state;
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 20, 3);
    parian_body *body = &scene->data.bodies[0];
    parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .color = {2, 2, 2}};
    assert_true(PARIAN_NEW(env, body->texel_normal_map, body->texel_count));
    for (uint32_t t = 0; t < body->texel_count; t++) {
        float tilt = 0.3f * sinf(1000.0f * body->texel_position[t][0]),
              *n = body->texel_normal_map[t];
        memcpy(n, body->texel_normal[t], sizeof body->texel_normal[t]);
        n[1] += tilt;
        float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int c = 0; c < 3; c++) {
            n[c] /= length;
        }
    }
    parian_renderer *renderer = lit_cpu(env, scene, 1024);
    float(*e)[3] = lit_irradiance(env, scene, renderer, &light), (*normal)[3];
    assert_true(PARIAN_NEW(env, normal, body->texel_count));
    parian_texel_arrays arrays = {.normal = normal};
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        const float *n = body->texel_normal_map[t];
        double want = directional_form(body->texel_position[t], n);
        assert_memory_equal(normal[t], n, sizeof normal[t]);
        assert_true(body->texel_normal[t][2] < 0.5f || fabs((double)e[t][1] - want) < 1e-5);
    }
    parian_free(env, normal);
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static void test_point(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 20, 3);
    parian_renderer *renderer = lit_cpu(env, scene, 1024);
    parian_light light = {.type = PARIAN_LIGHT_POINT, .color = {3, 3, 3}};
    memcpy(light.position, point_place, sizeof point_place);
    float(*e)[3] = lit_irradiance(env, scene, renderer, &light);
    double off = l1_against(scene, (const float(*)[3])e, point_form);
    print_message("point: L1 %.5f\n", off);
    assert_true(off < 0.005);
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* Flux of a spot onto a plane: E is divided by F_t at each texel, so that the sum is the spot's
 * whole flux, 2 pi I (1 - (cos inner + cos outer) / 2) for the smoothstep between the cosines. With
 * a picture, white in its middle half and black around: the solid angle of a square pyramid
 * instead. */
static double spot_flux(const parian_env *env, const parian_light *light, float distance)
{
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 6};
    double flux = 0.0;
    assert_int_equal(test_plane(env, 0.1, 24, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 40.0), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    float(*e)[3] = lit_irradiance(env, scene, renderer, light);
    const parian_body *body = &scene->data.bodies[0];
    for (uint32_t t = 0; t < body->texel_count; t++) {
        double d2 = 0.0;
        for (int c = 0; c < 3; c++) {
            double d = (double)(body->texel_position[t][c] - light->position[c]);
            d2 += d * d;
        }
        double transmit = parian_fresnel_transmittance((double)distance / sqrt(d2), 1.5);
        flux += (double)body->texel_area[t] * (double)e[t][0] / transmit;
    }
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    return flux;
}

static void place_over_plane(const parian_env *env, parian_light *light, float distance)
{
    parian_mesh mesh = {0};
    double lower[3], upper[3];
    assert_int_equal(test_plane(env, 0.1, 2, &mesh), PARIAN_OK);
    parian_mesh_bounds(&mesh, lower, upper);
    for (int c = 0; c < 3; c++) {
        light->position[c] = (float)(0.5 * (lower[c] + upper[c]));
    }
    light->position[2] += distance;
    parian_mesh_free(env, &mesh);
}

static void test_spot_flux(void **state)
{
    const parian_env *env = test_env(0);
    parian_light light = {.type = PARIAN_LIGHT_SPOT,
                          .direction = {0, 0, -1},
                          .color = {2, 2, 2},
                          .inner_deg = 15,
                          .outer_deg = 25};
    place_over_plane(env, &light, 0.08f);
    double flux = spot_flux(env, &light, 0.08f), deg = PARIAN_PI / 180.0;
    double want = 2.0 * PARIAN_PI * 2.0 * (1.0 - 0.5 * (cos(15 * deg) + cos(25 * deg)));
    print_message("spot: flux %.6f, expected %.6f\n", flux, want);
    assert_true(fabs(flux / want - 1.0) < 0.01);
    (void)state;
}

static void test_slide_flux(void **state)
{
    enum { SIDE = 64 };
    static float pixel[SIDE * SIDE][3];
    const parian_env *env = test_env(0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        bool lit = x >= SIDE / 4 && x < 3 * SIDE / 4 && y >= SIDE / 4 && y < 3 * SIDE / 4;
        pixel[i][0] = pixel[i][1] = pixel[i][2] = lit ? 1.0f : 0.0f;
    }
    parian_light light = {.type = PARIAN_LIGHT_SPOT,
                          .direction = {0, 0, -1},
                          .color = {1, 1, 1},
                          .inner_deg = 28,
                          .outer_deg = 28,
                          .image = {SIDE, SIDE, (const float(*)[3])pixel}};
    place_over_plane(env, &light, 0.07f);
    double flux = spot_flux(env, &light, 0.07f);
    double a = 0.5 * tan(28 * PARIAN_PI / 180.0); /* half side of the white square at distance 1 */
    double want = 4.0 * atan(a * a / sqrt(1.0 + 2.0 * a * a));
    print_message("slide: flux %.6f, expected %.6f\n", flux, want);
    assert_true(fabs(flux / want - 1.0) < 0.01);
    (void)state;
}

static double sky_form(const float p[3], const float n[3])
{
    (void)p;
    (void)n;
    return 2.0 * PARIAN_PI * (1.0 - 2.0 * parian_fresnel_c1(1.5));
}

/* An even sky on a sphere: E = pi L (1 - 2 C1), the same everywhere; shadows graze at each facet,
 * hence 2 %. */
static void test_sky(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 8, 3);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {2, 2, 2}};
    float(*e)[3] = lit_irradiance(env, scene, renderer, &light);
    double off = l1_against(scene, (const float(*)[3])e, sky_form);
    print_message("sky: L1 %.5f\n", off);
    assert_true(off < 0.02);
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* Irradiance of a rectangle seen head-on from its axis at distance d, half sides a: 4 L
 * asin(..)-form of the view factor of a parallel rectangle, by fine quadrature here; the sphere's
 * nearest texel stands for the receiver. */
static void test_rect(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 20, 3);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    parian_light light = {.type = PARIAN_LIGHT_RECT,
                          .position = {0, 0, 0.06f},
                          .axis_u = {0, 0.02f, 0},
                          .axis_v = {0.02f, 0, 0},
                          .color = {5, 5, 5}};
    const parian_body *body = &scene->data.bodies[0];
    float(*e)[3] = lit_irradiance(env, scene, renderer, &light);
    uint32_t nearest = 0;
    double want = 0.0;
    for (uint32_t t = 1; t < body->texel_count; t++) {
        nearest = body->texel_position[t][2] > body->texel_position[nearest][2] ? t : nearest;
    }
    const float *p = body->texel_position[nearest], *n = body->texel_normal[nearest];
    for (int i = 0; i < 200 * 200; i++) {
        double q[3] = {(i % 200 + 0.5) / 5000.0 - 0.02, (i / 200 + 0.5) / 5000.0 - 0.02, 0.06},
               d2 = 0, c = 0;
        for (int k = 0; k < 3; k++) {
            q[k] -= (double)p[k];
            d2 += q[k] * q[k];
            c += q[k] * (double)n[k];
        }
        c /= sqrt(d2);
        want += 5.0 * 4e-8 * (q[2] / sqrt(d2)) / d2 * fmax(c, 0.0) *
                parian_fresnel_transmittance(c, 1.5);
    }
    print_message("rect: E %.5f, expected %.5f\n", (double)e[nearest][0], want);
    assert_true(fabs((double)e[nearest][0] / want - 1.0) < 0.01); /* 4 x 4 pieces */
    parian_free(env, e);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* ---- shadows against rays ---- */

static bool ray_hits(const parian_body *body, const float origin[3], const double direction[3],
                     double far)
{
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        const float *a = body->vertex_position[body->triangle[t][0]];
        double e1[3], e2[3], s[3], p[3], q[3];
        parian_sub3(body->vertex_position[body->triangle[t][1]], a, e1);
        parian_sub3(body->vertex_position[body->triangle[t][2]], a, e2);
        parian_sub3(origin, a, s);
        parian_cross3(direction, e2, p);
        double det = parian_dot3(e1, p);
        double u = parian_dot3(s, p) / det;
        if (det == 0.0 || u < 0.0 || u > 1.0) {
            continue;
        }
        parian_cross3(s, e1, q);
        double v = parian_dot3(direction, q) / det, at = parian_dot3(e2, q) / det;
        if (v >= 0.0 && u + v <= 1.0 && at > 0.0 && at < far) {
            return true;
        }
    }
    return false;
}

typedef struct ray_job {
    const parian_body *body;
    const float (*e)[3];
    const parian_light *light;
    float size;          /* of the object */
    double *lit, *wrong; /* [texel_count] area, or 0 */
} ray_job;

/* Is the light seen from the texel? Rays start on the surface that the corner normals span
 * [Hanika21]. */
static bool sees_light(const ray_job *job, uint32_t t)
{
    const parian_body *body = job->body;
    const uint32_t triangle = body->texel_triangle[t];
    const float *b = body->texel_barycentric[t], share[3] = {b[0], b[1], 1.0f - b[0] - b[1]};
    const float *p = body->texel_position[t];
    double edge[2][3], facet[3], direction[3], length;
    float origin[3];
    for (int k = 0; k < 2; k++) {
        parian_sub3(body->vertex_position[body->triangle[triangle][k + 1]],
                    body->vertex_position[body->triangle[triangle][0]], edge[k]);
    }
    parian_cross3(edge[0], edge[1], facet);
    length = sqrt(parian_dot3(facet, facet));
    for (int c = 0; c < 3; c++) {
        origin[c] = p[c] + 2e-6f * job->size * (float)(facet[c] / length);
    }
    for (int k = 0; k < 3; k++) {
        const float *n = body->corner_normal[triangle][k];
        const float *corner = body->vertex_position[body->triangle[triangle][k]];
        float above = 0.0f;
        for (int c = 0; c < 3; c++) {
            above += (p[c] - corner[c]) * n[c];
        }
        for (int c = 0; c < 3; c++) {
            origin[c] -= fminf(above, 0.0f) * share[k] * n[c];
        }
    }
    bool far = job->light->type == PARIAN_LIGHT_DIRECTIONAL;
    for (int c = 0; c < 3; c++) {
        direction[c] = far ? -(double)job->light->direction[c]
                           : (double)job->light->position[c] - (double)origin[c];
    }
    length = sqrt(parian_dot3(direction, direction));
    for (int c = 0; c < 3; c++) {
        direction[c] /= length;
    }
    return !ray_hits(body, origin, direction, far ? 1e9 : length);
}

static void compare_texel(void *context, size_t texel)
{
    ray_job *job = context;
    uint32_t t = TEXEL_STEP * (uint32_t)texel;
    const float *p = job->body->texel_position[t], *n = job->body->texel_normal[t];
    double to_light[3], cosine = 0.0, d2 = 0.0;
    for (int c = 0; c < 3; c++) {
        bool far = job->light->type == PARIAN_LIGHT_DIRECTIONAL;
        to_light[c] =
            far ? -(double)job->light->direction[c] : (double)(job->light->position[c] - p[c]);
        d2 += to_light[c] * to_light[c];
        cosine += to_light[c] * (double)n[c];
    }
    cosine /= sqrt(d2);
    if (cosine <= 0.0) {
        assert_true(job->e[t][0] == 0.0f); /* the far side of a thin sheet stays dark */
        return;
    }
    bool sees = sees_light(job, t);
    double open = cosine * parian_fresnel_transmittance(cosine, 1.5) * (double)job->light->color[0];
    open /= job->light->type == PARIAN_LIGHT_DIRECTIONAL ? 1.0 : d2;
    bool lit = (double)job->e[t][0] > 0.5 * open;
    double area = (double)job->body->texel_area[t];
    job->lit[t] = sees ? area : 0.0;
    job->wrong[t] = lit != sees ? area : 0.0;
}

static double wrong_share(const parian_env *env, const parian_scene *scene,
                          parian_renderer *renderer, const parian_light *light)
{
    const parian_body *body = &scene->data.bodies[0];
    float(*e)[3] = lit_irradiance(env, scene, renderer, light);
    ray_job job = {.body = body, .e = (const float(*)[3])e, .light = light};
    double lit = 0.0, wrong = 0.0;
    for (int c = 0; c < 3; c++) {
        job.size = fmaxf(job.size, scene->info.upper[c] - scene->info.lower[c]);
    }
    assert_true(PARIAN_NEW0(env, job.lit, body->texel_count) &&
                PARIAN_NEW0(env, job.wrong, body->texel_count));
    parian_par(env, body->texel_count / TEXEL_STEP, compare_texel, &job);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        lit += job.lit[t];
        wrong += job.wrong[t];
    }
    parian_free(env, job.lit);
    parian_free(env, job.wrong);
    parian_free(env, e);
    assert_true(lit > 0.0);
    return wrong / lit;
}

static void test_shadows(void **state)
{
    const parian_env *env = test_env(0);
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 3};
    assert_int_equal(test_figure(env, RADIUS, 26, &mesh), PARIAN_OK);
    parian_scene *scene = lit_scene(env, &mesh, &desc);
    parian_renderer *renderer = lit_cpu(env, scene, 0);
    static const parian_light lights[] = {
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -1, -0.5f}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .direction = {0.1f, -1, 0.05f}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_POINT, .position = {0.06f, 0.05f, 0.03f}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_POINT,
         .position = {0.0f, 0.028f, 0.012f},
         .color = {1, 1, 1}}, /* between the ears */
    };
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        double share = wrong_share(env, scene, renderer, &lights[i]);
        print_message("shadows of light %zu: %.4f of the lit area differ from cast rays\n", i,
                      share);
        assert_true(share <= 0.001); /* rays that graze an edge */
    }
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

/* ---- hard places and refusals ---- */

static void test_hard_places(void **state)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = lit_sphere(env, RADIUS, 4, 2);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    parian_light light = {.type = PARIAN_LIGHT_POINT, .color = {1, 1, 1}};
    const parian_body *body = &scene->data.bodies[0];
    const float middle[3] = {0, 0, 0}, remote[3] = {1e9f, 0, 0};
    const float *places[] = {body->vertex_position[0], body->texel_position[5], middle, remote};
    for (int i = 0; i < 4; i++) { /* on a vertex, on a texel, in the middle, very far away */
        memcpy(light.position, places[i], sizeof light.position);
        float(*e)[3] = lit_irradiance(env, scene, renderer, &light);
        for (uint32_t t = 0; t < body->texel_count; t++) {
            assert_true(isfinite(e[t][0]) && e[t][0] >= 0.0f);
            assert_true(i != 2 || e[t][0] == 0.0f); /* from inside no light enters */
        }
        parian_free(env, e);
    }
    assert_int_equal(parian_renderer_set_lights(renderer, NULL, 0), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

static void test_refusals(void **state)
{
    const parian_env *env = test_env(1);
    parian_scene *scene = lit_sphere(env, RADIUS, 2, 2);
    parian_renderer *renderer = lit_cpu(env, scene, 256);
    const float hole[1][3] = {{NAN, 0, 0}};
    const parian_light bad[] = {
        {.type = (parian_light_type)9},
        {.type = PARIAN_LIGHT_POINT, .color = {-1, 0, 0}},
        {.type = PARIAN_LIGHT_POINT, .color = {NAN, 0, 0}},
        {.type = PARIAN_LIGHT_POINT, .position = {INFINITY, 0, 0}, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_DIRECTIONAL, .color = {1, 1, 1}},
        {.type = PARIAN_LIGHT_SPOT, .direction = {1, 0, 0}, .inner_deg = 30, .outer_deg = 20},
        {.type = PARIAN_LIGHT_SPOT, .direction = {1, 0, 0}, .inner_deg = 30, .outer_deg = 90},
        {.type = PARIAN_LIGHT_SPOT,
         .direction = {1, 0, 0},
         .inner_deg = 3,
         .outer_deg = 9,
         .image = {1, 1, hole}},
        {.type = PARIAN_LIGHT_RECT, .axis_u = {1, 0, 0}, .axis_v = {2, 0, 0}},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(parian_renderer_set_lights(renderer, &bad[i], 1), PARIAN_E_ARGUMENT);
    }
    parian_light many[300] = {0};
    assert_int_equal(parian_renderer_set_lights(renderer, many, 300), PARIAN_E_LIMIT);
    parian_settings settings = {.roughness = NAN};
    assert_int_equal(parian_renderer_set_settings(renderer, &settings), PARIAN_E_ARGUMENT);
    parian_draw_desc draw = {.width = 0, .height = 4};
    assert_int_equal(parian_renderer_draw(renderer, &draw), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_renderer_read_picture(renderer, NULL, NULL), PARIAN_E_ARGUMENT);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_directional), cmocka_unit_test(test_point),
        cmocka_unit_test(test_spot_flux),   cmocka_unit_test(test_slide_flux),
        cmocka_unit_test(test_sky),         cmocka_unit_test(test_rect),
        cmocka_unit_test(test_shadows),     cmocka_unit_test(test_hard_places),
        cmocka_unit_test(test_relief),      cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
