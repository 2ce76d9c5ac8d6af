/* test_body_file.c - scenes to files and back: every form, every rule of the schema.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/body_file.h"
#include "core/half.h"
#include "core/memory.h"
#include "support/test_support.h"
#include "support/tiny_body.h"

static parian_result save(const parian_env *env, const char *path, const parian_scene_data *scene)
{
    parian_writer *writer;
    parian_result result = parian_writer_begin(env, &(parian_writer_desc){.path = path}, &writer);
    assert_int_equal(result, PARIAN_OK);
    result = parian_scene_data_write(writer, scene);
    if (result != PARIAN_OK) {
        parian_writer_abort(writer);
        return result;
    }
    return parian_writer_finish(writer);
}

static parian_result load(const parian_env *env, const char *path, parian_scene_data *scene)
{
    parian_reader *reader;
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result == PARIAN_OK) {
        result = parian_scene_data_read(env, reader, scene);
        parian_reader_close(reader);
    }
    return result;
}

static void round_trip(parian_local_form form, uint32_t side)
{
    const parian_env *env = test_env(2);
    const char *path = test_scratch("round.parian");
    parian_scene_data scene, back;
    assert_int_equal(test_tiny_scene(env, form, side, &scene), PARIAN_OK);
    assert_int_equal(save(env, path, &scene), PARIAN_OK);
    assert_int_equal(load(env, path, &back), PARIAN_OK);
    assert_true(test_scene_equal(&scene, &back));
    assert_memory_equal(scene.bodies[0].texel_position, back.bodies[0].texel_position,
                        scene.bodies[0].texel_count * sizeof(float[3]));
    assert_memory_equal(scene.bodies[0].texel_border, back.bodies[0].texel_border,
                        scene.bodies[0].texel_count * sizeof(uint32_t));
    parian_scene_data_free(env, &scene);
    parian_scene_data_free(env, &back);
}

static void every_form_comes_back(void **state)
{
    (void)state;
    for (int form = PARIAN_LOCAL_NONE; form <= PARIAN_LOCAL_ONLY; form++) {
        round_trip((parian_local_form)form, 6);
    }
}

static void large_arrays_come_back(void **state)
{
    (void)state;
    round_trip(PARIAN_LOCAL_F16, 320); /* 5.5 MB of kernels: several blocks */
}

static void empty_scene_comes_back(void **state)
{
    (void)state;
    const char *path = test_scratch("empty.parian");
    parian_scene_data scene = {0}, back;
    assert_int_equal(save(test_env(1), path, &scene), PARIAN_OK);
    assert_int_equal(load(test_env(1), path, &back), PARIAN_OK);
    assert_int_equal(back.body_count, 0);
    assert_null(back.lights_json);
    parian_scene_data_free(test_env(1), &back);
}

static void derived_arrays_follow_from_stored_ones(void **state)
{
    (void)state;
    parian_body body;
    assert_int_equal(test_tiny_body(NULL, PARIAN_LOCAL_REBUILT, 4, &body), PARIAN_OK);
    for (uint32_t i = 0; i < 16; i++) {
        assert_float_equal(body.texel_position[i][0], 0.02f * ((float)(i % 4) + 0.5f) / 4, 1e-8);
        assert_float_equal(body.texel_position[i][1], 0.02f * ((float)(i / 4) + 0.5f) / 4, 1e-8);
        assert_float_equal(body.texel_normal[i][2], 1, 1e-7);
        assert_int_equal(body.texel_at[body.texel_index[i]], i);
    }
    assert_int_equal(body.texel_at[0], 0xFFFFFFFFu);
    assert_int_equal(body.texel_border[5], PARIAN_NO_BORDER);
    assert_int_equal(body.texel_border[4], 4);
    assert_int_equal(body.operators[0].run_factor[body.operators[0].run_total],
                     body.operators[0].factor_total);
    parian_body_free(NULL, &body);
}

/* ---- every rule refuses -------------------------------------------------------------------------
 */

static char last_error[1024];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(last_error, sizeof last_error, "%s", text);
    }
}

typedef struct damage {
    int rule;
    parian_local_form form;
    void (*apply)(parian_body *body);
} damage;

#define DAMAGE(name, statement)                                                                    \
    static void name(parian_body *b)                                                               \
    {                                                                                              \
        statement;                                                                                 \
    }
