/* light_sampler.c - every light type as samples at a point, and as radiance along a ray.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/light_sampler.h"

#include <string.h>

#include "bake/reference/light_parts.h"
#include "bake/reference/rays.h"
#include "bake/reference/vec3d.h"
#include "core/memory.h"

static const double pi = 3.14159265358979323846;

/* Squared distances below this (1 nm) count as it: what is on top of a light stays finite. For a
 * rectangle the same goes for this part of its area. */
static const double DISTANCE2_MIN = 1e-18, AREA_PART_MIN = 1e-12;

/* A light as it is used: doubles, unit vectors, what its type needs. */
typedef struct ready_light {
    double position[3], direction[3], color[3];
    double right[3], up[3], cos_inner, cos_outer, tan_outer; /* spot */
    double axis_u[3], axis_v[3], normal[3], area;            /* rect */
    parian_sky_table sky;                                    /* environment with a picture */
} ready_light;

struct parian_light_sampler {
    parian_env env;
    uint32_t count;
    parian_light *light;
    ready_light *ready;
};

/* ---- making ---- */

static bool is_zero(const float v[3])
{
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/* right and up of a view along -backward whose top is nearest to wanted; another axis where that is
 * parallel. */
static void make_frame(const double backward[3], const double wanted[3], double right[3],
                       double up[3])
{
    vec3d_cross(right, wanted, backward);
    if (vec3d_dot(right, right) < 1e-8 * vec3d_dot(wanted, wanted)) {
        const double other[3] = {0, fabs(backward[1]) < 0.9, fabs(backward[1]) >= 0.9};
        vec3d_cross(right, other, backward);
    }
    vec3d_normalize(right);
    vec3d_cross(up, backward, right);
}

static void make_spot(const parian_light *light, ready_light *ready)
{
    double wanted[3] = {0, 1, 0};
    const double backward[3] = {-ready->direction[0], -ready->direction[1], -ready->direction[2]};
    ready->cos_inner = cos(light->inner_deg * pi / 180);
    ready->cos_outer = cos(light->outer_deg * pi / 180);
    ready->tan_outer = tan(light->outer_deg * pi / 180);
    if (!is_zero(light->up)) {
        vec3d_from_float(wanted, light->up);
    }
    make_frame(backward, wanted, ready->right, ready->up);
}

static void make_rect(const parian_light *light, ready_light *ready)
{
    vec3d_from_float(ready->axis_u, light->axis_u);
    vec3d_from_float(ready->axis_v, light->axis_v);
    vec3d_cross(ready->normal, ready->axis_u, ready->axis_v);
    ready->area = 4 * vec3d_normalize(ready->normal);
}

static parian_result make_ready(const parian_env *env, const parian_light *light,
                                ready_light *ready)
{
    vec3d_from_float(ready->color, light->color);
    vec3d_from_float(ready->position, light->position);
    vec3d_from_float(ready->direction, light->direction);
    vec3d_normalize(ready->direction);
    if (light->type == PARIAN_LIGHT_SPOT) {
        make_spot(light, ready);
    } else if (light->type == PARIAN_LIGHT_RECT) {
        make_rect(light, ready);
    } else if (light->type == PARIAN_LIGHT_ENVIRONMENT && light->image.pixel) {
        return parian_sky_table_make(env, light, &ready->sky);
    }
    return PARIAN_OK;
}

static parian_result fill_sampler(const parian_light *lights, uint32_t count,
                                  parian_light_sampler *sampler)
{
    static const char *const names[] = {"point", "directional", "spot", "rect", "environment"};
    const parian_env *env = &sampler->env;
    if (!PARIAN_NEW(env, sampler->light, count) || !PARIAN_NEW0(env, sampler->ready, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u lights", count);
    }
    sampler->count = count;
    for (uint32_t i = 0; i < count; i++) {
        const char *fault = parian_light_fault(&lights[i]);
        if (fault) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "light %u (%s): %s", i,
                               (unsigned)lights[i].type < 5 ? names[lights[i].type] : "?", fault);
        }
        sampler->light[i] = lights[i];
        parian_result r = make_ready(env, &sampler->light[i], &sampler->ready[i]);
        if (r != PARIAN_OK) {
            return r;
        }
    }
    return PARIAN_OK;
}

