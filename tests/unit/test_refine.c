/* test_refine.c - the mean of E over sets of samples against integrals by cast rays: rectangles,
 * environments and shadows' edges on a body that shadows itself.
 *
 * The truth is what the sets approach: light of every direction, with the cosine at the texel's
 * centroid, times the share of the texel that sees it, by thousands of rays from points of the
 * texel that this file places itself.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/fresnel.h"
#include "core/small_maths.h"
#include "cpu/cpu_occlusion.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"

static const float RADIUS = 0.02f;
enum { SKY_WIDTH = 32, SKY_HEIGHT = 16, ROUND_COUNT = 4, SET_COUNT = 64 };
enum { RECT_SIDE = 80, DIRECTIONAL_RAYS = 4096, SKY_SIDE = 3, SUN_SIDE = 16, CHECK_STEP = 499 };

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
        double det = parian_dot3(e1, p), u = parian_dot3(s, p) / det;
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

/* ---- points of a texel ---- */

typedef struct texel_area {
    const parian_body *body;
    uint32_t texel, count;
    uint32_t triangle[64]; /* of its chart, those that may reach into it */
    uint64_t drawn;
} texel_area;

/* A number of the lattice whose steps are powers of the plastic number [Roberts18]. */
static double lattice(uint64_t index, double step)
{
    double at = 0.5 + step * (double)index;
    return at - floor(at);
}

static void find_triangles(const parian_body *body, uint32_t texel, texel_area *area)
{
    const uint32_t chart = body->triangle_chart[body->texel_triangle[texel]];
    const float low[2] = {(float)(body->texel_index[texel] % body->atlas_size),
                          (float)(body->texel_index[texel] / body->atlas_size)};
    *area = (texel_area){.body = body, .texel = texel};
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        const float(*uv)[2] = (const float(*)[2])body->corner_uv[t];
        bool apart = body->triangle_chart[t] != chart;
        for (int c = 0; c < 2; c++) {
            apart |= fmaxf(uv[0][c], fmaxf(uv[1][c], uv[2][c])) < low[c];
            apart |= fminf(uv[0][c], fminf(uv[1][c], uv[2][c])) > low[c] + 1.0f;
        }
        if (!apart) {
            assert_true(area->count < 64);
            area->triangle[area->count++] = t;
        }
    }
}

/* Barycentrics of a point of the atlas. */
static bool inside(const parian_body *body, uint32_t triangle, double x, double y, double share[3])
{
    const float(*uv)[2] = (const float(*)[2])body->corner_uv[triangle];
    double ax = (double)uv[1][0] - (double)uv[0][0], ay = (double)uv[1][1] - (double)uv[0][1];
    double bx = (double)uv[2][0] - (double)uv[0][0], by = (double)uv[2][1] - (double)uv[0][1];
    double px = x - (double)uv[0][0], py = y - (double)uv[0][1], det = ax * by - ay * bx;
    share[1] = (px * by - py * bx) / det;
    share[2] = (ax * py - ay * px) / det;
    share[0] = 1.0 - share[1] - share[2];
    return share[0] >= 0.0 && share[1] >= 0.0 && share[2] >= 0.0;
}

/* Where a ray from the next point of a texel starts: on the surface that the corner normals span
 * [Hanika21], 2e-6 of the largest coordinate above it. */
