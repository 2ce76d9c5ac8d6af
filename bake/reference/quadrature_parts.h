/* quadrature_parts.h - what the parts of the surface quadrature share: the job, its shared places,
 * the guide.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_QUADRATURE_PARTS_H
#define PARIAN_BAKE_QUADRATURE_PARTS_H

#include <math.h>

#include "bake/reference/surface_quadrature.h"
#include "bake/reference/surface_strata.h"
#include "core/transport_model.h"

enum { QUADRATURE_BLOCK = 256 /* strata whose places are read together */ };

/* Sets the streams of random numbers apart from those of whoever else was given the seed. */
#define QUADRATURE_SALT UINT64_C(0x51AD4A7C0FFE2B37)

/* Where a stratum may stay whole as seen from a receiver: not wider than a share of its distance,
 * and with not more than `tolerance` of the energy that would leave a plane. */
typedef struct quadrature_guide {
    parian_radial_table density; /* R_d over its total, m^-2 */
    double core2;                /* squared core length, m^2 */
    double tolerance;
} quadrature_guide;

/* Numbers for lights of extent: a lattice that covers the square evenly, shifted at random. Places
 * that follow each other are neighbours, so that those around a receiver see every part of a light
 * about equally often. Source  [Roberts18], the R2 sequence */
typedef struct quadrature_lattice {
    double shift[2];
} quadrature_lattice;

static inline quadrature_lattice quadrature_lattice_make(parian_random *random)
{
    double u = parian_random_unit(random), v = parian_random_unit(random);
    return (quadrature_lattice){{u, v}};
}

static inline void quadrature_lattice_at(const quadrature_lattice *lattice, uint64_t index,
                                         double at[2])
{
    at[0] = lattice->shift[0] + 0.75487766624669276005 * (double)index;
    at[1] = lattice->shift[1] + 0.56984029099805326591 * (double)index;
    at[0] -= floor(at[0]);
    at[1] -= floor(at[1]);
}

/* Strata next to each other along the tree. */
typedef struct quadrature_block {
    double lower[3], upper[3]; /* of their centres, relative to the tree's origin */
    double radius_max, area_max;
    uint32_t first, count;
    uint32_t arrival_count; /* of this replicate */
    bool lit;               /* in this replicate */
} quadrature_block;

/* Light that arrives at a shared place from one direction: for models that tell directions apart.
 */
typedef struct quadrature_arrival {
    uint32_t place;
    float direction[3], flux[3];
} quadrature_arrival;

/* One body's strata, and the places that all receivers share in the present replicate. */
typedef struct quadrature_surface {
    uint32_t body;
    parian_strata_tree tree;
    parian_stratum *stratum; /* [stratum_count] */
    size_t stratum_count;
    quadrature_block *block; /* [block_count] */
    size_t block_count;
    float *base;        /* the allocation of the next three */
    float *position[3]; /* [block_count * QUADRATURE_BLOCK] relative to the tree's origin */
    float *normal[3];
    float *flux[3];              /* E times area, W; zero behind the last place */
    quadrature_arrival *arrival; /* [stratum_count * arrivals_per_place] */
    uint32_t arrivals_per_place; /* 0: the model does not tell directions apart */
    quadrature_guide guide;
    bool tabulated; /* `model` is made: the BSSRDF does not tell directions apart */
    parian_transport_model model;
    parian_bssrdf_model *bssrdf;
} quadrature_surface;

typedef struct quadrature_job {
    const parian_env *env;
    const parian_reference_scene *scene;
    const parian_receivers *receivers;
    const parian_reference_quadrature_desc *desc;
    quadrature_surface surface;
    const uint32_t *index; /* receivers of this body */
    size_t index_count, batch_first;
    uint64_t replicate;
    quadrature_lattice lattice;      /* of the shared places of this replicate */
    double (*mean)[3], (*square)[3]; /* per receiver: running mean and sum of squared deviations */
    uint64_t *near_count;            /* [receivers] fresh places, all replicates */
} quadrature_job;

/* Prepare a body: strata for about `places` of them, guide, model. Errors: PARIAN_E_NOMEM,
 * PARIAN_E_ARGUMENT. */
parian_result quadrature_surface_make(const quadrature_job *job, uint32_t body, uint64_t places,
                                      quadrature_surface *surface);
void quadrature_surface_free(const parian_env *env, quadrature_surface *surface);

/* Samples of all lights at a shared place. */
uint32_t quadrature_count_arrivals(const parian_reference_scene *scene);

/* Draw the shared places of the present replicate and light them. */
void quadrature_light_places(quadrature_job *job);

/* Whether a stratum must be cut finer for a receiver at squared distance r2 of its centre. */
bool quadrature_must_split(const quadrature_guide *guide, double radius, double area, double r2);

/* The replicate's B at receivers index[from..to): over the shared places of far strata, and over
 * fresh ones around the receiver. B is added to. */
void quadrature_far(const quadrature_job *job, size_t from, size_t to, double (*B)[3]);
void quadrature_near(const quadrature_job *job, size_t from, size_t to, double (*B)[3]);

#endif
