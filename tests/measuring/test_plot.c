/* test_plot.c - plots and bar charts: axes and ticks, places of labels, hostile texts, same bytes,
 * gnuplot at fault.
 *
 * Looks are judged by eye; what is tested is that files appear, hold what they should, and stay the
 * same.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tests/measure/bar_chart.h"
#include "tests/measure/chart_axis.h"
#include "tests/measure/chart_labels.h"
#include "tests/measure/chart_text.h"
#include "tests/measure/plot.h"
#include "tool/files.h"
#include "tool/picture.h"

enum { FILE_MAX = 1 << 22, TEST_SKIPPED = 77 };

static const char HOSTILE[] = "it's \"bad\" `touch pwned` $(id) \\ \n \x01 \xff\xfe {/S a}_2^3 @x "
                              "~a %d %s <b>&amp; # \xc3\xa4 \xe6\xbc\xa2";

static uint8_t *read_file(const char *folder, const char *name, const char *suffix, size_t *size)
{
    char path[1200];
    static uint8_t
        *data; /* not on the stack: GCC 12 would warn of a pointer to it, which nobody keeps */
    snprintf(path, sizeof path, "%s/%s%s", folder, name, suffix);
    assert_int_equal(parian_file_read(NULL, path, FILE_MAX, &data, size), PARIAN_OK);
    assert_true(*size > 0);
    return data;
}

static bool exists(const char *folder, const char *file)
{
    char path[1200];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return access(path, F_OK) == 0;
}

static size_t count_of(const char *text, const char *what)
{
    size_t count = 0;
    for (const char *at = text; (at = strstr(at, what)) != NULL; at += strlen(what)) {
        count++;
    }
    return count;
}

/* ---- text --------------------------------------------------------------------------------------
 */
static const char *number(double value)
{
    static char text[64];
    parian_chart_text out = {0};
    parian_chart_text_put_number(&out, value);
    snprintf(text, sizeof text, "%s", out.text);
    parian_chart_text_free(&out);
    return text;
}

static void test_numbers(void **state)
{
    (void)state;
    assert_string_equal(number(0), "0");
    assert_string_equal(number(0.0001), "0.0001");
    assert_string_equal(number(1e-5), "1e-5");
    assert_string_equal(number(-2.5e-7), "-2.5e-7");
    assert_string_equal(number(0.1 + 0.2), "0.3");
    assert_string_equal(number(250000), "250000");
    assert_string_equal(number(1e6), "1e6");
    assert_string_equal(number(3.2e12), "3.2e12");
}

static const char *quoted(const char *text, size_t columns)
{
    static char result[512];
    parian_chart_text out = {0};
    parian_chart_text_put_quoted(&out, text, columns);
    snprintf(result, sizeof result, "%s", out.text);
    parian_chart_text_free(&out);
    return result;
}

static void test_quoting(void **state)
{
    parian_chart_text lines = {0};
    (void)state;
    assert_string_equal(quoted("a'b", 9), "'a''b'");
    assert_string_equal(quoted("a\nb\\", 9), "'a b\\'");
    assert_string_equal(quoted("\xff\xc3\xa4\xc3(\xed\xa0\x80\xc0\x80", 99),
                        "'?\xc3\xa4?(?\?\?\?\?'");
    assert_string_equal(quoted("abcdef", 6), "'abcdef'");
    assert_string_equal(quoted("abcdefg", 6), "'abcde\xe2\x80\xa6'");
    assert_string_equal(quoted(NULL, 6), "''");
    assert_int_equal(parian_chart_text_columns("a\xe6\xbc\xa2", 99), 3);
    assert_int_equal(parian_chart_text_put_lines(&lines, "one two three", 8), 2);
    assert_string_equal(lines.text, "'one two '.\"\\n\".'three'");
    parian_chart_text_free(&lines);
}

/* ---- axes --------------------------------------------------------------------------------------
 */
/* Any axis holds its data, and has 2 to 14 labelled ticks in ascending order. */
static void check_axis(bool logarithmic, double a, double b)
{
    parian_chart_tick ticks[PARIAN_CHART_TICKS_MAX];
    parian_chart_axis axis = parian_chart_axis_fit(logarithmic, a, b, false);
    size_t count = parian_chart_axis_ticks(&axis, ticks), labelled = 0;
    assert_true(isfinite(axis.low) && isfinite(axis.high) && axis.low < axis.high);
    assert_true(!logarithmic || axis.low > 0);
    assert_true(a > b || (axis.low <= a && b <= axis.high));
    for (size_t i = 0; i < count; i++) {
        labelled += ticks[i].labelled;
        assert_true(i == 0 || ticks[i].value > ticks[i - 1].value);
        double place = parian_chart_axis_place(&axis, ticks[i].value);
        assert_true(place > -1e-6 && place < 1 + 1e-6);
        assert_true(fabs(parian_chart_axis_value(&axis, place) - ticks[i].value) <=
                    1e-9 * fmax(fabs(axis.low), fabs(axis.high)));
    }
    assert_in_range(labelled, 2, 14);
}

