/* test_asset_damage.c - damaged and hostile assets: refused, or read as they were; never more
 * memory than a small multiple of the file.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "container/container_layout.h"
#include "core/body_file.h"
#include "core/memory.h"
#include "support/sealed_file.h"
#include "support/test_support.h"
#include "support/tiny_body.h"

enum { SIDE = 5, BIT_FLIPS = 2000, HOSTILE_CHANGES = 6000 };

/* Every claim of a file is bounded by 64 MiB and 64 times its size; an atlas of up to 2^20 texels
 * is free. */
#define MEMORY_LIMIT ((size_t)192 << 20)

static uint64_t random_state = 0x9E3779B97F4A7C15ull;

static uint32_t random_below(uint32_t count)
{
    random_state = random_state * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)((random_state >> 33) % count);
}

static sealed_file make(parian_local_form form, bool no_compression, parian_scene_data *scene)
{
    assert_int_equal(test_tiny_scene(NULL, form, SIDE, scene), PARIAN_OK);
    return sealed_file_make(scene, test_scratch("damage.parian"), no_compression);
}

/* Open, verify, read; what was allocated is free again, and never was more than the limit. */
static parian_result read_all(const uint8_t *data, size_t size, parian_scene_data *scene,
                              char *error)
{
    limited_memory memory = {.limit = MEMORY_LIMIT};
    parian_env env = limited_env(&memory);
    parian_reader *reader;
    parian_scene_data read;
    /* A copy of the exact size, so that the sanitizer sees a byte beyond. */
    uint8_t *copy = malloc(size ? size : 1);
    memcpy(copy, data, size);
    parian_result result = parian_reader_open_memory(&env, "x", copy, size, NULL, &reader);
    if (result == PARIAN_OK) {
        parian_result verified = parian_reader_verify(reader);
        result = parian_scene_data_read(&env, reader, &read);
        if (verified != PARIAN_OK) {
            assert_int_not_equal(result, PARIAN_OK);
        }
        if (result == PARIAN_OK && scene) {
            assert_true(test_scene_equal(&read, scene));
        }
        if (result == PARIAN_OK) {
            parian_scene_data_free(&env, &read);
        }
        parian_reader_close(reader);
    }
    free(copy);
    if (memory.live != 0 || memory.refused || (result != PARIAN_OK && !memory.error[0])) {
        fail_msg("%zu bytes left, %d requests above the limit, error \"%s\"", memory.live,
                 memory.refused, memory.error);
    }
    if (error) {
        memcpy(error, memory.error, sizeof memory.error);
    }
    return result;
}

static void every_truncation_is_refused(void **state)
{
    (void)state;
    parian_scene_data scene;
    sealed_file file = make(PARIAN_LOCAL_U8, false, &scene);
    assert_int_equal(read_all(file.data, file.size, &scene, NULL), PARIAN_OK);
    for (size_t size = 0; size < file.size; size++) {
        assert_int_equal(read_all(file.data, size, NULL, NULL), PARIAN_E_FORMAT);
    }
    free(file.data);
    parian_scene_data_free(NULL, &scene);
}

static void every_byte_counts(void **state)
{
    (void)state;
    parian_scene_data scene;
    sealed_file file = make(PARIAN_LOCAL_F16, false, &scene);
    for (size_t i = 0; i < file.size; i++) { /* padding and reserved bytes included */
        file.data[i] ^= 0x40;
        assert_int_equal(read_all(file.data, file.size, NULL, NULL), PARIAN_E_FORMAT);
        file.data[i] ^= 0x40;
    }
    for (int i = 0; i < BIT_FLIPS; i++) {
        uint32_t bit = random_below((uint32_t)file.size * 8);
        file.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
        assert_int_equal(read_all(file.data, file.size, NULL, NULL), PARIAN_E_FORMAT);
        file.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
    }
    free(file.data);
    parian_scene_data_free(NULL, &scene);
}

static void more_bytes_are_refused(void **state)
{
    (void)state;
    static const size_t extra[] = {1, 16, 64, 128, 4096};
    parian_scene_data scene;
    sealed_file file = make(PARIAN_LOCAL_NONE, false, &scene);
    uint8_t *longer = calloc(1, file.size + 4096);
    memcpy(longer, file.data, file.size);
    for (size_t i = 0; i < sizeof extra / sizeof *extra; i++) {
        assert_int_equal(read_all(longer, file.size + extra[i], NULL, NULL), PARIAN_E_FORMAT);
    }
    free(longer);
    free(file.data);
    parian_scene_data_free(NULL, &scene);
}

/* ---- lies with fitting checksums ----------------------------------------------------------------
 */

typedef struct lie {
    int rule;
    enum { IN_HEADER, IN_ENTRY, IN_BLOCK } where;
    uint32_t index; /* of the entry or block */
    size_t field, width;
    uint64_t value;
} lie;

