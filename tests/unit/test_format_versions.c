/* test_format_versions.c - golden files of every version of the format, files of versions to come,
 * and the dump of docs/format.md.
 *
 * With PARIAN_GOLDEN_WRITE set, golden files that are missing are written; none is ever replaced.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "container/container_layout.h"
#include "core/body_file.h"
#include "core/memory.h"
#include "support/sealed_file.h"
#include "support/test_support.h"
#include "support/tiny_body.h"
#include "tool/files.h"

enum { LATER_MINOR = 9, DUMP_MAX = 4096 };

static char last_error[1024];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(last_error, sizeof last_error, "%s", text);
    }
}

static const parian_env env = {.log = keep_error};

static const char *golden(const char *name)
{
    char path[128];
    snprintf(path, sizeof path, "tests/golden/%s", name);
    return test_source(path);
}

static bool may_write(const char *path)
{
    return getenv("PARIAN_GOLDEN_WRITE") && access(path, F_OK) != 0;
}

static parian_result load(const char *path, parian_scene_data *scene)
{
    parian_reader *reader;
    parian_result result = parian_reader_open(&env, path, NULL, &reader);
    if (result == PARIAN_OK) {
        result = parian_scene_data_read(&env, reader, scene);
        parian_reader_close(reader);
    }
    return result;
}

/* Write the scene where the golden file is missing, read the file, compare. */
static void read_golden(const char *name, const parian_scene_data *scene)
{
    const char *path = golden(name);
    parian_scene_data back;
    if (may_write(path)) {
        free(sealed_file_make(scene, path, false).data);
    }
    assert_int_equal(load(path, &back), PARIAN_OK);
    assert_true(test_scene_equal(scene, &back));
    parian_scene_data_free(NULL, &back);
}

static void version_1_0_reads_the_same(void **state)
{
    (void)state;
    parian_scene_data scene;
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_F16, 5, &scene), PARIAN_OK);
    read_golden("tiny_1_0.parian", &scene);
    for (uint32_t i = 0; i < scene.bodies[0].texel_count; i++) {
        scene.bodies[0].texel_area[i] *= 1.0001f;
    }
    read_golden("tiny_area_1_0.parian", &scene);
    parian_scene_data_free(NULL, &scene);
}

/* ---- a hierarchy of operators -------------------------------------------------------------------
 */

/* Every row one run over all columns; value(row, column) for all channels. */
static void fill_dense(parian_operator *op, uint32_t source, uint32_t target, uint32_t rows,
                       uint32_t columns, double (*value)(uint32_t row, uint32_t column))
{
    *op = (parian_operator){.source_register = source,
                            .target_register = target,
                            .row_count = rows,
                            .column_count = columns,
                            .run_total = rows,
                            .factor_total = (uint64_t)rows * columns};
    assert_true(PARIAN_NEW(NULL, op->run_offset, rows + 1) &&
                PARIAN_NEW(NULL, op->run_column, rows) && PARIAN_NEW(NULL, op->run_count, rows) &&
                PARIAN_NEW(NULL, op->factor, op->factor_total) &&
                PARIAN_NEW(NULL, op->scale, rows));
    op->run_offset[0] = 0;
    for (uint32_t row = 0; row < rows; row++) {
        op->run_offset[row + 1] = row + 1;
        op->run_column[row] = 0;
        op->run_count[row] = (uint16_t)columns;
        for (int c = 0; c < 3; c++) {
            op->scale[row][c] = 1;
            for (uint32_t k = 0; k < columns; k++) {
                op->factor[row * columns + k][c] = parian_half_from_float((float)value(row, k));
            }
        }
    }
}

/* Vertices 0 and 2 are the coarse points; 1 and 3 take half of each. */
static double interpolation(uint32_t vertex, uint32_t point)
{
    return vertex % 2 ? 0.5 : vertex / 2 == point ? 1 : 0;
}

static double restriction(uint32_t point, uint32_t vertex)
{
    return interpolation(vertex, point);
}

