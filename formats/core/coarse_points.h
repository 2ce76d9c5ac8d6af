/* coarse_points.h - coarse points among the transfer vertices: how finer points are interpolated from
 * them, and the maker of factors between them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_COARSE_POINTS_H
#define PARIAN_CORE_COARSE_POINTS_H

#include "core/factor_row.h"

typedef struct parian_coarse {
    uint32_t count, fine_count;
    uint32_t *vertex;    /* [count] transfer vertex of each coarse point, ascending */
    uint32_t (*near)[3]; /* [fine_count] coarse points around a finer one */
    float (*weight)[3];  /* [fine_count] not negative, sum 1; multiples of 2^-11, exact as halfs */
    float *moment;       /* [fine_count] sum of weight times squared distance, m^2 */
} parian_coarse;

/* Room for everything; only fine_count is set, [fine_count] coarse points fit. Errors:
 * PARIAN_E_NOMEM. */
parian_result parian_coarse_init(const parian_env *env, uint32_t fine_count, parian_coarse *coarse);
void parian_coarse_free(const parian_env *env, parian_coarse *coarse);

/* Read back what the operator `up` was made of. fine as in parian_coarse_moments. Errors:
 * PARIAN_E_NOMEM, PARIAN_E_UNSUPPORTED (no such interpolation). */
parian_result parian_coarse_read(const parian_env *env, const parian_body *body,
                                 const uint32_t *fine, const parian_operator *up,
                                 parian_coarse *coarse);

/* Prepare rows of factors between coarse points: areas and interpolation biases are the finer ones',
 * shared out by the weights, the bias with what the interpolation itself adds. vertices is the maker
 * of the transfer vertices, whose model is used and must outlive this one; finer that of the finer
 * points. Free with parian_coarse_maker_free. Errors: PARIAN_E_NOMEM. */
parian_result parian_coarse_maker_make(const parian_env *env, const parian_coarse *coarse,
                                       const parian_factor_maker *vertices,
                                       const parian_factor_maker *finer,
                                       parian_factor_maker *maker);
void parian_coarse_maker_free(const parian_env *env, parian_factor_maker *maker);

#endif
