/* atlas.h - charts of the transfer surface, packed into a square.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_ATLAS_H
#define PARIAN_BAKE_ATLAS_H

#include "core/body.h"

typedef struct parian_atlas_desc {
    uint32_t atlas_size;    /* side in texels; 0 takes 512 */
    double chart_angle_deg; /* normal deviation from the running average; 0 takes 30 */
    uint32_t gutter;        /* unowned texels kept around each chart; 0 takes 2 */
} parian_atlas_desc;

typedef struct parian_atlas_report {
    uint32_t chart_count;
    double occupancy;       /* area of charts over the area of the atlas */
    double texel_edge_m;    /* side of a texel on a surface parallel to its chart */
    double stretch_max;     /* largest ratio of surface to atlas area, in units of the mean */
    uint32_t smallest_side; /* with PARIAN_E_COMPUTE because the charts do not fit: the smallest
                               that does */
} parian_atlas_report;

/* Fill corner_uv, triangle_chart, chart_count and atlas_size of a body whose transfer surface is
 * set. Errors: PARIAN_E_COMPUTE when the charts do not fit (the log line names the smallest side
 * that fits). */
parian_result parian_stage_atlas(const parian_env *env, const parian_atlas_desc *desc,
                                 parian_body *body, parian_atlas_report *report);

#endif
