/* test_results_table.c - rows as CSV, and the readings that they allow.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tests/measure/results_table.h"

/* Three rows of a measurement whose channels err by l2, half of it, and twice of it. */
static void add(parian_results *results, const char *bake, const char *lights, double l2, double ms)
{
    static const double factor[3] = {1, 0.5, 2};
    for (int c = 0; c < 3; c++) {
        parian_measure_row row = {.model = "ball.ply",
                                  .method = "transfer",
                                  .reference = "dipole",
                                  .backend = "cpu",
                                  .channel = c,
                                  .relight_ms = ms,
                                  .bake_s = 2,
                                  .asset_bytes = 1000000};
        snprintf(row.asset, sizeof row.asset, "ball.ply %s", bake);
        snprintf(row.bake, sizeof row.bake, "%s", bake);
        snprintf(row.lights, sizeof row.lights, "%s", lights);
        row.error = (parian_radiosity_metrics){.l1 = l2,
                                               .l2 = factor[c] * l2,
                                               .energy_ratio = 1 - 0.01 * c,
                                               .p999 = 0.1,
                                               .minimum = 0.5 - 0.1 * c};
        assert_int_equal(parian_results_add(NULL, results, &row), PARIAN_OK);
    }
}

/* The field of a line (from 0: the names) that stands under a name; empty where there is none. */
static void field_of(const char *csv, int line, const char *name, char field[64])
{
    int column = 0, quoted = 0;
    const char *at = csv;
    for (size_t n = strlen(name); strncmp(at, name, n) != 0 || (at[n] != ',' && at[n] != '\n');
         column++) {
        at += strcspn(at, ",\n") + 1;
        assert_true(at < strchr(csv, '\n'));
    }
    for (at = csv; line > 0; line--) {
        at = strchr(at, '\n') + 1;
    }
    for (; column > 0; at++) {
        quoted ^= *at == '"';
        column -= *at == ',' && !quoted;
    }
    snprintf(field, 64, "%.*s", (int)strcspn(at, ",\n"), at);
}

static void test_csv(void **state)
{
    (void)state;
    parian_results results = {0};
    parian_text text = {.env = NULL};
    add(&results, "--local split, \"odd\"", "sun", 0.01, 3);
    parian_measure_row *row = &results.row[1];
    row->bake_s = NAN;
    row->vertices = 11;
    row->texels = 12;
    row->factors = 13;
    row->receivers = 14;
    row->error.truth_error = 0.15;
    row->irradiance_l2 = 0.16;
    row->transport_l2 = 0.17;
    row->error.not_finite = 18;
    parian_results_csv(&results, &text);
    const char *head = "asset,method,lights,reference,channel,l1,l2,energy_ratio,p999,minimum,"
                       "relight_ms,asset_bytes,bake_s,";
    assert_memory_equal(text.text, head, strlen(head));
    assert_non_null(
        strstr(text.text,
               "\n\"ball.ply --local split, \"\"odd\"\"\",transfer,sun,dipole,r,0.01,0.01,1,0.1,"
               "0.5,3,1000000,2,ball.ply,"));
    assert_non_null(strstr(
        text.text, ",g,0.01,0.005,0.99,0.1,0.4,3,1000000,,ball.ply,")); /* not known: empty */
    /* Every field under its name: the second row's values, all different. */
    static const char *const named[][2] = {{"model", "ball.ply"},
                                           {"backend", "cpu"},
                                           {"vertices", "11"},
                                           {"texels", "12"},
                                           {"factors", "13"},
                                           {"receivers", "14"},
                                           {"truth_standard_error", "0.15"},
                                           {"irradiance_l2", "0.16"},
                                           {"transport_l2", "0.17"},
                                           {"not_finite", "18"}};
    for (size_t k = 0; k < sizeof named / sizeof *named; k++) {
        char field[64];
        field_of(text.text, 2, named[k][0], field);
        assert_string_equal(field, named[k][1]);
    }
    /* As many fields in each line as names. */
    size_t lines = 0;
    for (const char *line = text.text; *line; line = strchr(line, '\n') + 1, lines++) {
        int fields = 1, quoted = 0;
        for (const char *c = line; *c != '\n'; c++) {
            quoted ^= *c == '"';
            fields += *c == ',' && !quoted;
        }
        assert_int_equal(fields, 24);
    }
    assert_int_equal(lines, 4);
    parian_free(NULL, text.text);
    parian_results_free(NULL, &results);
}

