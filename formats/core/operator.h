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

/* Sums over rows of weight[row] times the factors of each column: sum [op->column_count].
 * Errors: PARIAN_E_NOMEM. */
parian_result parian_operator_column_sums(const parian_env *env, const parian_operator *op,
                                          const float *weight, double (*sum)[3]);

#endif
