/* options.c - parses a command line by a table of options.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/options.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tool/options_internal.h"

enum { NAME_LENGTH_MAX = 64 };

void parian_options_common_rows(parian_common_options *common,
                                parian_option rows[PARIAN_COMMON_OPTION_COUNT])
{
    const parian_option table[PARIAN_COMMON_OPTION_COUNT] = {
        {.name = "-q",
         .alias = "--quiet",
         .kind = PARIAN_OPTION_FLAG,
         .value = &common->quiet,
         .help = "Print nothing but the one line of a failure."},
        {.name = "-v",
         .alias = "--verbose",
         .kind = PARIAN_OPTION_FLAG,
         .value = &common->verbose,
         .help = "Tell more on stderr."},
        {.name = "--threads",
         .kind = PARIAN_OPTION_COUNT,
         .value = &common->threads,
         .argument = "N",
         .help = "Threads to use; never changes the result (all cores).",
         .minimum = 1,
         .maximum = PARIAN_THREADS_MAX},
        {.name = "--progress",
         .kind = PARIAN_OPTION_CHOICE,
         .value = &common->progress,
         .choices = "auto|bar|json|none",
         .help = "How progress is shown on stderr (auto: a bar on a terminal, else nothing)."},
        {.name = "--help",
         .alias = "-h",
         .kind = PARIAN_OPTION_FLAG,
         .value = &common->help,
         .help = "Print this text; --help=man, =bash, =zsh and =fish print a manual page or "
                 "completion."},
        {.name = "--version",
         .kind = PARIAN_OPTION_FLAG,
         .value = &common->version,
         .help = "Print name and version."},
    };
    memcpy(rows, table, sizeof table);
}

/* Everything that the parsing functions pass around. */
typedef struct parse_state {
    const parian_command *command;
    parian_option common[PARIAN_COMMON_OPTION_COUNT];
    parian_common_options *common_values;
} parse_state;

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static parian_result
refuse(const parse_state *state, parian_result result, const char *format, ...)
{
    va_list args;
    fprintf(stderr, "%s: error: ", state->command->tool);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fprintf(stderr, " (see %s --help)\n", state->command->tool);
    return result;
}

static size_t row_count(const parse_state *state)
{
    return state->command->option_count + PARIAN_COMMON_OPTION_COUNT;
}

static const parian_option *row(const parse_state *state, size_t index)
{
    return index < state->command->option_count
               ? &state->command->options[index]
               : &state->common[index - state->command->option_count];
}

/* The option of this name, compared as a whole word of `length` characters; NULL if there is none.
 */
static const parian_option *find_option(const parse_state *state, const char *name, size_t length)
{
    for (size_t i = 0; i < row_count(state); i++) {
        const parian_option *option = row(state, i);
        if (option->kind == PARIAN_OPTION_GROUP) {
            continue;
        }
        if (strlen(option->name) == length && strncmp(option->name, name, length) == 0) {
            return option;
        }
        if (option->alias && strlen(option->alias) == length &&
            strncmp(option->alias, name, length) == 0) {
            return option;
        }
    }
    return NULL;
}

/* Number of insertions, deletions, replacements and swaps of neighbours that make b of a. */
static size_t edit_distance(const char *a, size_t a_length, const char *b)
{
    size_t previous[NAME_LENGTH_MAX + 1], row_now[NAME_LENGTH_MAX + 1],
        before[NAME_LENGTH_MAX + 1] = {0};
    size_t b_length = strlen(b);
    if (a_length > NAME_LENGTH_MAX || b_length > NAME_LENGTH_MAX) {
        return SIZE_MAX;
    }
    for (size_t j = 0; j <= b_length; j++) {
        previous[j] = j;
    }
    for (size_t i = 1; i <= a_length; i++) {
        row_now[0] = i;
        for (size_t j = 1; j <= b_length; j++) {
            size_t best = previous[j - 1] + (a[i - 1] != b[j - 1]);
            best = previous[j] + 1 < best ? previous[j] + 1 : best;
            best = row_now[j - 1] + 1 < best ? row_now[j - 1] + 1 : best;
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] &&
                before[j - 2] + 1 < best) {
                best = before[j - 2] + 1;
            }
            row_now[j] = best;
        }
        memcpy(before, previous, sizeof before);
        memcpy(previous, row_now, (b_length + 1) * sizeof row_now[0]);
    }
    return previous[b_length];
}

/* Keeps the nearest candidate; a longer name may be off by more. */
static void consider(const char *typed, size_t length, const char *candidate, const char **best,
                     size_t *distance)
{
    size_t far = candidate ? edit_distance(typed, length, candidate) : SIZE_MAX;
    size_t allowed = length < 6 ? 1 : length / 3;
    if (candidate && length > 3 && strncmp(typed, candidate, length) == 0) {
        far = 1; /* a beginning of the name */
    }
    if (far <= allowed && far < *distance) {
        *best = candidate;
        *distance = far;
    }
}

