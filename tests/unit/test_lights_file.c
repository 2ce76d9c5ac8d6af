/* test_lights_file.c - lights from files and from --light, and what mistakes in them say.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"
#include "tool/lights_file.h"
#include "tool/picture.h"

static char said[512];
static parian_log_level said_level;

static void keep_line(void *user, parian_log_level level, const char *text)
{
    (void)user;
    said_level = level;
    snprintf(said, sizeof said, "%s", text);
}

static const parian_env listening = {.log = keep_line};

static void check_vector(const float v[3], double x, double y, double z)
{
    const double expected[3] = {x, y, z};
    for (int c = 0; c < 3; c++) {
        if (!(fabs((double)v[c] - expected[c]) <= 1e-6 * (1 + fabs(expected[c])))) {
            fail_msg("(%g, %g, %g) is not (%g, %g, %g)", (double)v[0], (double)v[1], (double)v[2],
                     x, y, z);
        }
    }
}

static void write_slide(void)
{
    static const uint8_t pixels[2][4] = {{255, 0, 0, 255}, {0, 255, 0, 0}};
    assert_int_equal(parian_png_write(NULL, test_scratch("lights/slide.png"), 2, 1, pixels),
                     PARIAN_OK);
}

static void test_every_type(void **state)
{
    static const char json[] =
        "{\"lights\":[{\"type\":\"point\",\"position\":[1,2,3],\"intensity\":[4,5,6]},\n"
        "{\"type\":\"directional\",\"direction\":[0,0,-1e-30],\"irradiance\":2},\n"
        "{\"type\":\"spot\",\"position\":[0,0,1],\"direction\":[0,3,-4],\"intensity\":[7],\"outer_"
        "deg\":30,"
        "\"inner_deg\":20,\"image\":\"slide.png\"},\n"
        "{\"type\":\"rect\",\"center\":[0,1,0],\"axis_u\":[1,0,0],\"axis_v\":[0,0,1],\"radiance\":"
        "3},\n"
        "{\"type\":\"environment\",\"radiance\":[1,2,3],\"rotation_deg\":90},\n"
        "{\"type\":\"environment\",\"image\":\"slide.png\"}]}";
    parian_light_set set = {0};
    (void)state;
    write_slide();
    assert_int_equal(parian_file_write(NULL, test_scratch("lights/all.json"), json, strlen(json)),
                     PARIAN_OK);
    assert_int_equal(parian_lights_read_file(NULL, test_scratch("lights/all.json"), &set),
                     PARIAN_OK);
    assert_int_equal(set.count, 6);
    check_vector(set.light[0].position, 1, 2, 3);
    check_vector(set.light[0].color, 4, 5, 6);
    check_vector(set.light[1].direction, 0, 0, -1);
    check_vector(set.light[1].color, 2, 2, 2);
    check_vector(set.light[2].direction, 0, 0.6, -0.8);
    check_vector(set.light[2].color, 7, 7, 7);
    assert_true(fabsf(set.light[2].inner_deg - 20) < 1e-6f);
    assert_int_equal(set.light[2].image.width, 2);
    check_vector(set.light[2].image.pixel[0], 1, 0, 0);
    check_vector(set.light[2].image.pixel[1], 0, 1, 0);
    assert_int_equal(set.light[3].type, PARIAN_LIGHT_RECT);
    check_vector(set.light[3].position, 0, 1, 0);
    assert_true(fabsf(set.light[4].rotation_deg - 90) < 1e-6f);
    check_vector(set.light[5].color, 1, 1, 1);
    parian_light_set_free(NULL, &set);
    assert_int_equal(set.count, 0);
}

static void test_mistakes_name_light_and_key(void **state)
{
    static const char *const cases[][2] = {
        {"", "not valid JSON at line 1"},
        {"{\n\"lights\":[\n}", "line 3"},
        {"{\"lights\":[]} x", "not valid JSON"},
        {"[]", "no array 'lights'"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,0],\"intensity\":1},{}]}",
         "light 1: no object with a 'type'"},
        {"{\"lights\":[7]}", "light 0: no object"},
        {"{\"lights\":[{\"type\":\"laser\"}]}", "light 0: type 'laser'"},
        {"{\"lights\":[{\"type\":\"point\",\"intensity\":1}]}", "light 0: 'position' is missing"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0],\"intensity\":1}]}",
         "'position' is not three numbers"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":1,\"intensity\":1}]}",
         "'position' is not three numbers"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,\"1\"],\"intensity\":1}]}",
         "'position' is not a number"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,1e39],\"intensity\":1}]}",
         "'position' is not a finite number"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,1e999],\"intensity\":1}]}",
         "'position' is not a finite number"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,1],\"intensity\":[1,-1,1]}]}",
         "'intensity' is negative"},
        {"{\"lights\":[{\"type\":\"point\",\"position\":[0,0,1],\"intensity\":[1,1]}]}",
         "or one for all channels"},
        {"{\"lights\":[{\"type\":\"directional\",\"direction\":[0,0,0],\"irradiance\":1}]}",
         "'direction' has no length"},
        {"{\"lights\":[{\"type\":\"spot\",\"position\":[0,0,0],\"direction\":[0,0,1],\"intensity\":"
         "1,\"outer_deg\":90}]}",
         "0 < inner <= outer < 90"},
        {"{\"lights\":[{\"type\":\"spot\",\"position\":[0,0,0],\"direction\":[0,0,1],\"intensity\":"
         "1,\"inner_deg\":31}]}",
         "0 < inner <= outer < 90"},
        {"{\"lights\":[{\"type\":\"rect\",\"center\":[0,0,0],\"axis_u\":[1,0,0],\"axis_v\":[2,0,0],"
         "\"radiance\":1}]}",
         "do not span a rectangle"},
        {"{\"lights\":[{\"type\":\"environment\"}]}", "neither 'radiance' nor 'image'"},
        {"{\"lights\":[{\"type\":\"environment\",\"image\":3}]}", "'image' is not the name"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        parian_light_set set = {0};
        said[0] = '\0';
        assert_int_equal(parian_lights_parse(&listening, cases[i][0], NULL, &set), PARIAN_E_FORMAT);
        assert_int_equal(set.count, 0);
        if (!strstr(said, cases[i][1])) {
            fail_msg("'%s' does not say '%s'", said, cases[i][1]);
        }
        parian_light_set_free(NULL, &set);
    }
}

static void test_set_stays_on_failure(void **state)
{
    parian_light_set set = {0};
    (void)state;
    assert_int_equal(parian_lights_parse_spec(NULL, "point:0,0,0:intensity=1", &set), PARIAN_OK);
    assert_int_not_equal(
        parian_lights_parse(
            NULL, "{\"lights\":[{\"type\":\"environment\",\"radiance\":1},{\"type\":\"point\"}]}",
            NULL, &set),
        PARIAN_OK);
    assert_int_equal(set.count, 1);
    assert_int_equal(parian_lights_parse_spec(NULL, "environment:/no/such.exr", &set), PARIAN_E_IO);
    assert_int_equal(set.count, 1);
    parian_light_set_free(NULL, &set);
}

static void test_unknown_key_warns(void **state)
{
    parian_light_set set = {0};
    (void)state;
    said[0] = '\0';
    assert_int_equal(
        parian_lights_parse(&listening,
                            "{\"lights\":[{\"type\":\"environment\",\"radiance\":1,\"colour\":1}]}",
                            NULL, &set),
        PARIAN_OK);
    assert_int_equal(said_level, PARIAN_LOG_WARNING);
    assert_non_null(strstr(said, "light 0: 'colour' is no key of type 'environment'"));
    parian_light_set_free(NULL, &set);
}

static void test_specs(void **state)
{
    parian_light_set set = {0};
    char with_image[600];
    (void)state;
    write_slide();
    snprintf(with_image, sizeof with_image,
             "spot:0,0,1:direction=0,0,-2:outer=40:inner=10:image=%s:intensity=1,2,3",
             test_scratch("lights/slide.png"));
    assert_int_equal(parian_lights_parse_spec(NULL, "point:0,0.1,0.2:intensity=1", &set),
                     PARIAN_OK);
    assert_int_equal(
        parian_lights_parse_spec(NULL, "directional:0,0,-5:irradiance=1,0.9,0.8", &set), PARIAN_OK);
    assert_int_equal(parian_lights_parse_spec(NULL, with_image, &set), PARIAN_OK);
    assert_int_equal(
        parian_lights_parse_spec(NULL, "rect:0,1,0:u=0.1,0,0:v=0,0,0.1:radiance=3", &set),
        PARIAN_OK);
    assert_int_equal(parian_lights_parse_spec(NULL, "environment:radiance=1", &set), PARIAN_OK);
    assert_int_equal(set.count, 5);
    check_vector(set.light[0].position, 0, 0.1, 0.2);
    check_vector(set.light[1].direction, 0, 0, -1);
    check_vector(set.light[1].color, 1, 0.9, 0.8);
    check_vector(set.light[2].color, 1, 2, 3);
    assert_true(fabsf(set.light[2].outer_deg - 40) < 1e-5f &&
                fabsf(set.light[2].inner_deg - 10) < 1e-5f);
    assert_int_equal(set.light[2].image.height, 1);
    check_vector(set.light[3].axis_v, 0, 0, 0.1);
    parian_light_set_free(NULL, &set);
}

static void test_spec_mistakes(void **state)
{
    static const char *const cases[] = {"",
                                        "point",
                                        "point:0,0,0",
                                        "point:0,0,0:intensity=nan",
                                        "point:0,0,0:intensity=-1",
                                        "laser:0,0,0",
                                        "point:0,0:intensity=1",
                                        "point:0,0,0:intensity=1:intensity=2",
                                        "point:a,b,c:intensity=1",
                                        "point:0,0,0:5",
                                        "directional:0,0,0:irradiance=1",
                                        "point:0,0,0,:intensity=1",
                                        "point:0,0,0:intensity="};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        parian_light_set set = {0};
        parian_result result = parian_lights_parse_spec(&listening, cases[i], &set);
        if (result != PARIAN_E_ARGUMENT) {
            fail_msg("'%s' gives %d", cases[i], (int)result);
        }
        assert_int_equal(set.count, 0);
    }
}

static void test_to_json_and_back(void **state)
{
    static const char *const specs[] = {
        "point:0.1,-7,3e-9:intensity=1,2,3.3", "directional:0.6,0,0.8:irradiance=0.7",
        "spot:0,0,1:direction=0,1,0:outer=33:inner=11:up=1,0,0:intensity=5",
        "rect:0,1,0:u=0.1,0,0:v=0,0,0.3:radiance=3", "environment:radiance=1:rotation=17"};
    enum { COUNT = sizeof specs / sizeof specs[0] };
    parian_light_set set = {0}, back = {0};
    char *json;
    (void)state;
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(parian_lights_parse_spec(NULL, specs[i], &set), PARIAN_OK);
    }
    assert_int_equal(parian_lights_to_json(NULL, set.light, set.count, &json), PARIAN_OK);
    assert_int_equal(parian_lights_parse(NULL, json, NULL, &back), PARIAN_OK);
    assert_int_equal(back.count, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        assert_int_equal(back.light[i].type, set.light[i].type);
        assert_memory_equal(back.light[i].position, set.light[i].position,
                            sizeof set.light[i].position);
        assert_memory_equal(back.light[i].color, set.light[i].color, sizeof set.light[i].color);
        check_vector(back.light[i].direction, set.light[i].direction[0], set.light[i].direction[1],
                     set.light[i].direction[2]);
        check_vector(back.light[i].up, set.light[i].up[0], set.light[i].up[1], set.light[i].up[2]);
        assert_true(fabsf(back.light[i].outer_deg - set.light[i].outer_deg) < 1e-6f);
        assert_true(fabsf(back.light[i].rotation_deg - set.light[i].rotation_deg) < 1e-6f);
    }
    parian_free(NULL, json);
    parian_light_set_free(NULL, &set);
    parian_light_set_free(NULL, &back);
}

static void test_pixels_are_mended(void **state)
{
    static const float rgba[2][4] = {{NAN, INFINITY, -1, 1}, {0.5f, 0, 2, 1}};
    parian_light_set set = {0};
    char spec[600];
    (void)state;
    assert_int_equal(parian_exr_write(NULL, test_scratch("lights/bad.exr"), 2, 1, rgba), PARIAN_OK);
    snprintf(spec, sizeof spec, "environment:%s", test_scratch("lights/bad.exr"));
    assert_int_equal(parian_lights_parse_spec(&listening, spec, &set), PARIAN_OK);
    assert_int_equal(said_level, PARIAN_LOG_WARNING);
    check_vector(set.light[0].image.pixel[0], 0, 65504, 0);
    check_vector(set.light[0].image.pixel[1], 0.5, 0, 2);
    parian_light_set_free(NULL, &set);
}

/* Each allocation of ours fails once: no crash, no leak (cJSON keeps to malloc). */
static void test_failing_memory(void **state)
{
    parian_result result = PARIAN_E_NOMEM;
    (void)state;
    write_slide();
    const char json[] =
        "{\"lights\":[{\"type\":\"environment\",\"radiance\":1,\"image\":\"slide.png\"},"
        "{\"type\":\"environment\",\"radiance\":1}]}";
    for (size_t k = 0; k < 100 && result != PARIAN_OK; k++) {
        test_memory memory = {.fail_at = k};
        parian_env env = test_failing_env(&memory);
        parian_light_set set = {0};
        result = parian_lights_parse(&env, json, test_scratch("lights"), &set);
        assert_true(result == PARIAN_OK || result == PARIAN_E_NOMEM);
        parian_light_set_free(&env, &set);
        assert_int_equal(memory.live, 0);
    }
    assert_int_equal(result, PARIAN_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_type),
        cmocka_unit_test(test_mistakes_name_light_and_key),
        cmocka_unit_test(test_set_stays_on_failure),
        cmocka_unit_test(test_unknown_key_warns),
        cmocka_unit_test(test_specs),
        cmocka_unit_test(test_spec_mistakes),
        cmocka_unit_test(test_to_json_and_back),
        cmocka_unit_test(test_pixels_are_mended),
        cmocka_unit_test(test_failing_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
