/* bssrdf.h - the BSSRDF models that the quadrature integrates, all as radiosity per unit of
 * transmitted flux.
 *
 * Source  standard dipole [Jensen01]; dipole-flux: methods note 3.1; directional dipole
 * [Frisvad14]; photon beam diffusion [Habel13] as in [PBRT]
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_BSSRDF_H
#define PARIAN_BAKE_BSSRDF_H

#include "bake/reference/reference.h"
#include "core/dipole.h"

typedef struct parian_bssrdf_model parian_bssrdf_model;

typedef struct parian_bssrdf_desc {
    parian_reference_model model; /* any but PATH */
    /* The printed fits of the Fresnel moments instead of the exact ones: F_dr of the dipoles, C_phi
     * and C_E of the directional dipole (eta above 1). pbd takes the exact ones. */
    bool fit_fdr;
    bool normalise; /* directional, pbd: scale each channel so that a half-space under diffuse light
                     * gives back what radiative transfer does (half_space.h); the dipoles stay as
                     * they are */
} parian_bssrdf_desc;

/* Errors: PARIAN_E_NOMEM, PARIAN_E_ARGUMENT. */
parian_result parian_bssrdf_create(const parian_env *env, const parian_medium *medium,
                                   const parian_bssrdf_desc *desc, parian_bssrdf_model **model);
void parian_bssrdf_destroy(const parian_env *env, parian_bssrdf_model *model);

/* Whether the value depends on the direction of the light. */
bool parian_bssrdf_is_directional(const parian_bssrdf_model *model);
/* Length below which the value varies: the depth of the nearest source, m; for refining a
 * quadrature. */
double parian_bssrdf_core_length(const parian_bssrdf_model *model, int channel);
/* Factor that normalise applied, per channel; 1 where it did nothing. */
double parian_bssrdf_scale(const parian_bssrdf_model *model, int channel);

/* R from x_i (outward unit normal n_i, unit direction w_i towards the light, outside) to x_o (n_o),
 * m^-2, for the three channels. Never negative; finite for x_i = x_o; light from below n_i counts
 * as grazing. Symmetric in the two places for dipole and pbd only. Threads: any. */
void parian_bssrdf_value(const parian_bssrdf_model *model, const double x_i[3], const double n_i[3],
                         const double w_i[3], const double x_o[3], const double n_o[3],
                         double R[3]);

#endif
