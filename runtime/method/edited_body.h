/* edited_body.h - a body of another medium than it was baked of: factors, blending weights and
 * kernels made anew on the surface, the atlas and the sparsity pattern that the asset holds.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_EDITED_BODY_H
#define PARIAN_EDITED_BODY_H

#include "core/body.h"
#include "core/kernel.h"

typedef struct parian_edited_body {
    parian_body
        body; /* shares every array with the baked body, but for factors, scales and weights */
    parian_kernels kernels;
    bool owned; /* body is not the baked one: its own arrays are freed with it */
    double
        beyond_mean[3]; /* share of a row's energy at pairs that the asset does not hold: it is */
    double beyond_max;  /* spread over the row; mean over rows by channel, largest of all */
} parian_edited_body;

/* Make the body of a medium that parian_medium_check accepts. Factors at stored pairs are those of
 * a bake of that medium; each row is then brought to the energy of the whole one. Weights are
 * fitted anew, kernels rebuilt (forms F16 and U8 become REBUILT). Errors: PARIAN_E_NOMEM,
 * PARIAN_E_UNSUPPORTED (operators that no bake writes), PARIAN_E_INTERRUPTED. Threads: uses
 * env->par; the same values for any number of threads. baked must outlive it. */
parian_result parian_edited_body_make(const parian_env *env, const parian_body *baked,
                                      const parian_medium *medium, parian_edited_body *made);
/* The body as baked, with its kernels. */
parian_result parian_edited_body_restore(const parian_env *env, const parian_body *baked,
                                         parian_edited_body *made);
void parian_edited_body_free(const parian_env *env, parian_edited_body *made);

#endif
