/* global_operator.h - all rows of factors between some points, as a sparse operator.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_OPERATOR_H
#define PARIAN_BAKE_GLOBAL_OPERATOR_H

#include "bake/stages/global_rows.h"

/* Over all rows and channels. */
typedef struct parian_rows_report {
    double lost_mean, lost_max, sum_min[3], sum_max[3];
} parian_rows_report;

/* Compute, choose and code every row. op is zeroed before; registers are the caller's. Progress of
 * the global stage goes from begin to end. Errors: PARIAN_E_NOMEM, PARIAN_E_COMPUTE (2^32 runs),
 * PARIAN_E_INTERRUPTED; op then holds nothing. Threads: uses env->par. */
parian_result parian_rows_to_operator(const parian_env *env, const parian_row_maker *maker,
                                      double begin, double end, parian_operator *op,
                                      parian_rows_report *report);

/* Mean number of factors that a row keeps, from a sample of rows. */
parian_result parian_rows_sample(const parian_env *env, const parian_row_maker *maker,
                                 double *factors_per_row);

#endif
