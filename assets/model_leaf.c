/* model_leaf.c - a leaf: a closed thin sheet, curved, with a midrib and side veins on its
 * underside.
 *
 * Lengths in millimetres. The leaf lies along z, its tip towards +z, its upper side towards +y.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "models.h"

/* Chlorophyll takes red and blue; the mean free path is a quarter of the sheet. */
static const model_medium LEAF = {.sigma_s_prime_per_mm = {4.2, 4.6, 5.0},
                                  .sigma_a_per_mm = {0.42, 0.07, 0.85},
                                  .g = 0,
                                  .eta = 1.4};

static const double LENGTH = 80, WIDTH = 30.3; /* WIDTH: half of the leaf's breadth */
enum { VEIN_PAIRS = 8 };

/* Half the breadth at distance t (0 at the stem, 1 at the tip) along the midrib. */
static double half_breadth(double t)
{
    double s = clamp01(t);
    return WIDTH * pow(sin(M_PI * pow(s, 0.6)), 0.8) * (1 - 0.25 * smoothstep(0.55, 1, s));
}

/* Height of the sheet's middle over the plane, a gentle saddle with a curled tip and a wavy rim. */
static double lift(double x, double z)
{
    double t = z / LENGTH + 0.5, side = fabs(x) / WIDTH;
    double wave = 1.4 * sin(0.24 * z + (x > 0 ? 0.8 : 0)) * side * side;
    return 10 * side * side * (1 - 0.4 * t) -
           14 * (t - 0.45) * (t - 0.45) * (t > 0.45 ? 1.6 : 0.9) + wave;
}

/* 1 on the middle line of a side vein, falling to 0 beside it. */
static double side_veins(double x, double z)
{
    double side = fabs(x), sum = 0;
    for (int i = 0; i < VEIN_PAIRS; i++) {
        double start = -LENGTH / 2 + LENGTH * (0.05 + 0.105 * i) + (x > 0 ? 1.8 : 0);
        double across = (z - start - 0.72 * side - 0.012 * side * side) * 0.78;
        double width = 0.85 - 0.015 * side;
        sum = fmax(sum, exp(-across * across / (width * width)));
    }
    return sum;
}

static double sheet_solid(vec3 p)
{
    double t = p.z / LENGTH + 0.5;
    double breadth = half_breadth(t);
    double teeth = 0.5 * (0.5 + 0.5 * sin(2 * M_PI * p.z / 4.4)) * smoothstep(0.03, 0.2, t) *
                   smoothstep(0.98, 0.8, t);
    double slope = (half_breadth(t + 0.01) - half_breadth(t - 0.01)) / (0.02 * LENGTH);
    double outline = (fabs(p.x) - breadth + teeth) / sqrt(1 + fmin(slope * slope, 9));
    outline = solid_meet(outline, fabs(p.z) - LENGTH / 2, 2);
    double up = p.y - lift(p.x, p.z);
    double veins = side_veins(p.x, p.z) * smoothstep(-0.5, -5, outline);
    double half_thickness =
        0.36 + 0.05 * noise3(v3(0.9 * p.x, 0, 0.9 * p.z)) * smoothstep(0, -2, outline);
    double thicker = veins * (up < 0 ? 0.24 : -0.07) * smoothstep(0, 0.2, fabs(up));
    return solid_plate(outline, up, half_thickness + thicker);
}

static double rib_solid(vec3 p)
{
    vec3 q = v3(p.x, p.y - lift(0, p.z), p.z);
    double t = p.z / LENGTH + 0.5;
    double radius = 1.05 - 0.8 * clamp01(t);
    double end = fmax(-LENGTH / 2 - 9 - p.z, p.z - LENGTH / 2 + 2);
    return solid_meet(length2(q.x, q.y + 0.45) - radius, end, 0.8);
}

static double leaf_field(vec3 p)
{
    return 0.75 * solid_join(sheet_solid(p), rib_solid(p), 0.9);
}

parian_result model_leaf(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    const glb_part leaf = {.name = "leaf",
                           .material_name = "leaf tissue",
                           .medium = &LEAF,
                           .base_color = {1, 1, 1},
                           .roughness = 0.3};
    const glb_light key = {"key", true, {0.4, -1, -0.5}, {1.6, 1.6, 1.5}};
    const glb_light back = {"back", false, {-0.02, -0.06, -0.03}, {0.022, 0.021, 0.018}};
    model_add_light(scene, &key);
    model_add_light(scene, &back);
    return model_add_solid(env, scene, &leaf, leaf_field, v3(-34, -18, -52), v3(34, 16, 43),
                           triangle_count);
}
