/* bake_options.h - the command line of parian-bake.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_OPTIONS_H
#define PARIAN_BAKE_OPTIONS_H

#include "bake/pipeline/bake.h"
#include "tool/options.h"

typedef struct parian_bake_options {
    parian_bake_desc desc;
    parian_common_options common;
    parian_string_list materials;
    bool list_materials, print_config;
    char depfile[4096];
} parian_bake_options;

/* Parse and check; messages go to stderr. */
parian_result parian_bake_options_parse(int argc, char **argv, parian_bake_options *options);

#endif
