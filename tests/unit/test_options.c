/* test_options.c - parsing of command lines, and what mistakes say.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "support/test_support.h"
#include "tool/options.h"

enum { TEXT_MAX = 8192 };

typedef struct values {
    bool force, force_given;
    const char *output, *depfile;
    parian_string_list lights;
    uint32_t atlas;
    double threshold, scale;
    int bssrdf;
    parian_common_options common;
    parian_string_list positional;
    char out[TEXT_MAX], err[TEXT_MAX];
} values;

/* Sends a stream's descriptor to a file while a function runs, and reads it back. */
static int redirect(FILE *stream, const char *path)
{
    fflush(stream);
    int saved = dup(fileno(stream));
    FILE *file = fopen(path, "w+b");
    assert_non_null(file);
    dup2(fileno(file), fileno(stream));
    fclose(file);
    return saved;
}

static void restore(FILE *stream, int saved, const char *path, char text[TEXT_MAX])
{
    fflush(stream);
    dup2(saved, fileno(stream));
    close(saved);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT_MAX - 1, file)] = '\0';
    fclose(file);
}

static parian_result parse(values *v, const char *const *words)
{
    const parian_option options[] = {
        {"-o", "--output", PARIAN_OPTION_STRING, &v->output, "FILE", "Where to write.", 0, 0, NULL,
         NULL},
        {"-MF", NULL, PARIAN_OPTION_STRING, &v->depfile, "FILE", "Dependency file.", 0, 0, NULL,
         NULL},
        {"--force", NULL, PARIAN_OPTION_FLAG, &v->force, NULL, "Overrule the plan.", 0, 0, NULL,
         &v->force_given},
        {"--light", NULL, PARIAN_OPTION_LIST, &v->lights, "SPEC", "A light.", 0, 0, NULL, NULL},
        {"--atlas", NULL, PARIAN_OPTION_COUNT, &v->atlas, "N", "Side of the atlas (512).", 16, 8192,
         NULL, NULL},
        {"--threshold", NULL, PARIAN_OPTION_NUMBER, &v->threshold, "T", "Share of a row (0.002).",
         -1, 1, NULL, NULL},
        {"--scale", NULL, PARIAN_OPTION_LENGTH, &v->scale, "LEN", "Longest side.", 0, 0, NULL,
         NULL},
        {"--bssrdf", NULL, PARIAN_OPTION_CHOICE, &v->bssrdf, NULL,
         "The model of the transport, in a sentence that is long enough to be wrapped over more "
         "than one line "
         "of eighty columns.",
         0, 0, "dipole|dipole-flux", NULL},
        {"--max-error", NULL, PARIAN_OPTION_LATER, NULL, NULL, NULL, 0, 0, NULL, NULL},
    };
    static const parian_subcommand commands[] = {{"sub", "what sub does"}};
    const parian_command command = {.tool = "parian-test",
                                    .usage = "INPUT -o FILE",
                                    .summary = "Tests options. And more.",
                                    .epilogue = "Examples:\n  parian-test x\n",
                                    .options = options,
                                    .option_count = sizeof options / sizeof options[0],
                                    .commands = commands,
                                    .command_count = 1};
    char *argv[32] = {(char *)(uintptr_t) "parian-test"};
    const char *out = test_scratch("out.txt"), *err = test_scratch("err.txt");
    int argc = 1;
    memset(v, 0, sizeof *v);
    for (; words[argc - 1]; argc++) {
        argv[argc] = (char *)(uintptr_t)words[argc - 1];
    }
    int saved_out = redirect(stdout, out), saved_err = redirect(stderr, err);
    parian_result result =
        parian_options_parse(&command, &v->common, &v->positional, argc, argv, 1);
    restore(stderr, saved_err, err, v->err);
    restore(stdout, saved_out, out, v->out);
    return result;
}

#define PARSE(v, ...) parse((v), (const char *const[]){__VA_ARGS__, NULL})

static void test_takes_every_kind(void **state)
{
    values v;
    (void)state;
    assert_int_equal(PARSE(&v, "in.obj", "-o", "out", "-MF", "deps", "--force", "--light", "a",
                           "--light=b", "--atlas", "64", "--threshold", "-0.5", "--scale", "50mm",
                           "--bssrdf", "dipole-flux", "-", "--", "-o", "--threads"),
                     PARIAN_OK);
    assert_string_equal(v.output, "out");
    assert_string_equal(v.depfile, "deps");
    assert_true(v.force && v.force_given);
    assert_int_equal(v.lights.count, 2);
    assert_string_equal(v.lights.item[1], "b");
    assert_int_equal(v.atlas, 64);
    assert_true(fabs(v.threshold + 0.5) < 1e-15);
    assert_true(fabs(v.scale - 0.05) < 1e-15);
    assert_int_equal(v.bssrdf, 1);
    assert_int_equal(v.positional.count, 4);
    assert_string_equal(v.positional.item[1], "-");
    assert_string_equal(v.positional.item[2], "-o");
    assert_string_equal(v.err, "");
}

static void test_common_options(void **state)
{
    values v;
    (void)state;
    assert_int_equal(PARSE(&v, "-q", "-v", "--threads", "7", "--progress", "json"), PARIAN_OK);
    assert_true(v.common.quiet && v.common.verbose);
    assert_int_equal(v.common.threads, 7);
    assert_int_equal(v.common.progress, 2);
    assert_int_equal(PARSE(&v, "--threads", "0"), PARIAN_E_ARGUMENT);
}

/* One line, with this text in it. */
static void check_refused(const values *v, const char *text)
{
    const char *end = strchr(v->err, '\n');
    assert_non_null(end);
    assert_int_equal(end[1], '\0');
    if (!strstr(v->err, text)) {
        fail_msg("'%s' does not say '%s'", v->err, text);
    }
}

