/* report.h - what a bake tells about itself: seconds, counts, sizes, repairs, the plan and its
 * reasons.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REPORT_H
#define PARIAN_BAKE_REPORT_H

#include "bake/stages/atlas.h"
#include "bake/stages/surface.h"
#include "bake/stages/thickness.h"
#include "bake/stages/transfer_mesh.h"
#include "bake/stages/transport.h"

enum { PARIAN_STAGE_MAX = 16 };

typedef struct parian_stage_time {
    const char *name;
    double seconds;
} parian_stage_time;

/* Reports of the stages of one body. */
typedef struct parian_body_report {
    char name[PARIAN_NAME_MAX];
    parian_medium medium;
    parian_surface_report surface;
    parian_transfer_mesh_report transfer_mesh;
    parian_atlas_report atlas;
    parian_plan plan;
    parian_thickness_report thickness;
    parian_global_report global;
    parian_blend_report blend;
    uint32_t texel_count, border_count, gutter_count;
    bool has_normal_map, has_albedo;
    parian_stage_time stage[PARIAN_STAGE_MAX];
    size_t stage_count;
} parian_body_report;

typedef struct parian_bake_report {
    uint32_t body_count, surrounding_count;
    parian_body_report *bodies; /* [body_count] */
    double import_seconds, write_seconds, total_seconds;
    uint64_t file_size;
} parian_bake_report;

/* Append a stage's time; silently ignores more than PARIAN_STAGE_MAX. */
void parian_report_stage(parian_body_report *report, const char *name, double seconds);

/* Log the summary at info level (one line a body and stage). */
void parian_report_log(const parian_env *env, const parian_bake_report *report);

/* Write the report as JSON. config: resolved settings as JSON text, may be NULL. */
parian_result parian_report_write(const parian_env *env, const char *path,
                                  const parian_bake_report *report, const char *config);

#endif
