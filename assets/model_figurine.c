/* model_figurine.c - an elephant calf of alabaster: thin ears, thick body, a curled trunk, on a
 * slate base.
 *
 * Lengths in millimetres. The calf is the same left and right but for its tail, so that most parts
 * are evaluated at the mirrored point.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stddef.h>

#include "models.h"

/* Mean free paths of 0.62, 0.52 and 0.43 mm; red light diffuses farthest. */
static const model_medium ALABASTER = {.sigma_s_prime_per_mm = {1.6, 1.9, 2.3},
                                       .sigma_a_per_mm = {0.003, 0.013, 0.045},
                                       .g = 0,
                                       .eta = 1.5};

static const double SCALE = 1.064; /* from the drawing's millimetres to a calf 50 mm high */

static double skin_relief(vec3 p)
{
    double folds = noise3(v3_scale(p, 0.55)) + 0.5 * noise3(v3_scale(p, 1.1));
    return 0.12 * folds;
}

/* A saddle cloth with a raised hem and a woven pattern of diamonds, 0 to about 0.7 above the back.
 */
static double cloth_relief(vec3 p)
{
    double along = fabs(p.z + 6.5) - 8.5,
           hang = 24.5 + 0.8 * cos(2 * M_PI * (p.z + 6.5) / 4.25) - p.y;
    double edge = fmax(along, hang); /* negative on the cloth */
    double hem = smoothstep(-2.2, -1.8, edge) * smoothstep(0, -0.4, edge);
    double weave = cos(2 * M_PI * (p.z + p.y) / 4.6) * cos(2 * M_PI * (p.z - p.y) / 4.6);
    return smoothstep(0.15, -0.35, edge) * (0.5 + 0.5 * hem + 0.2 * weave * (1 - hem));
}

static double body_solid(vec3 p)
{
    double body = solid_ellipsoid(p, v3(0, 24, -6), v3(13.6, 12.8, 18));
    body = solid_join(body, solid_ellipsoid(p, v3(0, 27, 6), v3(10.5, 10.5, 11)), 6);
    return body - (p.y > 20 ? cloth_relief(p) : 0);
}

static double leg_solid(vec3 m, vec3 hip, vec3 foot)
{
    double leg = solid_cone(m, hip, v3_add(foot, v3(0, 4, 0)), 6.6, 4.7);
    leg = solid_join(leg, solid_ellipsoid(m, v3_add(foot, v3(0, 1.5, 0.4)), v3(5.5, 3.4, 5.7)), 3);
    for (int toe = -1; toe <= 1; toe++) {
        double angle = 0.62 * toe;
        vec3 nail = v3_add(foot, v3(5.0 * sin(angle), 1.2, 0.4 + 5.2 * cos(angle)));
        leg = solid_join(leg, solid_ellipsoid(m, nail, v3(1.6, 1.8, 1.2)), 0.25);
    }
    return leg;
}

static double head_solid(vec3 p, vec3 m)
{
    double head = solid_ellipsoid(p, v3(0, 34, 14), v3(9.6, 10, 10));
    head = solid_join(head, solid_sphere(m, v3(2.6, 40.5, 12.6), 6.4),
                      4); /* the two domes of the forehead */
    head = solid_join(head, solid_ellipsoid(m, v3(4.6, 30, 19), v3(4.2, 4.2, 4.2)), 4); /* cheeks */
    return solid_join(head, solid_cone(p, v3(0, 27.5, 15.5), v3(0, 24.6, 20.4), 4.0, 2.2),
                      2.5); /* jaw */
}

static double trunk_solid(vec3 p)
{
    static const vec3 point[] = {{0, 34, 21},     {0, 28.5, 26.4}, {0, 21.5, 29.2}, {0, 16.2, 33},
                                 {0, 16.6, 38.2}, {0, 21.6, 40.8}, {0, 26, 38.9}};
    static const double radius[] = {5.6, 4.7, 3.9, 3.3, 2.8, 2.35, 2.0};
    double along = 0;
    double trunk = solid_tube(p, point, radius, 7, &along);
    double rings =
        cos(2 * M_PI * 3.4 * along) * smoothstep(0.3, 1.2, along) * smoothstep(5.95, 5.4, along);
    double nostrils = solid_sphere(v3_mirror(p), v3(0.75, 27.6, 38.0), 0.55);
    return solid_cut(trunk - 0.14 * rings, nostrils, 0.3);
}

