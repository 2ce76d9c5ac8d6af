/* reference_options.h - the command line of parian-bake reference.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_OPTIONS_H
#define PARIAN_BAKE_REFERENCE_OPTIONS_H

#include "bake/pipeline/bake.h"
#include "bake/reference/path_tracing.h"
#include "tool/options.h"

typedef struct parian_reference_options {
    parian_common_options common;
    parian_bake_desc scene; /* input, material, scale, unit, origin */
    parian_string_list materials, light_specs;
    const char *lights_file; /* NULL: none */
    const char *output;      /* folder */
    bool planar;             /* tables of planes; else `model` on INPUT */
    parian_reference_model model;
    bool fit_fdr, normalise;
    uint64_t samples;        /* 0: the model's default */
    uint64_t receiver_count; /* 0: those of receiver_file */
    const char *receiver_file;
    const char *field_file; /* NULL: homogeneous */
    uint64_t seed;
    double standard_error; /* path: share of the mean of B at which to stop; 0: take all samples */
    parian_walk_kind walk;
    double patch;     /* m; 0: default */
    double thickness; /* planar: of a slab, m; 0: none */
} parian_reference_options;

/* Parse and check argv from the word behind "reference" on; messages go to stderr. */
parian_result parian_reference_options_parse(int argc, char **argv,
                                             parian_reference_options *options);

#endif
