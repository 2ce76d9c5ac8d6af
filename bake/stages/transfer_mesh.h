/* transfer_mesh.h - the mesh that transport is computed on: near-equilateral, with a wanted number of vertices.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_TRANSFER_MESH_H
#define PARIAN_BAKE_TRANSFER_MESH_H

#include "core/mesh.h"

typedef struct parian_transfer_mesh_desc {
    uint32_t vertex_target; /* 0 takes 10,000 */
} parian_transfer_mesh_desc;

typedef struct parian_transfer_mesh_report {
    uint32_t vertex_count, triangle_count;
    double edge_mean_m, edge_min_m, edge_max_m;
    double quality_mean;       /* mean of 4 sqrt(3) area / (sum of squared edges): 1 is equilateral */
    double distance_rms_m, distance_max_m; /* transfer surface to source and back, sampled */
    double area_ratio;         /* transfer over source */
    bool source_is_denser;     /* the source had more vertices: its detail goes into a normal map */
} parian_transfer_mesh_report;

/* Make transfer (a new mesh with positions and triangles; vertices ordered along the surface, so that near
 * vertices have near indices) of a source that went through the surface stage. The vertex count is met
 * within 5 % where the topology allows it (a closed surface of k parts needs at least 4 k vertices; a
 * warning names the count reached otherwise).
 * Errors: PARIAN_E_COMPUTE, PARIAN_E_NOMEM, PARIAN_E_INTERRUPTED. */
parian_result parian_stage_transfer_mesh(const parian_env *env, const parian_mesh *source,
                                         const parian_transfer_mesh_desc *desc, parian_mesh *transfer,
                                         parian_transfer_mesh_report *report);

#endif
