/* view_lights.c - the lights that the player begins with, and how the mouse moves them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_lights.h"

#include <string.h>

#include "core/memory.h"
#include "view_vector.h"

static const double PI = 3.14159265358979323846;
static const double KEY_IRRADIANCE = 3, BACK_IRRADIANCE = 2; /* W/m^2 at the centre of the bodies */
static const double LIGHT_DISTANCE = 2.5;                    /* bounding radii */
static const double SHOWN_DISTANCE = 1.3; /* of lights without a place, bounding radii */

parian_result parian_view_lights_read(const parian_env *env, const parian_view_options *options,
                                      parian_light_set *set)
{
    parian_result result = PARIAN_OK;
    if (options->lights_file) {
        result = parian_lights_read_file(env, options->lights_file, set);
    }
    for (size_t i = 0; i < options->lights.count && result == PARIAN_OK; i++) {
        result = parian_lights_parse_spec(env, options->lights.item[i], set);
    }
    return result;
}

static parian_light point_light(const parian_view_extent *extent, double x, double y, double z,
                                double irradiance)
{
    parian_light light = {.type = PARIAN_LIGHT_POINT};
    double direction[3] = {x, y, z};
    const double distance = LIGHT_DISTANCE * extent->body_radius;
    vector_normalize(direction);
    for (int c = 0; c < 3; c++) {
        light.position[c] = (float)(extent->body_centre[c] + distance * direction[c]);
        light.color[c] = (float)(irradiance * distance * distance);
    }
    return light;
}

parian_result parian_view_lights_default(const parian_env *env, const parian_scene_info *info,
                                         const parian_view_extent *extent, parian_light_set *set)
{
    if (info->lights_json) {
        parian_result result = parian_lights_parse(env, info->lights_json, NULL, set);
        if (result != PARIAN_OK || set->count > 0) {
            return result;
        }
    }
    const parian_light lights[] = {point_light(extent, -0.6, 0.7, 0.75, KEY_IRRADIANCE),
                                   point_light(extent, 0.5, 0.45, -0.85, BACK_IRRADIANCE)};
    parian_result result = PARIAN_OK;
    for (size_t i = 0; i < sizeof lights / sizeof lights[0] && result == PARIAN_OK; i++) {
        result = parian_light_set_append(env, set, &lights[i]);
    }
    return result;
}

/* Mean of a latitude-longitude picture over the sphere, 1 without one. */
static double mean_of_sky(const parian_light_image *image)
{
    double sum = 0, weights = 0;
    for (uint32_t y = 0; image->pixel && y < image->height; y++) {
        const double weight = sin(PI * (y + 0.5) / image->height);
        for (uint32_t x = 0; x < image->width; x++) {
            const float *pixel = image->pixel[(size_t)y * image->width + x];
            sum += weight * ((double)pixel[0] + (double)pixel[1] + (double)pixel[2]) / 3;
            weights += weight;
        }
    }
    return weights > 0 ? sum / weights : 1;
}

double parian_view_lights_brightness(const parian_light_set *set, const double point[3])
{
    double sum = 0;
    for (size_t i = 0; i < set->count; i++) {
        const parian_light *light = &set->light[i];
        const double grey =
            ((double)light->color[0] + (double)light->color[1] + (double)light->color[2]) / 3;
        double to_light[3], u[3], v[3], across[3];
        for (int c = 0; c < 3; c++) {
            to_light[c] = light->position[c] - point[c];
            u[c] = 2 * (double)light->axis_u[c];
            v[c] = 2 * (double)light->axis_v[c];
        }
        const double squared = vector_dot(to_light, to_light);
        vector_cross(u, v, across);
        switch (light->type) {
        case PARIAN_LIGHT_POINT:
        case PARIAN_LIGHT_SPOT:
            sum += squared > 0 ? grey / squared : 0;
            break;
        case PARIAN_LIGHT_DIRECTIONAL:
            sum += grey;
            break;
        case PARIAN_LIGHT_RECT:
            sum += squared > 0 ? grey * vector_length(across) / squared : 0;
            break;
        case PARIAN_LIGHT_ENVIRONMENT:
            sum += grey * PI * mean_of_sky(&light->image);
            break;
        }
    }
    return sum;
}

