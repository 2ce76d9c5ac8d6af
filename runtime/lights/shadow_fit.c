/* shadow_fit.c - places shadow maps: projections that cover the bodies, and everything, from each
 * light.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "lights/light_list.h"
#include "vec3.h"

enum { LAYERS_PER_SAMPLE_MAX = 12, LAYER_TOTAL_MAX = 256, SHADOW_SIZE_MIN = 256 };

typedef struct fit_scene {
    const float *lower, *upper; /* box of what casts shadows */
    uint32_t size;
    float extent; /* diagonal of the box */
} fit_scene;

static void set_row(float row[4], const float axis[3], const float origin[3], float scale,
                    float shift)
{
    vec3_copy(row, axis);
    vec3_scale(row, scale);
    row[3] = shift - vec3_dot(axis, origin) * scale;
}

/* Smallest and largest distance of the box along an axis from an origin. */
static void box_range(const fit_scene *scene, const float axis[3], const float origin[3],
                      float *least, float *most)
{
    *least = 1e30f;
    *most = -1e30f;
    for (int k = 0; k < 8; k++) {
        float corner[3];
        for (int c = 0; c < 3; c++) {
            corner[c] = (k >> c & 1 ? scene->upper[c] : scene->lower[c]) - origin[c];
        }
        float t = vec3_dot(axis, corner);
        *least = fminf(*least, t);
        *most = fmaxf(*most, t);
    }
}

