/* irradiance.c - E at a place of a body: smooth normal, exact Fresnel transmittance, shadows by
 * rays.
 *
 * Shadow rays start from the surface that the corner normals span, so that facets of a curved
 * surface do not shadow their neighbours by the horizon. Source  [Hanika21]
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/light_sampler.h"
#include "bake/reference/rays.h"
#include "bake/reference/vec3d.h"
#include "core/fresnel.h"

static const double pi = 3.14159265358979323846;
/* Height above the facet at which shadow rays start, in units of the scene's extent; and the share
 * of their length that is left out before a light, which may lie on a surface. */
static const double LIFT = 1e-7, END_SHARE = 1e-9;

/* Where shadow rays from a place start. */
static void shadow_origin(const parian_reference_scene *scene, const parian_place *place,
                          double origin[3])
{
    const parian_mesh *mesh = &scene->bodies[place->body].mesh;
    vec3d_copy(origin, place->position);
    vec3d_add_scaled(origin, place->normal, LIFT * scene->extent);
    for (int k = 0; mesh->corner_normal && k < 3; k++) {
        double normal[3], from_corner[3];
        vec3d_from_float(normal, mesh->corner_normal[place->triangle][k]);
        vec3d_sub(from_corner, place->position, mesh->position[mesh->triangle[place->triangle][k]]);
        double below = fmin(0, vec3d_dot(from_corner, normal));
        vec3d_add_scaled(origin, normal, -below * place->barycentric[k]);
    }
}

static bool is_shadowed(const parian_reference_scene *scene, const parian_place *place,
                        const parian_light_sample *sample)
{
    parian_ray ray = {.length = INFINITY, .mesh = PARIAN_RAY_NONE, .triangle = PARIAN_RAY_NONE};
    shadow_origin(scene, place, ray.origin);
    vec3d_copy(ray.direction, sample->direction);
    if (isfinite(sample->distance)) {
        vec3d_sub(ray.direction, place->position, ray.origin);
        vec3d_add_scaled(ray.direction, sample->direction, sample->distance);
        ray.length = vec3d_normalize(ray.direction) * (1 - END_SHARE);
    }
    return ray.length > 0 && parian_rays_blocked(scene->rays, &ray, PARIAN_RAY_NONE);
}

/* Two unit vectors perpendicular to a third and to each other.
 * Source  [Duff17] */
static void make_tangents(const double n[3], double u[3], double v[3])
{
    double sign = copysign(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    u[0] = 1 + sign * n[0] * n[0] * a;
    u[1] = sign * b;
    u[2] = -sign * n[0];
    v[0] = b;
    v[1] = sign + n[1] * n[1] * a;
    v[2] = -n[1];
}

/* A direction of a uniform sky by the cosine: every sample weighs pi L / cosine. */
static bool sample_uniform_sky(const parian_light *light, const double normal[3], double u,
                               double v, parian_light_sample *sample)
{
    double tangent[2][3], cosine = sqrt(1 - u), sine = sqrt(u), phi = 2 * pi * v;
    make_tangents(normal, tangent[0], tangent[1]);
    for (int k = 0; k < 3; k++) {
        sample->direction[k] =
            cosine * normal[k] + sine * (cos(phi) * tangent[0][k] + sin(phi) * tangent[1][k]);
        sample->irradiance[k] = pi * (double)light->color[k] / fmax(cosine, 1e-9);
    }
    sample->distance = INFINITY;
    return true;
}

void parian_reference_light_sample_at(const parian_reference_scene *scene, uint32_t light,
                                      const parian_place *place, double u, double v,
                                      double direction[3], double E[3])
{
    const parian_light *source = parian_light_sampler_light(scene->sampler, light);
    const double *normal = place->smooth_normal;
    parian_light_sample sample;
    bool uniform = source->type == PARIAN_LIGHT_ENVIRONMENT && !source->image.pixel;
    E[0] = E[1] = E[2] = 0;
    vec3d_copy(direction, normal);
    if (!(uniform ? sample_uniform_sky(source, normal, u, v, &sample)
                  : parian_light_sampler_sample(scene->sampler, light, place->position, u, v,
                                                &sample))) {
        return;
    }
    vec3d_copy(direction, sample.direction);
    double cosine = vec3d_dot(normal, sample.direction);
    if (!(cosine > 0) || is_shadowed(scene, place, &sample)) {
        return;
    }
    double eta = scene->bodies[place->body].medium.eta;
    vec3d_add_scaled(E, sample.irradiance, cosine * parian_fresnel_transmittance(cosine, eta));
}

void parian_reference_light_sample(const parian_reference_scene *scene, uint32_t light,
                                   const parian_place *place, parian_random *random,
                                   double direction[3], double E[3])
{
    double u = parian_random_unit(random), v = parian_random_unit(random);
    parian_reference_light_sample_at(scene, light, place, u, v, direction, E);
}

void parian_reference_irradiance(const parian_reference_scene *scene, uint32_t light,
                                 const parian_place *place, uint32_t count, parian_random *random,
                                 double E[3])
{
    /* A lattice in the square by the golden ratio, shifted at random: each point is uniform by
     * itself, all together are even. */
    static const double golden = 0.61803398874989484820;
    double shift_u = parian_random_unit(random), shift_v = parian_random_unit(random);
    double sum[3] = {0}, direction[3], one[3];
    if (parian_light_is_delta(parian_light_sampler_light(scene->sampler, light))) {
        count = 1;
    }
    for (uint32_t i = 0; i < count; i++) {
        double u = shift_u + (double)i / count, v = shift_v + golden * i;
        parian_reference_light_sample_at(scene, light, place, u - floor(u), v - floor(v), direction,
                                         one);
        vec3d_add_scaled(sum, one, 1);
    }
    if (count > 0) {
        vec3d_add_scaled(E, sum, 1.0 / count);
    }
}