static void next_origin(texel_area *area, float lift, float origin[3])
{
    const parian_body *body = area->body;
    const uint32_t index = body->texel_index[area->texel];
    uint32_t triangle = UINT32_MAX;
    double share[3], edge[2][3], facet[3], p[3] = {0};
    while (triangle == UINT32_MAX) {
        double x = index % body->atlas_size + lattice(++area->drawn, 0.7548776662466927);
        double y = index / body->atlas_size + lattice(area->drawn, 0.5698402909980532);
        for (uint32_t i = 0; i < area->count && triangle == UINT32_MAX; i++) {
            triangle =
                inside(body, area->triangle[i], x, y, share) ? area->triangle[i] : UINT32_MAX;
        }
    }
    const float *corner[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = body->vertex_position[body->triangle[triangle][k]];
        for (int c = 0; c < 3; c++) {
            p[c] += share[k] * (double)corner[k][c];
        }
    }
    parian_sub3(corner[1], corner[0], edge[0]);
    parian_sub3(corner[2], corner[0], edge[1]);
    parian_cross3(edge[0], edge[1], facet);
    double length = sqrt(parian_dot3(facet, facet));
    for (int c = 0; c < 3; c++) {
        origin[c] = (float)(p[c] + (double)lift * facet[c] / length);
    }
    for (int k = 0; k < 3; k++) {
        const float *n = body->corner_normal[triangle][k];
        double above = 0.0;
        for (int c = 0; c < 3; c++) {
            above += (p[c] - (double)corner[k][c]) * (double)n[c];
        }
        for (int c = 0; c < 3; c++) {
            origin[c] -= (float)(fmin(above, 0.0) * share[k] * (double)n[c]);
        }
    }
}

/* ---- truths ---- */

typedef struct truth_job {
    const parian_body *body;
    const parian_light *light;
    parian_casters casters;
    float lift;
    uint32_t step;
    double *truth; /* [texel_count] of the first channel; of every step-th */
} truth_job;

/* E by light of unit radiance over a solid angle, from a place (near) or a direction. One ray in
 * CHECK_STEP is cast against every triangle too. */
static double arriving(const truth_job *job, texel_area *area, const double source[3], bool near,
                       double solid_angle)
{
    const float *n = job->body->texel_normal[area->texel],
                *p = job->body->texel_position[area->texel];
    double direction[3], toward[3], length, cosine = 0.0;
    float origin[3], along[3], far = near ? 0.99999f : 1e30f;
    for (int c = 0; c < 3; c++) {
        toward[c] = source[c] - (near ? (double)p[c] : 0.0);
    }
    length = sqrt(parian_dot3(toward, toward));
    for (int c = 0; c < 3; c++) {
        cosine += toward[c] / length * (double)n[c];
    }
    if (cosine <= 0.0) {
        return 0.0;
    }
    next_origin(area, job->lift, origin);
    for (int c = 0; c < 3; c++) {
        direction[c] = source[c] - (near ? (double)origin[c] : 0.0);
        along[c] = (float)direction[c];
    }
    bool hidden = parian_cpu_occluded(&job->casters, 0, 1, origin, origin, along, far);
    if (area->drawn % CHECK_STEP == 0) {
        assert_int_equal(hidden, ray_hits(job->body, origin, direction, near ? 0.99999 : 1e30));
    }
    return hidden ? 0.0 : cosine * parian_fresnel_transmittance(cosine, 1.5) * solid_angle;
}

/* Middles of RECT_SIDE x RECT_SIDE pieces, each from another point of the texel. */
static double rect_truth(const truth_job *job, texel_area *area)
{
    const parian_light *light = job->light;
    const float *u = light->axis_u, *v = light->axis_v;
    const double a[3] = {u[0], u[1], u[2]}, b[3] = {v[0], v[1], v[2]};
    double across[3], sum = 0.0;
    parian_cross3(a, b, across);
    for (int i = 0; i < RECT_SIDE * RECT_SIDE; i++) {
        double x = 2.0 * (i % RECT_SIDE + 0.5) / RECT_SIDE - 1.0, toward[3];
        double y = 2.0 * (i / RECT_SIDE + 0.5) / RECT_SIDE - 1.0, place[3];
        for (int c = 0; c < 3; c++) {
            place[c] = (double)light->position[c] + x * a[c] + y * b[c];
            toward[c] = place[c] - (double)job->body->texel_position[area->texel][c];
        }
        double d2 = parian_dot3(toward, toward);
        double facing = -parian_dot3(toward, across) / sqrt(d2); /* area / 4 x cosine */
        double piece = 4.0 * fmax(facing, 0.0) / (RECT_SIDE * RECT_SIDE) / d2;
        sum += arriving(job, area, place, true, piece) * (double)light->color[0];
    }
    return sum;
}

