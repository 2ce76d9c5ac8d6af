/* planar_oracles.h - totals of an independent Monte Carlo program for half-space, slabs and
 * spheres.
 *
 * Isotropic scattering, albedo 0.9984376, eta 1.5 (green marble), sigma_t = 1, light transmitted at
 * one point, diffuse or along the normal; shares of the transmitted flux. From
 * oracles/mc/{hs_mar_d,hs_mar_n,slab_mar_T,sph_mar_R}.txt of the project's shared data. Those files
 * state neither photons nor errors; the scatter of neighbouring bins says about a million photons
 * each, so their standard error is taken as that of a run of ours with as many.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_PLANAR_ORACLES_H
#define PARIAN_TEST_PLANAR_ORACLES_H

#include "bake/reference/planar.h"

#define PLANAR_ORACLE_PHOTONS 1e6

typedef struct planar_oracle {
    const char *name;
    parian_planar_shape shape;
    double size;
    bool normal_incidence;
    double total[2], unscattered; /* lit side, far side; unscattered share of both */
} planar_oracle;

static const planar_oracle planar_oracles[] = {
    {"half-space, diffuse", PARIAN_HALF_SPACE, 0, false, {0.804945, 0}, 0},
    {"half-space, normal", PARIAN_HALF_SPACE, 0, true, {0.799232, 0}, 0},
    {"slab 0.5", PARIAN_SLAB, 0.5, false, {0.247764, 0.748399}, 0.544916},
    {"slab 1", PARIAN_SLAB, 1, false, {0.358216, 0.634124}, 0.304239},
    {"slab 2", PARIAN_SLAB, 2, false, {0.480810, 0.503962}, 0.097801},
    {"slab 5", PARIAN_SLAB, 5, false, {0.635578, 0.327175}, 0.003482},
    {"slab 10", PARIAN_SLAB, 10, false, {0.732605, 0.196713}, 0.000021},
    {"slab 20", PARIAN_SLAB, 20, false, {0.788519, 0.088795}, 0},
    {"sphere 0.5", PARIAN_SPHERE, 0.5, false, {0.997487, 0}, 0.392483},
    {"sphere 1", PARIAN_SPHERE, 1, false, {0.994922, 0}, 0.159327},
    {"sphere 2", PARIAN_SPHERE, 2, false, {0.989803, 0}, 0.027605},
    {"sphere 5", PARIAN_SPHERE, 5, false, {0.974852, 0}, 0.000166},
    {"sphere 10", PARIAN_SPHERE, 10, false, {0.951543, 0}, 0},
    {"sphere 25", PARIAN_SPHERE, 25, false, {0.898486, 0}, 0},
};
enum { PLANAR_ORACLE_COUNT = sizeof planar_oracles / sizeof *planar_oracles };

static inline parian_walk_medium planar_oracle_medium(void)
{
    return parian_walk_medium_of(0.9984376, 1 - 0.9984376, 0, 1.5);
}

static inline parian_planar_desc planar_oracle_desc(const planar_oracle *oracle, uint64_t photons,
                                                    uint64_t seed)
{
    return (parian_planar_desc){.shape = oracle->shape,
                                .size = oracle->size,
                                .medium = planar_oracle_medium(),
                                .normal_incidence = oracle->normal_incidence,
                                .photons = photons,
                                .seed = seed};
}

#endif
