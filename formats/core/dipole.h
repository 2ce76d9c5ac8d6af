/* dipole.h - the standard dipole: diffuse reflectance R_d of a half-space, by distance and with
 * geometry.
 *
 * R_d is radiosity that leaves per unit of flux that has crossed the boundary, m^-2. Lengths are
 * metres.
 *
 * Source  [Jensen01], [Lensch02] figure 2; F_dr is the exact Fresnel moment unless the fit is asked
 * for
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_DIPOLE_H
#define PARIAN_CORE_DIPOLE_H

#include <stdbool.h>

#include "core/medium.h"

typedef struct parian_dipole {
    double sigma_t_prime; /* sigma_s' + sigma_a, m^-1 */
    double albedo;        /* alpha' = sigma_s' / sigma_t' */
    double diffusion;     /* D = 1 / (3 sigma_t'), m */
    double sigma_tr;      /* sqrt(3 sigma_a sigma_t'), m^-1 */
    double f_dr, a;       /* A = (1 + F_dr) / (1 - F_dr) */
    double z_r, z_v;      /* depth of the source, height of its image, m */
} parian_dipole;

/* Parameters of one channel of a medium. A channel that does not scatter has albedo 0, hence R_d =
 * 0. */
parian_dipole parian_dipole_make(const parian_medium *medium, int channel, bool fit_fdr);

/* R_d at squared distance r2 on a plane, and its derivative with respect to r2 (m^-4). */
double parian_dipole_rd(const parian_dipole *dipole, double r2);
double parian_dipole_slope(const parian_dipole *dipole, double r2);

/* Laplacian of R_d over the plane at squared distance r2, m^-4. */
double parian_dipole_laplacian(const parian_dipole *dipole, double r2);

/* C(radius): energy that leaves within a disc around the point of entry, closed form; and
 * C(infinity). On a sphere of radius R the whole energy is C(2R), for the area within chord d of a
 * point is pi d^2. */
double parian_dipole_disc_energy(const parian_dipole *dipole, double radius);
double parian_dipole_total(const parian_dipole *dipole);

/* R_d from x_i with outward normal n_i to x_o with n_o: flux of the two sources' field through the
 * surface at x_o (methods note 3.1), never negative, with the distance to the real source at least
 * z_r / 4. Equals parian_dipole_rd on a plane. Not symmetric. */
double parian_dipole_flux(const parian_dipole *dipole, const double x_i[3], const double n_i[3],
                          const double x_o[3], const double n_o[3]);

#endif
