/* model_candle.c - a burning candle: dished top, drips down the side, a wick, a flame that is a
 * point light.
 *
 * Lengths in millimetres.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "models.h"

/* Mean free paths of about 1 mm, and little absorption: the top glows far down. */
static const model_medium WAX = {.sigma_s_prime_per_mm = {0.95, 1.0, 1.1},
                                 .sigma_a_per_mm = {0.0015, 0.007, 0.028},
                                 .g = 0.5,
                                 .eta = 1.43};

static const double RADIUS = 16, TOP = 81;

typedef struct drip {
    double angle_deg, length, width;
} drip;

static double side_relief(vec3 p)
{
    return 0.25 * noise3(v3(0.16 * p.x, 0.05 * p.y, 0.16 * p.z)) + 0.04 * noise3(v3_scale(p, 0.7));
}

/* A run of wax from the rim down the side, thicker at its end. `angle` is that of p about the axis.
 */
static double drip_solid(vec3 p, double angle, const drip *d)
{
    double a = d->angle_deg * M_PI / 180;
    if (fabs(remainder(angle - a, 2 * M_PI)) > 0.7) {
        return 4; /* at least that far away, on the side of the candle or near it */
    }
    double s = sin(a), c = cos(a);
    double wander = 0.05 * d->length;
    const vec3 point[] = {
        {s * (RADIUS - 2.6), TOP - 6.2, c * (RADIUS - 2.6)},
        {s * (RADIUS - 0.7), TOP - 7, c * (RADIUS - 0.7)},
        {s * (RADIUS - 0.1) + 0.3 * wander * c, TOP - 7 - 0.45 * d->length,
         c * (RADIUS - 0.1) - 0.3 * wander * s},
        {s * (RADIUS + 0.1) + wander * c, TOP - 6 - d->length, c * (RADIUS + 0.1) - wander * s},
    };
    const double radius[] = {0.9 * d->width, d->width, 0.75 * d->width, 1.15 * d->width};
    return solid_tube(p, point, radius, 4, NULL);
}

static double candle_field(vec3 p)
{
    static const drip drips[] = {{8, 30, 2.0},   {31, 13, 1.7},   {-38, 46, 2.1},
                                 {-63, 19, 1.6}, {74, 38, 1.9},   {118, 22, 2.0},
                                 {166, 52, 2.2}, {-118, 33, 1.8}, {-150, 14, 1.6}};
    double across = length2(p.x, p.z), angle = atan2(p.x, p.z);
    double side = across - RADIUS - side_relief(p);
    double rim = TOP - 2 + 1.2 * cos(angle - 0.4) + 0.7 * cos(3 * angle + 1);
    double solid = solid_meet(side, p.y - rim, 4);
    solid = solid_meet(solid, -p.y, 1.5);
    for (unsigned i = 0; i < sizeof drips / sizeof drips[0]; i++) {
        solid = solid_join(solid, drip_solid(p, angle, &drips[i]), 1.6);
    }
    return 0.9 * solid_cut(solid, solid_ellipsoid(p, v3(0, TOP + 1.5, 0), v3(13, 8.5, 13)), 3);
}

static double wick_field(vec3 p)
{
    static const vec3 point[] = {
        {0, TOP - 6.85, 0}, {0, TOP - 3, 0.1}, {0.5, TOP + 0.6, 0.5}, {1.5, TOP + 2.6, 1.1}};
    static const double radius[] = {0.75, 0.75, 0.7, 0.6};
    double along = 0;
    double wick = solid_tube(p, point, radius, 4, &along);
    return solid_meet(wick, TOP - 6.9 - p.y, 0.2);
}

parian_result model_candle(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    static const double dish[][2] = {{0, -3.5},   {24, -3.5},  {30, -2.6}, {34, -0.2},
                                     {34.8, 0.8}, {34.2, 1.3}, {33, 0.9},  {29, -1.3},
                                     {24, -1.9},  {12, -2},    {0, -2}};
    const glb_part wax = {.name = "candle",
                          .material_name = "wax",
                          .medium = &WAX,
                          .base_color = {1, 1, 1},
                          .roughness = 0.35};
    const glb_part wick = {.name = "wick",
                           .material_name = "charred cotton",
                           .base_color = {0.03, 0.027, 0.025},
                           .roughness = 0.9};
    const glb_part plate = {.name = "plate",
                            .material_name = "pewter",
                            .base_color = {0.18, 0.18, 0.19},
                            .roughness = 0.5};
    const glb_light flame = {"flame", false, {0.001, 0.0895, 0.001}, {0.0034, 0.0020, 0.0009}};
    const glb_light key = {"key", true, {-0.6, -0.55, -0.7}, {0.5, 0.55, 0.65}};
    model_add_light(scene, &flame);
    model_add_light(scene, &key);
    parian_result result = model_add_solid(env, scene, &wax, candle_field, v3(-21, -1, -21),
                                           v3(21, 84, 21), triangle_count);
    if (result == PARIAN_OK) {
        result = model_add_solid(env, scene, &wick, wick_field, v3(-2, 72, -2), v3(4, 86, 4), 4000);
    }
    return result != PARIAN_OK ? result
                               : model_add_lathe(env, scene, &plate, dish,
                                                 sizeof dish / sizeof dish[0], v3(0, 1.8, 0));
}
