/* options.h - one table of options per tool: parsing, --help, man pages and completion.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_OPTIONS_H
#define PARIAN_TOOL_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>

#include "parian/result.h"

typedef enum parian_option_kind {
    PARIAN_OPTION_FLAG,   /* --name            bool * */
    PARIAN_OPTION_STRING, /* --name VALUE      const char ** */
    PARIAN_OPTION_LIST,   /* --name VALUE ...  parian_string_list *, repeatable */
    PARIAN_OPTION_COUNT,  /* --name N          uint32_t *, within [minimum, maximum] */
    PARIAN_OPTION_NUMBER, /* --name X          double *, within [minimum, maximum] */
    PARIAN_OPTION_LENGTH, /* --name 50mm       double *, metres; units um mm cm m */
    PARIAN_OPTION_CHOICE, /* --name a|b|c      int *, index into choices */
    PARIAN_OPTION_LATER,  /* known, not built yet: refused with exit 5, absent from help */
    PARIAN_OPTION_GROUP   /* no option: name is a heading of --help above the rows that follow */
} parian_option_kind;

enum { PARIAN_STRING_LIST_MAX = 256 };
typedef struct parian_string_list {
    const char *item[PARIAN_STRING_LIST_MAX];
    size_t count;
} parian_string_list;

typedef struct parian_option {
    const char *name;  /* "--scale", "-o" */
    const char *alias; /* other spelling, or NULL */
    parian_option_kind kind;
    void *value;
    const char *argument;    /* for help: "LEN" */
    const char *help;        /* one or more sentences, with the default in parentheses */
    double minimum, maximum; /* COUNT, NUMBER: both 0 is no limit */
    const char *choices;     /* CHOICE: "dipole|dipole-flux" */
    bool *given;             /* set when the option was given; may be NULL */
} parian_option;

/* Rows that have no argument. */
#define PARIAN_FLAG_ROW(option_name, flag, text)                                                   \
    {                                                                                              \
        .name = (option_name), .kind = PARIAN_OPTION_FLAG, .value = (flag), .help = (text)         \
    }
#define PARIAN_LATER_ROW(option_name)                                                              \
    {                                                                                              \
        .name = (option_name), .kind = PARIAN_OPTION_LATER                                         \
    }
#define PARIAN_GROUP_ROW(heading)                                                                  \
    {                                                                                              \
        .name = (heading), .kind = PARIAN_OPTION_GROUP                                             \
    }

/* What may follow the name of a tool that has several commands. */
typedef struct parian_subcommand {
    const char *name; /* "validate" */
    const char *help; /* what it does, a few words */
} parian_subcommand;

typedef struct parian_command {
    const char *tool;     /* "parian-bake", or with a command: "parian-info validate" */
    const char *usage;    /* "INPUT -o OUT.parian [options]" */
    const char *summary;  /* what it does, a few lines */
    const char *epilogue; /* examples; may be NULL */
    const parian_option *options;
    size_t option_count;
    const parian_subcommand *commands; /* of the tool itself; NULL: it has none */
    size_t command_count;
} parian_command;

/* What --help prints: --help, --help=man and so on. */
typedef enum parian_help_form {
    PARIAN_HELP_TEXT,
    PARIAN_HELP_MAN,  /* a manual page for man(1) */
    PARIAN_HELP_BASH, /* completion; the parts of a tool and of its commands make one file */
    PARIAN_HELP_ZSH,
    PARIAN_HELP_FISH,
    PARIAN_HELP_COMMANDS /* the names of the tool's commands, a line each */
} parian_help_form;

/* The options that every tool has; they are parsed and printed with those of the command. */
typedef struct parian_common_options {
    bool quiet, verbose, help, version;
    unsigned threads; /* 0: all */
    int progress;     /* auto, bar, json, none */
    parian_help_form help_form;
} parian_common_options;

/* Parse argv[first..argc). Positional arguments go to `positional`. "--name=value" works too; "--"
 * ends options; "-" is positional. On a mistake prints one line to stderr (what, and "see TOOL
 * --help") and returns PARIAN_E_ARGUMENT or, for LATER, PARIAN_E_UNSUPPORTED. --help[=FORM] and
 * --version print to stdout and set common->help or ->version: the caller then exits with 0. */
parian_result parian_options_parse(const parian_command *command, parian_common_options *common,
                                   parian_string_list *positional, int argc, char **argv,
                                   int first);

/* "50mm" -> 0.05. PARIAN_E_ARGUMENT unless a positive finite number with a unit. */
parian_result parian_parse_length(const char *text, double *metres);

#endif
