/* path_medium.h - one channel of a body's medium as a path sees it: constant, or varying on a grid
 * of nodes.
 *
 * Flights in a varying medium are made by delta tracking against the largest coefficient
 * [Woodcock65]; the transmittance of a connection is exact: along a ray a trilinear coefficient is
 * a cubic in every cell, which Gauss-Legendre with two nodes integrates without error, so that
 * ratio tracking and its noise are not needed.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_MEDIUM_H
#define PARIAN_BAKE_PATH_MEDIUM_H

#include "bake/reference/reference.h"
#include "bake/reference/walk.h"

typedef struct parian_path_medium {
    parian_walk_medium walk;          /* where field is NULL; g and eta always */
    const parian_medium_field *field; /* the body's, or NULL */
    int channel;
    double majorant; /* largest sigma_t, m^-1 */
    double minorant; /* smallest sigma_t, m^-1 */
    double mean;     /* mean sigma_t of the nodes, m^-1 */
} parian_path_medium;

parian_path_medium parian_path_medium_make(const parian_reference_body *body, int channel);

/* Errors: PARIAN_E_ARGUMENT: coefficients or a field that are negative, not finite, or have no
 * place. */
parian_result parian_path_medium_check(const parian_env *env, const parian_reference_body *body);

/* sigma_s and sigma_a at x, m^-1. */
void parian_path_medium_at(const parian_path_medium *medium, const double x[3], double *sigma_s,
                           double *sigma_a);

/* Integral of sigma_t from x along a unit direction over length (finite). */
double parian_path_medium_depth(const parian_path_medium *medium, const double x[3],
                                const double direction[3], double length);

#endif
