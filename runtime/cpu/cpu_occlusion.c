/* cpu_occlusion.c - rays through the tree of what casts shadows.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_occlusion.h"

#include "vec3.h"

typedef struct shadow_ray {
    float origin[3], direction[3], inverse[3], far;
} shadow_ray;

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

static bool meets_box(const float (*box)[4], const shadow_ray *ray)
{
    float enter = 0.0f, leave = ray->far;
    for (int c = 0; c < 3; c++) {
        float a = (box[0][c] - ray->origin[c]) * ray->inverse[c];
        float b = (box[1][c] - ray->origin[c]) * ray->inverse[c];
        float first = a < b ? a : b, last = a < b ? b : a;
        enter = first > enter ? first : enter;
        leave = last < leave ? last : leave;
    }
    return enter <= leave;
}

static bool meets_caster(const parian_occluder_tree *tree, uint32_t at, uint32_t end,
                         const shadow_ray *ray)
{
    while (at < end) {
        const float(*box)[4] = (const float(*)[4])tree->element + at;
        uint32_t count = (uint32_t)box[1][3];
        bool met = meets_box(box, ray);
        for (uint32_t k = 0; met && k < count; k++) {
            if (meets_triangle(box + 2 + 3 * k, ray)) {
                return true;
            }
        }
        at = !met || count > 0 ? (uint32_t)box[0][3] : at + 2;
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
            float safe = fabsf(ray.direction[k]) < 1e-20f ? 1e-20f : ray.direction[k];
            ray.inverse[k] = 1.0f / safe;
        }
        if (meets_caster(casters->tree, (uint32_t)caster->first, (uint32_t)caster->end, &ray)) {
            return true;
        }
    }
    return false;
}