parian_result parian_light_sampler_create(const parian_env *env, const parian_light *lights,
                                          uint32_t count, parian_light_sampler **sampler)
{
    parian_light_sampler *made = NULL;
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u lights", count);
    }
    if (env) {
        made->env = *env;
    }
    parian_result r = fill_sampler(lights, count, made);
    if (r != PARIAN_OK) {
        parian_light_sampler_destroy(made);
        return r;
    }
    *sampler = made;
    return PARIAN_OK;
}

void parian_light_sampler_destroy(parian_light_sampler *sampler)
{
    if (!sampler) {
        return;
    }
    parian_env env = sampler->env;
    for (uint32_t i = 0; sampler->ready && i < sampler->count; i++) {
        parian_sky_table_free(&env, &sampler->ready[i].sky);
    }
    parian_free(&env, sampler->ready);
    parian_free(&env, sampler->light);
    parian_free(&env, sampler);
}

uint32_t parian_light_sampler_count(const parian_light_sampler *sampler)
{
    return sampler->count;
}

const parian_light *parian_light_sampler_light(const parian_light_sampler *sampler, uint32_t light)
{
    return &sampler->light[light];
}

bool parian_light_is_delta(const parian_light *light)
{
    return light->type != PARIAN_LIGHT_RECT && light->type != PARIAN_LIGHT_ENVIRONMENT;
}

/* ---- samples ---- */

/* The projected picture in a direction away from the light: bilinear between centres of pixels,
 * black outside. */
static void slide_at(const parian_light_image *image, const ready_light *ready,
                     const double away[3], double rgb[3])
{
    double reach = vec3d_dot(away, ready->direction) * ready->tan_outer;
    double x = (0.5 + 0.5 * vec3d_dot(away, ready->right) / reach) * image->width - 0.5;
    double y = (0.5 - 0.5 * vec3d_dot(away, ready->up) / reach) * image->height - 0.5;
    rgb[0] = rgb[1] = rgb[2] = 0;
    if (!(reach > 0 && x > -1 && x < image->width && y > -1 && y < image->height)) {
        return;
    }
    double x0 = floor(x), y0 = floor(y);
    for (int k = 0; k < 4; k++) {
        double px = x0 + (k & 1), py = y0 + (k >> 1);
        double weight = (1 - fabs(x - px)) * (1 - fabs(y - py));
        if (px < 0 || py < 0 || px >= image->width || py >= image->height) {
            continue;
        }
        const float *pixel = image->pixel[(size_t)py * image->width + (size_t)px];
        for (int c = 0; c < 3; c++) {
            rgb[c] += weight * (double)pixel[c];
        }
    }
}

/* Full within the inner cone, none beyond the outer one, smoothstep in the cosine between. */
static double cone_at(const ready_light *ready, double cosine)
{
    double ramp = (cosine - ready->cos_outer) / fmax(ready->cos_inner - ready->cos_outer, 1e-6);
    ramp = fmin(fmax(ramp, 0), 1);
    return ramp * ramp * (3 - 2 * ramp);
}

static bool sample_point(const parian_light *light, const ready_light *ready, const double x[3],
                         parian_light_sample *sample)
{
    vec3d_sub(sample->direction, ready->position, x);
    sample->distance = vec3d_normalize(sample->direction);
    double factor = 1 / fmax(sample->distance * sample->distance, DISTANCE2_MIN),
           slide[3] = {1, 1, 1};
    if (!(sample->distance > 0)) {
        return false;
    }
    if (light->type == PARIAN_LIGHT_SPOT) {
        const double away[3] = {-sample->direction[0], -sample->direction[1],
                                -sample->direction[2]};
        factor *= cone_at(ready, vec3d_dot(away, ready->direction));
        if (!(factor > 0)) {
            return false;
        }
        if (light->image.pixel) {
            slide_at(&light->image, ready, away, slide);
        }
    }
    for (int c = 0; c < 3; c++) {
        sample->irradiance[c] = ready->color[c] * slide[c] * factor;
    }
    return true;
}

static bool sample_rect(const ready_light *ready, const double x[3], double u, double v,
                        parian_light_sample *sample)
{
    vec3d_sub(sample->direction, ready->position, x);
    vec3d_add_scaled(sample->direction, ready->axis_u, 2 * u - 1);
    vec3d_add_scaled(sample->direction, ready->axis_v, 2 * v - 1);
    sample->distance = vec3d_normalize(sample->direction);
    double cosine = -vec3d_dot(sample->direction, ready->normal);
    if (!(cosine > 0)) {
        return false;
    }
    double distance2 = fmax(sample->distance * sample->distance, AREA_PART_MIN * ready->area);
    for (int c = 0; c < 3; c++) {
        sample->irradiance[c] = ready->color[c] * cosine * ready->area / distance2;
    }
    return true;
}

