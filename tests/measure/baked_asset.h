/* baked_asset.h - the assets that are measured: baked from models and kept by content, or given.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_BAKED_ASSET_H
#define PARIAN_MEASURE_BAKED_ASSET_H

#include "bake/cli/bake_options.h"
#include "tests/measure/measure_options.h"

enum { PARIAN_LABEL_MAX = 512 };

typedef struct parian_baked_asset {
    char label[PARIAN_LABEL_MAX]; /* model and settings: unique in a run */
    char model[PARIAN_LABEL_MAX]; /* name of the input's file */
    const char *bake;             /* settings as given; "" for an asset that was given */
    char path[PARIAN_MEASURE_PATH_MAX];
    bool from_model, cached;
    double bake_s; /* as of when it was baked; NaN where that is not known */
    uint64_t bytes;
    parian_bake_options *bake_options; /* resolved; its desc is also that of the truth's surface */
    char *words;                       /* what the options point into */
} parian_baked_asset;

/* Resolve what to bake of an input with the settings `bake`, without any work. Mistakes in the
 * settings are told on stderr. Errors: PARIAN_E_ARGUMENT, PARIAN_E_UNSUPPORTED, PARIAN_E_IO (the
 * input cannot be read), PARIAN_E_NOMEM. Free it in every case. */
parian_result parian_baked_asset_plan(const parian_env *env, const parian_measure_options *options,
                                      const char *input, const char *bake,
                                      parian_baked_asset *asset);
void parian_baked_asset_free(const parian_env *env, parian_baked_asset *asset);

/* True for a path that ends in .parian, in any case. */
bool parian_path_is_asset(const char *path);

/* Bake it unless folder has the bake of the same input bytes, settings and program. Errors: those
 * of a bake. */
parian_result parian_baked_asset_make(const parian_env *env, const char *folder,
                                      parian_baked_asset *asset);

#endif