DAMAGE(nan_position, b->vertex_position[1][2] = NAN)
DAMAGE(far_position, b->vertex_position[1][2] = 1e20f)
DAMAGE(triangle_beyond, b->triangle[1][2] = 4)
DAMAGE(chart_beyond, b->triangle_chart[0] = 1)
DAMAGE(zero_normal, b->corner_normal[0][0][2] = 0)
DAMAGE(uv_outside, b->corner_uv[1][1][0] = -0.5f)
DAMAGE(texel_twice, b->texel_index[3] = b->texel_index[2])
DAMAGE(texel_beyond, b->texel_index[b->texel_count - 1] = b->atlas_size * b->atlas_size)
DAMAGE(texel_triangle_beyond, b->texel_triangle[0] = 2)
DAMAGE(barycentric_sum, b->texel_barycentric[2][0] = b->texel_barycentric[2][1] = 0.8f)
DAMAGE(barycentric_negative, b->texel_barycentric[2][0] = -0.01f)
DAMAGE(area_zero, b->texel_area[4] = 0)
DAMAGE(area_nan, b->texel_area[4] = NAN)
DAMAGE(normal_map_long, b->texel_normal_map[7][2] = 3)
DAMAGE(albedo_high, b->texel_albedo[1][1] = 1.5f)
DAMAGE(gutter_order, b->gutter_index[1] = b->gutter_index[0])
DAMAGE(gutter_owned, b->gutter_index[8] = b->texel_index[0])
DAMAGE(gutter_source, b->gutter_source[2][3] = b->texel_count)
DAMAGE(gutter_weight, b->gutter_weight[0][0] = 0.5f)
DAMAGE(gutter_negative, b->gutter_weight[0][0] = 1.5f; b->gutter_weight[0][1] = -0.5f)
DAMAGE(border_order, b->border_texel[1] = 0)
DAMAGE(border_beyond, b->border_texel[b->border_count - 1] = b->texel_count)
DAMAGE(border_offset, b->border_offset[1] = b->border_offset[2] + 1)
DAMAGE(border_start, b->border_offset[0] = 1)
DAMAGE(border_list_order, b->border_neighbour[1] = b->border_neighbour[0])
DAMAGE(border_list_beyond, b->border_neighbour[b->border_offset[1] - 1] = b->texel_count)
DAMAGE(border_not_self, b->border_neighbour[0] = 1; b->border_neighbour[1] = 2)
DAMAGE(window_leaves, b->kernel_width = 5)
DAMAGE(width_even, b->kernel_width = 4)
DAMAGE(width_large, b->kernel_width = 17)
DAMAGE(atlas_empty, b->atlas_size = 0)
DAMAGE(atlas_huge, b->atlas_size = 16384)
DAMAGE(atlas_beyond, b->atlas_size = 0x10000)
DAMAGE(medium_negative, b->medium.sigma_a[1] = -1)
DAMAGE(medium_nan, b->medium.sigma_s_prime[1] = NAN)
DAMAGE(medium_g, b->medium.g[2] = 1)
DAMAGE(medium_eta, b->medium.eta = 0.5)
DAMAGE(medium_clear, memset(b->medium.sigma_s_prime, 0, sizeof b->medium.sigma_s_prime))
DAMAGE(run_empty, b->operators[0].run_count[0] = 0)
DAMAGE(run_long, b->operators[0].run_count[0] = 300)
DAMAGE(run_overlap, b->operators[0].run_column[2] = 0)
DAMAGE(run_outside, b->operators[0].run_column[b->operators[0].run_total - 1] = 4)
DAMAGE(run_offsets, b->operators[0].run_offset[1] = b->operators[0].run_offset[2] + 1)
DAMAGE(run_offset_end, b->operators[0].run_offset[4]--)
DAMAGE(factor_count, b->operators[0].run_count[0]--)
DAMAGE(factor_nan, b->operators[0].factor[3][1] = 0x7e00)
DAMAGE(scale_infinite, b->operators[0].scale[1][1] = INFINITY)
DAMAGE(register_same, b->operators[0].target_register = 0)
DAMAGE(register_beyond, b->operators[0].target_register = 99)
DAMAGE(register_size, b->operators[0].column_count = 5)
DAMAGE(blend_infinite, b->blend_weight[3][1][2] = 0x7c00)
DAMAGE(kernel_infinite, b->kernel_f16[5][0] = 0xfc00)
DAMAGE(kernel_border_nan, b->border_f16[5][0] = 0x7fff)
DAMAGE(channel_scale, b->kernel_channel_scale[0] = NAN)
DAMAGE(kernel_scale, b->kernel_scale[0][0] = -1)
DAMAGE(split_radius, b->split_radius_m = 0)
DAMAGE(only_with_operators, b->local_form = PARIAN_LOCAL_ONLY)
DAMAGE(form_beyond, b->local_form = (parian_local_form)6)
DAMAGE(bssrdf_beyond, b->bssrdf = (parian_bssrdf)2)