static void test_mistakes(void **state)
{
    values v;
    (void)state;
    const struct {
        const char *words[4];
        const char *said;
    } cases[] = {
        {{"--atals", "64"}, "did you mean '--atlas'?"},
        {{"--thresh", "1"}, "did you mean '--threshold'?"},
        {{"--qwertyuiop"}, "unknown option '--qwertyuiop' (see"},
        {{"-oout"}, "unknown option '-oout'"},
        {{"-o"}, "-o needs a value: FILE"},
        {{"-o", "--force"}, "-o needs a value"},
        {{"--force=1"}, "--force takes no value"},
        {{"--atlas", "15"}, "15 is outside of 16 to 8192"},
        {{"--atlas", "99999999999999999999999"}, "outside of 16 to 8192"},
        {{"--atlas", "-64"}, "not a whole number"},
        {{"--atlas", "64x"}, "not a whole number"},
        {{"--atlas", ""}, "not a whole number"},
        {{"--threshold", "nan"}, "not a finite number"},
        {{"--threshold", "inf"}, "not a finite number"},
        {{"--threshold", "1e999"}, "not a finite number"},
        {{"--threshold", "0x1"}, "not a finite number"},
        {{"--threshold", "1.5"}, "outside of -1 to 1"},
        {{"--scale", "50"}, "not a length"},
        {{"--scale", "0mm"}, "not a length"},
        {{"--scale", "-1m"}, "not a length"},
        {{"--scale", "50 parsec"}, "not a length"},
        {{"--bssrdf", "dipol"}, "not one of dipole|dipole-flux"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(parse(&v, cases[i].words), PARIAN_E_ARGUMENT);
        check_refused(&v, cases[i].said);
    }
}

static void test_later_is_unsupported(void **state)
{
    values v;
    (void)state;
    assert_int_equal(PARSE(&v, "--max-error", "0.1"), PARIAN_E_UNSUPPORTED);
    check_refused(&v, "--max-error");
}

static void test_help_fits_and_hides(void **state)
{
    values v;
    (void)state;
    assert_int_equal(PARSE(&v, "--help"), PARIAN_OK);
    assert_true(v.common.help);
    assert_non_null(strstr(v.out, "-o, --output FILE"));
    assert_non_null(strstr(v.out, "--bssrdf dipole|dipole-flux"));
    assert_non_null(strstr(v.out, "Exit status:"));
    assert_non_null(strstr(v.out, "Examples:"));
    assert_null(strstr(v.out, "--max-error"));
    for (const char *line = v.out; *line;) {
        size_t length = strcspn(line, "\n");
        assert_true(length <= 80);
        line += length + (line[length] == '\n');
    }
    assert_int_equal(PARSE(&v, "--version"), PARIAN_OK);
    assert_string_equal(v.out, "parian-test " PARIAN_VERSION "\n");
}

/* Each form of --help holds every option that is built, and none that is not. */
static void test_forms_of_help(void **state)
{
    static const struct {
        const char *form, *expected[4];
    } cases[] = {
        {"--help=man",
         {".TH PARIAN\\-TEST 1 \"\"", "parian\\-test \\- tests options\n",
          "\\fB\\-o\\fR, \\fB\\-\\-output\\fR \\fIFILE\\fR", "\\fBparian\\-test\\-sub\\fR(1)"}},
        {"--help=bash",
         {"-o | --output) mapfile -t COMPREPLY < <(compgen -f", "compgen -W 'dipole dipole-flux'",
          "complete -o default -F _parian_test", "sub) command=_"}},
        {"--help=zsh", {"#compdef parian-test", "--bssrdf=[", ":(dipole dipole-flux)'", "_files"}},
        {"--help=fish",
         {"complete -c parian-test", "-x -a 'dipole dipole-flux'", "-r -F",
          "-a sub -d 'what sub does'"}},
        {"--help=commands", {"sub\n", "sub\n", "sub\n", "sub\n"}}};
    values v;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(PARSE(&v, cases[i].form), PARIAN_OK);
        for (int k = 0; k < 4; k++) {
            if (!strstr(v.out, cases[i].expected[k])) {
                fail_msg("%s lacks '%s'", cases[i].form, cases[i].expected[k]);
            }
        }
        assert_null(strstr(v.out, "max-error"));
        assert_null(strstr(v.out, "max\\-error"));
    }
    assert_int_equal(PARSE(&v, "--help=html"), PARIAN_E_ARGUMENT);
    assert_non_null(strstr(v.err, "man|bash|zsh|fish"));
}

static void test_too_many(void **state)
{
    static const char *words[PARIAN_STRING_LIST_MAX + 2];
    parian_common_options common = {0};
    parian_string_list list = {.count = 0};
    (void)state;
    for (size_t i = 0; i <= PARIAN_STRING_LIST_MAX; i++) {
        words[i] = "x";
    }
    const parian_command command = {.tool = "parian-test"};
    const char *err = test_scratch("err.txt");
    char text[TEXT_MAX];
    int saved = redirect(stderr, err);
    parian_result result = parian_options_parse(
        &command, &common, &list, PARIAN_STRING_LIST_MAX + 1, (char **)(uintptr_t)words, 0);
    restore(stderr, saved, err, text);
    assert_int_equal(result, PARIAN_E_ARGUMENT);
    assert_non_null(strstr(text, "more than 256"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_takes_every_kind),
        cmocka_unit_test(test_common_options),
        cmocka_unit_test(test_mistakes),
        cmocka_unit_test(test_later_is_unsupported),
        cmocka_unit_test(test_help_fits_and_hides),
        cmocka_unit_test(test_forms_of_help),
        cmocka_unit_test(test_too_many),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