static void test_axes(void **state)
{
    (void)state;
    static const double span[] = {0,   1e-12, 1e-3, 0.3, 0.7, 1,  1.5, 2.2,
                                  2.4, 4,     6.9,  7.1, 9,   15, 40,  199};
    for (size_t i = 0; i < sizeof span / sizeof *span; i++) {
        for (double start = -100; start + span[i] <= 100; start += 7.3) {
            check_axis(true, pow(10, start), pow(10, start + span[i]));
        }
    }
    static const double pair[][2] = {{0, 0},          {1, 1},        {-5, -5},     {0, 1e-9},
                                     {-1e100, 1e100}, {3, 3.001},    {-0.2, 1.07}, {99, 1000},
                                     {-1e-3, -1e-5},  {1e9, 1e9 + 1}};
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
        check_axis(false, pair[i][0], pair[i][1]);
    }
    check_axis(false, INFINITY, -INFINITY);
    check_axis(true, INFINITY, -INFINITY);
    assert_false(parian_chart_axis_takes(true, 0) || parian_chart_axis_takes(true, -1));
    assert_false(parian_chart_axis_takes(false, NAN) || parian_chart_axis_takes(true, NAN));
    assert_false(parian_chart_axis_takes(false, -INFINITY) ||
                 parian_chart_axis_takes(true, INFINITY));
    assert_true(parian_chart_axis_takes(false, -1) && parian_chart_axis_takes(true, 1e-20));
}

/* Labels of points that lie close: none covers another, a point, or leaves the frame. */
static void test_labels_do_not_overlap(void **state)
{
    enum { POINTS = 24 };
    parian_chart_dot dots[POINTS];
    parian_chart_label labels[POINTS];
    const parian_chart_box frame = {0, 0, 400, 300}, taken = {300, 240, 400, 300};
    size_t shown = 0;
    (void)state;
    for (size_t i = 0; i < POINTS; i++) {
        double t = (double)i;
        dots[i] = (parian_chart_dot){10 + fmod(97 * t, 380), 10 + fmod(61 * t, 280), i % 6 > 0};
        labels[i] = (parian_chart_label){.dot = i, .width = 50, .height = 13};
    }
    parian_chart_labels_place(&frame, dots, POINTS, &taken, 1, labels, POINTS);
    for (size_t i = 0; i < POINTS; i++) {
        const parian_chart_label *a = &labels[i];
        if (!a->shown) {
            continue;
        }
        shown++;
        assert_true(a->x >= 0 && a->x + 50 <= 400 && a->y >= 6.5 && a->y + 6.5 <= 300);
        assert_true(a->x + 50 <= 300 || a->y + 6.5 <= 240);
        for (size_t j = 0; j < i; j++) {
            assert_true(!labels[j].shown || fabs(a->x - labels[j].x) >= 50 ||
                        fabs(a->y - labels[j].y) >= 13);
        }
    }
    assert_true(shown >= POINTS - 2);
}

/* ---- files -------------------------------------------------------------------------------------
 */
static const parian_plot_point MENDED[] = {
    {12.1, 0.031, "5k"}, {21, 0.012, "10k"}, {40, 0.0061, "20k"}};
static const parian_plot_point PAPER[] = {{9, 0.042, "paper"}, {17, 0.036, NULL}};
static const parian_plot_series SERIES[] = {{"mended", MENDED, 3}, {"the paper's", PAPER, 2}};
static const parian_plot PLOT = {"Error against time", "ms", "L2", true, true, SERIES, 2, "a note"};

static void check_outputs(const char *folder, const char *name)
{
    size_t size;
    uint8_t *svg = read_file(folder, name, ".svg", &size),
            *png = read_file(folder, name, ".png", &size);
    assert_int_equal(memcmp(png, "\x89PNG\r\n\x1a\n", 8), 0);
    assert_non_null(strstr((const char *)svg, "</svg>"));
    free(svg);
    free(png);
}

static void test_same_bytes(void **state)
{
    static const char *const suffix[4] = {".gp", ".dat", ".svg", ".png"};
    const char *folder[2] = {test_scratch("plot_a"), test_scratch("plot_b")};
    (void)state;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(parian_plot_write(NULL, folder[i], "speed", &PLOT), PARIAN_OK);
        check_outputs(folder[i], "speed");
    }
    for (int i = 0; i < 4; i++) {
        size_t size[2];
        uint8_t *a = read_file(folder[0], "speed", suffix[i], &size[0]);
        uint8_t *b = read_file(folder[1], "speed", suffix[i], &size[1]);
        assert_int_equal(size[0], size[1]);
        assert_memory_equal(a, b, size[0]);
        free(a);
        free(b);
    }
}