static const damage damages[] = {
    {221, PARIAN_LOCAL_F16, nan_position},
    {221, PARIAN_LOCAL_F16, far_position},
    {222, PARIAN_LOCAL_F16, triangle_beyond},
    {222, PARIAN_LOCAL_F16, chart_beyond},
    {226, PARIAN_LOCAL_F16, zero_normal},
    {233, PARIAN_LOCAL_F16, uv_outside},
    {223, PARIAN_LOCAL_F16, texel_twice},
    {222, PARIAN_LOCAL_F16, texel_beyond},
    {222, PARIAN_LOCAL_F16, texel_triangle_beyond},
    {224, PARIAN_LOCAL_F16, barycentric_sum},
    {224, PARIAN_LOCAL_F16, barycentric_negative},
    {225, PARIAN_LOCAL_F16, area_zero},
    {225, PARIAN_LOCAL_F16, area_nan},
    {226, PARIAN_LOCAL_F16, normal_map_long},
    {227, PARIAN_LOCAL_F16, albedo_high},
    {223, PARIAN_LOCAL_F16, gutter_order},
    {229, PARIAN_LOCAL_F16, gutter_owned},
    {222, PARIAN_LOCAL_F16, gutter_source},
    {228, PARIAN_LOCAL_F16, gutter_weight},
    {228, PARIAN_LOCAL_F16, gutter_negative},
    {223, PARIAN_LOCAL_F16, border_order},
    {222, PARIAN_LOCAL_F16, border_beyond},
    {230, PARIAN_LOCAL_F16, border_offset},
    {230, PARIAN_LOCAL_F16, border_start},
    {231, PARIAN_LOCAL_F16, border_list_order},
    {231, PARIAN_LOCAL_F16, border_list_beyond},
    {231, PARIAN_LOCAL_NONE, border_not_self},
    {232, PARIAN_LOCAL_REBUILT, window_leaves},
    {213, PARIAN_LOCAL_REBUILT, width_even},
    {213, PARIAN_LOCAL_REBUILT, width_large},
    {212, PARIAN_LOCAL_REBUILT, atlas_empty},
    {212, PARIAN_LOCAL_REBUILT, atlas_huge},
    {212, PARIAN_LOCAL_REBUILT, atlas_beyond},
    {214, PARIAN_LOCAL_REBUILT, medium_negative},
    {214, PARIAN_LOCAL_REBUILT, medium_nan},
    {214, PARIAN_LOCAL_REBUILT, medium_g},
    {214, PARIAN_LOCAL_REBUILT, medium_eta},
    {214, PARIAN_LOCAL_REBUILT, medium_clear},
    {242, PARIAN_LOCAL_REBUILT, run_empty},
    {242, PARIAN_LOCAL_REBUILT, run_long},
    {242, PARIAN_LOCAL_REBUILT, run_overlap},
    {242, PARIAN_LOCAL_REBUILT, run_outside},
    {230, PARIAN_LOCAL_REBUILT, run_offsets},
    {230, PARIAN_LOCAL_REBUILT, run_offset_end},
    {243, PARIAN_LOCAL_REBUILT, factor_count},
    {221, PARIAN_LOCAL_REBUILT, factor_nan},
    {221, PARIAN_LOCAL_REBUILT, scale_infinite},
    {241, PARIAN_LOCAL_REBUILT, register_same},
    {241, PARIAN_LOCAL_REBUILT, register_beyond},
    {241, PARIAN_LOCAL_REBUILT, register_size},
    {221, PARIAN_LOCAL_REBUILT, blend_infinite},
    {221, PARIAN_LOCAL_F16, kernel_infinite},
    {221, PARIAN_LOCAL_F16, kernel_border_nan},
    {251, PARIAN_LOCAL_F16, channel_scale},
    {251, PARIAN_LOCAL_U8, kernel_scale},
    {252, PARIAN_LOCAL_SPLIT, split_radius},
    {211, PARIAN_LOCAL_NONE, only_with_operators},
    {211, PARIAN_LOCAL_NONE, form_beyond},
    {211, PARIAN_LOCAL_NONE, bssrdf_beyond},
};

