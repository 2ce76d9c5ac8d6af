/* test_refine.c - the mean of E over sets of samples against quadrature by cast rays: rectangles
 * and environments on a body that shadows itself, and texels that a shadow's edge crosses.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/fresnel.h"
#include "core/small_maths.h"
#include "method/ray_origins.h"
#include "runtime/renderer_internal.h"
#include "support/lit_scene.h"

static const float RADIUS = 0.02f;
enum { TEXEL_STEP = 31, QUADRATURE = 16, SKY_WIDTH = 32, SKY_HEIGHT = 16, SET_COUNT = 16 };

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

/* ---- truths at the centroid of a texel ---- */

typedef struct truth_job {
    const parian_body *body;
    const parian_light *light;
    const float (*origin)[3];
    double *truth; /* [texel_count] of the first channel; of every TEXEL_STEP-th */
} truth_job;

/* E by light of unit radiance over a solid angle, from a place (near) or a direction: cosine at the
 * centroid, the ray from where rays start. */
static double arriving(const truth_job *job, uint32_t t, const double source[3], bool near,
                       double solid_angle)
{
    const float *n = job->body->texel_normal[t], *p = job->body->texel_position[t];
    double direction[3], toward[3], length, cosine = 0.0;
    for (int c = 0; c < 3; c++) {
        toward[c] = source[c] - (near ? (double)p[c] : 0.0);
    }
    length = sqrt(parian_dot3(toward, toward));
    for (int c = 0; c < 3; c++) {
        direction[c] = toward[c] / length;
        cosine += direction[c] * (double)n[c];
    }
    for (int c = 0; near && c < 3; c++) {
        direction[c] += ((double)p[c] - (double)job->origin[t][c]) / length;
    }
    if (cosine <= 0.0 || ray_hits(job->body, job->origin[t], direction, near ? length : 1e9)) {
        return 0.0;
    }
    return cosine * parian_fresnel_transmittance(cosine, 1.5) * solid_angle;
}

/* Midpoints of QUADRATURE x QUADRATURE pieces. */
static double rect_truth(const truth_job *job, uint32_t t)
{
    const parian_light *light = job->light;
    const float *u = light->axis_u, *v = light->axis_v;
    const double a[3] = {u[0], u[1], u[2]}, b[3] = {v[0], v[1], v[2]};
    double across[3], sum = 0.0;
    parian_cross3(a, b, across);
    for (int i = 0; i < QUADRATURE * QUADRATURE; i++) {
        double x = 2.0 * (i % QUADRATURE + 0.5) / QUADRATURE - 1.0, toward[3];
        double y = 2.0 * (i / QUADRATURE + 0.5) / QUADRATURE - 1.0, place[3];
        for (int c = 0; c < 3; c++) {
            place[c] = (double)light->position[c] + x * a[c] + y * b[c];
            toward[c] = place[c] - (double)job->body->texel_position[t][c];
        }
        double d2 = parian_dot3(toward, toward);
        double facing = -parian_dot3(toward, across) / sqrt(d2); /* area / 4 x cosine */
        double piece = 4.0 * fmax(facing, 0.0) / (QUADRATURE * QUADRATURE) / d2;
        sum += arriving(job, t, place, true, piece) * (double)light->color[0];
    }
    return sum;
}

/* Midpoints of 2 x 2 parts of each pixel. */
static double sky_truth(const truth_job *job, uint32_t t)
{
    const parian_light_image *image = &job->light->image;
    double sum = 0.0;
    for (uint32_t i = 0; i < image->width * image->height * 4; i++) {
        uint32_t x = i % (2 * image->width), y = i / (2 * image->width);
        double phi = ((x + 0.5) / (2 * image->width) - 0.5) * 2.0 * PARIAN_PI;
        double theta = (y + 0.5) / (2 * image->height) * PARIAN_PI;
        const double toward[3] = {sin(theta) * sin(phi), cos(theta), -sin(theta) * cos(phi)};
        double piece =
            sin(theta) * (PARIAN_PI / (2 * image->height)) * (2.0 * PARIAN_PI / (2 * image->width));
        sum += arriving(job, t, toward, false, piece) * (double)job->light->color[0] *
               (double)image->pixel[y / 2 * image->width + x / 2][0];
    }
    return sum;
}

static void find_truth(void *context, size_t index)
{
    const truth_job *job = context;
    uint32_t t = TEXEL_STEP * (uint32_t)index;
    job->truth[t] = job->light->type == PARIAN_LIGHT_RECT ? rect_truth(job, t) : sky_truth(job, t);
}

/* ---- errors ---- */

/* Root of the mean square difference, over the root of the mean square. */
static double error_of(const parian_scene *scene, parian_renderer *renderer, const double *truth,
                       double *energy)
{
    const parian_env *env = test_env(0);
    const parian_body *body = &scene->data.bodies[0];
    parian_texel_arrays arrays = {0};
    double off = 0.0, whole = 0.0, sum = 0.0, want = 0.0;
    assert_true(PARIAN_NEW0(env, arrays.irradiance, body->texel_count));
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    for (uint32_t t = 0; t < body->texel_count; t += TEXEL_STEP) {
        double e = (double)arrays.irradiance[t][0], area = (double)body->texel_area[t];
        off += area * (e - truth[t]) * (e - truth[t]);
        whole += area * truth[t] * truth[t];
        sum += area * e;
        want += area * truth[t];
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

/* E of the first set and after SET_COUNT sets. Texels' points move with the sets, and the truth is
 * that of centroids: what is left at the end is the change of E over a texel. */
static void converge(const parian_light *light, double first_max, double last_max)
{
    const parian_env *env = test_env(0);
    parian_scene *scene = make_figure(env);
    const parian_body *body = &scene->data.bodies[0];
    parian_renderer *renderer = lit_cpu(env, scene, 64);
    float(*origin)[3] = NULL;
    truth_job job = {.body = body, .light = light};
    double energy[2];
    assert_true(PARIAN_NEW(env, origin, body->texel_count) &&
                PARIAN_NEW0(env, job.truth, body->texel_count));
    parian_ray_origins(env, body, NULL, 0, origin);
    job.origin = (const float(*)[3])origin;
    parian_par(env, (body->texel_count + TEXEL_STEP - 1) / TEXEL_STEP, find_truth, &job);
    assert_int_equal(parian_renderer_set_lights(renderer, light, 1), PARIAN_OK);
    double first = error_of(scene, renderer, job.truth, &energy[0]);
    while (parian_renderer_set_count(renderer) < SET_COUNT) {
        assert_int_equal(parian_renderer_refine(renderer), PARIAN_OK);
    }
    double last = error_of(scene, renderer, job.truth, &energy[1]);
    print_message("light type %d: error %.4f, after %d sets %.4f; energy %+.4f, %+.4f\n",
                  (int)light->type, first, SET_COUNT, last, energy[0], energy[1]);
    assert_true(first < first_max && last < last_max);
    assert_true(fabs(energy[1]) < 0.003);
    parian_free(env, origin);
    parian_free(env, job.truth);
    parian_renderer_destroy(renderer);
    parian_scene_close(scene);
}

static void test_rect(void **state)
{
    const parian_light light = {.type = PARIAN_LIGHT_RECT,
                                .position = {0.01f, 0.02f, 0.06f},
                                .axis_u = {0, 0.02f, 0},
                                .axis_v = {0.02f, 0, 0},
                                .color = {5, 5, 5}};
    converge(&light, 0.03, 0.01);
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
    converge(&light, 0.03, 0.02);
    (void)state;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rect),
        cmocka_unit_test(test_sky),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
