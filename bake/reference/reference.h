/* reference.h - ground truth: the scene, the receivers and the results that every reference model shares.
 *
 * Two truths: the chosen BSSRDF integrated over the surface (the discretisation error is measured against
 * it), and the radiative transfer equation in the real geometry (the model error).
 *
 * B is the common currency: radiosity in the sense of L_o = F_t B / (pi C), W m^-2. A BSSRDF model is
 * evaluated as R = radiosity per unit of transmitted flux, m^-2, so that B = sum of R E dA.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_H
#define PARIAN_BAKE_REFERENCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/medium.h"
#include "core/mesh.h"
#include "parian/light.h"

typedef enum parian_reference_model {
    PARIAN_REFERENCE_DIPOLE = 0,  /* standard dipole, by distance */
    PARIAN_REFERENCE_DIPOLE_FLUX, /* two sources, true gradient at the receiver */
    PARIAN_REFERENCE_DIRECTIONAL, /* directional dipole */
    PARIAN_REFERENCE_PBD,         /* photon beam diffusion with single scattering */
    PARIAN_REFERENCE_PATH         /* volumetric path tracing */
} parian_reference_model;

/* Coefficients that vary inside a body: a grid over the body's bounding box, read trilinearly between node
 * centres that sit on the box's faces; g and eta are the medium's. */
typedef struct parian_medium_field {
    uint32_t size[3];    /* nodes along x, y, z, each at least 2 */
    double lower[3], upper[3]; /* the box, metres */
    float (*sigma_s)[3]; /* [z][y][x] m^-1, not reduced */
    float (*sigma_a)[3]; /* [z][y][x] m^-1 */
} parian_medium_field;

/* One body. mesh has corner_normal: the smooth normals that E uses, as in a bake (crease 50 degrees). */
typedef struct parian_reference_body {
    char name[PARIAN_NAME_MAX];
    parian_mesh mesh; /* metres; an oriented 2-manifold with boundary */
    bool closed;      /* no boundary edge: inside and outside are known */
    parian_medium medium;
    parian_medium_field *field; /* NULL: homogeneous */
    bool fit_fdr;               /* what an asset was baked with; false for a model */
} parian_reference_body;

struct parian_rays;
struct parian_light_sampler;

typedef struct parian_reference_scene {
    uint32_t body_count, surrounding_count, light_count;
    parian_reference_body *bodies;
    parian_mesh *surroundings; /* opaque; they only cast shadows */
    parian_light *lights;
    double lower[3], upper[3]; /* box of bodies and surroundings */
    double extent;             /* longest side of the bodies' box, metres */
    struct parian_rays *rays;  /* meshes: bodies first, then surroundings */
    struct parian_light_sampler *sampler;
} parian_reference_scene;

/* Places on bodies where B is wanted. */
typedef struct parian_receivers {
    size_t count;
    double (*position)[3];
    double (*normal)[3];       /* unit, of the triangle */
    double (*smooth_normal)[3];/* unit, interpolated: what E uses */
    double *area;              /* the surface that each stands for, m^2 */
    uint32_t *body, *triangle;
    double (*barycentric)[3];
} parian_receivers;

/* What a model yields, per receiver and channel; every array [count][3]. */
typedef struct parian_reference_result {
    double (*irradiance)[3];     /* E, transmitted, on the smooth normal */
    double (*radiosity)[3];      /* B */
    double (*standard_error)[3]; /* of B, one standard deviation */
    double (*unscattered)[3];    /* path: the part of B that never scattered; else NULL */
    uint64_t samples;            /* per receiver and channel, as reached */
    double seconds;
    /* path: energy books, W per channel, and what roulette added and removed, so that
     * in + roulette_added = out + absorbed + roulette_removed + lost to 1e-6 */
    double in[3], out[3], absorbed[3], roulette_added[3], roulette_removed[3], lost[3];
    uint64_t scattering_events;
} parian_reference_result;

void parian_reference_scene_free(const parian_env *env, parian_reference_scene *scene);
void parian_receivers_free(const parian_env *env, parian_receivers *receivers);
void parian_reference_result_free(const parian_env *env, parian_reference_result *result);
parian_result parian_reference_result_init(const parian_env *env, size_t count, bool with_unscattered,
                                           parian_reference_result *result);

#endif