/* The writer makes the reader's checks: what no reader takes is not written. */
static void every_rule_refuses(void **state)
{
    (void)state;
    parian_env env = {.log = keep_error};
    const char *path = test_scratch("refused.parian");
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        parian_scene_data scene;
        char rule[16];
        struct stat status;
        assert_int_equal(test_tiny_scene(NULL, damages[i].form, 6, &scene), PARIAN_OK);
        damages[i].apply(&scene.bodies[0]);
        last_error[0] = 0;
        assert_int_equal(save(&env, path, &scene), PARIAN_E_ARGUMENT);
        snprintf(rule, sizeof rule, "rule %d:", damages[i].rule);
        if (!strstr(last_error, rule)) {
            fail_msg("damage %zu: expected %s got \"%s\"", i, rule, last_error);
        }
        assert_int_not_equal(stat(path, &status), 0);
        parian_scene_data_free(NULL, &scene);
    }
}

static void missing_and_surplus_arrays_are_refused(void **state)
{
    (void)state;
    parian_env env = {.log = keep_error};
    parian_scene_data scene;
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_F16, 6, &scene), PARIAN_OK);
    float(*normal)[3][3] = scene.bodies[0].corner_normal;
    scene.bodies[0].corner_normal = NULL;
    assert_int_equal(save(&env, test_scratch("m.parian"), &scene), PARIAN_E_ARGUMENT);
    assert_non_null(strstr(last_error, "rule 201"));
    scene.bodies[0].corner_normal = normal;
    scene.bodies[0].local_form = PARIAN_LOCAL_NONE;
    assert_int_equal(save(&env, test_scratch("m.parian"), &scene), PARIAN_E_ARGUMENT);
    assert_non_null(strstr(last_error, "rule 204"));
    parian_scene_data_free(NULL, &scene);
}

/* ---- chunks that do not belong ------------------------------------------------------------------
 */

static parian_result save_with(const parian_env *env, const char *path, const char *name,
                               uint32_t object, uint32_t flags)
{
    parian_scene_data scene;
    parian_writer *writer;
    parian_chunk_info info = {
        .object = object, .element = PARIAN_ELEMENT_F32, .flags = flags, .rank = 1, .shape = {1}};
    assert_int_equal(test_tiny_scene(env, PARIAN_LOCAL_NONE, 4, &scene), PARIAN_OK);
    assert_int_equal(parian_writer_begin(env, &(parian_writer_desc){.path = path}, &writer),
                     PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, &scene), PARIAN_OK);
    snprintf(info.name, sizeof info.name, "%s", name);
    assert_int_equal(parian_writer_chunk(writer, &info, &(float){1}), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    parian_scene_data_free(env, &scene);
    return load(env, path, &scene) == PARIAN_OK ? (parian_scene_data_free(env, &scene), PARIAN_OK)
                                                : load(env, path, &scene);
}

static void unknown_chunks_are_ignored_or_refused(void **state)
{
    (void)state;
    parian_env env = {.log = keep_error};
    const char *path = test_scratch("unknown.parian");
    assert_int_equal(save_with(&env, path, "future.thing", 0, 0), PARIAN_OK);
    assert_int_equal(save_with(&env, path, "future.thing", 0, PARIAN_CHUNK_REQUIRED),
                     PARIAN_E_UNSUPPORTED);
    assert_non_null(strstr(last_error, "rule 206"));
    assert_non_null(strstr(last_error, "future.thing"));
    assert_int_equal(save_with(&env, path, "local.split_radius", 0, 0), PARIAN_E_FORMAT);
    assert_non_null(strstr(last_error, "rule 204"));
    assert_int_equal(save_with(&env, path, "texel.area", 7, 0), PARIAN_E_FORMAT);
    assert_non_null(strstr(last_error, "rule 204"));
}

static void control_characters_leave_names(void **state)
{
    (void)state;
    const char *path = test_scratch("names.parian");
    parian_scene_data scene, back;
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 4, &scene), PARIAN_OK);
    strcpy(scene.bodies[0].name, "a\033[31mb\nc");
    assert_int_equal(save(NULL, path, &scene), PARIAN_OK);
    assert_int_equal(load(NULL, path, &back), PARIAN_OK);
    assert_string_equal(back.bodies[0].name, "a_[31mb_c");
    parian_scene_data_free(NULL, &scene);
    parian_scene_data_free(NULL, &back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_comes_back),
        cmocka_unit_test(large_arrays_come_back),
        cmocka_unit_test(empty_scene_comes_back),
        cmocka_unit_test(derived_arrays_follow_from_stored_ones),
        cmocka_unit_test(every_rule_refuses),
        cmocka_unit_test(missing_and_surplus_arrays_are_refused),
        cmocka_unit_test(unknown_chunks_are_ignored_or_refused),
        cmocka_unit_test(control_characters_leave_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
