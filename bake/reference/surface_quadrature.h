/* surface_quadrature.h - B at receivers as the integral of a BSSRDF over the surface: stratified
 * random places by area, refined around each receiver, in independent replicates that give the
 * standard error.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SURFACE_QUADRATURE_H
#define PARIAN_BAKE_SURFACE_QUADRATURE_H

#include "bake/reference/bssrdf.h"
#include "bake/reference/reference.h"

typedef struct parian_reference_quadrature_desc {
    parian_bssrdf_desc bssrdf;
    uint64_t samples; /* per receiver, all replicates together; 0 takes a default that meets 0.1 %
                         on smooth light */
    uint64_t seed;
    double (
        *scale)[3]; /* [body_count] receives the factors of bssrdf.normalise; NULL: not wanted */
} parian_reference_quadrature_desc;

/* result is initialised by the callee; free it in every case. Errors: PARIAN_E_NOMEM,
 * PARIAN_E_ARGUMENT, PARIAN_E_INTERRUPTED. Threads: env->par; the numbers do not depend on their
 * count. */
parian_result parian_reference_quadrature(const parian_env *env,
                                          const parian_reference_scene *scene,
                                          const parian_receivers *receivers,
                                          const parian_reference_quadrature_desc *desc,
                                          parian_reference_result *result);

#endif
