/* model_cup.c - a thin cup of milk glass with a fluted side, a foot ring and a handle.
 *
 * Lengths in millimetres.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "models.h"

/* Almost white: a hint of absorption in the red makes light that went far a little cool. */
static const model_medium MILK_GLASS = {.sigma_s_prime_per_mm = {1.5, 1.6, 1.8},
                                        .sigma_a_per_mm = {0.0040, 0.0028, 0.0030},
                                        .g = 0.2,
                                        .eta = 1.5};

static const double HEIGHT = 58;

/* The middle of the wall in the half plane of radius and height, from the bottom's middle to the
 * lip. */
static double profile_distance(double r, double y)
{
    static const vec3 point[] = {{0, 4, 0},      {12, 4, 0},    {17.5, 5, 0},
                                 {22.5, 9.5, 0}, {26, 17, 0},   {27.6, 27, 0},
                                 {28, 38, 0},    {28.6, 48, 0}, {30.2, 56.2, 0}};
    static const double radius[] = {1.6, 1.6, 1.55, 1.45, 1.4, 1.3, 1.25, 1.25, 1.6};
    return solid_tube(v3(r, y, 0), point, radius, 9, NULL);
}

/* Standing petals on the outside, above 0 where the wall is thicker. */
static double flutes(double wall, double angle, double r, double y)
{
    double outside = smoothstep(-0.1, 0.3, profile_distance(r + 0.5, y) - wall);
    double petal = fabs(cos(12 * angle));
    return outside * 0.45 * (sqrt(petal * petal + 0.02) - 0.6) * smoothstep(8, 14, y) *
           smoothstep(46, 38, y);
}

static double handle_solid(vec3 p)
{
    static const vec3 point[] = {{26.2, 45.5, 0}, {34, 48.6, 0},   {42.6, 45, 0},  {46.2, 35.6, 0},
                                 {42.6, 25.6, 0}, {34.5, 19.2, 0}, {25.4, 17.6, 0}};
    static const double radius[] = {2.8, 2.5, 2.35, 2.3, 2.35, 2.5, 3.0};
    return solid_tube(v3(p.x, p.y, 0.8 * p.z), point, radius, 7, NULL);
}

static double cup_field(vec3 p)
{
    double r = length2(p.x, p.z);
    double wall = profile_distance(r, p.y);
    if (wall < 3) {
        wall -= flutes(wall, atan2(p.x, p.z), r, p.y);
    }
    double foot = length2(fmax(fabs(r - 15.6) - 0.3, 0), fmax(fabs(p.y - 2.2) - 1.2, 0)) - 1.0;
    double solid = solid_join(wall, foot, 2.5);
    double handle = solid_cut(handle_solid(p), r - 27, 1); /* nothing of it inside */
    solid = solid_join(solid, handle, 2.6);
    return 0.9 * solid_meet(solid, p.y - HEIGHT, 0.4);
}

parian_result model_cup(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    static const double mat[][2] = {{0, -2.4},  {45, -2.4}, {46, -2},   {46.4, -1.3},
                                    {46, -0.6}, {45, -0.2}, {20, -0.2}, {0, -0.2}};
    const glb_part cup = {.name = "cup",
                          .material_name = "milk glass",
                          .medium = &MILK_GLASS,
                          .base_color = {1, 1, 1},
                          .roughness = 0.12};
    const glb_part coaster = {.name = "coaster",
                              .material_name = "cork",
                              .base_color = {0.30, 0.19, 0.11},
                              .roughness = 0.9};
    const glb_light key = {"key", true, {0.5, -0.8, -0.7}, {2.2, 2.15, 2.05}};
    const glb_light back = {"back", false, {-0.05, 0.075, -0.11}, {0.030, 0.028, 0.025}};
    model_add_light(scene, &key);
    model_add_light(scene, &back);
    parian_result result = model_add_solid(env, scene, &cup, cup_field, v3(-33, -1, -33),
                                           v3(50, 60, 33), triangle_count);
    return result != PARIAN_OK ? result
                               : model_add_lathe(env, scene, &coaster, mat,
                                                 sizeof mat / sizeof mat[0], v3(0, 0, 0));
}
