/* path_parts.h - what the files of volumetric path tracing share: the scene as paths see it, the
 * walker, tallies.
 *
 * Weights. B(x) = integral of L_out cos over the outside hemisphere, and L_out = T L_in / eta^2. A
 * direction chosen with density cos / pi outside and refracted inwards therefore starts a walk of
 * weight pi T that gathers L_in / eta^2. What it gathers where it leaves again is T eta^2 L_outside
 * / eta^2: the squares cancel, and choosing to leave with probability T leaves L_outside. What it
 * gathers by a connection to a light at a scattering event is albedo * phase * fluence / eta^2:
 * there the square stays.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_PARTS_H
#define PARIAN_BAKE_PATH_PARTS_H

#include "bake/reference/light_sampler.h"
#include "bake/reference/path_grid.h"
#include "bake/reference/path_medium.h"
#include "bake/reference/path_tracing.h"
#include "bake/reference/rays.h"
#include "bake/reference/refracted_paths.h"

/* How the adjoint walks meet a light. */
typedef enum path_meeting {
    PATH_BY_EXIT = 0,   /* where a walk leaves the body: lights of extent */
    PATH_BY_CONNECTION, /* from every event straight through a facet: lights without extent; the
                           rest is REMAINDER */
    PATH_BY_FORWARD     /* not at all: photons bring all of it */
} path_meeting;

typedef struct path_light {
    path_meeting meeting;
    parian_light_point point; /* of lights without extent */
    parian_refractor_index *
        *index;         /* [bodies] of light from infinity met by connection, else NULL */
    double *cumulative; /* [triangle_total + 1] chance of a photon to start below a triangle; NULL:
                           gives none */
} path_light;

typedef struct path_body {
    const parian_reference_body *source;
    parian_path_medium medium[3];
    parian_path_grid grid;
    parian_refractor *refractor; /* NULL where no light is met by connection */
    double index_length;         /* longest path that the lights' indices find */
    uint32_t first_triangle;     /* of the body in the list of all */
    double extent;
} path_body;

/* Receivers by place, and the area of surface that their patches hold. */
typedef struct path_patches {
    double radius, lower[3], inverse;
    uint32_t size[3];
    uint32_t *first, *member; /* [cells + 1], [count] */
    double *area;             /* [count] m^2 */
} path_patches;

typedef struct path_scene {
    const parian_env *env;
    const parian_reference_scene *scene;
    const parian_receivers *receivers;
    uint64_t seed;
    path_body *body;                         /* [scene->body_count] */
    path_light *light;                       /* [scene->light_count] */
    uint32_t triangle_total, *triangle_body; /* all bodies' triangles in a row, [triangle_total] */
    path_patches patches;
    bool any_connection, any_forward;
} path_scene;

/* A place inside a body and a direction. */
typedef struct path_walker {
    uint32_t body, triangle; /* that it stands on, or PARIAN_RAY_NONE */
    double position[3], direction[3];
    double normal[3]; /* outward, of the triangle, after PATH_MEETS_BOUNDARY */
} path_walker;

typedef enum path_event { PATH_SCATTERS = 0, PATH_MEETS_BOUNDARY, PATH_IS_LOST } path_event;

/* Fly to the next scattering event or to the boundary. albedo is written where it scatters. */
path_event parian_path_fly(const path_scene *path, int channel, path_walker *walker,
                           parian_random *random, double *albedo);
/* The boundary ahead, whatever scatters before it; its distance. False where there is none. */
bool parian_path_boundary(const path_scene *path, path_walker *walker, double length,
                          double *distance);
/* A walk that has met the boundary very often since it last scattered dies with a small probability
 * at each further meeting, so that light caught by total reflection in a clear body ends too. */
bool parian_path_caught(double *weight, uint32_t meetings, parian_random *random,
                        parian_walk_books *books);

/* Light that a walk finds where it leaves along direction (unit, outside) from a place on a
 * triangle. */
double parian_path_exit_light(const path_scene *path, int channel, const path_walker *walker,
                              const double direction[3]);
/* The same from every light without extent to a scattering event: sum over straight connections of
 * phase * fluence, sr^-1 W m^-2; an unbiased estimate whose search radius is random. */
double parian_path_connect(const path_scene *path, int channel, const path_walker *walker,
                           parian_random *random);
/* Rate of that radius, m^-1: a share of the extinction that no path falls below. */
double parian_path_connection_rate(const parian_path_medium *medium);
/* What comes straight to a receiver: flux that leaves there, W m^-2; exact. */
double parian_path_straight(const path_scene *path, int channel, size_t receiver);
/* Irradiance in one channel on a plane at x perpendicular to the light, where the light is visible
 * from x, a place on a triangle of a body, else 0; its direction and what u and v choose. */
double parian_path_visible_light(const path_scene *path, uint32_t light, int channel, uint32_t body,
                                 uint32_t triangle, const double x[3], double u, double v,
                                 double direction[3]);

typedef struct path_tally {
    double sum, square, unscattered;
} path_tally;

/* Walks first to first + count - 1 from one receiver in one channel; adds to tally and books. */
void parian_path_adjoint(const path_scene *path, size_t receiver, int channel, uint64_t first,
                         uint32_t count, path_tally *tally, parian_walk_books *books);

/* Which photons count. */
typedef enum path_share {
    PATH_REMAINDER =
        0, /* those reflected inside before they first scatter: what connections cannot reach */
    PATH_EVERYTHING
} path_share;

/* Photons of one light in one channel. flux [receivers][2]: flux that left within each patch and
 * its part that never scattered, W times the count of photons; NULL: books alone. Books in W times
 * the count. */
typedef struct path_photons {
    uint32_t light;
    int channel;
    path_share share;
    uint64_t first;
    uint32_t count;
} path_photons;
void parian_path_forward(const path_scene *path, const path_photons *photons, double (*flux)[2],
                         parian_walk_books *books);

/* Where photons of a light may start; NULL where the light reaches nothing. Errors: PARIAN_E_NOMEM.
 */
parian_result parian_path_entries_make(path_scene *path, uint32_t light);
parian_result parian_path_patches_make(path_scene *path, double radius);
void parian_path_patches_free(path_scene *path);
/* Call found for every receiver whose patch holds a place of a body with this normal. */
typedef void (*path_patch_found)(void *context, size_t receiver);
void parian_path_patches_at(const path_scene *path, uint32_t body, const double position[3],
                            const double normal[3], path_patch_found found, void *context);

/* Corner k of a triangle of a body. */
static inline const double *path_corner(const path_scene *path, uint32_t body, uint32_t triangle,
                                        int k)
{
    const parian_mesh *mesh = &path->scene->bodies[body].mesh;
    return mesh->position[mesh->triangle[triangle][k]];
}

/* A place by barycentrics. */
static inline void path_place(const path_scene *path, uint32_t body, uint32_t triangle,
                              const double barycentric[3], double position[3])
{
    const double *a = path_corner(path, body, triangle, 0);
    const double *b = path_corner(path, body, triangle, 1);
    const double *c = path_corner(path, body, triangle, 2);
    for (int k = 0; k < 3; k++) {
        position[k] = barycentric[0] * a[k] + barycentric[1] * b[k] + barycentric[2] * c[k];
    }
}

#endif
