/* cpu_lights.c - light that arrives at a point, and shadows: the C evaluation of
 * shaders/lights.glsl.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_lights.h"

#include <string.h>

#include "core/memory.h"
#include "cpu/cpu_raster.h"
#include "lights/light_image.h"
#include "vec3.h"

/* ---- shadow maps ---- */

typedef struct shadow_target {
    float row[4][4]; /* of the layer, for points before they are placed */
    const float (*position)[3];
    const uint32_t (*triangle)[3];
    float *depth;
} shadow_target;

static void shadow_fragment(void *context, uint32_t pixel, uint32_t triangle, const float share[3])
{
    const shadow_target *target = context;
    const float *row = target->row[2];
    float sum = share[0] + share[1] + share[2], depth = 0.0f;
    for (int k = 0; k < 3; k++) {
        const float *p = target->position[target->triangle[triangle][k]];
        depth += share[k] * (vec3_dot(row, p) + row[3]);
    }
    depth /= sum;
    if (depth >= 0.0f && depth < target->depth[pixel]) {
        target->depth[pixel] = depth;
    }
}

/* A mesh and where it stands. */
typedef struct caster {
    const float (*position)[3];
    const uint32_t (*triangle)[3];
    uint32_t count;
    const parian_placement *at; /* NULL: where the file has it */
} caster;

static parian_result draw_caster(const parian_env *env, uint32_t size,
                                 const parian_shadow_layer *layer, const caster *what, float *depth)
{
    shadow_target target = {.position = what->position, .triangle = what->triangle, .depth = depth};
    for (int r = 0; r < 4; r++) {
        if (what->at) {
            placement_fold(what->at, layer->row[r], target.row[r]);
        } else {
            memcpy(target.row[r], layer->row[r], sizeof target.row[r]);
        }
    }
    parian_raster_desc desc = {.width = size,
                               .height = size,
                               .triangle_count = what->count,
                               .triangle = what->triangle,
                               .position = what->position,
                               .near_w = layer->perspective ? layer->near_m : 0.0f,
                               .fragment = shadow_fragment,
                               .context = &target};
    for (int k = 0; k < 4; k++) {
        desc.row_x[k] = target.row[0][k];
        desc.row_y[k] = -target.row[1][k]; /* shadow maps keep row 0 at y = -1, as GL does */
        desc.row_w[k] = target.row[3][k];
    }
    return parian_raster_run(env, &desc);
}

static parian_result draw_bodies(const parian_env *env, const parian_scene_data *scene,
                                 const parian_placement *at, uint32_t size,
                                 const parian_shadow_layer *layer, float *depth)
{
    parian_result result = PARIAN_OK;
    for (uint32_t b = 0; result == PARIAN_OK && b < scene->body_count; b++) {
        const parian_body *body = &scene->bodies[b];
        const caster what = {(const float(*)[3])body->vertex_position,
                             (const uint32_t(*)[3])body->triangle, body->triangle_count, at};
        result = draw_caster(env, size, layer, &what, depth);
    }
    return result;
}

static parian_result draw_surroundings(const parian_env *env, const parian_scene_data *scene,
                                       uint32_t size, const parian_shadow_layer *layer,
                                       float *depth)
{
    parian_result result = PARIAN_OK;
    for (uint32_t s = 0; result == PARIAN_OK && s < scene->surrounding_count; s++) {
        const parian_surrounding *piece = &scene->surroundings[s];
        const caster what = {(const float(*)[3])piece->vertex_position,
                             (const uint32_t(*)[3])piece->triangle, piece->triangle_count, NULL};
        result = draw_caster(env, size, layer, &what, depth);
    }
    return result;
}

parian_result parian_cpu_shadow(const parian_env *env, const parian_scene_data *scene,
                                const parian_placement *instances, uint32_t instance_count,
                                parian_cpu_lights *lights)
{
    const parian_light_list *list = lights->list;
    size_t area = (size_t)list->shadow_size * list->shadow_size;
    parian_result result = PARIAN_OK;
    parian_free(env, lights->depth);
    if (!PARIAN_NEW(env, lights->depth, area * list->layer_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u shadow maps of %u texels a side",
                           list->layer_count, list->shadow_size);
    }
    for (size_t i = 0; i < area * list->layer_count; i++) {
        lights->depth[i] = 1.0f;
    }
    for (uint32_t l = 0; result == PARIAN_OK && l < list->layer_count; l++) {
        const parian_shadow_layer *layer = &list->layer[l];
        float *depth = lights->depth + l * area;
        for (uint32_t i = 0; result == PARIAN_OK && i < instance_count; i++) {
            result = draw_bodies(env, scene, &instances[i], list->shadow_size, layer, depth);
        }
        if (result == PARIAN_OK) {
            result = draw_surroundings(env, scene, list->shadow_size, layer, depth);
        }
    }
    return result;
}