/* By hand: gnuplot speed.gp, in its folder, gives the same picture. */
static void test_script_runs_by_hand(void **state)
{
    const char *folder = test_scratch("by_hand");
    char command[1200];
    size_t size[2];
    (void)state;
    assert_int_equal(parian_plot_write(NULL, folder, "speed", &PLOT), PARIAN_OK);
    uint8_t *first = read_file(folder, "speed", ".svg", &size[0]);
    snprintf(command, sizeof command, "cd '%s' && rm speed.svg speed.png && gnuplot speed.gp",
             folder);
    assert_int_equal(system(command), 0);
    uint8_t *second = read_file(folder, "speed", ".svg", &size[1]);
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(first, second, size[0]);
    assert_true(exists(folder, "speed.png"));
    free(first);
    free(second);
}

/* Texts mean themselves: nothing is run, the SVG holds them as text, and its markup stays whole. */
static void test_hostile_texts(void **state)
{
    const char *folder = test_scratch("hostile"), *name = "ho'st \"ile` {x} $(y) %d";
    const parian_plot_point points[] = {{1, 2, HOSTILE}, {3, 4, "b\\"}, {5, 6, "c'"}};
    const parian_plot_series series[] = {{HOSTILE, points, 3}, {HOSTILE, NULL, 0}};
    const parian_plot plot = {HOSTILE, HOSTILE, HOSTILE, false, true, series, 2, HOSTILE};
    const char *const groups[] = {HOSTILE, "x"};
    const double values[] = {1, 2};
    const parian_bar_series bars[] = {{HOSTILE, values}, {HOSTILE, values}};
    size_t size;
    (void)state;
    assert_int_equal(parian_plot_write(NULL, folder, name, &plot), PARIAN_OK);
    check_outputs(folder, name);
    uint8_t *svg = read_file(folder, name, ".svg", &size);
    const char *text = (const char *)svg;
    assert_non_null(strstr(text, "`touch pwned` $(id)"));
    assert_non_null(strstr(text, "{/S a}_2^3 @x ~a %d %s"));
    assert_null(strstr(text, "<b>"));
    assert_true(count_of(text, "<text") == count_of(text, "</text>") && count_of(text, "<g ") > 0);
    free(svg);
    for (int lying = 0; lying < 2; lying++) {
        const parian_bar_chart chart = {HOSTILE, HOSTILE, false, lying,  groups,
                                        2,       bars,    2,     HOSTILE};
        assert_int_equal(parian_bar_chart_write(NULL, folder, "bars", &chart), PARIAN_OK);
        check_outputs(folder, "bars");
    }
    assert_false(exists(folder, "pwned") || exists(".", "pwned"));
}

static void test_odd_data(void **state)
{
    static const parian_plot_point one[] = {{3, 7, "only"}},
                                   negative[] = {{-3, 7, "a"}, {0, 0, NULL}, {NAN, 1, "n"}};
    static const parian_plot_point huge[] = {
        {1e300, 1, NULL}, {1e-300, 1, NULL}, {INFINITY, 2, NULL}};
    static const parian_plot_series series[] = {
        {NULL, one, 1}, {"negative", negative, 3}, {"huge", huge, 3}};
    const char *folder = test_scratch("odd");
    (void)state;
    for (size_t first = 0; first < 4; first++) {
        for (int kind = 0; kind < 4; kind++) {
            parian_plot plot = {
                .title = "odd", .log_x = kind & 1, .log_y = kind & 2, .series_count = first < 3};
            plot.series = first < 3 ? &series[first] : NULL;
            assert_int_equal(parian_plot_write(test_env(1), folder, "odd", &plot), PARIAN_OK);
            check_outputs(folder, "odd");
        }
    }
    parian_plot plot = {.log_x = true, .log_y = true, .series = series, .series_count = 3};
    size_t size;
    assert_int_equal(parian_plot_write(test_env(1), folder, "odd", &plot), PARIAN_OK);
    uint8_t *svg = read_file(folder, "odd", ".svg", &size),
            *dat = read_file(folder, "odd", ".dat", &size);
    assert_non_null(
        strstr((const char *)svg, "Not drawn: 6 points that are not above zero or not finite."));
    assert_int_equal(count_of((const char *)dat, "# left out: "), 6);
    free(svg);
    free(dat);
    static const double none[2] = {NAN, 0};
    static const char *const groups[2] = {"a", NULL};
    const parian_bar_series bars = {NULL, none};
    parian_bar_chart chart = {
        .logarithmic = true, .groups = groups, .group_count = 2, .series = &bars};
    for (chart.series_count = 0; chart.series_count < 2; chart.series_count++) {
        chart.lying = chart.series_count > 0;
        assert_int_equal(parian_bar_chart_write(test_env(1), folder, "bars", &chart), PARIAN_OK);
        check_outputs(folder, "bars");
    }
}

