/* measure_options.h - the command line of parian-measure.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_OPTIONS_H
#define PARIAN_MEASURE_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/measure/method_spec.h"
#include "tool/options.h"

enum { PARIAN_MEASURE_PATH_MAX = 4096 };

typedef enum parian_measure_backend {
    PARIAN_MEASURE_CORE = 0, /* OpenGL 3.3 core without a window */
    PARIAN_MEASURE_ES,       /* OpenGL ES 3.0 */
    PARIAN_MEASURE_CPU       /* the C evaluation */
} parian_measure_backend;

typedef struct parian_measure_options {
    parian_common_options common;
    parian_string_list inputs;
    const char *output, *cache; /* folders */
    parian_string_list lights, bakes, materials;
    const char *scale; /* as given, for the bake; NULL where not given */
    int unit;          /* of "mm|cm|m" */
    bool unit_given, keep_origin;
    const char *methods_text;
    parian_method_spec method[PARIAN_METHODS_MAX];
    size_t method_count;
    int backend;   /* parian_measure_backend */
    int reference; /* parian_reference_model, where reference_given */
    bool reference_given, images;
    int normalise;    /* of "on|off" */
    uint32_t samples; /* 0: what the model takes by default */
    double standard_error, relight_seconds;
    uint32_t receivers, map_receivers, picture_size, seed;
    const char *camera;
    char cache_default[PARIAN_MEASURE_PATH_MAX];
} parian_measure_options;

typedef struct parian_hard_options {
    parian_common_options common;
    const char *output, *cases; /* cases: names that commas separate, or NULL for all */
    bool list;
} parian_hard_options;

/* Parse and check; mistakes are told on stderr. After --help or --version options->common says so.
 * Errors: PARIAN_E_ARGUMENT, PARIAN_E_UNSUPPORTED. */
parian_result parian_measure_options_parse(int argc, char **argv, parian_measure_options *options);
/* The same for `parian-measure hard-cases`. */
parian_result parian_hard_options_parse(int argc, char **argv, parian_hard_options *options);

/* What is wrong with the settings of a bake as one string, in words, or NULL: options that name
 * inputs or outputs, or that print, are not a bake's to choose here. */
const char *parian_bake_text_fault(const char *text);

#endif
