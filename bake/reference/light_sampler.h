/* light_sampler.h - light samples at a point, and radiance along a ray, for every light type.
 *
 * Conventions are those of docs/runtime.md (orientation of pictures, cone of a spot).
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_LIGHT_SAMPLER_H
#define PARIAN_BAKE_LIGHT_SAMPLER_H

#include "bake/reference/reference.h"
#include "core/random.h"

typedef struct parian_light_sampler parian_light_sampler;

/* One direction from which light arrives; its expectation over the random numbers is the light's
 * whole. */
typedef struct parian_light_sample {
    double direction[3];  /* unit, from the point towards the light */
    double distance;      /* metres; INFINITY for lights without a place */
    double irradiance[3]; /* W m^-2 on a plane perpendicular to direction: before cosine, Fresnel,
                           * shadow; for lights of extent divided by the density of the sample */
} parian_light_sample;

/* lights [count] are copied, pictures are not. Errors: PARIAN_E_ARGUMENT (which
 * light, and what is wrong with it), PARIAN_E_NOMEM. */
parian_result parian_light_sampler_create(const parian_env *env, const parian_light *lights,
                                          uint32_t count, parian_light_sampler **sampler);
void parian_light_sampler_destroy(parian_light_sampler *sampler);

uint32_t parian_light_sampler_count(const parian_light_sampler *sampler);
const parian_light *parian_light_sampler_light(const parian_light_sampler *sampler, uint32_t light);
/* Point, directional and spot lights have one direction at a point, and need no random numbers. */
bool parian_light_is_delta(const parian_light *light);

/* Sample one light at x with two uniform numbers; rect by area, environment by its luminance (by
 * the cosine-free sphere where it has no picture). Returns false where it gives nothing. */
bool parian_light_sampler_sample(const parian_light_sampler *sampler, uint32_t light,
                                 const double x[3], double u, double v,
                                 parian_light_sample *sample);

/* Radiance that a ray meets beyond all surfaces: rects that face it, nearest first, else
 * environments; L [3], W m^-2 sr^-1. only_light: one light, or PARIAN_RAY_NONE for all.
 * hit_distance (may be NULL): distance to the rect, or INFINITY. */
void parian_light_sampler_radiance(const parian_light_sampler *sampler, uint32_t only_light,
                                   const double origin[3], const double direction[3], double L[3],
                                   double *hit_distance);

/* Transmitted irradiance of one light at a place of a body (smooth normal n, exact Fresnel of eta,
 * shadows by rays from a point moved off the facets by the terminator offset of irradiance.c);
 * count samples for a light of extent. E [3] is added to. */
typedef struct parian_place {
    uint32_t body, triangle;
    double position[3], normal[3], smooth_normal[3], barycentric[3];
} parian_place;
void parian_reference_irradiance(const parian_reference_scene *scene, uint32_t light,
                                 const parian_place *place, uint32_t count, parian_random *random,
                                 double E[3]);
/* The same for one light sample: its direction (unit, outside, towards the light) and the
 * transmitted irradiance that it brings, zero where it is shadowed or below the horizon. */
void parian_reference_light_sample(const parian_reference_scene *scene, uint32_t light,
                                   const parian_place *place, parian_random *random,
                                   double direction[3], double E[3]);
/* The same from two uniform numbers of the caller's choice. */
void parian_reference_light_sample_at(const parian_reference_scene *scene, uint32_t light,
                                      const parian_place *place, double u, double v,
                                      double direction[3], double E[3]);

#endif