static double between_points(uint32_t row, uint32_t column)
{
    return row == column ? 0 : 40;
}

static void operators_of_coarse_levels_read_the_same(void **state)
{
    (void)state;
    parian_scene_data scene;
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 4, &scene), PARIAN_OK);
    parian_body *body = &scene.bodies[0];
    fill_dense(&body->operators[1], 0, 2, 2, 4, restriction);
    fill_dense(&body->operators[2], 2, 3, 2, 2, between_points);
    fill_dense(&body->operators[3], 3, 1, 4, 2, interpolation);
    body->operator_count = 4;
    read_golden("levels_1_0.parian", &scene);
    parian_scene_data_free(NULL, &scene);
}

/* ---- files of versions to come ------------------------------------------------------------------
 */

static void write_later_minor(const char *path, const char *chunk, uint32_t flags)
{
    static const uint16_t data[3] = {1, 2, 3};
    parian_scene_data scene;
    parian_writer *writer;
    const parian_writer_desc desc = {.path = path, .version_minor = LATER_MINOR};
    parian_chunk_info info = {.element = PARIAN_ELEMENT_U16, .rank = 1, .shape = {3}};
    info.flags = flags;
    snprintf(info.name, sizeof info.name, "%s", chunk);
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 4, &scene), PARIAN_OK);
    assert_int_equal(parian_writer_begin(NULL, &desc, &writer), PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, &scene), PARIAN_OK);
    assert_int_equal(parian_writer_chunk(writer, &info, data), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    parian_scene_data_free(NULL, &scene);
}

static sealed_file read_bytes(const char *path)
{
    sealed_file file;
    assert_int_equal(parian_file_read(NULL, path, UINT64_MAX, &file.data, &file.size), PARIAN_OK);
    return file;
}

/* Change one byte of an entry, and let the checksums fit again. */
static void change_entry(const char *path, uint32_t chunk, uint32_t place, uint8_t value)
{
    sealed_file file = read_bytes(path);
    file.data[sealed_file_entry(&file, chunk) + place] = value;
    sealed_file_seal(&file);
    assert_int_equal(parian_file_write(NULL, path, file.data, file.size), PARIAN_OK);
    free(file.data);
}

static void later_minor_versions_are_read(void **state)
{
    (void)state;
    const char *path = golden("later_optional_1_9.parian");
    parian_scene_data scene, back;
    parian_reader *reader;
    if (may_write(path)) {
        write_later_minor(path, "body.from_the_future", 0);
        change_entry(path, 0, ENTRY_FLAGS + 2, 0x40); /* bit 22: unused in 1.0 */
    }
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 4, &scene), PARIAN_OK);
    assert_int_equal(load(path, &back), PARIAN_OK);
    assert_true(test_scene_equal(&scene, &back));
    assert_int_equal(parian_reader_open(NULL, path, NULL, &reader), PARIAN_OK);
    assert_int_equal(parian_reader_version_minor(reader), LATER_MINOR);
    assert_int_equal(parian_reader_chunk(reader, 0)->flags, PARIAN_CHUNK_REQUIRED | 0x400000u);
    parian_reader_close(reader);
    parian_scene_data_free(NULL, &scene);
    parian_scene_data_free(NULL, &back);
}

static void expect_unsupported(const char *path, const char *rule, const char *name)
{
    parian_scene_data scene;
    last_error[0] = 0;
    assert_int_equal(load(path, &scene), PARIAN_E_UNSUPPORTED);
    assert_non_null(strstr(last_error, rule));
    assert_non_null(strstr(last_error, name));
}

static void later_required_chunks_are_refused_by_name(void **state)
{
    (void)state;
    const char *path = golden("later_required_1_9.parian");
    if (may_write(path)) {
        write_later_minor(path, "body.grid_of_media", PARIAN_CHUNK_REQUIRED);
    }
    expect_unsupported(path, "rule 206", "body.grid_of_media");
}

