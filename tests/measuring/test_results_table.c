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

static void test_csv(void **state)
{
    (void)state;
    parian_results results = {0};
    parian_text text = {.env = NULL};
    add(&results, "--local split, \"odd\"", "sun", 0.01, 3);
    results.row[1].bake_s = NAN;
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
    assert_true(parian_measurement_leads(&results, 5));
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
