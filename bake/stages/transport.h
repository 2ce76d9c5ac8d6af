/* transport.h - the plan, the global throughput factors, the blending weights and the local
 * kernels.
 *
 * The stages run in the order plan, global, blend, local; plan.c, global.c, core/blend.c, local.c.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_TRANSPORT_H
#define PARIAN_BAKE_TRANSPORT_H

#include "core/blend.h"
#include "core/body.h"

typedef struct parian_plan_desc {
    bool force_local, force_global, no_local, no_global; /* overrule the criterion */
    parian_local_form local_form; /* the form asked for, if a local part is needed */
    bool paper_form;
} parian_plan_desc;

typedef struct parian_plan {
    bool local, global;
    char reason[512];           /* one paragraph people can read */
    double mean_free_path_m[3]; /* 1 / sigma_t' */
    double extent_m, texel_edge_m, vertex_edge_m;
    double error_without_local, error_without_global; /* estimated relative change of B */
} parian_plan;

/* Decide which parts this body needs; sets body->local_form, has_global, split_radius_m. A part is
 * left out only when the change of B is estimated at 0.5 % at most. Needs surface, atlas and
 * texels. */
parian_result parian_stage_plan(const parian_env *env, const parian_plan_desc *desc,
                                parian_body *body, parian_plan *plan);

/* Whether far pairs go over coarse points. */
typedef enum parian_hierarchy {
    PARIAN_HIERARCHY_AUTO = 0, /* where that saves factors */
    PARIAN_HIERARCHY_ON = 1,   /* one coarse level at least */
    PARIAN_HIERARCHY_OFF = 2
} parian_hierarchy;

typedef struct parian_global_desc {
    double threshold; /* share of a row that may be dropped; 0 takes 0.002; negative: nothing */
    double threshold_absolute;  /* > 0: drop factors (dimensionless, F times A/3) below it, as the
                                   paper */
    parian_hierarchy hierarchy; /* the paper's form, and any threshold but by share, has none */
} parian_global_desc;

typedef struct parian_global_report {
    uint64_t factor_count;      /* stored, per channel, in all operators */
    double kept_share;          /* of vertex_count^2 */
    double lost_mean, lost_max; /* share of a vertex's row that was dropped, over rows and channels;
                                 * with coarse levels, of what they leave, in absolute values */
    uint32_t level_count, level_points[4]; /* coarse levels */
    char hierarchy[160];                   /* why there are so many, in words */
    double row_sum_min[3], row_sum_max[3];
} parian_global_report;

/* Fill the operators: [0] from flux to radiosity at the vertices and, with coarse levels, registers
 * 2 and up, those that carry far pairs. Does nothing when the plan needs no global part. */
parian_result parian_stage_global(const parian_env *env, const parian_global_desc *desc,
                                  parian_body *body, parian_global_report *report);

/* Fill the stored kernels (forms F16, U8); nothing to do for the others. */
parian_result parian_stage_local(const parian_env *env, parian_body *body);

#endif
