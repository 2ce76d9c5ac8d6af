/* renderer_instances.c - where copies of the scene stand: checks their transforms, finds their
 * bounds.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "renderer_internal.h"
#include "vec3.h"

static const float identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
static const float shape_tolerance = 1e-3f; /* of lengths and angles of the axes */
static const float scale_min = 1e-6f, scale_max = 1e6f, reach_max = 1e9f;

/* ---- transforms ---- */

/* What is wrong with a transform, or NULL; scale: its scale. */
static const char *find_fault(const float m[16], float *scale)
{
    float cross[3], length[3];
    for (int k = 0; k < 16; k++) {
        if (!isfinite(m[k])) {
            return "is not finite";
        }
    }
    if (m[3] != 0.0f || m[7] != 0.0f || m[11] != 0.0f || m[15] != 1.0f) {
        return "has a last row other than 0 0 0 1";
    }
    for (int k = 0; k < 3; k++) {
        length[k] = vec3_length(&m[4 * k]);
        if (!(length[k] >= scale_min && length[k] <= scale_max)) {
            return "scales by less than 1e-6 or more than 1e6";
        }
    }
    *scale = (length[0] + length[1] + length[2]) / 3.0f;
    for (int k = 0; k < 3; k++) {
        float between = vec3_dot(&m[4 * k], &m[4 * ((k + 1) % 3)]) / (*scale * *scale);
        if (fabsf(length[k] / *scale - 1.0f) > shape_tolerance) {
            return "scales its axes differently";
        }
        if (fabsf(between) > shape_tolerance) {
            return "shears";
        }
    }
    vec3_cross(cross, &m[0], &m[4]);
    if (vec3_dot(cross, &m[8]) < 0.0f) {
        return "mirrors";
    }
    return vec3_length(&m[12]) > reach_max ? "moves farther than 1e9 m" : NULL;
}

static bool is_zero(const float m[16])
{
    for (int k = 0; k < 16; k++) {
        if (m[k] != 0.0f) {
            return false;
        }
    }
    return true;
}

static parian_result make_placement(const parian_env *env, const parian_instance *instance,
                                    size_t index, parian_placement *made)
{
    const float *m = !instance || is_zero(instance->transform) ? identity : instance->transform;
    const char *fault = find_fault(m, &made->scale);
    if (fault) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "instance %zu: the transform %s; expected a rotation times one scale "
                           "and a translation",
                           index, fault);
    }
    memcpy(made->model, m, sizeof made->model);
    return PARIAN_OK;
}

/* ---- bounds ---- */

static void grow(float lower[3], float upper[3], const float p[3])
{
    for (int c = 0; c < 3; c++) {
        lower[c] = fminf(lower[c], p[c]);
        upper[c] = fmaxf(upper[c], p[c]);
    }
}

/* Grow a box by the vertices of all bodies of an instance. */
static void grow_instance(const parian_scene_data *data, const parian_placement *at, float lower[3],
                          float upper[3])
{
    for (uint32_t b = 0; b < data->body_count; b++) {
        for (uint32_t v = 0; v < data->bodies[b].vertex_count; v++) {
            float p[3];
            placement_point(at, data->bodies[b].vertex_position[v], p);
            grow(lower, upper, p);
        }
    }
}

/* Largest distance of the bodies' vertices of an instance from a point. */
static float find_reach(const parian_scene_data *data, const parian_placement *at,
                        const float center[3])
{
    float reach = 0.0f;
    for (uint32_t b = 0; b < data->body_count; b++) {
        for (uint32_t v = 0; v < data->bodies[b].vertex_count; v++) {
            float p[3];
            placement_point(at, data->bodies[b].vertex_position[v], p);
            vec3_sub(p, p, center);
            reach = fmaxf(reach, vec3_dot(p, p));
        }
    }
    return sqrtf(reach);
}

/* The origin is the middle of an empty box. */
static void set_middle(float center[3], const float lower[3], const float upper[3])
{
    for (int c = 0; c < 3; c++) {
        center[c] = lower[c] <= upper[c] ? 0.5f * (lower[c] + upper[c]) : 0.0f;
    }
}

/* The ball around the middle of the bodies' box that holds all their vertices, and the one around
 * the box of everything. */
