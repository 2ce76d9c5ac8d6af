/* blend_solve.h - the least-squares problem of one texel's three blending weights, for three
 * channels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_BLEND_SOLVE_H
#define PARIAN_CORE_BLEND_SOLVE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct parian_blend_system {
    uint32_t count;      /* texels that are fitted */
    double normal[3][3]; /* sum of psi_j psi_k */
    double right[3][3];  /* [corner][channel] sum of psi_k times what is to be fitted */
    double reach[3];     /* c_k: integral of corner k's hat outside the window, m^2 */
    double missing[3];   /* e: energy still to be carried outside the window, per unit of flux */
    double whole[3];     /* all the energy, for relative errors */
    double floor[3][3];  /* [corner][channel] least weight: no negative response at the corner */
    double ceiling[3];   /* largest weight: hats that hardly leave the window would need any */
    float beta[3];       /* the texel's barycentrics */
} parian_blend_system;

/* Add one texel with the corners' hats, R_d, and what the global part carries. */
void parian_blend_add(parian_blend_system *system, const float psi[3], const float direct[3],
                      const float carried[3]);

/* q[corner][channel], m^-2. With fit: constrained least squares, drawn slightly to the fallback,
 * which shares the missing energy out by the barycentrics. Zero where the hats do not leave the
 * window. */
void parian_blend_solve(const parian_blend_system *system, bool fit, double q[3][3]);

/* The paper's: least squares without constraint; zero without fit. */
void parian_blend_solve_free(const parian_blend_system *system, bool fit, double q[3][3]);

#endif
