/* options_shells.c - prints completion for bash, zsh and fish from the table of options.
 *
 * Each call prints the part of one command. A completion file is the part of the tool itself, then
 * those of its commands.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "tool/options_internal.h"

parian_value_kind parian_option_value_kind(const parian_option *option)
{
    const char *argument = parian_option_argument(option);
    if (!argument) {
        return PARIAN_VALUE_NONE;
    }
    if (option->choices) {
        return PARIAN_VALUE_CHOICE;
    }
    bool text = option->kind == PARIAN_OPTION_STRING || option->kind == PARIAN_OPTION_LIST;
    if (text && (strstr(argument, "FILE") || strchr(argument, '.'))) {
        return PARIAN_VALUE_FILE;
    }
    return text && strstr(argument, "DIR") ? PARIAN_VALUE_FOLDER : PARIAN_VALUE_WORD;
}

const parian_option *parian_command_row(const parian_command *command,
                                        const parian_option *common_rows, size_t index)
{
    if (index < command->option_count) {
        return &command->options[index];
    }
    index -= command->option_count;
    return index < PARIAN_COMMON_OPTION_COUNT ? &common_rows[index] : NULL;
}

/* text with `from` replaced, such as "parian-info validate" as "parian_info_validate". */
static void print_replaced(const char *text, const char *from, char to)
{
    for (; *text; text++) {
        putchar(strchr(from, *text) ? to : *text);
    }
}

static void print_function_name(const char *tool)
{
    putchar('_');
    print_replaced(tool, "- ", '_');
}

/* Length of the tool's own name in "parian-info validate". */
static int tool_length(const parian_command *command)
{
    return (int)strcspn(command->tool, " ");
}

static bool is_command(const parian_command *command)
{
    return command->tool[tool_length(command)] == ' ';
}

/* ---- bash --------------------------------------------------------------------------------------
 */

static void print_bash_value(const parian_option *option)
{
    parian_value_kind kind = parian_option_value_kind(option);
    if (kind == PARIAN_VALUE_NONE) {
        return;
    }
    printf("    %s%s%s) ", option->name, option->alias ? " | " : "",
           option->alias ? option->alias : "");
    if (kind == PARIAN_VALUE_CHOICE) {
        fputs("COMPREPLY=($(compgen -W '", stdout);
        print_replaced(option->choices, "|", ' ');
        puts("' -- \"$2\")) ;;");
    } else if (kind == PARIAN_VALUE_WORD) {
        puts("COMPREPLY=() && compopt +o default ;;");
    } else {
        printf("mapfile -t COMPREPLY < <(compgen -%c -- \"$2\") && compopt -o filenames ;;\n",
               kind == PARIAN_VALUE_FOLDER ? 'd' : 'f');
    }
}

/* What stands where no value of an option is due: options, commands, files. */
static void print_bash_words(const parian_command *command, const parian_option *common_rows)
{
    const parian_option *option;
    fputs("    *)\n        case $2 in\n        -*) COMPREPLY=($(compgen -W '", stdout);
    for (size_t i = 0; (option = parian_command_row(command, common_rows, i)); i++) {
        if (parian_option_is_shown(option)) {
            printf("%s ", option->name);
            printf(option->alias ? "%s " : "", option->alias);
        }
    }
    puts("' -- \"$2\")) ;;");
    fputs("        *) mapfile -t COMPREPLY < <(", stdout);
    if (command->command_count > 0) {
        fputs("compgen -W '", stdout);
        for (size_t i = 0; i < command->command_count; i++) {
            printf("%s ", command->commands[i].name);
        }
        fputs("' -- \"$2\"; ", stdout);
    }
    puts("compgen -f -- \"$2\") && compopt -o filenames ;;\n        esac ;;");
}