/* ---- failures ----------------------------------------------------------------------------------
 */
static char failure[512];
static int failure_count;

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(failure, sizeof failure, "%s", text);
        failure_count++;
    }
}

static void assert_one_failure(const char *part)
{
    assert_int_equal(failure_count, 1);
    assert_non_null(strstr(failure, part));
    assert_null(strchr(failure, '\n'));
    failure_count = 0;
}

static void write_program(const char *path, const char *text)
{
    assert_int_equal(parian_file_write(NULL, path, text, strlen(text)), PARIAN_OK);
    assert_int_equal(chmod(path, 0755), 0);
}

static void test_gnuplot_at_fault(void **state)
{
    const parian_env env = {.log = keep_error};
    const char *folder = test_scratch("fault"), *programs = test_scratch("programs");
    char path[1200], *before = strdup(getenv("PATH"));
    (void)state;
    snprintf(path, sizeof path, "%s/gnuplot", programs);
    setenv("PATH", "/nonexistent", 1);
    assert_int_equal(parian_plot_write(&env, folder, "none", &PLOT), PARIAN_E_UNSUPPORTED);
    assert_one_failure("gnuplot is not installed");
    assert_true(exists(folder, "none.gp") && exists(folder, "none.dat"));
    assert_false(exists(folder, "none.svg") || exists(folder, "none.png"));
    setenv("PATH", programs, 1);
    write_program(path,
                  "#!/bin/sh\necho >&2 '         ^'\necho >&2 'line 7: all is lost'\nexit 3\n");
    assert_int_equal(parian_plot_write(&env, folder, "fails", &PLOT), PARIAN_E_IO);
    assert_one_failure("line 7: all is lost");
    write_program(path, "#!/bin/sh\nexit 0\n");
    assert_int_equal(parian_plot_write(&env, folder, "idle", &PLOT), PARIAN_E_IO);
    assert_one_failure("has not written");
    write_program(path, "#!/bin/sh\nkill -9 $$\n");
    assert_int_equal(parian_plot_write(&env, folder, "killed", &PLOT), PARIAN_E_IO);
    assert_one_failure("gnuplot failed");
    assert_false(exists(folder, "fails.svg") || exists(folder, "idle.svg") ||
                 exists(folder, "killed.svg"));
    setenv("PATH", before, 1);
    free(before);
}

static void test_bad_arguments(void **state)
{
    const parian_env env = {.log = keep_error};
    const char *folder = test_scratch("bad");
    char longest[300];
    parian_bar_chart chart = {.group_count = 1000};
    (void)state;
    memset(longest, 'a', sizeof longest - 1);
    longest[sizeof longest - 1] = 0;
    failure_count = 0;
    static const char *const names[] = {"", "a/b", "a\nb"};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(parian_plot_write(&env, folder, i < 3 ? names[i] : longest, &PLOT),
                         PARIAN_E_ARGUMENT);
        assert_one_failure("name");
    }
    assert_int_equal(parian_bar_chart_write(&env, folder, "b", &chart), PARIAN_E_ARGUMENT);
    assert_one_failure("at most");
    assert_int_equal(parian_plot_write(&env, "/dev/null/x", "b", &PLOT), PARIAN_E_IO);
    assert_one_failure("/dev/null");
}

static void test_failing_memory(void **state)
{
    (void)state;
    for (size_t k = 0; k < 200; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_result result = parian_plot_write(&env, test_scratch("memory"), "speed", &PLOT);
        assert_int_equal(memory.live, 0);
        if (result == PARIAN_OK) {
            return;
        }
        assert_true(result == PARIAN_E_NOMEM || result == PARIAN_E_IO);
    }
    fail_msg("no end of allocations");
}

int main(void)
{
    if (system("gnuplot --version > /dev/null 2>&1") != 0) {
        fprintf(stderr, "gnuplot is missing\n");
        return TEST_SKIPPED;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_quoting),
        cmocka_unit_test(test_axes),
        cmocka_unit_test(test_labels_do_not_overlap),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_script_runs_by_hand),
        cmocka_unit_test(test_hostile_texts),
        cmocka_unit_test(test_odd_data),
        cmocka_unit_test(test_gnuplot_at_fault),
        cmocka_unit_test(test_bad_arguments),
        cmocka_unit_test(test_failing_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