static double ear_solid(vec3 m)
{
    const frame f = frame_make(v3(7.6, 35.5, 10.5), v3(0.42, 0.06, 1), v3(0, 1, 0));
    vec3 q = frame_local(&f, m);
    double outline = length2(q.x - 8.4, (q.y - 1.2) * 0.96) - 9.4;
    outline = solid_join(outline, length2(q.x - 5.6, q.y + 7.2) - 5.2, 7);
    outline += 0.35 * cos(0.9 * q.y + 0.4) * smoothstep(8, 15, q.x);
    double root = smoothstep(11, -1, q.x);
    double veins =
        cos(9 * atan2(q.y, q.x + 5)) * smoothstep(1, 7, q.x) * smoothstep(-0.6, -4.5, outline);
    double cup = 0.016 * (q.x - 7) * (q.x - 7) + 0.012 * q.y * q.y + 0.5 * sin(0.42 * q.y + 0.3);
    double roll = smoothstep(-2.6, -0.9, outline); /* the rim is rolled */
    double half_thickness = 0.58 + 0.9 * root * root + 0.1 * veins + 0.4 * roll;
    return 0.85 * solid_plate(outline, q.z - cup + 1, half_thickness);
}

static double tail_solid(vec3 p)
{
    static const vec3 point[] = {
        {0, 30, -21.5}, {0.4, 26, -25}, {1.2, 19.5, -26}, {2.6, 14.5, -25}, {3.4, 11, -24.8}};
    static const double radius[] = {2.2, 1.35, 1.0, 1.25, 0.5};
    double along = 0;
    double tail = solid_tube(p, point, radius, 5, &along);
    return tail - 0.45 * smoothstep(2.6, 3.2, along) * smoothstep(4.0, 3.6, along);
}

static double with_eye(double solid, vec3 m)
{
    const vec3 eye = {6.9, 36.3, 20.2};
    solid = solid_cut(solid, solid_sphere(m, v3_add(eye, v3(0.85, 0.1, 0.9)), 2.4), 0.6);
    solid = solid_join(solid, solid_sphere(m, eye, 1.65), 0.2);
    const vec3 brow = {6.6, 38.7, 20.0};
    return solid_join(solid,
                      solid_cone(m, v3_add(brow, v3(-1.7, -0.2, 0.7)),
                                 v3_add(brow, v3(1.5, -0.5, -1.2)), 0.9, 0.7),
                      1.0);
}

static double calf_solid(vec3 p)
{
    vec3 m = v3_mirror(p);
    double solid = body_solid(p);
    solid = solid_join(solid, leg_solid(m, v3(6.6, 19, 4.5), v3(7.6, 0, 6.5)), 2.5);
    solid = solid_join(solid, leg_solid(m, v3(7, 19, -15), v3(7.8, 0, -14.5)), 2.5);
    solid = solid_join(solid, head_solid(p, m), 3.5);
    solid = solid_join(solid, trunk_solid(p), 2);
    solid -= skin_relief(p);
    solid = with_eye(solid, m);
    solid = solid_join(solid, ear_solid(m), 1.6);
    solid = solid_join(solid, tail_solid(p), 1.5);
    return solid_meet(solid, -p.y, 0.8); /* flat soles */
}

static double figurine_field(vec3 p)
{
    return SCALE * calf_solid(v3_scale(p, 1 / SCALE));
}

parian_result model_figurine(const parian_env *env, uint32_t triangle_count, glb_scene *scene)
{
    static const double base[][2] = {{0, -4.2},    {30, -4.2},   {31.2, -3.9}, {31.6, -3.2},
                                     {31.6, -1.4}, {31.2, -0.6}, {30, -0.2},   {24, -0.2},
                                     {12, -0.2},   {0, -0.2}};
    const glb_part calf = {.name = "figurine",
                           .material_name = "honey alabaster",
                           .medium = &ALABASTER,
                           .base_color = {1, 1, 1},
                           .roughness = 0.25};
    const glb_part plinth = {.name = "base",
                             .material_name = "slate",
                             .base_color = {0.06, 0.065, 0.075},
                             .roughness = 0.6};
    const glb_light key = {"key", true, {-0.55, -0.75, -0.65}, {2.6, 2.5, 2.4}};
    const glb_light back = {"back", false, {0.035, 0.055, -0.085}, {0.020, 0.019, 0.017}};
    model_add_light(scene, &key);
    model_add_light(scene, &back);
    parian_result result = model_add_solid(env, scene, &calf, figurine_field, v3(-31, -1, -31),
                                           v3(31, 53, 48), triangle_count);
    return result != PARIAN_OK ? result
                               : model_add_lathe(env, scene, &plinth, base,
                                                 sizeof base / sizeof base[0], v3(0, 0, -4));
}
