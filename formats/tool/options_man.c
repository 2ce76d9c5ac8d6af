/* options_man.c - prints a manual page from the table of options.
 *
 * The pages hold no dates: the same source gives the same bytes.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "tool/options_internal.h"

static const char *const tools[] = {"parian-bake",    "parian-view",   "parian-info",
                                    "parian-measure", "parian-models", "parian-montage"};

/* One character as roff takes it. */
static void print_character(char c)
{
    switch (c) {
    case '\\':
        fputs("\\(rs", stdout);
        break;
    case '-':
        fputs("\\-", stdout);
        break;
    case '~':
        fputs("\\(ti", stdout);
        break;
    case '^':
        fputs("\\(ha", stdout);
        break;
    case '`':
        fputs("\\(ga", stdout);
        break;
    case '\'':
        fputs("\\(aq", stdout);
        break;
    case '"':
        fputs("\\(dq", stdout);
        break;
    default:
        putchar(c);
    }
}

static void print_escaped(const char *text, size_t length)
{
    if (length > 0 && text[0] == '.') {
        fputs("\\&", stdout);
    }
    for (size_t i = 0; i < length; i++) {
        print_character(text[i]);
    }
}

/* Running text: a line for each sentence, and a paragraph after an empty line. */
static void print_text(const char *text)
{
    bool line_empty = true;
    while (*text) {
        size_t word = strcspn(text, " \n");
        if (word > 0) {
            bool ends = text[word - 1] == '.' || text[word - 1] == ':';
            fputs(line_empty ? "" : " ", stdout);
            print_escaped(text, word);
            line_empty = ends;
            fputs(ends ? "\n" : "", stdout);
        } else if (text[0] == '\n' && text[1] == '\n') {
            fputs(line_empty ? ".PP\n" : "\n.PP\n", stdout);
            line_empty = true;
        }
        text += word + (text[word] != '\0');
    }
    fputs(line_empty ? "" : "\n", stdout);
}

/* "PARIAN-INFO-VALIDATE": the name of the page, spaces as hyphens. */
static void print_page_name(const char *tool, bool upper)
{
    for (; *tool; tool++) {
        print_character(*tool == ' ' ? '-' : upper ? (char)toupper((unsigned char)*tool) : *tool);
    }
}

static void print_name(const parian_command *command)
{
    const char *summary = command->summary ? command->summary : "";
    size_t length = parian_sentence_length(summary);
    fputs(".TH ", stdout);
    print_page_name(command->tool, true);
    printf(" 1 \"\" \"Parian %s\" \"Parian\"\n.SH NAME\n", PARIAN_VERSION);
    print_page_name(command->tool, false);
    fputs(" \\- ", stdout);
    for (size_t i = 0; i < length; i++) {
        char c = summary[i] == '\n' ? ' ' : summary[i];
        print_character(i == 0 ? (char)tolower((unsigned char)c) : c);
    }
    putchar('\n');
}

static void print_synopsis(const parian_command *command)
{
    fputs(".SH SYNOPSIS\n.B ", stdout);
    print_escaped(command->tool, strlen(command->tool));
    putchar('\n');
    const char *usage = command->usage ? command->usage : "[options]";
    print_escaped(usage, strlen(usage));
    putchar('\n');
    puts(".SH DESCRIPTION");
    print_text(command->summary ? command->summary : "");
}

static void print_option(const parian_option *option)
{
    const char *argument = parian_option_argument(option);
    if (option->kind == PARIAN_OPTION_GROUP) {
        printf(".SS %s\n", option->name);
    }
    if (!parian_option_is_shown(option)) {
        return;
    }
    fputs(".TP\n\\fB", stdout);
    print_escaped(option->name, strlen(option->name));
    if (option->alias) {
        fputs("\\fR, \\fB", stdout);
        print_escaped(option->alias, strlen(option->alias));
    }
    if (argument) {
        fputs("\\fR \\fI", stdout);
        print_escaped(argument, strlen(argument));
    }
    fputs("\\fR\n", stdout);
    print_text(option->help ? option->help : "");
    if (option->choices && option->argument) {
        fputs("One of ", stdout);
        print_text(option->choices);
        puts(".");
    }
}

static void print_options(const parian_command *command, const parian_option *common_rows)
{
    if (command->option_count > 0) {
        puts(".SH OPTIONS");
    }
    for (size_t i = 0; i < command->option_count; i++) {
        print_option(&command->options[i]);
    }
    puts(".SH COMMON OPTIONS");
    for (size_t i = 0; i < PARIAN_COMMON_OPTION_COUNT; i++) {
        print_option(&common_rows[i]);
    }
}

static void print_commands(const parian_command *command)
{
    puts(".SH COMMANDS");
    for (size_t i = 0; i < command->command_count; i++) {
        fputs(".TP\n.B ", stdout);
        print_escaped(command->commands[i].name, strlen(command->commands[i].name));
        putchar('\n');
        print_text(command->commands[i].help);
    }
}

/* The epilogue of --help: indented lines are shown as they are, others are text. */
static void print_epilogue(const char *text)
{
    bool literal = false, titled = false;
    while (*text) {
        size_t length = strcspn(text, "\n");
        bool indented = length > 2 && text[0] == ' ' && text[1] == ' ';
        bool title = strncmp(text, "Example", 7) == 0 && text[length - 1] == ':' && length < 10;
        if (literal != indented && (literal || !title)) {
            puts(literal ? ".EE" : ".EX");
            literal = indented;
        }
        if (title || (!titled && length > 0)) {
            puts(title ? ".SH EXAMPLES" : ".SH NOTES");
            titled = true;
        }
        if (indented) {
            print_escaped(text + 2, length - 2);
            putchar('\n');
        } else if (!title && length > 0) {
            char line[1024];
            snprintf(line, sizeof line, "%.*s", (int)length, text);
            print_text(line);
        } else if (length == 0 && text[1] != '\0' && strncmp(text + 1, "Example", 7) != 0) {
            puts(".PP");
        }
        text += length + (text[length] == '\n');
    }
    fputs(literal ? ".EE\n" : "", stdout);
}

/* The page of the tool, of its commands, and of the other tools. */
static void print_see_also(const parian_command *command)
{
    size_t own = strcspn(command->tool, " ");
    bool first = true;
    puts(".SH SEE ALSO");
    for (size_t i = 0; i < command->command_count; i++) {
        fputs(first ? "\\fB" : ",\n\\fB", stdout);
        print_page_name(command->tool, false);
        fputs("\\-", stdout);
        print_page_name(command->commands[i].name, false);
        fputs("\\fR(1)", stdout);
        first = false;
    }
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++) {
        if (strcmp(tools[i], command->tool) == 0) {
            continue;
        }
        bool parent = strlen(tools[i]) == own && strncmp(tools[i], command->tool, own) == 0;
        if (parent || command->tool[own] == '\0') {
            fputs(first ? "\\fB" : ",\n\\fB", stdout);
            print_page_name(tools[i], false);
            fputs("\\fR(1)", stdout);
            first = false;
        }
    }
    putchar('\n');
}

parian_result parian_options_print_man(const parian_command *command,
                                       const parian_option *common_rows)
{
    print_name(command);
    print_synopsis(command);
    if (command->command_count > 0) {
        print_commands(command);
    }
    print_options(command, common_rows);
    puts(".SH EXIT STATUS");
    print_text(parian_exit_status_text);
    if (command->epilogue) {
        print_epilogue(command->epilogue);
    }
    print_see_also(command);
    return parian_options_end_output();
}