/* Chunk 0 is scene.counts (8 bytes, raw); its block is block 0. */
static const lie lies[] = {
    {102, IN_HEADER, 0, 0, 1, 'X'},
    {104, IN_HEADER, 0, HEADER_MAJOR, 2, 2},
    {105, IN_HEADER, 0, HEADER_RESERVED, 8, 1},
    {106, IN_HEADER, 0, HEADER_FILE_SIZE, 8, 1},
    {107, IN_HEADER, 0, HEADER_CHUNK_COUNT, 4, 0xFFFFFFFF},
    {107, IN_HEADER, 0, HEADER_CHUNK_COUNT, 4, 0},
    {107, IN_HEADER, 0, HEADER_BLOCK_COUNT, 8, UINT64_MAX},
    {107, IN_HEADER, 0, HEADER_BLOCK_COUNT, 8, 0},
    {107, IN_HEADER, 0, HEADER_TABLE_OFFSET, 8, 64},
    {107, IN_HEADER, 0, HEADER_TABLE_OFFSET, 8, UINT64_MAX},
    {111, IN_ENTRY, 0, ENTRY_NAME, 1, 'A'},
    {111, IN_ENTRY, 0, ENTRY_NAME, 1, 0},
    {111, IN_ENTRY, 0, ENTRY_NAME + 39, 1, 'a'},
    {112, IN_ENTRY, 0, ENTRY_ELEMENT, 2, 0},
    {112, IN_ENTRY, 0, ENTRY_ELEMENT, 2, 0xFFFF},
    {113, IN_ENTRY, 0, ENTRY_CODEC, 1, 4},
    {113, IN_ENTRY, 0, ENTRY_CODEC, 1, 255},
    {114, IN_ENTRY, 0, ENTRY_RANK, 1, 0},
    {114, IN_ENTRY, 0, ENTRY_RANK, 1, 5},
    {114, IN_ENTRY, 0, ENTRY_SHAPE + 8, 8, 1},
    {115, IN_ENTRY, 0, ENTRY_SHAPE, 8, UINT64_MAX},
    {116, IN_ENTRY, 0, ENTRY_FLAGS, 4, 2},
    {116, IN_ENTRY, 0, ENTRY_RESERVED, 8, 1},
    {116, IN_ENTRY, 0, ENTRY_RESERVED + 16, 8, 1ull << 56},
    {116, IN_BLOCK, 0, BLOCK_RESERVED, 4, 1},
    {117, IN_ENTRY, 0, ENTRY_OFFSET, 8, 128},
    {117, IN_ENTRY, 1, ENTRY_OFFSET, 8, 64},
    {117, IN_ENTRY, 1, ENTRY_OFFSET, 8, UINT64_MAX},
    {118, IN_BLOCK, 0, BLOCK_STORED_SIZE, 4, 0},
    {118, IN_BLOCK, 0, BLOCK_STORED_SIZE, 4, 9},
    {118, IN_BLOCK, 0, BLOCK_STORED_SIZE, 4, 0xFFFFFFFF},
    {119, IN_ENTRY, 0, ENTRY_SHAPE, 8, 0},
    {119, IN_ENTRY, 0, ENTRY_SHAPE, 8, 1ull << 30},
    {142, IN_ENTRY, 0, ENTRY_SHAPE, 8, 1ull << 40},
    {124, IN_ENTRY, 0, ENTRY_STORED_SIZE, 8, 7},
    {124, IN_ENTRY, 0, ENTRY_STORED_SIZE, 8, UINT64_MAX},
    {123, IN_ENTRY, 0, ENTRY_CODEC, 1, 1},
};

static size_t place_of(const sealed_file *file, const lie *l)
{
    size_t base = l->where == IN_HEADER  ? 0
                  : l->where == IN_ENTRY ? sealed_file_entry(file, l->index)
                                         : sealed_file_block(file, l->index);
    return base + l->field;
}

static void expect_rule(const sealed_file *file, int rule)
{
    char error[1024], expected[16];
    parian_result result = read_all(file->data, file->size, NULL, error);
    snprintf(expected, sizeof expected, "rule %d:", rule);
    if (result == PARIAN_OK || !strstr(error, expected)) {
        fail_msg("expected %s got result %d \"%s\"", expected, result, error);
    }
}

static void every_lie_is_found(void **state)
{
    (void)state;
    parian_scene_data scene;
    sealed_file file = make(PARIAN_LOCAL_NONE, false, &scene);
    uint8_t *original = malloc(file.size);
    memcpy(original, file.data, file.size);
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        memcpy(file.data + place_of(&file, &lies[i]), &lies[i].value, lies[i].width);
        sealed_file_seal(&file);
        expect_rule(&file, lies[i].rule);
        memcpy(file.data, original, file.size);
    }
    file.data[64 + 8] = 1; /* padding behind scene.counts */
    expect_rule(&file, 122);
    memcpy(file.data, original, file.size);
    memcpy(file.data + sealed_file_entry(&file, 1), file.data + sealed_file_entry(&file, 0),
           ENTRY_OBJECT);
    sealed_file_seal(&file);
    expect_rule(&file, 120);
    free(original);
    free(file.data);
    parian_scene_data_free(NULL, &scene);
}

