/* bake.h - the bake as a whole: knows the order of the stages, the settings, the report, nothing
 * else.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_BAKE_H
#define PARIAN_BAKE_BAKE_H

#include "bake/pipeline/report.h"
#include "bake/stages/import.h"
#include "core/body.h"

typedef enum parian_form { PARIAN_FORM_PARIAN = 0, PARIAN_FORM_PAPER = 1 } parian_form;

/* Resolved settings of a bake. Paths and text belong to the caller. */
typedef struct parian_bake_desc {
    const char *input;
    const char *output;          /* NULL: nothing is written (a dry run for --report and --dump) */
    const char *const *material; /* [material_count] as given: NAME, FILE.json or MESH=NAME */
    size_t material_count;
    double scale_m; /* longest side of the bodies' bounding box; 0: as it is */
    double unit_m;  /* metres of one file unit for formats without a scene; 0: not given */
    bool keep_origin;
    parian_bssrdf bssrdf;
    bool fit_fdr;
    parian_form form;
    uint32_t atlas_size, kernel_width, transfer_vertices;
    parian_local_form local_form;
    double threshold;
    double threshold_absolute; /* 0: by share */
    parian_hierarchy hierarchy;
    bool force_local, force_global, no_local, no_global;
    const char *dump_folder;  /* NULL: none */
    const char *report_path;  /* NULL: none */
    const char *depfile_path; /* NULL: none */
} parian_bake_desc;

/* Run the whole bake and write what the desc asks for.
 * Errors: those of the stages; nothing is left behind on failure. Threads: uses env->par. */
parian_result parian_bake_run(const parian_env *env, const parian_bake_desc *desc);

/* ---- parts of the pipeline, one file each
 * -------------------------------------------------------- */

/* What becomes of each part of a source scene. */
typedef struct parian_selection {
    bool *is_body;         /* [part_count] */
    parian_medium *medium; /* [part_count] of the bodies */
    uint32_t body_count;
} parian_selection;

/* Decide which parts are bodies, and of which medium. Errors: PARIAN_E_ARGUMENT (a name nothing
 * has), PARIAN_E_FORMAT, PARIAN_E_IO. */
parian_result parian_select_bodies(const parian_env *env, const parian_bake_desc *desc,
                                   const parian_source_scene *scene, parian_selection *selection);
void parian_selection_free(const parian_env *env, parian_selection *selection);

/* The medium that a name of a preset or a FILE.json stands for. Errors: PARIAN_E_ARGUMENT (no such
 * preset), PARIAN_E_FORMAT, PARIAN_E_IO. */
parian_result parian_find_medium(const parian_env *env, const char *text, parian_medium *medium);

/* Bring a scene to metres and size (scale_m, unit_m, keep_origin); lights move along. */
parian_result parian_scale_scene(const parian_env *env, const parian_bake_desc *desc,
                                 const parian_selection *selection, parian_source_scene *scene);

/* Run all stages for one part: surface to local kernels. The part's mesh is repaired in place. On
 * failure body is freed. */
parian_result parian_bake_body(const parian_env *env, const parian_bake_desc *desc,
                               parian_source_scene *scene, uint32_t part,
                               const parian_medium *medium, parian_body *body,
                               parian_body_report *report);

/* Vertices and atlas side of one body: as given for up to four bodies; more share what four would
 * get, in proportion to area_share (its part of the area of all bodies). */
void parian_share_budget(const parian_bake_desc *desc, uint32_t body_count, double area_share,
                         uint32_t *vertices, uint32_t *atlas_size);

/* A part of the surroundings as it is stored. */
parian_result parian_make_surrounding(const parian_env *env, const parian_source_scene *scene,
                                      uint32_t part, parian_surrounding *surrounding);

/* Settings and input hash as JSON for the asset; no paths, no times. */
parian_result parian_make_provenance(const parian_env *env, const parian_bake_desc *desc,
                                     char **json);

/* The resolved settings as JSON text (--print-config); free with cJSON_free; NULL without memory.
 */
char *parian_settings_json(const parian_bake_desc *desc);

/* Whether every output named can be written: a name for a file, in a folder that is or can be made;
 * the asset not over its own input. Nothing is created. Errors: PARIAN_E_IO, PARIAN_E_ARGUMENT. */
parian_result parian_check_outputs(const parian_env *env, const parian_bake_desc *desc);

/* --dump: every intermediate array as .npy, the atlas as PNG and EXR. */
parian_result parian_bake_dump(const parian_env *env, const char *folder,
                               const parian_scene_data *scene);

/* -MD: "OUT: INPUT MATERIAL.json BUFFERS..." for Make and Ninja. */
parian_result parian_write_depfile(const parian_env *env, const parian_bake_desc *desc);

#endif