/* The function that bash calls: finds the command, and the option that is due a value. */
static void print_bash_entry(const parian_command *command)
{
    print_function_name(command->tool);
    puts("() {\n"
         "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} word "
         "command=");
    puts("    if [ \"$current\" = = ]; then\n"
         "        current=\n"
         "    elif [ \"$previous\" = = ]; then\n"
         "        previous=${COMP_WORDS[COMP_CWORD - 2]}\n"
         "    fi");
    if (command->command_count > 0) {
        puts("    for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n        case $word in");
        fputs("        ", stdout);
        for (size_t i = 0; i < command->command_count; i++) {
            printf("%s%s", i > 0 ? " | " : "", command->commands[i].name);
        }
        puts(") command=_${word//-/_} && break ;;\n        esac\n    done");
    }
    fputs("    \"", stdout);
    print_function_name(command->tool);
    puts("_words$command\" \"$previous\" \"$current\"\n}");
    printf("complete -o default -F ");
    print_function_name(command->tool);
    printf(" %s\n", command->tool);
}

parian_result parian_options_print_bash(const parian_command *command,
                                        const parian_option *common_rows)
{
    const parian_option *option;
    int own = tool_length(command);
    if (!is_command(command)) {
        printf("# Completion of %s for bash; made from the options of %s --help.\n", command->tool,
               command->tool);
        print_bash_entry(command);
    }
    char tool[64];
    snprintf(tool, sizeof tool, "%.*s words%s", own, command->tool, command->tool + own);
    putchar('\n');
    print_function_name(tool);
    puts("() {\n    case $1 in");
    for (size_t i = 0; (option = parian_command_row(command, common_rows, i)); i++) {
        if (parian_option_is_shown(option)) {
            print_bash_value(option);
        }
    }
    print_bash_words(command, common_rows);
    puts("    esac\n}");
    return parian_options_end_output();
}

/* ---- zsh and fish ------------------------------------------------------------------------------
 */

/* The first sentence of help within single quotes; `special` characters get a backslash. */
static void print_brief(const char *help, const char *special, const char *quote)
{
    size_t length = parian_sentence_length(help);
    for (size_t i = 0; i < length; i++) {
        if (help[i] == '\'') {
            fputs(quote, stdout);
        } else {
            printf(strchr(special, help[i]) ? "\\" : "");
            putchar(help[i] == '\n' ? ' ' : help[i]);
        }
    }
}

static void print_zsh_spec(const parian_option *option, const char *name, const char *other)
{
    parian_value_kind kind = parian_option_value_kind(option);
    bool equals = kind != PARIAN_VALUE_NONE && strncmp(name, "--", 2) == 0;
    fputs("        '", stdout);
    if (option->kind == PARIAN_OPTION_LIST) {
        putchar('*');
    } else if (other) {
        printf("(%s)", other);
    }
    printf("%s%s[", name, equals ? "=" : "");
    print_brief(option->help ? option->help : "", "[]\\", "'\\''");
    putchar(']');
    if (kind != PARIAN_VALUE_NONE) {
        putchar(':');
        print_replaced(option->argument ? option->argument : "value", ":", ' ');
        putchar(':');
    }
    if (kind == PARIAN_VALUE_CHOICE) {
        putchar('(');
        print_replaced(option->choices, "|", ' ');
        putchar(')');
    } else if (kind == PARIAN_VALUE_FILE || kind == PARIAN_VALUE_FOLDER) {
        fputs(kind == PARIAN_VALUE_FILE ? "_files" : "_files -/", stdout);
    }
    puts("' \\");
}

/* The function that zsh calls: the command decides, or the tool itself. */
static void print_zsh_entry(const parian_command *command)
{
    printf("#compdef %s\n# Completion of %s for zsh; made from the options of %s --help.\n\n",
           command->tool, command->tool, command->tool);
    print_function_name(command->tool);
    puts("() {\n    local word");
    if (command->command_count > 0) {
        puts("    for word in ${words[2,CURRENT-1]}; do\n        case $word in");
        fputs("        ", stdout);
        for (size_t i = 0; i < command->command_count; i++) {
            printf("%s%s", i > 0 ? "|" : "", command->commands[i].name);
        }
        fputs(") ", stdout);
        print_function_name(command->tool);
        puts("_words_${word//-/_}; return ;;\n        esac\n    done");
    }
    fputs("    ", stdout);
    print_function_name(command->tool);
    puts("_words\n}");
}

