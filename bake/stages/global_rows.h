/* global_rows.h - one row of throughput factors: chosen from, coded.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_ROWS_H
#define PARIAN_BAKE_GLOBAL_ROWS_H

#include <stdatomic.h>

#include "bake/stages/transport.h"
#include "core/factor_row.h"

/* What every row needs. */
typedef struct parian_row_maker {
    parian_factor_maker factors;
    double threshold, threshold_absolute; /* as parian_global_desc, resolved; below 0: keep all */
} parian_row_maker;

parian_result parian_row_maker_make(const parian_env *env, const parian_global_desc *desc,
                                    const parian_body *body, parian_row_maker *maker);
void parian_row_maker_free(const parian_env *env, parian_row_maker *maker);

/* Buffers of one thread. */
typedef struct parian_row_work {
    parian_row row;
    float *weighted[3]; /* factor times A_u / 3: share of radiosity under uniform light */
    uint8_t *keep;      /* [padded + 16] */
    float *base;
    float (*coded)[3]; /* [PARIAN_RUN_MAX] */
} parian_row_work;

parian_result parian_row_work_make(const parian_env *env, const parian_row_maker *maker,
                                   parian_row_work *work);
void parian_row_work_free(const parian_env *env, parian_row_work *work);

typedef struct parian_row_choice {
    double sum[3], lost[3]; /* of the kept factors; share that was dropped */
    float scale[3];
} parian_row_choice;

typedef struct parian_run {
    uint32_t column, count;
} parian_run;
typedef struct parian_run_list {
    parian_run *run;
    uint32_t count, capacity;
} parian_run_list;
void parian_run_list_free(const parian_env *env, parian_run_list *list);

/* Mark the factors that stay (work->keep), small gaps filled. */
void parian_row_choose(const parian_row_maker *maker, parian_row_work *work,
                       parian_row_choice *choice);
/* Append the marked columns as runs. */
parian_result parian_row_append_runs(const parian_env *env, const parian_row_maker *maker,
                                     const parian_row_work *work, parian_run_list *list,
                                     uint64_t *factors);

#endif
