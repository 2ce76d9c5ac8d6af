/* options_internal.h - what the parser of options and the printer of --help share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_OPTIONS_INTERNAL_H
#define PARIAN_TOOL_OPTIONS_INTERNAL_H

#include "tool/options.h"

enum { PARIAN_COMMON_OPTION_COUNT = 6, PARIAN_THREADS_MAX = 1024 };

/* The rows of the options that every tool has, with their values bound to common. */
void parian_options_common_rows(parian_common_options *common,
                                parian_option rows[PARIAN_COMMON_OPTION_COUNT]);

/* Print --help to stdout in 80 columns. Errors: PARIAN_E_IO. */
parian_result parian_options_print_help(const parian_command *command,
                                        const parian_option *common_rows);

#endif