static void test_worst_channel(void **state)
{
    (void)state;
    parian_results results = {0};
    add(&results, "", "sun", 0.01, 3);
    parian_measurement m = parian_measurement_at(&results, 0);
    assert_int_equal(parian_measurement_count(&results), 1);
    assert_true(m.l2 == 0.02 && m.energy_ratio == 0.98 && fabs(m.minimum - 0.3) < 1e-12);
    results.row[1].error.l2 = NAN; /* nothing is worse */
    assert_true(isnan(parian_measurement_at(&results, 0).l2));
    parian_results_free(NULL, &results);
}

static void test_readings(void **state)
{
    (void)state;
    parian_results results = {0};
    add(&results, "coarse", "sun", 0.02, 0.5); /* worst channel 4 % */
    add(&results, "middle", "sun", 0.008, 5);  /* 1.6 % */
    add(&results, "slow", "sun", 0.008, 50);   /* as good, and slower */
    add(&results, "fine", "sun", 0.001, 500);  /* 0.2 % */
    add(&results, "broken", "sun", 0.0001, 0.1);
    results.row[results.count - 1].error.not_finite = 1; /* never chosen */
    add(&results, "coarse", "moon", 0.0001, 0.1);        /* another light set */
    add(&results, "coarse", "sun", 0.0001, 0.1);         /* another truth */
    for (size_t i = results.count - 3; i < results.count; i++) {
        snprintf(results.row[i].reference, sizeof results.row[i].reference, "path");
    }
    assert_int_equal(parian_results_best_within(&results, 0, 0.4), SIZE_MAX);
    assert_int_equal(parian_results_best_within(&results, 0, 1), 0);
    assert_int_equal(parian_results_best_within(&results, 0, 10), 1);
    assert_int_equal(parian_results_best_within(&results, 0, 100), 1);
    assert_int_equal(parian_results_best_within(&results, 0, 1000), 3);
    assert_int_equal(parian_results_best_within(&results, 5, 1000), 5);
    assert_int_equal(parian_results_cheapest_under(&results, 0, 0.001), SIZE_MAX);
    assert_int_equal(parian_results_cheapest_under(&results, 0, 0.005), 3);
    assert_int_equal(parian_results_cheapest_under(&results, 0, 0.02), 1);
    assert_int_equal(parian_results_cheapest_under(&results, 0, 0.05), 0);
    assert_true(parian_measurement_leads(&results, 0) && !parian_measurement_leads(&results, 3));
    assert_true(parian_measurement_leads(&results, 5) && parian_measurement_leads(&results, 6));
    parian_results_free(NULL, &results);
}

static void test_tables_fit_a_terminal(void **state)
{
    (void)state;
    parian_results results = {0};
    parian_text text = {.env = NULL};
    add(&results, "--quality preview", "sun", 0.02, 0.5);
    add(&results, "--transfer-vertices 100000 --atlas 1024 --kernel 9", "sun", 0.02, 12345.678);
    parian_results_summary(&results, 0, &text);
    parian_results_readings(&results, 0, &text);
    for (const char *line = text.text; *line; line = strchr(line, '\n') + 1) {
        assert_true(strcspn(line, "\n") <= 110);
    }
    assert_non_null(strstr(text.text, "12346"));
    assert_non_null(strstr(text.text, "   12346    1.00    2.0\n")); /* ms, megabytes, seconds */
    assert_non_null(strstr(
        text.text, "L2 within 5 %       4.00       0.5     1.00  transfer --quality preview\n"));
    assert_non_null(strstr(text.text, "within 1 ms"));
    parian_free(NULL, text.text);
    parian_results_free(NULL, &results);
}

/* Memory that fails at any point is told, and leaks nothing. */
static void test_failing_memory(void **state)
{
    (void)state;
    for (size_t at = 0; at < 4; at++) {
        test_memory memory = {.fail_at = at};
        parian_env env = test_failing_env(&memory);
        parian_results results = {0};
        parian_text text = {.env = &env};
        parian_measure_row row = {.asset = "a"};
        for (int i = 0; i < 60; i++) {
            if (parian_results_add(&env, &results, &row) != PARIAN_OK) {
                break;
            }
        }
        parian_results_csv(&results, &text);
        parian_free(&env, text.text);
        parian_results_free(&env, &results);
        assert_int_equal(memory.live, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_csv),
        cmocka_unit_test(test_worst_channel),
        cmocka_unit_test(test_readings),
        cmocka_unit_test(test_tables_fit_a_terminal),
        cmocka_unit_test(test_failing_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