static parian_result refuse_unknown(const parse_state *state, const char *argument, size_t length)
{
    const char *best = NULL;
    size_t distance = SIZE_MAX;
    for (size_t i = 0; i < row_count(state); i++) {
        parian_option_kind kind = row(state, i)->kind;
        if (kind != PARIAN_OPTION_LATER && kind != PARIAN_OPTION_GROUP) {
            consider(argument, length, row(state, i)->name, &best, &distance);
            consider(argument, length, row(state, i)->alias, &best, &distance);
        }
    }
    if (best) {
        return refuse(state, PARIAN_E_ARGUMENT, "unknown option '%.*s'; did you mean '%s'?",
                      (int)length, argument, best);
    }
    return refuse(state, PARIAN_E_ARGUMENT, "unknown option '%.*s'", (int)length, argument);
}

/* A whole number or a fraction, finite and with nothing behind it. */
static bool parse_number(const char *text, double *number)
{
    char *end;
    if (!((*text >= '0' && *text <= '9') || *text == '-' || *text == '+' || *text == '.') ||
        strpbrk(text, "xXnN")) {
        return false;
    }
    *number = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*number);
}

static bool out_of_range(const parian_option *option, double number)
{
    bool limited =
        option->minimum < 0 || option->minimum > 0 || option->maximum < 0 || option->maximum > 0;
    return limited && (number < option->minimum || number > option->maximum);
}

static parian_result set_number(const parse_state *state, const parian_option *option,
                                const char *text)
{
    double number;
    if (!parse_number(text, &number)) {
        return refuse(state, PARIAN_E_ARGUMENT, "%s: '%s' is not a finite number", option->name,
                      text);
    }
    if (out_of_range(option, number)) {
        return refuse(state, PARIAN_E_ARGUMENT, "%s: %s is outside of %g to %g", option->name, text,
                      option->minimum, option->maximum);
    }
    *(double *)option->value = number;
    return PARIAN_OK;
}

static parian_result set_count(const parse_state *state, const parian_option *option,
                               const char *text)
{
    char *end = NULL;
    errno = 0;
    unsigned long long number = strtoull(text, &end, 10);
    if (*text < '0' || *text > '9' || *end != '\0') {
        return refuse(state, PARIAN_E_ARGUMENT, "%s: '%s' is not a whole number", option->name,
                      text);
    }
    if (errno == ERANGE || number > UINT32_MAX || out_of_range(option, (double)number)) {
        bool limited = option->maximum > 0;
        return refuse(state, PARIAN_E_ARGUMENT, "%s: %s is outside of %.0f to %.0f", option->name,
                      text, option->minimum, limited ? option->maximum : (double)UINT32_MAX);
    }
    *(uint32_t *)option->value = (uint32_t)number;
    return PARIAN_OK;
}

static parian_result set_length(const parse_state *state, const parian_option *option,
                                const char *text)
{
    if (parian_parse_length(text, option->value) != PARIAN_OK) {
        return refuse(state, PARIAN_E_ARGUMENT,
                      "%s: '%s' is not a length such as 50mm (units: um, mm, cm, m)", option->name,
                      text);
    }
    return PARIAN_OK;
}

static parian_result set_choice(const parse_state *state, const parian_option *option,
                                const char *text)
{
    const char *at = option->choices;
    for (int index = 0; at; index++) {
        size_t length = strcspn(at, "|");
        if (strlen(text) == length && strncmp(at, text, length) == 0) {
            *(int *)option->value = index;
            return PARIAN_OK;
        }
        at = at[length] == '|' ? at + length + 1 : NULL;
    }
    return refuse(state, PARIAN_E_ARGUMENT, "%s: '%s' is not one of %s", option->name, text,
                  option->choices);
}

static parian_result append(const parse_state *state, parian_string_list *list, const char *what,
                            const char *text)
{
    if (list->count >= PARIAN_STRING_LIST_MAX) {
        return refuse(state, PARIAN_E_ARGUMENT, "%s: more than %d", what, PARIAN_STRING_LIST_MAX);
    }
    list->item[list->count++] = text;
    return PARIAN_OK;
}

static parian_result set_value(const parse_state *state, const parian_option *option,
                               const char *text)
{
    switch (option->kind) {
    case PARIAN_OPTION_STRING:
        *(const char **)option->value = text;
        return PARIAN_OK;
    case PARIAN_OPTION_LIST:
        return append(state, option->value, option->name, text);
    case PARIAN_OPTION_COUNT:
        return set_count(state, option, text);
    case PARIAN_OPTION_NUMBER:
        return set_number(state, option, text);
    case PARIAN_OPTION_LENGTH:
        return set_length(state, option, text);
    case PARIAN_OPTION_CHOICE:
        return set_choice(state, option, text);
    case PARIAN_OPTION_FLAG:
    case PARIAN_OPTION_LATER:
    case PARIAN_OPTION_GROUP:
        break;
    }
    return PARIAN_E_ARGUMENT;
}

static const char *const help_forms[] = {"text", "man", "bash", "zsh", "fish", "commands"};

