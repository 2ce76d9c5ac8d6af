/* factor_row.h - throughput factors between one vertex and all others, prefiltered, before any is
 * dropped.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_FACTOR_ROW_H
#define PARIAN_CORE_FACTOR_ROW_H

#include "core/transport_model.h"
#include "core/vertex_frame.h"

/* What every row needs. */
typedef struct parian_factor_maker {
    const parian_body *body;
    parian_transport_model model;
    parian_vertex_frame frame;
    float (*total)[3]; /* row sums that the diagonal brings about; NULL: the diagonal is zero */
    const float (*position)[3]; /* [points]: the vertices', or own_position */
    float (*own_position)[3];   /* of coarse points; else NULL */
    float (*cap)[3]; /* mean of R_d over a disc of the vertex's area; NULL without prefilter */
} parian_factor_maker;

/* Prepare for a body's surface, medium and local form; free it in every case. Errors:
 * PARIAN_E_NOMEM, PARIAN_E_ARGUMENT (no triangles). Threads: uses env->par. */
parian_result parian_factor_maker_make(const parian_env *env, const parian_body *body,
                                       parian_factor_maker *maker);
void parian_factor_maker_free(const parian_env *env, parian_factor_maker *maker);

/* Fill maker->cap from areas and medium. */
parian_result parian_factor_cap(const parian_env *env, parian_factor_maker *maker);

/* Fill row with the factors F_vu of receiver v from all vertices u, m^-2; zeros in the padding. */
void parian_factor_row(const parian_factor_maker *maker, uint32_t v, const parian_row *row);

/* The scale of a row and channel as it is coded: the power of two that brings the largest magnitude
 * of value [padded] into [2^13, 2^14). */
float parian_factor_scale(const float *value, uint32_t padded);

/* Code the factors of count columns from the first on. coded [PARIAN_RUN_MAX] is scratch. Negative
 * ones (less than what coarse points carry) are rounded towards zero: with what those carry they
 * must not come out below it. */
void parian_factor_code_run(const parian_row *row, const float scale[3], uint32_t first,
                            uint32_t count, float (*coded)[3], parian_half (*factor)[3]);

/* Write the factors of row v of op, whose runs and scales are set. coded as above. */
void parian_factor_code(const parian_row *row, float (*coded)[3], parian_operator *op, uint32_t v);

#endif
