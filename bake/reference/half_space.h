/* half_space.h - the reflectance of a half-space under diffuse light by radiative transfer, without
 * noise.
 *
 * Discrete ordinates: directions are quadrature nodes on both sides of the critical angle, and the
 * reflection of an infinitely deep medium is the limit of doubling a layer. The boundary is a
 * smooth Fresnel boundary, the phase function is Henyey-Greenstein's.
 *
 * Source  doubling of layers [Hansen74]; truncation of the phase function's peak [Wiscombe77]
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_HALF_SPACE_H
#define PARIAN_BAKE_HALF_SPACE_H

/* Flux that leaves a half-space per unit of flux that has entered it from uniform light outside
 * (what the boundary reflected before entry is in neither).
 *
 * albedo   of a single scattering event, sigma_s / (sigma_s + sigma_a); clamped to [0, 1]
 * g        mean cosine of Henyey-Greenstein's phase function; clamped to [-0.995, 0.995]
 * eta      index inside over outside, positive
 *
 * Error below 1e-4 for |g| <= 0.9 and 1e-3 beyond. Uses 120 KiB of stack. Threads: pure function.
 */
double parian_half_space_reflectance(double albedo, double g, double eta);

#endif
