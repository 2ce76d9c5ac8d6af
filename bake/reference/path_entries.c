/* path_entries.c - where photons of a light start: the triangles of all bodies with a chance by the
 * light they take.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"
#include "core/memory.h"

/* Share of the chance that goes by facing alone, so that what a spot's picture or cone hides at the
 * four probed places is found all the same. */
static const double BLIND_SHARE = 0.1;

typedef struct triangle_light {
    double seen; /* estimate of the flux that a light of this type brings */
    double
        facing; /* the same for a light without cone or picture; above zero wherever any may come */
} triangle_light;

/* Brightness over the channels of a light at x, times the cosine. */
static double probe(const path_scene *path, uint32_t light, const double x[3],
                    const double normal[3])
{
    parian_light_sample s;
    if (!parian_light_sampler_sample(path->scene->sampler, light, x, 0.5, 0.5, &s)) {
        return 0;
    }
    double cosine = vec3d_dot(s.direction, normal);
    double bright = s.irradiance[0] + s.irradiance[1] + s.irradiance[2];
    return cosine > 0 ? cosine * bright : 0;
}

/* Cosine over distance squared towards a light without extent; the sign is the same all over a
 * triangle. */
static double face(const parian_light_point *light, const double x[3], const double normal[3])
{
    double to[3];
    if (light->at_infinity) {
        return fmax(vec3d_dot(light->direction, normal), 0);
    }
    vec3d_sub(to, light->position, x);
    double distance = vec3d_normalize(to);
    return distance > 0 ? fmax(vec3d_dot(to, normal), 0) / (distance * distance) : 0;
}

static triangle_light look_at_triangle(const path_scene *path, uint32_t light, uint32_t body,
                                       uint32_t triangle)
{
    const double *p[3];
    double a[3], b[3], normal[3], middle[3];
    triangle_light t = {0};
    for (int k = 0; k < 3; k++) {
        p[k] = path_corner(path, body, triangle, k);
    }
    vec3d_sub(a, p[1], p[0]);
    vec3d_sub(b, p[2], p[0]);
    vec3d_cross(normal, a, b);
    double area = 0.5 * vec3d_normalize(normal);
    if (!parian_light_is_delta(parian_light_sampler_light(path->scene->sampler, light))) {
        t.facing = t.seen = area;
        return t;
    }
    for (int k = 0; k < 3; k++) {
        middle[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
    }
    for (int i = 0; i < 4; i++) {
        const double *x = i < 3 ? p[i] : middle;
        t.seen += 0.25 * area * probe(path, light, x, normal);
        t.facing += 0.25 * area * face(&path->light[light].point, x, normal);
    }
    return t;
}

static double sum_of(const triangle_light *all, uint32_t count, bool seen)
{
    double sum = 0;
    for (uint32_t t = 0; t < count; t++) {
        sum += seen ? all[t].seen : all[t].facing;
    }
    return sum;
}

parian_result parian_path_entries_make(path_scene *path, uint32_t light)
{
    const parian_env *env = path->env;
    uint32_t count = path->triangle_total;
    triangle_light *all;
    double *cumulative = NULL;
    if (!PARIAN_NEW(env, all, count) || !PARIAN_NEW(env, cumulative, (size_t)count + 1)) {
        parian_free(env, all);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", count);
    }
    for (uint32_t t = 0; t < count; t++) {
        uint32_t body = path->triangle_body[t];
        all[t] = look_at_triangle(path, light, body, t - path->body[body].first_triangle);
    }
    double seen = sum_of(all, count, true), facing = sum_of(all, count, false), sum = 0;
    double share = seen > 0 ? 1 - BLIND_SHARE : 0;
    for (uint32_t t = 0; t < count && facing > 0; t++) {
        cumulative[t] = sum;
        sum += share * (seen > 0 ? all[t].seen / seen : 0) + (1 - share) * all[t].facing / facing;
    }
    for (uint32_t t = 0; t < count && sum > 0; t++) {
        cumulative[t] /= sum;
    }
    cumulative[count] = 1;
    parian_free(env, all);
    if (!(sum > 0)) {
        parian_free(env, cumulative);
        cumulative = NULL;
    }
    path->light[light].cumulative = cumulative;
    return PARIAN_OK;
}
