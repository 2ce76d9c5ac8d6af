/* options_internal.h - what the parser of options and the printers of --help share.
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

/* Print to stdout, from the same table: --help in 80 columns, a manual page, and the part of a
 * completion file that serves this command. Errors: PARIAN_E_IO. */
parian_result parian_options_print_help(const parian_command *command,
                                        const parian_option *common_rows);
parian_result parian_options_print_man(const parian_command *command,
                                       const parian_option *common_rows);
parian_result parian_options_print_bash(const parian_command *command,
                                        const parian_option *common_rows);
parian_result parian_options_print_zsh(const parian_command *command,
                                       const parian_option *common_rows);
parian_result parian_options_print_fish(const parian_command *command,
                                        const parian_option *common_rows);

/* ---- shared by the printers ---- */

/* What an option takes, as far as completion cares. */
typedef enum parian_value_kind {
    PARIAN_VALUE_NONE,
    PARIAN_VALUE_WORD, /* nothing to offer */
    PARIAN_VALUE_CHOICE,
    PARIAN_VALUE_FILE,
    PARIAN_VALUE_FOLDER
} parian_value_kind;
parian_value_kind parian_option_value_kind(const parian_option *option);

/* False for headings and for options that are not built yet. */
bool parian_option_is_shown(const parian_option *option);

/* What stands for the value in help: "FILE", "a|b", "VALUE"; NULL for a flag. */
const char *parian_option_argument(const parian_option *option);

/* Row i of the command's own options, followed by the common ones; NULL behind the last. */
const parian_option *parian_command_row(const parian_command *command,
                                        const parian_option *common_rows, size_t index);

/* Length of the first sentence of text, without its full stop. */
size_t parian_sentence_length(const char *text);

/* Flush stdout. Errors: PARIAN_E_IO. */
parian_result parian_options_end_output(void);

extern const char parian_exit_status_text[]; /* "0 ok, 1 usage, ..." */

#endif
