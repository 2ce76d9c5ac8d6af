/* refracted_paths.h - next-event estimation through the boundary: every straight path from a point
 * inside a triangle mesh through one facet, by Snell's law, to a point or direction of light
 * outside.
 *
 * On a flat facet a directional light has a closed form and a point light a root in one variable;
 * which facets can carry a path is found by a hierarchy of boxes and cones of normals, so that none
 * is missed.
 *
 * Source  [Walter09] for the search with position and half-vector bounds
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFRACTED_PATHS_H
#define PARIAN_BAKE_REFRACTED_PATHS_H

#include <stdbool.h>
#include <stdint.h>

#include "core/mesh.h"

enum { PARIAN_REFRACTOR_NO_SKIP = 0xFFFFFFFFu };

typedef struct parian_refractor parian_refractor;

/* A light as a single point, or as a direction from infinity. */
typedef struct parian_light_point {
    bool at_infinity;
    double position[3];  /* of the point */
    double direction[3]; /* at infinity: unit, towards the light */
} parian_light_point;

typedef struct parian_refracted_path {
    uint32_t triangle;
    double entry[3];       /* y on the facet */
    double to_light[3];    /* unit, from y, outside */
    double light_distance; /* metres; INFINITY at infinity */
    double into[3];        /* unit, from y to x, inside */
    double length;         /* |x - y| */
    /* Irradiance on a plane at x perpendicular to `into`, without absorption in the medium and
     * without shadows: directional lights per unit of irradiance on a plane perpendicular to the
     * light's direction outside (T cos_i / cos_t); point lights per unit of intensity (m^-2).
     * Fresnel transmission is in it. */
    double factor;
} parian_refracted_path;

/* eta: index inside over outside, any positive value. The mesh is copied; triangles without an area
 * or with a coordinate that is not finite carry no paths. Errors: PARIAN_E_NOMEM; PARIAN_E_ARGUMENT
 * (eta is not positive and finite, a triangle names a vertex that does not exist). */
parian_result parian_refractor_create(const parian_env *env, const parian_mesh *mesh, double eta,
                                      parian_refractor **refractor);
void parian_refractor_destroy(parian_refractor *refractor);

/* Call found for every path not longer than max_length from x, in the order of the triangles'
 * places in the hierarchy. x may lie on the surface: skip_triangle (or PARIAN_REFRACTOR_NO_SKIP)
 * carries no path. Shadows, and facets between x and y, are the caller's to test. A path through an
 * edge that two coplanar facets share is counted once. What is not finite (x, light) has no paths.
 * Threads: any. */
typedef void (*parian_refracted_path_found)(void *context, const parian_refracted_path *path);
void parian_refracted_paths(const parian_refractor *refractor, const double x[3],
                            const parian_light_point *light, double max_length,
                            uint32_t skip_triangle, parian_refracted_path_found found,
                            void *context);

/* A search made for one direction of light at infinity and for paths of at most max_length: finds
 * the same paths (in an order of its own) several times faster. The refractor must outlive it.
 *
 * Errors   PARIAN_E_NOMEM; PARIAN_E_ARGUMENT (the direction is not finite, or zero; max_length is
 * not positive)
 */
typedef struct parian_refractor_index parian_refractor_index;
parian_result parian_refractor_prepare_direction(const parian_env *env,
                                                 const parian_refractor *refractor,
                                                 const double direction[3], double max_length,
                                                 parian_refractor_index **index);
void parian_refractor_index_destroy(parian_refractor_index *index);
/* As parian_refracted_paths, with the direction of the index; max_length up to that of the index.
 * Threads: any. */
void parian_refractor_index_paths(const parian_refractor_index *index, const double x[3],
                                  double max_length, uint32_t skip_triangle,
                                  parian_refracted_path_found found, void *context);

/* What a search cost: nodes of four children that were opened, facets that were tested. */
typedef struct parian_refracted_cost {
    uint64_t nodes, facets;
} parian_refracted_cost;
/* The two searches above, with their cost added to cost. */
void parian_refracted_paths_counted(const parian_refractor *refractor, const double x[3],
                                    const parian_light_point *light, double max_length,
                                    uint32_t skip_triangle, parian_refracted_path_found found,
                                    void *context, parian_refracted_cost *cost);
void parian_refractor_index_paths_counted(const parian_refractor_index *index, const double x[3],
                                          double max_length, uint32_t skip_triangle,
                                          parian_refracted_path_found found, void *context,
                                          parian_refracted_cost *cost);

#endif