static float row_at(const float row[4], const float p[3])
{
    return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
}

/* Light that passes one map; false where the point does not fall on it. */
static bool look_up_layer(const parian_cpu_lights *lights, uint32_t index, const float p[3],
                          const float n[3], float scale, float *lit)
{
    const parian_shadow_layer *layer = &lights->list->layer[index];
    const float size = (float)lights->list->shadow_size;
    float w = row_at(layer->row[3], p), q[3];
    if (w <= 0.0f) {
        return false;
    }
    float texel = layer->texel_scale * w;
    vec3_copy(q, p);
    vec3_add_scaled(q, n, 1.5f * texel + scale * lights->lift);
    w = row_at(layer->row[3], q);
    if (layer->perspective && w <= layer->near_m) {
        return false;
    }
    float x = (row_at(layer->row[0], q) / w * 0.5f + 0.5f) * size - 0.5f;
    float y = (row_at(layer->row[1], q) / w * 0.5f + 0.5f) * size - 0.5f;
    if (!(x >= 0.0f && y >= 0.0f && x < size - 1.0f && y < size - 1.0f)) {
        return false;
    }
    float depth = row_at(layer->row[2], q) - 0.5f * texel / (layer->far_m - layer->near_m);
    float x0 = floorf(x), y0 = floorf(y), fx = x - x0, fy = y - y0;
    uint32_t side = lights->list->shadow_size;
    const float *map = lights->depth + ((size_t)index * side + (uint32_t)y0) * side + (uint32_t)x0;
    float a = depth <= map[0] ? 1.0f : 0.0f, b = depth <= map[1] ? 1.0f : 0.0f;
    float c = depth <= map[side] ? 1.0f : 0.0f, d = depth <= map[side + 1] ? 1.0f : 0.0f;
    *lit = (a * (1.0f - fx) + b * fx) * (1.0f - fy) + (c * (1.0f - fx) + d * fx) * fy;
    return true;
}

float parian_cpu_visibility(const parian_cpu_lights *lights, const parian_light_sample *sample,
                            const float p[3], const float n[3], float scale)
{
    float lit = 1.0f;
    for (uint32_t k = 0; k < sample->layer_count; k++) {
        if (look_up_layer(lights, sample->layer_first + k, p, n, scale, &lit)) {
            return lit;
        }
    }
    return 1.0f;
}

/* ---- light at a point ---- */

/* Bilinear look-up in one level, black outside. */
static void image_level(const parian_light_list *list, const parian_light_sample *sample,
                        uint32_t level, float s, float t, float rgb[3])
{
    uint32_t offset = sample->image_offset;
    for (uint32_t l = 0; l < level; l++) {
        offset += parian_image_level_side(sample->image_width, l) *
                  parian_image_level_side(sample->image_height, l);
    }
    int w = (int)parian_image_level_side(sample->image_width, level);
    int h = (int)parian_image_level_side(sample->image_height, level);
    float x = s * (float)w - 0.5f, y = t * (float)h - 0.5f;
    float x0 = floorf(x), y0 = floorf(y);
    vec3_set(rgb, 0.0f);
    for (int k = 0; k < 4; k++) {
        int ix = (int)x0 + (k & 1), iy = (int)y0 + (k >> 1);
        float weight = (k & 1 ? x - x0 : 1.0f - (x - x0)) * (k >> 1 ? y - y0 : 1.0f - (y - y0));
        if (ix >= 0 && iy >= 0 && ix < w && iy < h) {
            vec3_add_scaled(rgb, list->image[offset + (uint32_t)(iy * w + ix)], weight);
        }
    }
}

