/* test_media.c - presets, material files and the media of glTF materials.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/stages/media.h"
#include "tool/media_file.h"

static void assert_near(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected) + 1e-300)) {
        fail_msg("%.9g, expected %.9g", found, expected);
    }
}

static void find_presets(void **state)
{
    (void)state;
    assert_int_equal(parian_media_preset_count(), 51);
    for (uint32_t i = 0; i < parian_media_preset_count(); i++) {
        parian_medium medium = *parian_media_preset(i);
        assert_ptr_equal(parian_media_find(medium.name), parian_media_preset(i));
        assert_int_equal(parian_medium_check(NULL, &medium), PARIAN_OK);
        assert_true(strlen(medium.source) > 10);
    }
    assert_null(parian_media_preset(51));
    assert_ptr_equal(parian_media_find("skim-MILK"), parian_media_find("Skimmilk"));
    assert_ptr_equal(parian_media_find("head_&_shoulders shampoo"),
                     parian_media_find("Head & Shoulders Shampoo"));
    assert_null(parian_media_find("skim"));
    assert_null(parian_media_find(""));
    assert_null(parian_media_find(NULL));
}

static void values_in_si(void **state)
{
    (void)state;
    const parian_medium *marble = parian_media_find("marble");
    assert_near(marble->sigma_s_prime[1], 2620, 1e-15);
    assert_near(marble->sigma_a[2], 7.1, 1e-15);
    assert_true(marble->reduced_only && marble->eta == 1.5 && marble->g[0] == 0);
    /* the misprints of circulating tables are not here */
    assert_near(parian_media_find("chicken1")->sigma_a[0], 15, 1e-15);
    assert_near(parian_media_find("chicken2")->sigma_a[0], 18, 1e-15);
    assert_near(parian_media_find("apple")->sigma_a[2], 46, 1e-15);
    const parian_medium *milk = parian_media_find("lowfatmilk");
    assert_false(milk->reduced_only);
    /* sigma_s' / (1 - g) is the measured sigma_s within the 2 % of its rounding: 13.1157 per mm */
    assert_near(milk->sigma_s_prime[0] / (1 - milk->g[0]), 13115.7, 0.02);
}

static parian_result read_text(const char *text, parian_medium *medium)
{
    const char *path = test_scratch("medium.json");
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return parian_media_read_file(NULL, path, medium);
}

static void read_files(void **state)
{
    (void)state;
    parian_medium m;
    assert_int_equal(
        read_text("{\"name\":\"x\",\"sigma_s_prime\":[1,2,3],\"sigma_a\":0.01,\"eta\":1.3,"
                  "\"unit\":\"1/mm\",\"source\":\"s\",\"comment\":1}",
                  &m),
        PARIAN_OK);
    assert_string_equal(m.name, "x");
    assert_near(m.sigma_s_prime[2], 3000, 1e-15);
    assert_near(m.sigma_a[0], 10, 1e-15);
    assert_true(m.reduced_only);
    assert_int_equal(read_text("{\"sigma_s\":[10,10,10],\"g\":0.9,\"sigma_a\":[1,1,1],\"eta\":1.3,"
                               "\"unit\":\"1/cm\"}",
                               &m),
                     PARIAN_OK);
    assert_near(m.sigma_s_prime[0], 100, 1e-12);
    assert_false(m.reduced_only);
}

static void refuse_files(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "",
        "{",
        "[]",
        "{\"sigma_s_prime\":1,\"sigma_a\":1,\"eta\":1.3}",
        "{\"sigma_s_prime\":1,\"sigma_s\":1,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":[1,2],\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":\"1\",\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":-1,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":1e999,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":0,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":1,\"sigma_a\":1,\"eta\":0.9,\"unit\":\"1/m\"}",
        "{\"sigma_s_prime\":1,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/ft\"}",
        "{\"sigma_s\":1,\"g\":1,\"sigma_a\":1,\"eta\":1.3,\"unit\":\"1/m\"}"};
    parian_medium m;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(read_text(bad[i], &m), PARIAN_E_FORMAT);
    }
    assert_int_equal(parian_media_read_file(NULL, test_scratch("absent.json"), &m), PARIAN_E_IO);
}

