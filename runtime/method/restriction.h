/* restriction.h - for each transfer vertex, the texels that feed it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RESTRICTION_H
#define PARIAN_RESTRICTION_H

#include "core/body.h"

/* A texel that feeds a vertex: Phi_v += flux E, D_v += w E. */
typedef struct parian_feed {
    uint32_t texel; /* ordinal */
    float flux;     /* beta_v A, or (4 beta_v - 1) A in the paper's form; m^2 */
} parian_feed;

typedef struct parian_restriction {
    uint32_t vertex_count;
    uint32_t total;           /* 3 texel_count */
    uint32_t *offset;         /* [vertex_count + 1] */
    parian_feed *feed;        /* [total] texels of a vertex ascending */
    parian_half (*weight)[3]; /* [total] w_v of the feed, or NULL where the body has none */
} parian_restriction;

/* Errors: PARIAN_E_NOMEM. */
parian_result parian_restriction_build(const parian_env *env, const parian_body *body,
                                       parian_restriction *restriction);
void parian_restriction_free(const parian_env *env, parian_restriction *restriction);

#endif