static parian_result set_help_form(const parse_state *state, const char *text)
{
    for (size_t i = 0; i < sizeof help_forms / sizeof *help_forms; i++) {
        if (strcmp(help_forms[i], text) == 0) {
            state->common_values->help_form = (parian_help_form)i;
            return PARIAN_OK;
        }
    }
    return refuse(state, PARIAN_E_ARGUMENT, "--help: '%s' is not one of man|bash|zsh|fish", text);
}

/* One option at argv[*index]; advances over its value. */
static parian_result parse_option(const parse_state *state, int argc, char **argv, int *index)
{
    const char *argument = argv[*index];
    const char *equals = strncmp(argument, "--", 2) == 0 ? strchr(argument, '=') : NULL;
    size_t length = equals ? (size_t)(equals - argument) : strlen(argument);
    const parian_option *option = find_option(state, argument, length);
    const char *value = equals ? equals + 1 : NULL;
    if (!option) {
        return refuse_unknown(state, argument, length);
    }
    if (option->kind == PARIAN_OPTION_LATER) {
        return refuse(state, PARIAN_E_UNSUPPORTED, "option '%s' is not supported by this version",
                      option->name);
    }
    if (option->given) {
        *option->given = true;
    }
    if (equals && option->value == &state->common_values->help) {
        state->common_values->help = true;
        return set_help_form(state, value);
    }
    if (option->kind == PARIAN_OPTION_FLAG) {
        *(bool *)option->value = true;
        return equals ? refuse(state, PARIAN_E_ARGUMENT, "%s takes no value", option->name)
                      : PARIAN_OK;
    }
    if (!value) {
        bool missing =
            *index + 1 >= argc || find_option(state, argv[*index + 1], strlen(argv[*index + 1]));
        if (missing) {
            return refuse(state, PARIAN_E_ARGUMENT, "%s needs a value: %s", option->name,
                          option->choices    ? option->choices
                          : option->argument ? option->argument
                                             : "VALUE");
        }
        value = argv[++*index];
    }
    return set_value(state, option, value);
}

static parian_result print_version(const parse_state *state)
{
    size_t word = strcspn(state->command->tool, " ");
    printf("%.*s %s\n", (int)word, state->command->tool, PARIAN_VERSION);
    return fflush(stdout) == 0 ? PARIAN_OK : PARIAN_E_IO;
}

static parian_result print_commands(const parian_command *command)
{
    for (size_t i = 0; i < command->command_count; i++) {
        puts(command->commands[i].name);
    }
    return parian_options_end_output();
}

static parian_result print_form(const parse_state *state)
{
    switch (state->common_values->help_form) {
    case PARIAN_HELP_MAN:
        return parian_options_print_man(state->command, state->common);
    case PARIAN_HELP_BASH:
        return parian_options_print_bash(state->command, state->common);
    case PARIAN_HELP_ZSH:
        return parian_options_print_zsh(state->command, state->common);
    case PARIAN_HELP_FISH:
        return parian_options_print_fish(state->command, state->common);
    case PARIAN_HELP_COMMANDS:
        return print_commands(state->command);
    case PARIAN_HELP_TEXT:
        break;
    }
    return parian_options_print_help(state->command, state->common);
}

static parian_result print_and_check(const parse_state *state)
{
    parian_result result = state->common_values->help ? print_form(state) : print_version(state);
    if (result != PARIAN_OK) {
        fprintf(stderr, "%s: error: cannot write to stdout: %s\n", state->command->tool,
                strerror(errno));
    }
    return result;
}

parian_result parian_options_parse(const parian_command *command, parian_common_options *common,
                                   parian_string_list *positional, int argc, char **argv, int first)
{
    parse_state state = {.command = command, .common_values = common};
    bool options_ended = false;
    parian_options_common_rows(common, state.common);
    for (int i = first; i < argc; i++) {
        parian_result result;
        if (options_ended || argv[i][0] != '-' || argv[i][1] == '\0') {
            result = append(&state, positional, "arguments", argv[i]);
        } else if (strcmp(argv[i], "--") == 0) {
            options_ended = true;
            continue;
        } else {
            result = parse_option(&state, argc, argv, &i);
        }
        if (result != PARIAN_OK) {
            return result;
        }
        if (common->help || common->version) {
            return print_and_check(&state);
        }
    }
    return PARIAN_OK;
}

parian_result parian_parse_length(const char *text, double *metres)
{
    static const struct {
        const char *unit;
        double metres;
    } units[] = {{"um", 1e-6}, {"mm", 1e-3}, {"cm", 1e-2}, {"m", 1}};
    char *end;
    if (*text != '.' && (*text < '0' || *text > '9')) {
        return PARIAN_E_ARGUMENT;
    }
    double number = strtod(text, &end);
    while (*end == ' ') {
        end++;
    }
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        double length = number * units[i].metres;
        if (strcmp(end, units[i].unit) == 0 && isfinite(length) && length > 0) {
            *metres = length;
            return PARIAN_OK;
        }
    }
    return PARIAN_E_ARGUMENT;
}
