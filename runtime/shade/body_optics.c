/* body_optics.c - what shading must know of a medium: Fresnel moments and albedo.
 *
 * SPDX-License-Identifier: MIT
 */
#include "shade/body_optics.h"

#include "core/dipole.h"
#include "core/fresnel.h"
#include "core/small_maths.h"

/* int P_l(mu) mu F_t(mu) dmu over [0, 1], P_l the Legendre polynomials; midpoint rule. The
 * integrand is smooth but for a bend at one mu, so that 4,096 pieces are good to 1e-6. */
static double transmit_moment(double eta, int l)
{
    enum { PIECES = 4096 };
    double sum = 0.0;
    for (int i = 0; i < PIECES; i++) {
        double mu = (i + 0.5) / PIECES;
        double legendre = l == 0 ? 1.0 : l == 1 ? mu : 0.5 * (3.0 * mu * mu - 1.0);
        sum += legendre * mu * parian_fresnel_transmittance(mu, eta);
    }
    return sum / PIECES;
}

parian_body_optics parian_body_optics_make(const parian_medium *medium, bool fit_fdr)
{
    parian_body_optics optics = {.eta = (float)medium->eta, .tint = {1, 1, 1}};
    optics.exit_norm = (float)parian_fresnel_exit_norm(medium->eta);
    for (int l = 0; l < 3; l++) {
        optics.zonal_transmit[l] = (float)(2.0 * PARIAN_PI * transmit_moment(medium->eta, l));
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        parian_dipole dipole = parian_dipole_make(medium, c, fit_fdr);
        optics.albedo[c] = (float)parian_dipole_total(&dipole);
    }
    return optics;
}
