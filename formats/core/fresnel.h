/* fresnel.h - exact unpolarised Fresnel reflection at a smooth dielectric boundary, and its
 * moments.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_FRESNEL_H
#define PARIAN_CORE_FRESNEL_H

/* Reflectance of unpolarised light that arrives with cosine cos_i (clamped to [0, 1]) at a boundary
 * to a medium of relative index eta = n_beyond / n_here; 1 beyond the critical angle. Pure
 * functions. */
double parian_fresnel_reflectance(double cos_i, double eta);

/* 1 - reflectance: the share of flux that crosses. From outside onto a body of index eta this is
 * F_t. */
double parian_fresnel_transmittance(double cos_i, double eta);
float parian_fresnel_transmittancef(float cos_i, float eta);

/* Moments of the reflectance, integral over mu in [0, 1] of R(mu, eta) mu (first: C1) and mu^2
 * (second: C2). By quadrature on both sides of the critical angle, to 1e-9. eta as above: a body of
 * index 1.5 seen from inside is eta = 1 / 1.5. */
double parian_fresnel_c1(double eta);
double parian_fresnel_c2(double eta);

/* Share of diffuse flux inside a body of index eta that its boundary sends back: F_dr = 2
 * C1(1/eta), 0 for eta = 1; and the polynomial that the papers print (off by 0.005 at eta = 2.5).
 */
double parian_fresnel_fdr(double eta);
double parian_fresnel_fdr_fit(double eta);

/* C = 1 - 2 C1(eta), the integral of F_t cos / pi over the hemisphere outside: L = F_t B / (pi C).
 */
double parian_fresnel_exit_norm(double eta);

#endif
