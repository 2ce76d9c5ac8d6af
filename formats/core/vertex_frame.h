/* vertex_frame.h - the transfer surface seen from its vertices: areas and fans, exact totals of
 * R_d, rows of numbers over all vertices.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_VERTEX_FRAME_H
#define PARIAN_CORE_VERTEX_FRAME_H

#include "core/body.h"
#include "core/transport_model.h"

/* The transfer surface seen from its vertices. */
typedef struct parian_vertex_frame {
    float *
        area; /* [vertex_count] a third of the incident triangles' area: integral of the hat, m^2 */
    float *bias; /* [vertex_count] m^2: linear interpolation adds bias times the Laplacian (mean) */
    float bias_max;
    float (*normal)[3];   /* [vertex_count] unit, weighted by angle */
    float *triangle_area; /* [triangle_count] m^2 */
    uint32_t *fan_offset; /* [vertex_count + 1] */
    uint32_t *fan;        /* [3 triangle_count] triangles around a vertex, ascending */
    parian_point_arrays points;
} parian_vertex_frame;

parian_result parian_vertex_frame_make(const parian_env *env, const parian_body *body,
                                       parian_vertex_frame *frame);
void parian_vertex_frame_free(const parian_env *env, parian_vertex_frame *frame);

/* total[v]: integral of the model over the surface, from all points to v, or, with as_source, from
 * v to all points. Near triangles by adaptive quadrature (polar around v), the rest by hats.
 * Relative error about 1e-3 or better for any ratio of edge to mean free path. */
parian_result parian_vertex_totals(const parian_env *env, const parian_body *body,
                                   const parian_transport_model *model,
                                   const parian_vertex_frame *frame, bool as_source,
                                   float (*total)[3]);

/* One row of throughput factors F_vu, channels apart. */
typedef struct parian_row {
    float *r2, *value[3]; /* [points.padded]; value is 0 in the padding */
    float *base;
} parian_row;

parian_result parian_row_make(const parian_env *env, const parian_vertex_frame *frame,
                              parian_row *row);
void parian_row_free(const parian_env *env, parian_row *row);

/* Sum over u of weight[u] value[u], sixteen lanes in fixed order; arrays are padded. */
double parian_row_dot(const float *weight, const float *value, uint32_t padded);

#endif
