/* body_optics.c - what shading must know of a medium: Fresnel moments and albedo.
 *
 * SPDX-License-Identifier: MIT
 */
#include "shade/body_optics.h"

#include "core/dipole.h"
#include "core/fresnel.h"

parian_body_optics parian_body_optics_make(const parian_medium *medium, bool fit_fdr)
{
    parian_body_optics optics = {.eta = (float)medium->eta, .tint = {1, 1, 1}};
    optics.exit_norm = (float)parian_fresnel_exit_norm(medium->eta);
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        parian_dipole dipole = parian_dipole_make(medium, c, fit_fdr);
        optics.albedo[c] = (float)parian_dipole_total(&dipole);
    }
    return optics;
}
