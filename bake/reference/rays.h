/* rays.h - nearest hit and occlusion among triangle meshes, by Embree (C interface, robust mode).
 *
 * Coordinates go in as doubles and are traced as floats relative to the scene's centre, in units of its
 * extent. A flat triangle cannot be met twice by a straight ray: the one that the ray starts on is skipped.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_RAYS_H
#define PARIAN_BAKE_RAYS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/mesh.h"

enum { PARIAN_RAY_NONE = 0xFFFFFFFFu };

typedef struct parian_rays parian_rays;

typedef struct parian_ray {
    double origin[3], direction[3]; /* direction of unit length */
    double length;                  /* metres; INFINITY for no end */
    uint32_t mesh, triangle;        /* that the origin lies on, or PARIAN_RAY_NONE */
} parian_ray;

typedef struct parian_ray_hit {
    uint32_t mesh, triangle;
    double distance;       /* metres */
    double barycentric[3];
    double normal[3];      /* unit, of the triangle, outward by its orientation */
} parian_ray_hit;

/* meshes [count] are copied. Errors: PARIAN_E_NOMEM, PARIAN_E_ARGUMENT. */
parian_result parian_rays_create(const parian_env *env, const parian_mesh *const *meshes, uint32_t count,
                                 parian_rays **rays);
void parian_rays_destroy(parian_rays *rays);

/* Nearest hit; false when there is none. only_mesh: PARIAN_RAY_NONE for all. Threads: any. */
bool parian_rays_nearest(const parian_rays *rays, const parian_ray *ray, uint32_t only_mesh,
                         parian_ray_hit *hit);
/* Whether anything lies strictly between the origin and length. */
bool parian_rays_blocked(const parian_rays *rays, const parian_ray *ray, uint32_t only_mesh);

#endif