static bool sample_environment(const ready_light *ready, double u, double v,
                               parian_light_sample *sample)
{
    sample->distance = INFINITY;
    if (ready->sky.image) {
        return parian_sky_sample(&ready->sky, u, v, sample->direction, sample->irradiance);
    }
    double z = 1 - 2 * u, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * pi * v;
    sample->direction[0] = s * cos(phi);
    sample->direction[1] = s * sin(phi);
    sample->direction[2] = z;
    for (int c = 0; c < 3; c++) {
        sample->irradiance[c] = ready->color[c] * 4 * pi;
    }
    return true;
}

bool parian_light_sampler_sample(const parian_light_sampler *sampler, uint32_t light,
                                 const double x[3], double u, double v, parian_light_sample *sample)
{
    const parian_light *source = &sampler->light[light];
    const ready_light *ready = &sampler->ready[light];
    switch (source->type) {
    case PARIAN_LIGHT_POINT:
    case PARIAN_LIGHT_SPOT:
        return sample_point(source, ready, x, sample);
    case PARIAN_LIGHT_RECT:
        return sample_rect(ready, x, u, v, sample);
    case PARIAN_LIGHT_ENVIRONMENT:
        return sample_environment(ready, u, v, sample);
    case PARIAN_LIGHT_DIRECTIONAL:
        break;
    }
    vec3d_copy(sample->direction, ready->direction);
    vec3d_scale(sample->direction, -1);
    vec3d_copy(sample->irradiance, ready->color);
    sample->distance = INFINITY;
    return true;
}

/* ---- radiance ---- */

/* Distance along a ray to the shining side of a rectangle, INFINITY where it passes. */
static double meet_rect(const ready_light *ready, const double origin[3], const double direction[3])
{
    double facing = vec3d_dot(direction, ready->normal), to[3], normal[3], cross[3];
    if (!(facing < 0)) {
        return INFINITY;
    }
    vec3d_sub(to, ready->position, origin);
    double distance = vec3d_dot(to, ready->normal) / facing;
    vec3d_scale(to, -1);
    vec3d_add_scaled(to, direction, distance);
    vec3d_cross(normal, ready->axis_u, ready->axis_v);
    double scale = vec3d_dot(normal, normal);
    vec3d_cross(cross, to, ready->axis_v);
    double u = vec3d_dot(cross, normal) / scale;
    vec3d_cross(cross, ready->axis_u, to);
    double v = vec3d_dot(cross, normal) / scale;
    return distance > 0 && fabs(u) <= 1 && fabs(v) <= 1 ? distance : INFINITY;
}

static void add_environment(const ready_light *ready, const double direction[3], double L[3])
{
    double radiance[3];
    vec3d_copy(radiance, ready->color);
    if (ready->sky.image) {
        parian_sky_radiance(&ready->sky, direction, radiance);
    }
    vec3d_add_scaled(L, radiance, 1);
}

void parian_light_sampler_radiance(const parian_light_sampler *sampler, uint32_t only_light,
                                   const double origin[3], const double direction[3], double L[3],
                                   double *hit_distance)
{
    double nearest = INFINITY;
    L[0] = L[1] = L[2] = 0;
    for (uint32_t i = 0; i < sampler->count; i++) {
        if (sampler->light[i].type != PARIAN_LIGHT_RECT ||
            (only_light != PARIAN_RAY_NONE && only_light != i)) {
            continue;
        }
        double distance = meet_rect(&sampler->ready[i], origin, direction);
        if (distance < nearest) {
            nearest = distance;
            vec3d_copy(L, sampler->ready[i].color);
        }
    }
    for (uint32_t i = 0; nearest == INFINITY && i < sampler->count; i++) {
        if (sampler->light[i].type == PARIAN_LIGHT_ENVIRONMENT &&
            (only_light == PARIAN_RAY_NONE || only_light == i)) {
            add_environment(&sampler->ready[i], direction, L);
        }
    }
    if (hit_distance) {
        *hit_distance = nearest;
    }
}