/* The projected picture at a point, filtered over `extent`. */
static void image_at(const parian_light_list *list, const parian_light_sample *sample,
                     const float away[3], float extent, float rgb[3])
{
    float z = vec3_dot(away, sample->direction), reach = z * sample->tan_outer;
    vec3_set(rgb, 0.0f);
    if (!(reach > 0.0f)) {
        return;
    }
    float s = 0.5f + 0.5f * vec3_dot(away, sample->right) / reach;
    float t = 0.5f - 0.5f * vec3_dot(away, sample->up) / reach;
    if (!(s > -1.0f && s < 2.0f && t > -1.0f && t < 2.0f)) {
        return;
    }
    float pixel = 2.0f * reach / (float)sample->image_width, coarse[3];
    float level = log2f(fmaxf(extent / pixel, 1.0f));
    level = fminf(level, (float)(sample->image_levels - 1));
    uint32_t fine = (uint32_t)level;
    float blend = level - (float)fine;
    image_level(list, sample, fine, s, t, rgb);
    if (blend > 0.0f) {
        image_level(list, sample, fine + 1, s, t, coarse);
        vec3_scale(rgb, 1.0f - blend);
        vec3_add_scaled(rgb, coarse, blend);
    }
}

void parian_cpu_light_at(const parian_light_list *list, const parian_light_sample *sample,
                         const float p[3], float extent, float to_light[3], float irradiance[3])
{
    vec3_copy(irradiance, sample->color);
    if (sample->kind == PARIAN_SAMPLE_DIRECTIONAL || sample->kind == PARIAN_SAMPLE_PROBE) {
        vec3_copy(to_light, sample->direction);
        vec3_scale(to_light, -1.0f);
        return;
    }
    float away[3];
    vec3_sub(away, p, sample->position);
    vec3_copy(to_light, away);
    vec3_scale(to_light, -1.0f);
    float distance = vec3_normalize(to_light);
    float attenuation = 1.0f / fmaxf(distance * distance, extent * extent / (float)M_PI);
    float cosine = -vec3_dot(to_light, sample->direction);
    if (sample->kind == PARIAN_SAMPLE_PATCH) {
        attenuation *= fmaxf(cosine, 0.0f);
    }
    if (sample->kind == PARIAN_SAMPLE_SPOT) {
        float ramp =
            (cosine - sample->cos_outer) / fmaxf(sample->cos_inner - sample->cos_outer, 1e-6f);
        ramp = fminf(fmaxf(ramp, 0.0f), 1.0f);
        attenuation *= ramp * ramp * (3.0f - 2.0f * ramp);
        if (sample->image_levels > 0 && attenuation > 0.0f) {
            float rgb[3];
            image_at(list, sample, away, extent, rgb);
            for (int c = 0; c < 3; c++) {
                irradiance[c] *= rgb[c];
            }
        }
    }
    vec3_scale(irradiance, attenuation);
}

/* ---- environment ---- */

static void evaluate_sh(const parian_light_list *list, const float direction[3],
                        const float zonal[3], float value[3])
{
    static const int band[PARIAN_SH_COUNT] = {0, 1, 1, 1, 2, 2, 2, 2, 2};
    float y[PARIAN_SH_COUNT];
    parian_sh_evaluate(direction, y);
    vec3_set(value, 0.0f);
    for (int k = 0; k < PARIAN_SH_COUNT; k++) {
        vec3_add_scaled(value, list->environment_sh[k], zonal[band[k]] * y[k]);
    }
    for (int c = 0; c < 3; c++) {
        value[c] = fmaxf(value[c], 0.0f);
    }
}

void parian_cpu_environment_radiance(const parian_light_list *list, const float direction[3],
                                     float radiance[3])
{
    const float one[3] = {1.0f, 1.0f, 1.0f};
    evaluate_sh(list, direction, one, radiance);
}

void parian_cpu_environment_open(const parian_light_list *list, const float n[3],
                                 const float zonal[3], const float open[3], const float whole[3],
                                 float irradiance[3])
{
    evaluate_sh(list, n, zonal, irradiance);
    for (int c = 0; c < 3; c++) {
        irradiance[c] *= whole[c] > 0.0f ? open[c] / whole[c] : 1.0f;
    }
}

void parian_cpu_environment(const parian_cpu_lights *lights, const float p[3], const float n[3],
                            const float zonal[3], float scale, float irradiance[3])
{
    const parian_light_list *list = lights->list;
    float open[3] = {0}, whole[3] = {0};
    for (uint32_t i = 0; i < list->sample_count; i++) {
        const parian_light_sample *sample = &list->sample[i];
        float cosine = -vec3_dot(n, sample->direction);
        if (sample->kind != PARIAN_SAMPLE_PROBE || cosine <= 0.0f) {
            continue;
        }
        vec3_add_scaled(whole, sample->color, cosine);
        vec3_add_scaled(open, sample->color,
                        cosine * parian_cpu_visibility(lights, sample, p, n, scale));
    }
    parian_cpu_environment_open(list, n, zonal, open, whole, irradiance);
}
