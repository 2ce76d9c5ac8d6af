/* surface_samples.h - a Poisson-disk sample set of a surface, as plain arrays.
 *
 * No two samples that face alike (positive dot product of their facets' normals) are nearer than
 * the set's radius, and every point of the surface has a sample that faces alike within it. Samples
 * are in a progressive order: any first part of them is well spread.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_SURFACE_SAMPLES_H
#define PARIAN_CORE_SURFACE_SAMPLES_H

#include <stdint.h>

#include "core/point_grid.h"

typedef struct parian_surface_samples {
    uint32_t count;
    double radius_m;         /* least distance of samples that face alike; straight, not geodesic */
    uint32_t *triangle;      /* [count] the triangle that a sample lies on */
    float (*barycentric)[2]; /* [count] of its corners 0 and 1; the rest is corner 2's; in [0,1] */
    float *area;   /* [count] m^2, of the surface that is nearest to the sample; they sum to
                    * that of the surface */
    float *radius; /* [count] metres to the nearest sample before it that faces alike; the
                    * box's diagonal where there is none. The least of the first n is the
                    * least distance among them. */
} parian_surface_samples;

void parian_surface_samples_free(const parian_env *env, parian_surface_samples *samples);

/* The surface that samples lie on. Normals of triangles without area are zero: nothing faces them
 * alike. */
typedef struct parian_sampled_surface {
    uint32_t triangle_count;
    const float (*vertex)[3];
    const uint32_t (*triangle)[3];
} parian_sampled_surface;

/* Position of barycentrics as they are stored, and the normal of the facet; in double. */
parian_point parian_surface_point(const parian_sampled_surface *surface, uint32_t triangle,
                                  const float barycentric[2]);

#endif