static parian_bounds find_bounds(const parian_scene *scene, const parian_placement *instances,
                                 uint32_t count)
{
    parian_bounds bounds = {.lower = {INFINITY, INFINITY, INFINITY},
                            .upper = {-INFINITY, -INFINITY, -INFINITY}};
    float half[3], reach = 0.0f;
    for (uint32_t i = 0; i < count; i++) {
        grow_instance(&scene->data, &instances[i], bounds.lower, bounds.upper);
    }
    set_middle(bounds.bodies.center, bounds.lower, bounds.upper);
    for (uint32_t i = 0; i < count; i++) {
        reach = fmaxf(reach, find_reach(&scene->data, &instances[i], bounds.bodies.center));
    }
    bounds.bodies.radius = fmaxf(reach, 1e-9f);
    for (uint32_t s = 0; s < scene->data.surrounding_count; s++) {
        const parian_surrounding *piece = &scene->data.surroundings[s];
        for (uint32_t v = 0; v < piece->vertex_count; v++) {
            grow(bounds.lower, bounds.upper, piece->vertex_position[v]);
        }
    }
    if (!(bounds.lower[0] <= bounds.upper[0])) {
        return (parian_bounds){.bodies.radius = 1e-9f, .everything.radius = 1e-9f};
    }
    set_middle(bounds.everything.center, bounds.lower, bounds.upper);
    vec3_sub(half, bounds.upper, bounds.everything.center);
    bounds.everything.radius = fmaxf(vec3_length(half), 1e-9f);
    return bounds;
}

/* ---- setting ---- */

parian_result parian_renderer_start_instances(parian_renderer *renderer)
{
    if (!PARIAN_NEW0(&renderer->env, renderer->instances, 1)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for an instance");
    }
    renderer->instance_count = 1;
    parian_result result = make_placement(&renderer->env, NULL, 0, renderer->instances);
    renderer->bounds = find_bounds(renderer->scene, renderer->instances, 1);
    return result;
}

/* Place shadow maps anew, in a copy of the lights: on failure they stay as they were. */
static parian_result refit_shadows(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    parian_light_list list = renderer->lights;
    list.layer = NULL;
    if (!PARIAN_NEW(env, list.sample, list.sample_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u light samples",
                           list.sample_count);
    }
    for (uint32_t i = 0; i < list.sample_count; i++) {
        list.sample[i] = renderer->lights.sample[i];
    }
    parian_result result = parian_renderer_fit_shadows(renderer, &list);
    parian_light_list *old = result == PARIAN_OK ? &renderer->lights : &list;
    parian_free(env, old->sample);
    parian_free(env, old->layer);
    if (result == PARIAN_OK) {
        renderer->lights = list;
    }
    return result;
}

/* Take over checked placements, or nothing. */
static parian_result replace(parian_renderer *renderer, parian_placement *made, uint32_t count)
{
    const parian_bounds before = renderer->bounds;
    renderer->bounds = find_bounds(renderer->scene, made, count);
    uint32_t held = renderer->instance_count > count ? renderer->instance_count : count;
    parian_result result = renderer->backend->resize(renderer, held);
    if (result == PARIAN_OK) {
        result = refit_shadows(renderer);
    }
    if (result != PARIAN_OK) {
        renderer->bounds = before;
        renderer->backend->resize(renderer, renderer->instance_count);
        parian_free(&renderer->env, made);
        return result;
    }
    parian_free(&renderer->env, renderer->instances);
    renderer->instances = made;
    renderer->instance_count = count;
    renderer->lights_changed = true;
    return renderer->backend->resize(renderer, count);
}

parian_result parian_renderer_set_instances(parian_renderer *renderer,
                                            const parian_instance *instances, size_t count)
{
    parian_placement *made;
    parian_result result = PARIAN_OK;
    if (!renderer || (count > 0 && !instances)) {
        return PARIAN_E_ARGUMENT;
    }
    const parian_env *env = &renderer->env;
    size_t many = count ? count : 1;
    if (many > PARIAN_INSTANCE_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT, "%zu instances given, at most %d are possible",
                           count, PARIAN_INSTANCE_MAX);
    }
    if (!PARIAN_NEW0(env, made, many)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu instances", many);
    }
    for (size_t i = 0; result == PARIAN_OK && i < many; i++) {
        result = make_placement(env, count ? &instances[i] : NULL, i, &made[i]);
    }
    bool equal = result == PARIAN_OK && many == renderer->instance_count &&
                 memcmp(made, renderer->instances, many * sizeof *made) == 0;
    if (result != PARIAN_OK || equal) {
        parian_free(env, made);
        return result;
    }
    return replace(renderer, made, (uint32_t)many);
}