static parian_source_material wax(void)
{
    parian_source_material m = {.name = "wax", .has_volume = true, .has_scatter = true, .ior = 1.4};
    m.attenuation_distance = 0.01;
    for (int c = 0; c < 3; c++) {
        m.attenuation_color[c] = exp(-1.0 - c);
        m.multiscatter_color[c] = 0.2 + 0.3 * c;
    }
    return m;
}

static void from_materials(void **state)
{
    (void)state;
    parian_source_material m = wax();
    parian_medium medium;
    m.scatter_anisotropy = 0.4;
    for (int draft = 0; draft < 2; draft++) {
        m.new_draft = draft == 1;
        assert_int_equal(parian_media_from_material(NULL, &m, &medium), PARIAN_OK);
        for (int c = 0; c < 3; c++) {
            double r = m.multiscatter_color[c], sigma_t = 100 * (1.0 + c);
            double s = 4.09712 + 4.20863 * r - sqrt(9.59217 + 41.6808 * r + 17.7126 * r * r);
            double albedo = (1 - s * s) / (draft ? 1 - 0.4 * s * s : 1);
            /* rounding of a handful of operations */
            assert_near(medium.sigma_s_prime[c], 0.6 * albedo * sigma_t, 1e-12);
            assert_near(medium.sigma_a[c], (1 - albedo) * sigma_t, 1e-12);
        }
        assert_near(medium.eta, 1.4, 0);
    }
}

static void edges_of_materials(void **state)
{
    (void)state;
    parian_source_material m = wax();
    parian_medium medium;
    m.attenuation_color[0] = 1; /* clear in one channel: a small extinction, not none */
    m.attenuation_color[1] = 0; /* opaque in one: a large one, not infinite */
    m.multiscatter_color[2] = 1;
    assert_int_equal(parian_media_from_material(NULL, &m, &medium), PARIAN_OK);
    assert_true(medium.sigma_s_prime[0] > 0 && medium.sigma_s_prime[0] < 1);
    assert_near(medium.sigma_s_prime[1] + medium.sigma_a[1], 100 * log(512), 1e-12);
    /* white: the fit's s is below 3e-5 there, so that the albedo is 1 to 1e-9 */
    assert_true(medium.sigma_a[2] < 1e-9 * medium.sigma_s_prime[2]);

    for (int k = 0; k < 7; k++) {
        m = wax();
        *(k == 0   ? &m.attenuation_distance
          : k == 1 ? &m.attenuation_color[1]
          : k == 2 ? &m.multiscatter_color[2]
          : k == 3 ? &m.scatter_anisotropy
          : k == 4 ? &m.ior
                   : &m.attenuation_distance) = k == 0   ? INFINITY
                                                : k == 5 ? 0
                                                : k == 6 ? -1.0
                                                         : 7;
        assert_int_equal(parian_media_from_material(NULL, &m, &medium), PARIAN_E_FORMAT);
    }
    m = wax();
    memset(m.multiscatter_color, 0, sizeof m.multiscatter_color);
    assert_int_equal(parian_media_from_material(NULL, &m, &medium), PARIAN_E_FORMAT);
    m = wax();
    m.attenuation_color[0] = m.attenuation_color[1] = m.attenuation_color[2] = 1;
    assert_int_equal(parian_media_from_material(NULL, &m, &medium), PARIAN_E_FORMAT);
}

static void check_media(void **state)
{
    (void)state;
    parian_medium m = *parian_media_find("lowfat milk");
    m.g[1] = 0.999;
    assert_int_equal(parian_medium_check(NULL, &m), PARIAN_OK);
    assert_near(m.g[1], 0.995, 0);
    m.sigma_a[0] = NAN;
    assert_int_equal(parian_medium_check(NULL, &m), PARIAN_E_ARGUMENT);
    m = *parian_media_find("merlot"); /* scatters in red alone */
    assert_int_equal(parian_medium_check(NULL, &m), PARIAN_OK);
    m.sigma_s_prime[0] = 0;
    assert_int_equal(parian_medium_check(NULL, &m), PARIAN_E_ARGUMENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(find_presets),   cmocka_unit_test(values_in_si),
        cmocka_unit_test(read_files),     cmocka_unit_test(refuse_files),
        cmocka_unit_test(from_materials), cmocka_unit_test(edges_of_materials),
        cmocka_unit_test(check_media),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
