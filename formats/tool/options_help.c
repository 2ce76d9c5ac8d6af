/* options_help.c - prints --help from the table of options, in 80 columns.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "tool/options_internal.h"

const char parian_exit_status_text[] =
    "0 ok, 1 usage, 2 input or output failed, 3 invalid input file, 4 computation failed, 5 not "
    "supported, 7 compared files differ, 130 interrupted.";

enum { COLUMNS = 80, HEAD_INDENT = 2, HELP_COLUMN_MAX = 26, HEAD_MAX = 160 };

/* Words of text from `column` on, wrapped; lines after the first begin at `indent`. A newline of
 * the text breaks the line. Ends with a newline. */
static void print_wrapped(const char *text, size_t column, size_t indent)
{
    bool line_empty = true;
    while (*text) {
        size_t word = strcspn(text, " \n");
        if (word > 0) {
            if (!line_empty && column + 1 + word > COLUMNS) {
                printf("\n%*s", (int)indent, "");
                column = indent;
                line_empty = true;
            }
            printf("%s%.*s", line_empty ? "" : " ", (int)word, text);
            column += word + (line_empty ? 0 : 1);
            line_empty = false;
            text += word;
        }
        if (*text == '\n') {
            printf("\n%*s", (int)indent, "");
            column = indent;
            line_empty = true;
        }
        text += *text != '\0';
    }
    putchar('\n');
}

bool parian_option_is_shown(const parian_option *option)
{
    return option->kind != PARIAN_OPTION_LATER && option->kind != PARIAN_OPTION_GROUP;
}

const char *parian_option_argument(const parian_option *option)
{
    if (option->kind == PARIAN_OPTION_FLAG) {
        return NULL;
    }
    return option->argument ? option->argument : option->choices ? option->choices : "VALUE";
}

/* "-o, --output FILE": names and argument of an option. */
static size_t option_head(const parian_option *option, char head[HEAD_MAX])
{
    const char *argument = parian_option_argument(option);
    int length =
        snprintf(head, HEAD_MAX, "%s%s%s%s%s", option->name, option->alias ? ", " : "",
                 option->alias ? option->alias : "", argument ? " " : "", argument ? argument : "");
    return length > 0 ? (size_t)length : 0;
}

static void print_option(const parian_option *option, size_t help_column)
{
    char head[HEAD_MAX];
    if (option->kind == PARIAN_OPTION_LATER) {
        return;
    }
    if (option->kind == PARIAN_OPTION_GROUP) {
        printf("\n%s:\n", option->name);
        return;
    }
    size_t length = option_head(option, head);
    printf("%*s%s", HEAD_INDENT, "", head);
    if (HEAD_INDENT + length + 2 > help_column) {
        putchar('\n');
        length = 0;
        printf("%*s", (int)help_column, "");
    } else {
        printf("%*s", (int)(help_column - HEAD_INDENT - length), "");
    }
    print_wrapped(option->help ? option->help : "", help_column, help_column);
}

/* The column at which most help texts can begin on the line of their option. */
static size_t find_help_column(const parian_option *options, size_t count)
{
    size_t column = 0;
    for (size_t i = 0; i < count; i++) {
        char head[HEAD_MAX];
        size_t needed = HEAD_INDENT + option_head(&options[i], head) + 2;
        if (parian_option_is_shown(&options[i]) && needed <= HELP_COLUMN_MAX && needed > column) {
            column = needed;
        }
    }
    return column ? column : HELP_COLUMN_MAX;
}

static void print_usage(const parian_command *command)
{
    size_t indent = (size_t)printf("Usage: %s ", command->tool);
    print_wrapped(command->usage ? command->usage : "[options]", indent, indent);
}

static void print_commands(const parian_command *command)
{
    size_t column = 0;
    for (size_t i = 0; i < command->command_count; i++) {
        size_t length = strlen(command->commands[i].name);
        column = length > column ? length : column;
    }
    column += HEAD_INDENT + 2;
    puts("\nCommands:");
    for (size_t i = 0; i < command->command_count; i++) {
        printf("%*s%-*s", HEAD_INDENT, "", (int)column - HEAD_INDENT, command->commands[i].name);
        print_wrapped(command->commands[i].help, column, column);
    }
    printf("%s COMMAND --help tells more.\n", command->tool);
}

parian_result parian_options_print_help(const parian_command *command,
                                        const parian_option *common_rows)
{
    size_t column = find_help_column(command->options, command->option_count);
    size_t common_column = find_help_column(common_rows, PARIAN_COMMON_OPTION_COUNT);
    column = common_column > column ? common_column : column;
    print_usage(command);
    if (command->summary) {
        putchar('\n');
        print_wrapped(command->summary, 0, 0);
    }
    if (command->command_count > 0) {
        print_commands(command);
    }
    if (command->option_count > 0 && command->options[0].kind != PARIAN_OPTION_GROUP) {
        puts("\nOptions:");
    }
    for (size_t i = 0; i < command->option_count; i++) {
        print_option(&command->options[i], column);
    }
    puts("\nCommon options:");
    for (size_t i = 0; i < PARIAN_COMMON_OPTION_COUNT; i++) {
        print_option(&common_rows[i], column);
    }
    putchar('\n');
    printf("Exit status: ");
    print_wrapped(parian_exit_status_text, 13, 13);
    if (command->epilogue) {
        printf("\n%s%s", command->epilogue,
               command->epilogue[strlen(command->epilogue) - 1] == '\n' ? "" : "\n");
    }
    return parian_options_end_output();
}

parian_result parian_options_end_output(void)
{
    return fflush(stdout) == 0 && !ferror(stdout) ? PARIAN_OK : PARIAN_E_IO;
}

size_t parian_sentence_length(const char *text)
{
    size_t length = 0;
    while (text[length] != '\0' &&
           !(text[length] == '.' &&
             (text[length + 1] == '\0' || text[length + 1] == ' ' || text[length + 1] == '\n'))) {
        length++;
    }
    return length;
}
