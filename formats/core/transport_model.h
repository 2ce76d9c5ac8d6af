/* transport_model.h - R_d of a body between any two surface points, quickly: what the bake
 * discretises and what kernels are rebuilt from.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_TRANSPORT_MODEL_H
#define PARIAN_CORE_TRANSPORT_MODEL_H

#include "core/body.h"
#include "core/dipole.h"
#include "core/dipole_table.h"

/* Which share of R_d: with the smooth split, FAR is R_d S(r / split_radius) and NEAR is the rest,
 * S(t) = t^3 (10 - 15 t + 6 t^2), 1 from t = 1 on. */
typedef enum parian_model_share {
    PARIAN_MODEL_FULL,
    PARIAN_MODEL_FAR,
    PARIAN_MODEL_NEAR
} parian_model_share;

typedef struct parian_transport_model {
    parian_dipole dipole[3];
    parian_model_share share;
    bool flux; /* dipole-flux: depends on the normals at both points */
    double split_radius;
    double z_min;                  /* smallest z_r of a channel that scatters, m */
    parian_radial_table value;     /* the share of the distance-only R_d */
    parian_radial_table laplacian; /* its Laplacian over a plane, m^-4 */
    parian_radial_table slope;     /* its derivative with respect to squared distance, m^-4 */
    parian_radial_table gradient;  /* flux only: alpha'/4pi (1 + s q) e^(-s q) / q^3 by q^2 */
} parian_transport_model;

/* Prepare a model for a body's medium and extent. Errors: PARIAN_E_NOMEM. */
parian_result parian_transport_model_make(const parian_env *env, const parian_body *body,
                                          parian_model_share share, parian_transport_model *model);
void parian_transport_model_free(const parian_env *env, parian_transport_model *model);

/* Share of R_d at distance r, by channel, in double precision (plane). */
double parian_transport_model_exact(const parian_transport_model *model, int channel, double r2);

/* S of the smooth split. */
double parian_split_weight(double t);

/* R_d from x_i (normal n_i) to x_o (normal n_o). Normals are read with flux alone. */
void parian_transport_model_eval(const parian_transport_model *model, const float x_i[3],
                                 const float n_i[3], const float x_o[3], const float n_o[3],
                                 float value[3]);

/* Points and unit normals, coordinates apart; every array is padded to a multiple of 16. */
typedef struct parian_point_arrays {
    uint32_t count, padded;
    float *x, *y, *z;    /* padding repeats the last point */
    float *nx, *ny, *nz; /* NULL where the model needs no normals */
    float *base;         /* the allocation */
} parian_point_arrays;

parian_result parian_point_arrays_make(const parian_env *env, const float (*position)[3],
                                       const float (*normal)[3], uint32_t count,
                                       parian_point_arrays *points);
void parian_point_arrays_free(const parian_env *env, parian_point_arrays *points);

/* R_d between one point and all of points: from them to it, or, with as_source, from it to them.
 * Writes squared distances and the three channels, [padded] each. */
void parian_transport_model_row(const parian_transport_model *model, const float x[3],
                                const float n[3], bool as_source, const parian_point_arrays *points,
                                float *r2, float *const value[3]);

#endif
