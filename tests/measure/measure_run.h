/* measure_run.h - measures assets under light sets, and reports what was found.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_RUN_H
#define PARIAN_MEASURE_RUN_H

#include <cjson/cJSON.h>

#include "bake/reference/reference.h"
#include "tests/measure/baked_asset.h"
#include "tests/measure/machine.h"
#include "tests/measure/measure_options.h"
#include "tests/measure/relight.h"
#include "tests/measure/results_table.h"
#include "tests/measure/truth.h"
#include "tool/lights_file.h"

enum { PARIAN_ASSETS_MAX = 1024 };

typedef struct parian_named_lights {
    char name[PARIAN_LABEL_MAX]; /* of the file, without folder and ending */
    parian_light_set set;
} parian_named_lights;

/* A run as it goes. */
typedef struct parian_measure_run {
    const parian_measure_options *options;
    const char *command; /* as typed */
    parian_baked_asset *asset;
    size_t asset_count;
    parian_named_lights lights[PARIAN_STRING_LIST_MAX];
    size_t light_count;
    parian_measure_device device;
    parian_results results;
    parian_text images; /* lines of images.csv, while there are any */
    cJSON *measurements;
    char renderer[256]; /* of the last asset: the same for all */
} parian_measure_run;

/* What one measurement is made from: an asset on its renderer under one light set, and the truth
 * there. */
typedef struct parian_measure_case {
    const parian_baked_asset *asset;
    const parian_named_lights *lights;
    parian_relit *relit;
    parian_reference_scene *scene;
    parian_truth_desc truth;
} parian_measure_case;

/* Measure every asset under every light set with every method, and write all results into the
 * folder. assets are planned (baked_asset.h). Errors: those of bakes, renderers, truths, files. */
parian_result parian_measure_run_all(const parian_env *env, const parian_measure_options *options,
                                     parian_baked_asset *assets, size_t asset_count,
                                     const char *command);

/* ---- measure_report.c: results.csv, results.json, results.md, plots, and the tables on stdout
 * ---- */
/* Add what one measurement of three rows is made of. */
void parian_measure_note(parian_measure_run *run, const parian_measure_case *c, const char *method,
                         const parian_relight_times *times, const parian_reference_result *truth,
                         bool truth_cached);
parian_result parian_measure_report(const parian_env *env, parian_measure_run *run);

/* ---- measure_maps.c: error maps in the atlas and on the object ---- */
parian_result parian_measure_maps(const parian_env *env, const parian_measure_run *run,
                                  const parian_measure_case *c);

/* ---- measure_images.c: the backend's picture against that of the C evaluation ---- */
parian_result parian_measure_image(const parian_env *env, parian_measure_run *run,
                                   const parian_measure_case *c);

/* FOLDER/NAME of the results, or of a folder below; false where the name is too long. */
bool parian_measure_path(const parian_measure_run *run, const char *name,
                         char path[PARIAN_MEASURE_PATH_MAX]);
/* Letters and digits of labels, and '-' for the rest: part of a file's name. */
void parian_measure_slug(const char *label, const char *lights, char slug[2 * PARIAN_LABEL_MAX]);

#endif
