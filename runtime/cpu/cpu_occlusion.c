/* cpu_occlusion.c - rays through the tree of what casts shadows.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_occlusion.h"

#include <math.h>

#include "vec3.h"

typedef struct shadow_ray {
    float origin[3], direction[3], far;
} shadow_ray;

/* The same ray in the grid of boxes. */
typedef struct grid_ray {
    float start[3], inverse[3], far;
} grid_ray;

/* Source  [MoellerTrumbore97] */
static bool meets_triangle(const float (*corner)[4], const shadow_ray *ray)
{
    float p[3], s[3], q[3];
    vec3_cross(p, ray->direction, corner[2]);
    float det = vec3_dot(corner[1], p);
    if (det == 0.0f) {
        return false;
    }
    vec3_sub(s, ray->origin, corner[0]);
    float u = vec3_dot(s, p) / det;
    if (!(u >= 0.0f && u <= 1.0f)) {
        return false;
    }
    vec3_cross(q, s, corner[1]);
    float v = vec3_dot(ray->direction, q) / det, t = vec3_dot(corner[2], q) / det;
    return v >= 0.0f && u + v <= 1.0f && t > 0.0f && t < ray->far;
}

static grid_ray enter_grid(const float (*grid)[4], const shadow_ray *ray)
{
    grid_ray in = {.far = ray->far};
    for (int c = 0; c < 3; c++) {
        float along = ray->direction[c] * grid[1][c];
        in.start[c] = (ray->origin[c] - grid[0][c]) * grid[1][c];
        in.inverse[c] = 1.0f / (fabsf(along) < 1e-20f ? 1e-20f : along);
    }
    return in;
}

static bool meets_box(const float box[4], const grid_ray *ray)
{
    float enter = 0.0f, leave = ray->far;
    for (int c = 0; c < 3; c++) {
        float upper = (float)((uint32_t)box[c] / PARIAN_OCCLUDER_GRID);
        float lower = box[c] - PARIAN_OCCLUDER_GRID * upper;
        float a = (lower - ray->start[c]) * ray->inverse[c];
        float b = (upper - ray->start[c]) * ray->inverse[c];
        float first = a < b ? a : b, last = a < b ? b : a;
        enter = first > enter ? first : enter;
        leave = last < leave ? last : leave;
    }
    return enter <= leave;
}

static bool meets_caster(const parian_occluder_tree *tree, uint32_t at, uint32_t end,
                         const shadow_ray *ray)
{
    if (at >= end) {
        return false;
    }
    const grid_ray in = enter_grid((const float(*)[4])tree->element + at, ray);
    at += 2;
    while (at < end) {
        const float *box = tree->element[at];
        uint32_t leaf = at + 1, after = (uint32_t)fabsf(box[3]);
        bool met = meets_box(box, &in), leafs = box[3] < 0.0f;
        for (; met && leafs && leaf < after; leaf += 3) {
            if (meets_triangle((const float(*)[4])tree->element + leaf, ray)) {
                return true;
            }
        }
        at = met && !leafs ? at + 1 : after;
    }
    return false;
}

bool parian_cpu_occluded(const parian_casters *casters, uint32_t own_first, uint32_t own_count,
                         const float own[3], const float origin[3], const float direction[3],
                         float far)
{
    for (uint32_t c = 0; c < casters->count; c++) {
        const parian_caster *caster = &casters->caster[c];
        bool here = c >= own_first && c < own_first + own_count;
        shadow_ray ray = {.far = far};
        for (int k = 0; k < 3; k++) {
            ray.origin[k] = here ? own[k] : vec3_dot(caster->row[k], origin) + caster->row[k][3];
            ray.direction[k] = vec3_dot(caster->row[k], direction);
        }
        if (meets_caster(casters->tree, (uint32_t)caster->first, (uint32_t)caster->end, &ray)) {
            return true;
        }
    }
    return false;
}
