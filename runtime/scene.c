/* scene.c - an asset in memory, with its counts and bounds.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scene_internal.h"

#include <math.h>
#include <string.h>

#include "core/body_file.h"
#include "core/memory.h"

static void grow(float lower[3], float upper[3], const float (*position)[3], uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            lower[c] = fminf(lower[c], position[i][c]);
            upper[c] = fmaxf(upper[c], position[i][c]);
        }
    }
}

static void start_bounds(float lower[3], float upper[3])
{
    for (int c = 0; c < 3; c++) {
        lower[c] = INFINITY;
        upper[c] = -INFINITY;
    }
}

static void clear_empty(float lower[3], float upper[3])
{
    if (!(lower[0] <= upper[0])) {
        memset(lower, 0, 3 * sizeof *lower);
        memset(upper, 0, 3 * sizeof *upper);
    }
}

static parian_scene_info summarise(const parian_scene_data *data)
{
    parian_scene_info info = {.body_count = data->body_count,
                              .surrounding_count = data->surrounding_count,
                              .lights_json = data->lights_json};
    start_bounds(info.body_lower, info.body_upper);
    for (uint32_t b = 0; b < data->body_count; b++) {
        const parian_body *body = &data->bodies[b];
        info.texel_count += body->texel_count;
        info.vertex_count += body->vertex_count;
        grow(info.body_lower, info.body_upper, (const float(*)[3])body->vertex_position,
             body->vertex_count);
    }
    memcpy(info.lower, info.body_lower, sizeof info.lower);
    memcpy(info.upper, info.body_upper, sizeof info.upper);
    for (uint32_t s = 0; s < data->surrounding_count; s++) {
        const parian_surrounding *piece = &data->surroundings[s];
        grow(info.lower, info.upper, (const float(*)[3])piece->vertex_position,
             piece->vertex_count);
    }
    clear_empty(info.body_lower, info.body_upper);
    clear_empty(info.lower, info.upper);
    return info;
}

parian_result parian_scene_adopt(const parian_env *env, parian_scene_data *data,
                                 parian_scene **scene)
{
    parian_scene *made;
    if (!PARIAN_NEW0(env, made, 1)) {
        parian_scene_data_free(env, data);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a scene");
    }
    if (env) {
        made->env = *env;
    }
    made->data = *data;
    memset(data, 0, sizeof *data);
    made->info = summarise(&made->data);
    *scene = made;
    return PARIAN_OK;
}

parian_result parian_scene_open(const parian_env *env, const char *path, parian_scene **scene)
{
    parian_reader *reader = NULL;
    parian_scene_data data = {0};
    if (!path || !scene) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "a scene needs a path and a place to go");
    }
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result != PARIAN_OK) {
        return result;
    }
    result = parian_scene_data_read(env, reader, &data);
    parian_reader_close(reader);
    return result == PARIAN_OK ? parian_scene_adopt(env, &data, scene) : result;
}

void parian_scene_close(parian_scene *scene)
{
    if (scene) {
        parian_env env = scene->env;
        parian_scene_data_free(&env, &scene->data);
        parian_free(&env, scene);
    }
}

parian_scene_body parian_scene_get_body(const parian_scene *scene, uint32_t index)
{
    if (index >= scene->data.body_count) {
        return (parian_scene_body){0};
    }
    const parian_body *body = &scene->data.bodies[index];
    parian_scene_body out = {.name = body->name,
                             .medium_name = body->medium.name,
                             .eta = body->medium.eta,
                             .atlas_size = body->atlas_size,
                             .chart_count = body->chart_count,
                             .texel_count = body->texel_count,
                             .vertex_count = body->vertex_count,
                             .triangle_count = body->triangle_count,
                             .has_local = body->local_form != PARIAN_LOCAL_NONE,
                             .has_global = body->has_global,
                             .vertex_position = (const float(*)[3])body->vertex_position,
                             .triangle = (const uint32_t(*)[3])body->triangle,
                             .corner_normal = (const float(*)[3][3])body->corner_normal,
                             .corner_uv = (const float(*)[3][2])body->corner_uv,
                             .triangle_chart = body->triangle_chart,
                             .texel_index = body->texel_index,
                             .texel_albedo = (const float(*)[3])body->texel_albedo,
                             .texel_normal_map = (const float(*)[3])body->texel_normal_map};
    for (int c = 0; c < 3; c++) {
        out.sigma_s_prime[c] = body->medium.sigma_s_prime[c];
        out.sigma_a[c] = body->medium.sigma_a[c];
    }
    for (uint32_t o = 0; o < body->operator_count; o++) {
        out.factor_count += body->operators[o].factor_total;
    }
    return out;
}

parian_scene_info parian_scene_get_info(const parian_scene *scene)
{
    return scene->info;
}
