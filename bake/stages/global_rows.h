/* global_rows.h - one row of throughput factors: computed, chosen from, coded.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_ROWS_H
#define PARIAN_BAKE_GLOBAL_ROWS_H

#include <stdatomic.h>

#include "bake/stages/transport.h"
#include "core/array_check.h"
#include "core/factor_far.h"

/* What every row needs. Points are the transfer vertices, or coarse points among them. */
typedef struct parian_row_maker {
    parian_factor_maker factors;
    double threshold, threshold_absolute; /* as parian_global_desc, resolved; below 0: keep all */
    const parian_far *far;    /* what coarser points carry, which is taken off; NULL: nothing */
    const parian_bits *finer; /* [points^2] pairs that finer points carry: zero; NULL: none */
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
    double whole[3];   /* sum of the row's factors times areas, before anything was taken off */
    parian_far_work far;
} parian_row_work;

parian_result parian_row_work_make(const parian_env *env, const parian_row_maker *maker,
                                   parian_row_work *work);
void parian_row_work_free(const parian_env *env, parian_row_work *work);

typedef struct parian_row_choice {
    double sum[3];  /* of the factors times areas that are left */
    double lost[3]; /* share of the row that was dropped, in absolute values */
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

/* Fill work->row with the factors of receiver v. */
void parian_row_compute(const parian_row_maker *maker, uint32_t v, parian_row_work *work);
/* Mark the factors that stay (work->keep), small gaps filled. Where coarser points take part, the
 * diagonal, if there is one, takes what was dropped. */
void parian_row_choose(const parian_row_maker *maker, uint32_t v, parian_row_work *work,
                       parian_row_choice *choice);
/* Append the marked columns as runs. */
parian_result parian_row_append_runs(const parian_env *env, const parian_row_maker *maker,
                                     const parian_row_work *work, parian_run_list *list,
                                     uint64_t *factors);
#endif
