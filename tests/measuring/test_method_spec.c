/* test_method_spec.c - names and settings of methods: what is taken, and what is refused as what.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "support/test_support.h"
#include "tests/measure/measure_options.h"
#include "tests/measure/method_spec.h"

static void keep_line(void *user, parian_log_level level, const char *text)
{
    if (level == PARIAN_LOG_ERROR) {
        snprintf(user, 512, "%s", text);
    }
}

static parian_result parse(const char *text, parian_method_spec *spec, char line[512])
{
    const parian_env env = {.log = keep_line, .user = line};
    line[0] = 0;
    return parian_method_parse(&env, text, spec);
}

static void test_takes_what_is_built(void **state)
{
    (void)state;
    parian_method_spec spec;
    char line[512];
    assert_int_equal(parse("transfer", &spec, line), PARIAN_OK);
    assert_string_equal(spec.name, "transfer");
    assert_string_equal(spec.text, "transfer");
    assert_int_equal(spec.pair_count, 0);
}

static void test_refuses_by_kind(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        parian_result result;
        const char *said;
    } cases[] = {
        {"texture:samples=400", PARIAN_E_UNSUPPORTED, "texture"},
        {"texture:samples=900,local=401", PARIAN_E_UNSUPPORTED, "texture"},
        {"volume", PARIAN_E_UNSUPPORTED, "volume"},
        {"maps", PARIAN_E_UNSUPPORTED, "maps"},
        {"lensch", PARIAN_E_ARGUMENT, "lensch"},
        {"transfer:samples=4", PARIAN_E_ARGUMENT, "samples"},
        {"", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {":a=1", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"texture:", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"texture:samples", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"texture:samples=", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"texture:samples=1,", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"texture:=1", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"transfer texture", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
        {"transfer:a=1:b=2", PARIAN_E_ARGUMENT, "NAME[:KEY=VALUE"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        parian_method_spec spec;
        char line[512];
        assert_int_equal(parse(cases[i].text, &spec, line), cases[i].result);
        assert_non_null(strstr(line, cases[i].said));
    }
}

/* Every length around the limits of a word and of a text, and more pairs than there is room for. */
static void test_long_texts(void **state)
{
    (void)state;
    char text[4096], line[512];
    parian_method_spec spec;
    for (size_t n = 1; n < 400; n++) {
        memset(text, 'a', n);
        text[n] = 0;
        assert_int_equal(parse(text, &spec, line), PARIAN_E_ARGUMENT);
    }
    strcpy(text, "texture:");
    for (int i = 0; i < 30; i++) {
        sprintf(text + strlen(text), "k%d=1,", i);
    }
    text[strlen(text) - 1] = 0;
    assert_int_equal(parse(text, &spec, line), PARIAN_E_ARGUMENT);
}

static void test_lists(void **state)
{
    (void)state;
    static parian_method_spec spec[PARIAN_METHODS_MAX];
    size_t count;
    char line[512] = "";
    const parian_env env = {.log = keep_line, .user = line};
    assert_int_equal(parian_method_list_parse(&env, "  transfer \n", spec, &count), PARIAN_OK);
    assert_int_equal(count, 1);
    assert_int_equal(parian_method_list_parse(&env, "transfer transfer", spec, &count),
                     PARIAN_E_ARGUMENT);
    assert_int_equal(parian_method_list_parse(&env, " ", spec, &count), PARIAN_E_ARGUMENT);
    assert_int_equal(parian_method_list_parse(&env, "transfer maps", spec, &count),
                     PARIAN_E_UNSUPPORTED);
    char many[2000];
    memset(many, 'x', sizeof many - 1);
    many[sizeof many - 1] = 0;
    assert_int_equal(parian_method_list_parse(&env, many, spec, &count), PARIAN_E_ARGUMENT);
}

static void test_bake_texts(void **state)
{
    (void)state;
    assert_null(parian_bake_text_fault(""));
    assert_null(parian_bake_text_fault("--quality preview --form=paper --local split"));
    assert_string_equal(parian_bake_text_fault("--quality preview -o x"), "-o");
    assert_string_equal(parian_bake_text_fault("--report=x"), "--report");
    assert_string_equal(parian_bake_text_fault("  --dump d"), "--dump");
    assert_string_equal(parian_bake_text_fault("-MD"), "-MD");
    assert_null(parian_bake_text_fault("--outputs")); /* the bake's own parser refuses it */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_takes_what_is_built), cmocka_unit_test(test_refuses_by_kind),
        cmocka_unit_test(test_long_texts),          cmocka_unit_test(test_lists),
        cmocka_unit_test(test_bake_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
