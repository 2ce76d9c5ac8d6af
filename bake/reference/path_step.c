/* path_step.c - one flight of a walk inside a body: to the next scattering event, or to the
 * boundary.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_parts.h"

#include "bake/reference/vec3d.h"

/* Meetings of the boundary without scattering after which roulette begins, and its odds. */
enum { PATH_MEETINGS_FREE = 64 };
static const double CAUGHT_SURVIVAL = 0.9;

/* Surfaces met from outside, which only a walk at a crossing of the surface with itself meets, are
 * passed. */
enum { PATH_PASSES_MAX = 16 };

bool parian_path_boundary(const path_scene *path, path_walker *walker, double length,
                          double *distance)
{
    parian_ray ray = {.length = length, .mesh = walker->body, .triangle = walker->triangle};
    parian_ray_hit hit;
    vec3d_copy(ray.origin, walker->position);
    vec3d_copy(ray.direction, walker->direction);
    *distance = 0;
    for (int pass = 0; pass < PATH_PASSES_MAX; pass++) {
        if (!parian_rays_nearest(path->scene->rays, &ray, walker->body, &hit)) {
            return false;
        }
        *distance += hit.distance;
        path_place(path, walker->body, hit.triangle, hit.barycentric, ray.origin);
        if (vec3d_dot(hit.normal, ray.direction) > 0) {
            walker->triangle = hit.triangle;
            vec3d_copy(walker->position, ray.origin);
            vec3d_copy(walker->normal, hit.normal);
            return true;
        }
        ray.triangle = hit.triangle;
        ray.length -= hit.distance;
    }
    return false;
}

/* Whether a tentative event at the walker's place is a real one (delta tracking), and its albedo.
 */
static bool scatters(const parian_path_medium *medium, const path_walker *walker,
                     parian_random *random, double *albedo)
{
    double sigma_s, sigma_a;
    if (!medium->field) {
        *albedo = medium->walk.albedo;
        return true;
    }
    parian_path_medium_at(medium, walker->position, &sigma_s, &sigma_a);
    double sigma_t = sigma_s + sigma_a;
    *albedo = sigma_t > 0 ? sigma_s / sigma_t : 0;
    return parian_random_unit(random) * medium->majorant < sigma_t;
}

path_event parian_path_fly(const path_scene *path, int channel, path_walker *walker,
                           parian_random *random, double *albedo)
{
    const path_body *body = &path->body[walker->body];
    const parian_path_medium *medium = &body->medium[channel];
    for (;;) {
        double flight = parian_walk_flight(medium->majorant, random), distance;
        double safe = parian_path_grid_distance(&body->grid, walker->position);
        if (safe < 0) {
            return PATH_IS_LOST;
        }
        if (!(flight < safe)) {
            if (parian_path_boundary(path, walker, flight, &distance)) {
                return PATH_MEETS_BOUNDARY;
            }
            if (!(flight < INFINITY)) {
                return PATH_IS_LOST;
            }
        }
        vec3d_add_scaled(walker->position, walker->direction, flight);
        walker->triangle = PARIAN_RAY_NONE;
        if (scatters(medium, walker, random, albedo)) {
            return PATH_SCATTERS;
        }
    }
}

bool parian_path_caught(double *weight, uint32_t meetings, parian_random *random,
                        parian_walk_books *books)
{
    return meetings > PATH_MEETINGS_FREE &&
           !parian_walk_roulette(weight, INFINITY, *weight / CAUGHT_SURVIVAL, random, books);
}
