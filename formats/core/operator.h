/* operator.h - application of sparse operators: restriction, transport, prolongation alike.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_OPERATOR_H
#define PARIAN_CORE_OPERATOR_H

#include "core/body.h"

/* y = (accumulate ? y : 0) + op x.
 *
 * x [op->column_count], y [op->row_count]; they do not overlap. Factors are normal halves or zero
 * (subnormal ones give the same result, slowly). Threads: uses env->par over blocks of rows; the
 * same bits for any number of threads and on every machine. */
void parian_operator_apply(const parian_env *env, const parian_operator *op, const float (*x)[3],
                           float (*y)[3], bool accumulate);

/* radiosity += what a body's operators, in their order, make of flux. The first operator leads from
 * register 0 to 1 (flux, radiosity: [its columns]); the others' registers begin at zero.
 * Errors: PARIAN_E_NOMEM, PARIAN_E_ARGUMENT (a register beyond 31). */
parian_result parian_operators_apply(const parian_env *env, const parian_operator *ops,
                                     uint32_t count, const float (*flux)[3], float (*radiosity)[3]);

/* The transpose of that: sum[u] = sum over v of weight[v] times the radiosity that unit flux at u
 * makes at v. sum [columns of the first operator]. Errors as above. */
parian_result parian_operators_column_sums(const parian_env *env, const parian_operator *ops,
                                           uint32_t count, const float *weight, double (*sum)[3]);

#endif