static void print_zsh_words(const parian_command *command)
{
    if (command->command_count > 0) {
        fputs("        '1:command or file:{ compadd --", stdout);
        for (size_t i = 0; i < command->command_count; i++) {
            printf(" %s", command->commands[i].name);
        }
        puts("; _files }' \\");
    }
    puts(is_command(command) ? "        '1: :()' '*:file:_files'\n}"
                             : "        '*:file:_files'\n}");
}

parian_result parian_options_print_zsh(const parian_command *command,
                                       const parian_option *common_rows)
{
    const parian_option *option;
    char tool[64];
    int own = tool_length(command);
    if (!is_command(command)) {
        print_zsh_entry(command);
    }
    snprintf(tool, sizeof tool, "%.*s words%s", own, command->tool, command->tool + own);
    putchar('\n');
    print_function_name(tool);
    puts("() {\n    _arguments \\");
    for (size_t i = 0; (option = parian_command_row(command, common_rows, i)); i++) {
        if (parian_option_is_shown(option)) {
            print_zsh_spec(option, option->name, option->alias);
        }
        if (parian_option_is_shown(option) && option->alias) {
            print_zsh_spec(option, option->alias, option->name);
        }
    }
    print_zsh_words(command);
    return parian_options_end_output();
}

static void print_fish_name(const char *name)
{
    if (strncmp(name, "--", 2) == 0) {
        printf(" -l %s", name + 2);
    } else {
        printf(" -%c %s", strlen(name) == 2 ? 's' : 'o', name + 1);
    }
}

static void print_fish_option(const char *condition, const char *tool, int own,
                              const parian_option *option)
{
    printf("complete -c %.*s%s", own, tool, condition);
    print_fish_name(option->name);
    if (option->alias) {
        print_fish_name(option->alias);
    }
    switch (parian_option_value_kind(option)) {
    case PARIAN_VALUE_CHOICE:
        fputs(" -x -a '", stdout);
        print_replaced(option->choices, "|", ' ');
        putchar('\'');
        break;
    case PARIAN_VALUE_WORD:
        fputs(" -x", stdout);
        break;
    case PARIAN_VALUE_FILE:
        fputs(" -r -F", stdout);
        break;
    case PARIAN_VALUE_FOLDER:
        fputs(" -x -a '(__fish_complete_directories)'", stdout);
        break;
    case PARIAN_VALUE_NONE:
        break;
    }
    fputs(" -d '", stdout);
    print_brief(option->help ? option->help : "", "\\", "\\'");
    puts("'");
}

parian_result parian_options_print_fish(const parian_command *command,
                                        const parian_option *common_rows)
{
    const parian_option *option;
    char condition[512] = "";
    int own = tool_length(command);
    size_t length = 0;
    if (is_command(command)) {
        snprintf(condition, sizeof condition, " -n '__fish_seen_subcommand_from %s'",
                 command->tool + own + 1);
    } else {
        printf("# Completion of %s for fish; made from the options of %s --help.\n", command->tool,
               command->tool);
    }
    for (size_t i = 0; i < command->command_count && length < sizeof condition; i++) {
        length += (size_t)snprintf(condition + length, sizeof condition - length, "%s %s",
                                   i ? "" : " -n 'not __fish_seen_subcommand_from",
                                   command->commands[i].name);
    }
    if (length + 1 < sizeof condition && command->command_count > 0) {
        strcpy(condition + length, "'");
    }
    for (size_t i = 0; i < command->command_count; i++) {
        printf("complete -c %s%s -a %s -d '", command->tool, condition, command->commands[i].name);
        print_brief(command->commands[i].help, "\\", "\\'");
        puts("'");
    }
    for (size_t i = 0; (option = parian_command_row(command, common_rows, i)); i++) {
        if (parian_option_is_shown(option)) {
            print_fish_option(condition, command->tool, own, option);
        }
    }
    return parian_options_end_output();
}