static void turn_vector(float v[3], const double axis[3], double angle)
{
    double turned[3] = {v[0], v[1], v[2]};
    vector_rotate(axis, angle, turned);
    for (int c = 0; c < 3; c++) {
        v[c] = (float)turned[c];
    }
}

void parian_view_light_turn(parian_light *light, const double centre[3], const double axis[3],
                            double angle)
{
    for (int c = 0; c < 3; c++) {
        light->position[c] -= (float)centre[c];
    }
    turn_vector(light->position, axis, angle);
    for (int c = 0; c < 3; c++) {
        light->position[c] += (float)centre[c];
    }
    turn_vector(light->direction, axis, angle);
    turn_vector(light->up, axis, angle);
    turn_vector(light->axis_u, axis, angle);
    turn_vector(light->axis_v, axis, angle);
    light->rotation_deg += (float)(angle * 180 / PI * axis[1]);
}

/* ---- editing -----------------------------------------------------------------------------------
 */
parian_light parian_view_light_make(const parian_view_extent *extent, parian_light_type type)
{
    parian_light light = point_light(extent, 0.7, 0.6, 0.4, BACK_IRRADIANCE);
    const float half = (float)(0.5 * extent->body_radius);
    float strength = light.color[0];
    light.type = type;
    for (int c = 0; c < 3; c++) {
        light.direction[c] = (float)extent->body_centre[c] - light.position[c];
    }
    light.outer_deg = 20;
    light.inner_deg = 14;
    light.axis_u[0] = half;
    light.axis_v[2] = half; /* u x v points down */
    if (type == PARIAN_LIGHT_RECT) {
        light.position[0] = (float)extent->body_centre[0];
        light.position[1] = (float)(extent->body_centre[1] + 1.5 * extent->body_radius);
        light.position[2] = (float)extent->body_centre[2];
        strength = 4;
        light.axis_u[0] = -half;
    } else if (type == PARIAN_LIGHT_DIRECTIONAL) {
        strength = (float)BACK_IRRADIANCE;
    } else if (type == PARIAN_LIGHT_ENVIRONMENT) {
        strength = 0.3f;
    }
    light.color[0] = light.color[1] = light.color[2] = strength;
    return light;
}

void parian_view_light_remove(const parian_env *env, parian_light_set *set, size_t index)
{
    if (index < set->count) {
        parian_free(env, (void *)(uintptr_t)set->light[index].image.pixel);
        memmove(set->light + index, set->light + index + 1,
                (set->count - index - 1) * sizeof *set->light);
        set->count--;
    }
}

bool parian_view_light_place(const parian_light *light, const parian_view_extent *extent,
                             double place[3])
{
    double direction[3];
    for (int c = 0; c < 3; c++) {
        place[c] = light->position[c];
        direction[c] = light->direction[c];
    }
    if (light->type == PARIAN_LIGHT_DIRECTIONAL) {
        vector_normalize(direction);
        vector_add_scaled(extent->body_centre, -SHOWN_DISTANCE * extent->body_radius, direction,
                          place);
    }
    return light->type != PARIAN_LIGHT_ENVIRONMENT;
}

void parian_view_light_move(parian_light *light, const parian_view_extent *extent,
                            const double place[3])
{
    double toward[3];
    vector_add_scaled(extent->body_centre, -1, place, toward);
    if (light->type == PARIAN_LIGHT_DIRECTIONAL && vector_length(toward) > 0) {
        vector_normalize(toward);
    }
    for (int c = 0; c < 3; c++) {
        if (light->type == PARIAN_LIGHT_DIRECTIONAL) {
            light->direction[c] = (float)toward[c];
        } else {
            light->position[c] = (float)place[c];
        }
    }
}