static void later_codecs_and_elements_are_unsupported(void **state)
{
    (void)state;
    const char *path = golden("later_codec_1_9.parian"), *copy = test_scratch("element.parian");
    if (may_write(path)) {
        write_later_minor(path, "body.from_the_future", 0);
        change_entry(path, 0, ENTRY_CODEC, 200);
    }
    expect_unsupported(path, "rule 113", "codec");
    write_later_minor(copy, "body.from_the_future", 0);
    change_entry(copy, 0, ENTRY_ELEMENT, 99);
    expect_unsupported(copy, "rule 112", "element");
}

/* In a file of our own version they are damage. */
static void unknown_codecs_of_this_version_are_refused(void **state)
{
    (void)state;
    const char *path = test_scratch("codec.parian");
    parian_scene_data scene = {0};
    parian_reader *reader;
    free(sealed_file_make(&scene, path, false).data);
    change_entry(path, 0, ENTRY_CODEC, 200);
    assert_int_equal(parian_reader_open(&env, path, NULL, &reader), PARIAN_E_FORMAT);
}

static void other_major_versions_are_refused(void **state)
{
    (void)state;
    const char *path = golden("later_major_2_0.parian");
    if (may_write(path)) {
        uint8_t header[HEADER_SIZE + 6] = PARIAN_MAGIC "\2";
        sealed_file file = {header, sizeof header};
        memcpy(header + HEADER_SIZE, "unread", 6);
        sealed_file_seal(&file);
        assert_int_equal(parian_file_write(NULL, path, header, sizeof header), PARIAN_OK);
    }
    expect_unsupported(path, "rule 104", "2.0");
}

/* ---- the smallest asset, byte for byte ----------------------------------------------------------
 */

/* Bytes of the lines "    0000a0  12 34 ..." of a text; offsets must go on from one to the next. */
static size_t read_dump(const char *text, uint8_t *bytes, size_t size_max)
{
    size_t size = 0;
    for (const char *line = text; line; line = strchr(line, '\n')) {
        unsigned offset, value;
        int used = 0;
        line += *line == '\n';
        if (sscanf(line, "    %6x %n", &offset, &used) != 1 || used < 11 || offset != size) {
            continue;
        }
        for (const char *at = line + used; sscanf(at, " %2x%n", &value, &used) == 1; at += used) {
            assert_true(size < size_max);
            bytes[size++] = (uint8_t)value;
            if (at[used] == '\n') {
                break;
            }
        }
    }
    return size;
}

static void smallest_asset_is_that_of_the_specification(void **state)
{
    (void)state;
    const char *path = golden("smallest_1_0.parian");
    parian_scene_data empty = {0};
    sealed_file made = sealed_file_make(&empty, test_scratch("smallest.parian"), false);
    if (may_write(path)) {
        assert_int_equal(parian_file_write(NULL, path, made.data, made.size), PARIAN_OK);
    }
    sealed_file stored = read_bytes(path), text = read_bytes(test_source("docs/format.md"));
    uint8_t dump[DUMP_MAX];
    assert_int_equal(made.size, stored.size);
    assert_memory_equal(made.data, stored.data, made.size);
    assert_int_equal(read_dump((const char *)text.data, dump, sizeof dump), made.size);
    assert_memory_equal(made.data, dump, made.size);
    free(made.data);
    free(stored.data);
    free(text.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(version_1_0_reads_the_same),
        cmocka_unit_test(operators_of_coarse_levels_read_the_same),
        cmocka_unit_test(later_minor_versions_are_read),
        cmocka_unit_test(later_required_chunks_are_refused_by_name),
        cmocka_unit_test(later_codecs_and_elements_are_unsupported),
        cmocka_unit_test(unknown_codecs_of_this_version_are_refused),
        cmocka_unit_test(other_major_versions_are_refused),
        cmocka_unit_test(smallest_asset_is_that_of_the_specification),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