/* Middles of side x side parts of a pixel. */
static double pixel_truth(const truth_job *job, texel_area *area, uint32_t pixel, uint32_t side)
{
    const parian_light_image *image = &job->light->image;
    const uint32_t width = side * image->width, height = side * image->height;
    double sum = 0.0;
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = side * (pixel % image->width) + i % side;
        uint32_t y = side * (pixel / image->width) + i / side;
        double phi = ((x + 0.5) / width - 0.5) * 2.0 * PARIAN_PI;
        double theta = (y + 0.5) / height * PARIAN_PI;
        const double toward[3] = {sin(theta) * sin(phi), cos(theta), -sin(theta) * cos(phi)};
        double piece = 2.0 * sin(theta) * sin(0.5 * PARIAN_PI / height) * (2.0 * PARIAN_PI / width);
        sum += arriving(job, area, toward, false, piece);
    }
    return sum * (double)job->light->color[0] * (double)image->pixel[pixel][0];
}

static double sky_truth(const truth_job *job, texel_area *area)
{
    const parian_light_image *image = &job->light->image;
    double sum = 0.0;
    for (uint32_t i = 0; i < image->width * image->height; i++) {
        sum += pixel_truth(job, area, i, image->pixel[i][0] > 10.0f ? SUN_SIDE : SKY_SIDE);
    }
    return sum;
}