/* Parallel light: a square that holds the ball. */
static void fit_parallel(const fit_scene *scene, const float direction[3], const parian_ball *ball,
                         parian_shadow_layer *layer)
{
    const float up[3] = {0.0f, 1.0f, 0.0f};
    float u[3], v[3], least, most;
    vec3_frame(direction, up, u, v);
    float half = ball->radius * (1.0f + 8.0f / (float)scene->size);
    box_range(scene, direction, ball->center, &least, &most);
    least -= 1e-3f * scene->extent;
    most += 1e-3f * scene->extent;
    set_row(layer->row[0], u, ball->center, 1.0f / half, 0.0f);
    set_row(layer->row[1], v, ball->center, 1.0f / half, 0.0f);
    set_row(layer->row[2], direction, ball->center, 1.0f / (most - least), -least / (most - least));
    const float one[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    memcpy(layer->row[3], one, sizeof one);
    layer->texel_scale = 2.0f * half / (float)scene->size;
    layer->near_m = 0.0f;
    layer->far_m = most - least;
    layer->perspective = false;
}

/* A pyramid from a position along `forward` whose half opening has the tangent `tangent`. */
static void fit_pyramid(const fit_scene *scene, const float position[3], const float forward[3],
                        const float near_up[3], float tangent, parian_shadow_layer *layer)
{
    float u[3], v[3], least, most;
    vec3_frame(forward, near_up, u, v);
    box_range(scene, forward, position, &least, &most);
    float near_m = 2e-4f * scene->extent;
    float far_m = fmaxf(most, 0.0f) + 1e-2f * scene->extent + near_m;
    tangent *= 1.0f + 8.0f / (float)scene->size;
    set_row(layer->row[0], u, position, 1.0f / tangent, 0.0f);
    set_row(layer->row[1], v, position, 1.0f / tangent, 0.0f);
    set_row(layer->row[2], forward, position, 1.0f / (far_m - near_m), -near_m / (far_m - near_m));
    set_row(layer->row[3], forward, position, 1.0f, 0.0f);
    layer->texel_scale = 2.0f * tangent / (float)scene->size;
    layer->near_m = near_m;
    layer->far_m = far_m;
    layer->perspective = true;
}

static uint32_t fit_cube(const fit_scene *scene, const float position[3],
                         parian_shadow_layer *layers)
{
    for (int face = 0; face < 6; face++) {
        float forward[3] = {0}, up[3] = {0};
        forward[face / 2] = face % 2 ? -1.0f : 1.0f;
        up[(face / 2 + 1) % 3] = 1.0f;
        fit_pyramid(scene, position, forward, up, 1.0f, &layers[face]);
    }
    return 6;
}

/* Light from a position on a ball: one pyramid from outside, a cube of six from inside. A cone that
 * is narrower than the ball (cos_outer, 0 for none) is covered itself. */
static uint32_t fit_ball(const fit_scene *scene, const parian_light_sample *sample,
                         const parian_ball *ball, parian_shadow_layer *layers)
{
    const float up[3] = {0.0f, 1.0f, 0.0f};
    float forward[3];
    vec3_sub(forward, ball->center, sample->position);
    float distance = vec3_normalize(forward);
    bool outside = distance > 1.2f * ball->radius;
    float tangent = 0.0f;
    if (outside) {
        tangent = ball->radius / sqrtf(distance * distance - ball->radius * ball->radius);
    }
    bool narrow =
        sample->kind == PARIAN_SAMPLE_SPOT && sample->tan_outer < (outside ? tangent : 4.0f);
    if (narrow) {
        fit_pyramid(scene, sample->position, sample->direction, up, sample->tan_outer, layers);
        return 1;
    }
    if (outside) {
        fit_pyramid(scene, sample->position, forward, up, tangent, layers);
        return 1;
    }
    return fit_cube(scene, sample->position, layers);
}

static uint32_t fit_sample(const fit_scene *scene, const parian_light_sample *sample,
                           const parian_ball *bodies, const parian_ball *everything,
                           parian_shadow_layer *layers)
{
    if (sample->kind == PARIAN_SAMPLE_PROBE && !everything) {
        return 0;
    }
    if (sample->kind == PARIAN_SAMPLE_DIRECTIONAL || sample->kind == PARIAN_SAMPLE_PROBE) {
        fit_parallel(scene, sample->direction, bodies, layers);
        if (!everything) {
            return 1;
        }
        fit_parallel(scene, sample->direction, everything, layers + 1);
        return 2;
    }
    uint32_t count = fit_ball(scene, sample, bodies, layers);
    if (everything && count == 1) {
        count += fit_ball(scene, sample, everything, layers + count);
    }
    return count;
}

/* The largest side, halved until all layers fit into the memory they may take. */
static uint32_t choose_size(uint32_t wanted, uint32_t layers, uint64_t memory_max)
{
    uint32_t size = wanted;
    while (size > SHADOW_SIZE_MIN && (uint64_t)size * size * 4 * layers > memory_max) {
        size /= 2;
    }
    return size;
}

static uint32_t fit_all(parian_light_list *list, const fit_scene *scene, const parian_ball *bodies,
                        const parian_ball *everything)
{
    uint32_t total = 0;
    for (uint32_t i = 0; i < list->sample_count; i++) {
        parian_light_sample *sample = &list->sample[i];
        sample->layer_first = total;
        sample->layer_count = fit_sample(scene, sample, bodies, everything, list->layer + total);
        total += sample->layer_count;
    }
    return total;
}

parian_result parian_shadow_fit(const parian_env *env, parian_light_list *list,
                                uint32_t shadow_size, uint64_t memory_max,
                                const parian_ball *bodies, const parian_ball *everything,
                                bool has_surroundings, const float lower[3], const float upper[3])
{
    float diagonal[3];
    vec3_sub(diagonal, upper, lower);
    fit_scene scene = {lower, upper, shadow_size, vec3_length(diagonal)};
    const parian_ball *second = has_surroundings ? everything : NULL;
    parian_shadow_layer *layer;
    if (!PARIAN_NEW0(env, layer, (size_t)list->sample_count * LAYERS_PER_SAMPLE_MAX)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for shadow maps of %u light samples",
                           list->sample_count);
    }
    parian_free(env, list->layer);
    list->layer = layer;
    uint32_t total = fit_all(list, &scene, bodies, second);
    if (total > LAYER_TOTAL_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "lights need %u shadow maps, at most %d are possible", total,
                           LAYER_TOTAL_MAX);
    }
    scene.size = choose_size(shadow_size, total, memory_max);
    list->layer_count = fit_all(list, &scene, bodies, second);
    list->shadow_size = scene.size;
    return PARIAN_OK;
}