/* Every 8-byte word of header and table set to extremes, with fitting checksums. */
static void extremes_do_no_harm(void **state)
{
    (void)state;
    static const uint64_t value[] = {0,          1,          0xFF,       0xFFFFFFFF,
                                     1ull << 32, 1ull << 62, 1ull << 63, UINT64_MAX};
    parian_scene_data scene;
    sealed_file file = make(PARIAN_LOCAL_F16, false, &scene);
    uint8_t *original = malloc(file.size);
    memcpy(original, file.data, file.size);
    size_t table = sealed_file_entry(&file, 0);
    for (size_t place = 8; place + 8 <= file.size; place += 8) {
        if (place == HEADER_SIZE) {
            place = table;
        }
        for (size_t i = 0; i < sizeof value / sizeof *value; i++) {
            store_u64(file.data + place, value[i]);
            sealed_file_seal(&file);
            read_all(file.data, file.size, NULL, NULL);
            memcpy(file.data, original, file.size);
        }
    }
    free(original);
    free(file.data);
    parian_scene_data_free(NULL, &scene);
}

static void change_at_random(sealed_file *file)
{
    static const uint32_t word[] = {0,          1,          0x7FFFFFFF, 0x80000000,
                                    0xFFFFFFFF, 0x7FC00000, 0x7F800000, 0x00010001};
    uint32_t changes = 1 + random_below(3);
    for (uint32_t i = 0; i < changes; i++) {
        uint32_t place = 8 + random_below((uint32_t)file->size - 12);
        if (random_below(2)) {
            file->data[place] = (uint8_t)random_below(256);
        } else {
            store_u32(file->data + (place & ~3u), word[random_below(8)]);
        }
    }
}

/* Values, settings, frames and table changed at random, with fitting checksums: refused or read. */
static void hostile_values_do_no_harm(void **state)
{
    (void)state;
    static const parian_local_form forms[] = {PARIAN_LOCAL_F16, PARIAN_LOCAL_U8, PARIAN_LOCAL_SPLIT,
                                              PARIAN_LOCAL_REBUILT};
    for (size_t form = 0; form < 4; form++) {
        for (int compressed = 0; compressed < 2; compressed++) {
            parian_scene_data scene;
            sealed_file file = make(forms[form], !compressed, &scene);
            uint8_t *original = malloc(file.size);
            memcpy(original, file.data, file.size);
            for (int i = 0; i < HOSTILE_CHANGES / 8; i++) {
                change_at_random(&file);
                sealed_file_seal(&file);
                read_all(file.data, file.size, NULL, NULL);
                memcpy(file.data, original, file.size);
            }
            free(original);
            free(file.data);
            parian_scene_data_free(NULL, &scene);
        }
    }
}

/* ---- a small file that claims much --------------------------------------------------------------
 */

static void expansion_is_limited(void **state)
{
    (void)state;
    const char *path = test_scratch("expand.parian");
    size_t size = (size_t)80 << 20;
    uint8_t *zeros = calloc(1, size);
    parian_writer *writer;
    parian_reader *reader;
    limited_memory memory = {.limit = 1 << 20};
    parian_env env = limited_env(&memory);
    parian_chunk_info info = {
        .name = "zeros", .element = PARIAN_ELEMENT_U8, .codec = PARIAN_CODEC_ZSTD, .rank = 1};
    info.shape[0] = size;
    assert_int_equal(parian_writer_begin(NULL, &(parian_writer_desc){.path = path}, &writer),
                     PARIAN_OK);
    assert_int_equal(parian_writer_chunk(writer, &info, zeros), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    assert_int_equal(parian_reader_open(&env, path, NULL, &reader), PARIAN_E_LIMIT);
    assert_non_null(strstr(memory.error, "rule 143"));
    assert_int_equal(memory.live, 0);
    parian_reader_limits limits = {.expansion_max = 1 << 20};
    assert_int_equal(parian_reader_open(&env, path, &limits, &reader), PARIAN_OK);
    parian_reader_close(reader);
    limits.chunk_count_max = 1;
    limits.decoded_size_max = size - 1;
    assert_int_equal(parian_reader_open(&env, path, &limits, &reader), PARIAN_E_LIMIT);
    assert_non_null(strstr(memory.error, "rule 142"));
    free(zeros);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_truncation_is_refused), cmocka_unit_test(every_byte_counts),
        cmocka_unit_test(more_bytes_are_refused),      cmocka_unit_test(every_lie_is_found),
        cmocka_unit_test(extremes_do_no_harm),         cmocka_unit_test(hostile_values_do_no_harm),
        cmocka_unit_test(expansion_is_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