static double directional_truth(const truth_job *job, texel_area *area)
{
    const float *d = job->light->direction;
    const double length = sqrt((double)(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    const double toward[3] = {-(double)d[0] / length, -(double)d[1] / length,
                              -(double)d[2] / length};
    double sum = 0.0;
    for (int i = 0; i < DIRECTIONAL_RAYS; i++) {
        sum += arriving(job, area, toward, false, 1.0 / DIRECTIONAL_RAYS);
    }
    return sum * (double)job->light->color[0];
}

static void find_truth(void *context, size_t index)
{
    const truth_job *job = context;
    uint32_t t = job->step * (uint32_t)index;
    texel_area area;
    find_triangles(job->body, t, &area);
    job->truth[t] = job->light->type == PARIAN_LIGHT_RECT          ? rect_truth(job, &area)
                    : job->light->type == PARIAN_LIGHT_ENVIRONMENT ? sky_truth(job, &area)
                                                                   : directional_truth(job, &area);
}

/* ---- errors ---- */

/* Root of the mean square difference, over the root of the mean square. */
static double error_of(const parian_scene *scene, parian_renderer *renderer, const truth_job *job,
                       double *energy)
{
    const parian_env *env = test_env(0);
    const parian_body *body = &scene->data.bodies[0];
    parian_texel_arrays arrays = {0};
    double off = 0.0, whole = 0.0, sum = 0.0, want = 0.0;
    assert_true(PARIAN_NEW0(env, arrays.irradiance, body->texel_count));
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    for (uint32_t t = 0; t < body->texel_count; t += job->step) {
        double e = (double)arrays.irradiance[t][0], area = (double)body->texel_area[t];
        off += area * (e - job->truth[t]) * (e - job->truth[t]);
        whole += area * job->truth[t] * job->truth[t];
        sum += area * e;
        want += area * job->truth[t];
    }
    parian_free(env, arrays.irradiance);
    *energy = sum / want - 1.0;
    return sqrt(off / whole);
}

static parian_scene *make_figure(const parian_env *env)
{
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = 4};
    assert_int_equal(test_figure(env, (double)RADIUS, 8, &mesh), PARIAN_OK);
    return lit_scene(env, &mesh, &desc);
}

/* E after 1, 4, 16 and 64 sets. The first set is a quadrature of its own, the others random points:
 * from 4 sets to 64 their error must fall about as sets^-0.5 (to a quarter; 0.3 allows for luck),
 * or be below what the truth's own rays leave; and end below that of the first set. */
static void converge(const parian_light *light, uint32_t step, double first_max, double last_max)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = make_figure(env);
    const parian_body *body = &scene->data.bodies[0];
    parian_renderer *renderer = lit_cpu(env, scene, 64);
    truth_job job = {.body = body, .light = light, .step = step};
    double error[ROUND_COUNT], energy[ROUND_COUNT];
    assert_true(PARIAN_NEW0(env, job.truth, body->texel_count));
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        for (int c = 0; c < 3; c++) {
            job.lift = fmaxf(job.lift, 2e-6f * fabsf(body->vertex_position[v][c]));
        }
    }
    assert_int_equal(parian_renderer_set_lights(renderer, light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_relight(renderer), PARIAN_OK);
    job.casters = (parian_casters){&renderer->tree, renderer->caster, renderer->caster_count};
    parian_par(env, (body->texel_count + step - 1) / step, find_truth, &job);
    for (uint32_t round = 0, sets = 1; sets <= SET_COUNT; sets *= 4, round++) {
        while (parian_renderer_set_count(renderer) < sets) {
            assert_int_equal(parian_renderer_refine(renderer), PARIAN_OK);
        }
        error[round] = error_of(scene, renderer, &job, &energy[round]);
        print_message("light type %d, %2u sets: error %.5f, energy %+.5f\n", (int)light->type, sets,
                      error[round], energy[round]);
    }
    assert_true(error[3] < fmax(0.3 * error[1], 4e-4));
    assert_true(error[0] < first_max && error[2] < 0.01 && error[3] < last_max);
    assert_true(fabs(energy[ROUND_COUNT - 1]) < 0.001);
    parian_free(env, job.truth);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static void test_directional(void **state)
{
    const parian_light light = {
        .type = PARIAN_LIGHT_DIRECTIONAL, .direction = {-1, -1, -0.5f}, .color = {1, 1, 1}};
    converge(&light, 13, 0.003, 0.0005);
    (void)state;
}

static void test_rect(void **state)
{
    const parian_light light = {.type = PARIAN_LIGHT_RECT,
                                .position = {0.01f, 0.02f, 0.06f},
                                .axis_u = {0, 0.02f, 0},
                                .axis_v = {0.02f, 0, 0},
                                .color = {5, 5, 5}};
    converge(&light, 93, 0.005, 0.002);
    (void)state;
}

/* A coloured sky with a sun of a few pixels that brings a third of the light. */
static void test_sky(void **state)
{
    static float pixel[SKY_WIDTH * SKY_HEIGHT][3];
    for (int i = 0; i < SKY_WIDTH * SKY_HEIGHT; i++) {
        int x = i % SKY_WIDTH, y = i / SKY_WIDTH;
        bool sun = x >= 20 && x < 22 && y >= 4 && y < 6;
        float up = 1.0f - (float)y / SKY_HEIGHT;
        pixel[i][0] = 0.35f + 0.8f * up + 0.3f * sinf(0.2f * (float)x) + (sun ? 50.0f : 0.0f);
        pixel[i][1] = 0.3f + up + (sun ? 40.0f : 0.0f);
        pixel[i][2] = 0.5f + 1.5f * up + (sun ? 30.0f : 0.0f);
    }
    const parian_light light = {.type = PARIAN_LIGHT_ENVIRONMENT,
                                .color = {1, 1, 1},
                                .image = {SKY_WIDTH, SKY_HEIGHT, (const float(*)[3])pixel}};
    converge(&light, 61, 0.015, 0.004);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_directional),
        cmocka_unit_test(test_rect),
        cmocka_unit_test(test_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
