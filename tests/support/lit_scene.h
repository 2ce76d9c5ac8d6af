/* lit_scene.h - scenes and renderers of hand-made bodies, for the tests of the runtime.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_LIT_SCENE_H
#define PARIAN_TEST_LIT_SCENE_H

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "runtime/scene_internal.h"
#include "support/lit_body.h"
#include "support/test_support.h"

/* One body made of a mesh, which is freed. */
static inline parian_scene *lit_scene(const parian_env *env, parian_mesh *mesh,
                                      const test_lit_desc *desc)
{
    parian_scene_data data = {.body_count = 1};
    parian_scene *scene = NULL;
    data.bodies = parian_zalloc(env, 1, sizeof *data.bodies);
    assert_non_null(data.bodies);
    assert_int_equal(test_lit_body(env, mesh, desc, data.bodies), PARIAN_OK);
    parian_mesh_free(env, mesh);
    assert_int_equal(parian_scene_adopt(env, &data, &scene), PARIAN_OK);
    return scene;
}

static inline parian_scene *lit_sphere(const parian_env *env, float radius, unsigned cuts,
                                       uint32_t cut)
{
    parian_mesh mesh = {0};
    test_lit_desc desc = {.cut = cut, .form = PARIAN_LOCAL_NONE, .smooth_sphere = true};
    assert_int_equal(test_sphere(env, radius, cuts, &mesh), PARIAN_OK);
    assert_int_equal(parian_mesh_make_corner_normals(env, &mesh, 180.0), PARIAN_OK);
    return lit_scene(env, &mesh, &desc);
}

/* The C evaluation, with shadow maps of a side (0: the default). */
static inline parian_renderer *lit_cpu(const parian_env *env, const parian_scene *scene,
                                       uint32_t shadow_size)
{
    parian_renderer_desc desc = {.backend = PARIAN_BACKEND_CPU, .shadow_size = shadow_size};
    parian_renderer *renderer = NULL;
    assert_int_equal(parian_renderer_create(env, scene, &desc, &renderer), PARIAN_OK);
    return renderer;
}

/* E of every texel under one light; free with parian_free(env). */
static inline float (*lit_irradiance(const parian_env *env, const parian_scene *scene,
                                     parian_renderer *renderer, const parian_light *light))[3]
{
    parian_texel_arrays arrays = {0};
    arrays.irradiance = parian_alloc(env, scene->info.texel_count, sizeof *arrays.irradiance);
    assert_non_null(arrays.irradiance);
    assert_int_equal(parian_renderer_set_lights(renderer, light, 1), PARIAN_OK);
    assert_int_equal(parian_renderer_read_texels(renderer, &arrays), PARIAN_OK);
    return arrays.irradiance;
}

/* A camera at `eye` that looks at the origin, 40 degrees high, for pictures of width x height. */
static inline parian_camera lit_camera(const float eye[3], uint32_t width, uint32_t height)
{
    parian_camera camera = {{0}, {0}};
    float length = sqrtf(eye[0] * eye[0] + eye[1] * eye[1] + eye[2] * eye[2]);
    float back[3] = {eye[0] / length, eye[1] / length, eye[2] / length};
    float flat = sqrtf(back[0] * back[0] + back[2] * back[2]);
    float right[3] = {back[2] / flat, 0.0f, -back[0] / flat};
    float up[3] = {back[1] * right[2], back[2] * right[0] - back[0] * right[2],
                   -back[1] * right[0]};
    float near_m = 0.05f * length, far_m = 20.0f * length, focal = 1.0f / tanf(0.35f);
    for (int c = 0; c < 3; c++) {
        camera.view[4 * c] = right[c];
        camera.view[4 * c + 1] = up[c];
        camera.view[4 * c + 2] = back[c];
    }
    camera.view[14] = -length;
    camera.view[15] = 1.0f;
    camera.projection[0] = focal * (float)height / (float)width;
    camera.projection[5] = focal;
    camera.projection[10] = (far_m + near_m) / (near_m - far_m);
    camera.projection[11] = -1.0f;
    camera.projection[14] = 2.0f * far_m * near_m / (near_m - far_m);
    return camera;
}

#endif
