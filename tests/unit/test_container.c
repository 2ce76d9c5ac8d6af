/* test_container.c - arrays into a container and back: elements, codecs, shapes, sizes, mapping,
 * bytes.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/memory.h"
#include "parian/format.h"
#include "support/test_support.h"
#include "tool/files.h"

/* Repeatable numbers that compress somewhat: small steps of a generator. */
static void fill(void *data, size_t size, uint32_t seed)
{
    uint8_t *byte = data;
    for (size_t i = 0; i < size; i++) {
        seed = seed * 1664525u + 1013904223u;
        byte[i] = (uint8_t)(i % 8 < 4 ? i / 64 : seed >> 28);
    }
}

static void fill_noise(void *data, size_t size, uint32_t seed)
{
    uint8_t *byte = data;
    for (size_t i = 0; i < size; i++) {
        seed = seed * 1664525u + 1013904223u;
        byte[i] = (uint8_t)(seed >> 24);
    }
}

static parian_chunk_info describe(const char *name, parian_element element, parian_codec codec,
                                  uint64_t count)
{
    parian_chunk_info info = {.element = element, .codec = codec, .rank = 1, .shape = {count}};
    snprintf(info.name, sizeof info.name, "%s", name);
    return info;
}

static parian_writer *begin(const parian_env *env, const char *path, bool plain)
{
    parian_writer *writer;
    parian_writer_desc desc = {.path = path, .no_compression = plain};
    assert_int_equal(parian_writer_begin(env, &desc, &writer), PARIAN_OK);
    return writer;
}

static void check_chunk(const parian_reader *reader, const parian_chunk_info *info,
                        const void *expected, size_t size)
{
    int64_t index = parian_reader_find(reader, info->name, info->object, info->level);
    assert_true(index >= 0);
    const parian_chunk_info *found = parian_reader_chunk(reader, (uint32_t)index);
    assert_int_equal(found->size, size);
    assert_int_equal(found->element, info->element);
    assert_int_equal(found->rank, info->rank);
    assert_memory_equal(found->shape, info->shape, sizeof info->shape);
    uint8_t *data = malloc(size + 1);
    data[size] = 0xA5;
    assert_int_equal(parian_reader_read(reader, (uint32_t)index, data), PARIAN_OK);
    assert_memory_equal(data, expected, size);
    assert_int_equal(data[size], 0xA5);
    free(data);
}

/* Every element with every codec it may have, for sizes around nothing and around a block. */
static void every_element_codec_and_size(void **state)
{
    (void)state;
    static const uint64_t bytes[] = {0,
                                     8,
                                     16,
                                     4096,
                                     PARIAN_BLOCK_SIZE - 8,
                                     PARIAN_BLOCK_SIZE,
                                     PARIAN_BLOCK_SIZE + 8,
                                     3 * PARIAN_BLOCK_SIZE + 40};
    const parian_env *env = test_env(2);
    const char *path = test_scratch("all.parian");
    uint8_t *data = malloc(4 * PARIAN_BLOCK_SIZE);
    fill(data, 4 * PARIAN_BLOCK_SIZE, 1);
    for (int codec = PARIAN_CODEC_RAW; codec <= PARIAN_CODEC_DELTA_ZSTD; codec++) {
        parian_writer *writer = begin(env, path, false);
        for (uint32_t pass = 0; pass < 2; pass++) {
            parian_reader *reader = NULL;
            if (pass == 1) {
                assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
                assert_int_equal(parian_reader_open(env, path, NULL, &reader), PARIAN_OK);
                assert_int_equal(parian_reader_verify(reader), PARIAN_OK);
            }
            for (int element = PARIAN_ELEMENT_U8; element <= PARIAN_ELEMENT_F64; element++) {
                if (codec == PARIAN_CODEC_DELTA_ZSTD && element >= PARIAN_ELEMENT_F16) {
                    continue;
                }
                for (uint32_t i = 0; i < sizeof bytes / sizeof *bytes; i++) {
                    parian_chunk_info info =
                        describe("array", (parian_element)element, (parian_codec)codec,
                                 bytes[i] / parian_element_size((parian_element)element));
                    info.object = i;
                    info.level = (uint32_t)element;
                    if (pass == 0) {
                        assert_int_equal(parian_writer_chunk(writer, &info, bytes[i] ? data : NULL),
                                         PARIAN_OK);
                    } else {
                        check_chunk(reader, &info, data, bytes[i]);
                    }
                }
            }
            parian_reader_close(reader);
        }
    }
    free(data);
}

static void shapes_names_and_flags(void **state)
{
    (void)state;
    const parian_env *env = test_env(1);
    const char *path = test_scratch("shapes.parian");
    uint16_t data[2 * 3 * 4 * 5];
    fill_noise(data, sizeof data, 3);
    parian_chunk_info info = describe("a.name_of.39.characters_0123456789_abcd", PARIAN_ELEMENT_U16,
                                      PARIAN_CODEC_SHUFFLE_ZSTD, 2);
    assert_int_equal(strlen(info.name), PARIAN_CHUNK_NAME_MAX - 1);
    info.rank = 4;
    info.shape[1] = 3, info.shape[2] = 4, info.shape[3] = 5;
    info.object = 0xFFFFFFFF;
    info.level = 0xFFFFFFFE;
    info.flags = PARIAN_CHUNK_REQUIRED;
    parian_writer *writer = begin(env, path, false);
    assert_int_equal(parian_writer_chunk(writer, &info, data), PARIAN_OK);
    parian_chunk_info empty = describe("empty", PARIAN_ELEMENT_F32, PARIAN_CODEC_SHUFFLE_ZSTD, 0);
    empty.rank = 2;
    empty.shape[1] = 3;
    assert_int_equal(parian_writer_chunk(writer, &empty, NULL), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    parian_reader *reader;
    assert_int_equal(parian_reader_open(env, path, NULL, &reader), PARIAN_OK);
    check_chunk(reader, &info, data, sizeof data);
    check_chunk(reader, &empty, "", 0);
    assert_int_equal(parian_reader_chunk(reader, 0)->flags, PARIAN_CHUNK_REQUIRED);
    assert_int_equal(parian_reader_find(reader, "empty", 1, 0), -1);
    assert_int_equal(parian_reader_find(reader, "empt", 0, 0), -1);
    assert_null(parian_reader_chunk(reader, 2));
    parian_reader_close(reader);
}

/* A raw chunk is mapped where it lies: no allocation of its size, aligned, inside the bytes. */
static void raw_is_mapped_without_a_copy(void **state)
{
    (void)state;
    const char *path = test_scratch("raw.parian");
    size_t size = 3 * PARIAN_BLOCK_SIZE + 100, file_size;
    uint8_t *noise = malloc(size), *file;
    const void *mapped;
    parian_reader *reader;
    static const uint8_t zeros[1000];
    fill_noise(noise, size, 5);
    parian_writer *writer = begin(NULL, path, false);
    parian_chunk_info odd = describe("odd", PARIAN_ELEMENT_U8, PARIAN_CODEC_RAW, 3);
    parian_chunk_info info =
        describe("noise", PARIAN_ELEMENT_U8, PARIAN_CODEC_ZSTD, size); /* saves nothing */
    assert_int_equal(parian_writer_chunk(writer, &odd, noise), PARIAN_OK);
    assert_int_equal(parian_writer_chunk(writer, &info, noise), PARIAN_OK);
    parian_chunk_info coded = describe("coded", PARIAN_ELEMENT_U8, PARIAN_CODEC_ZSTD, 1000);
    assert_int_equal(parian_writer_chunk(writer, &coded, zeros), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, path, UINT64_MAX, &file, &file_size), PARIAN_OK);
    assert_int_equal(parian_reader_open_memory(NULL, "memory", file, file_size, NULL, &reader),
                     PARIAN_OK);
    assert_int_equal(parian_reader_chunk(reader, 1)->codec, PARIAN_CODEC_RAW);
    assert_int_equal(parian_reader_map(reader, 1, &mapped), PARIAN_OK);
    assert_int_equal(parian_reader_chunk(reader, 1)->offset % 64, 0);
    assert_ptr_equal(mapped, file + parian_reader_chunk(reader, 1)->offset);
    assert_memory_equal(mapped, noise, size);
    assert_int_equal(parian_reader_map(reader, 2, &mapped), PARIAN_E_UNSUPPORTED);
    parian_reader_close(reader);
    parian_free(NULL, file);
    free(noise);
}

static void write_sample(const parian_env *env, const char *path, bool plain)
{
    size_t size = 21 * PARIAN_BLOCK_SIZE + 4;
    uint8_t *data = malloc(size);
    fill(data, size, 9);
    parian_writer *writer = begin(env, path, plain);
    for (int codec = PARIAN_CODEC_RAW; codec <= PARIAN_CODEC_DELTA_ZSTD; codec++) {
        parian_chunk_info info =
            describe("data", PARIAN_ELEMENT_U32, (parian_codec)codec, size / 4);
        info.level = (uint32_t)codec;
        assert_int_equal(parian_writer_chunk(writer, &info, data), PARIAN_OK);
    }
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    free(data);
}

static void same_bytes_for_any_number_of_threads(void **state)
{
    (void)state;
    static const unsigned threads[] = {1, 2, 7};
    uint64_t hash[4];
    for (int i = 0; i < 3; i++) {
        const char *path = test_scratch("threads.parian");
        write_sample(test_env(threads[i]), path, false);
        assert_int_equal(parian_file_hash(NULL, path, &hash[i]), PARIAN_OK);
        assert_int_equal(hash[i], hash[0]);
    }
    write_sample(test_env(1), test_scratch("plain.parian"), true);
    assert_int_equal(parian_file_hash(NULL, test_scratch("plain.parian"), &hash[3]), PARIAN_OK);
    assert_true(hash[3] != hash[0]);
}

static void empty_container(void **state)
{
    (void)state;
    parian_reader *reader;
    const char *path = test_scratch("none.parian");
    assert_int_equal(parian_writer_finish(begin(NULL, path, false)), PARIAN_OK);
    assert_int_equal(parian_reader_open(NULL, path, NULL, &reader), PARIAN_OK);
    assert_int_equal(parian_reader_chunk_count(reader), 0);
    assert_int_equal(parian_reader_file_size(reader), 64);
    assert_int_equal(parian_reader_verify(reader), PARIAN_OK);
    parian_reader_close(reader);
}

static parian_result try_chunk(parian_chunk_info info, const void *data)
{
    parian_writer *writer = begin(NULL, test_scratch("bad.parian"), false);
    parian_result result = parian_writer_chunk(writer, &info, data);
    if (result == PARIAN_OK) { /* once more: must be new */
        result = parian_writer_chunk(writer, &info, data);
    }
    assert_int_equal(parian_writer_finish(writer), result); /* a failed writer does not finish */
    return result;
}

static void bad_descriptions_are_refused(void **state)
{
    (void)state;
    static const uint32_t data[4];
    parian_chunk_info good = describe("good", PARIAN_ELEMENT_U32, PARIAN_CODEC_RAW, 4), bad;
    struct stat status;
    assert_int_equal(try_chunk(good, data), PARIAN_E_ARGUMENT); /* the second time */
#define REFUSED(change)                                                                            \
    bad = good;                                                                                    \
    change;                                                                                        \
    assert_int_equal(try_chunk(bad, data), PARIAN_E_ARGUMENT)
    REFUSED(bad.name[0] = 0);
    REFUSED(bad.name[0] = 'A');
    REFUSED(memset(bad.name, 'a', sizeof bad.name));
    REFUSED(bad.element = (parian_element)0);
    REFUSED(bad.element = (parian_element)11);
    REFUSED(bad.codec = (parian_codec)4);
    REFUSED((bad.element = PARIAN_ELEMENT_F32, bad.codec = PARIAN_CODEC_DELTA_ZSTD));
    REFUSED(bad.rank = 0);
    REFUSED(bad.rank = 5);
    REFUSED(bad.shape[1] = 1);
    REFUSED(bad.flags = 2);
    REFUSED((bad.rank = 3, bad.shape[0] = bad.shape[1] = bad.shape[2] = 1ull << 40));
#undef REFUSED
    assert_int_equal(try_chunk(good, NULL), PARIAN_E_ARGUMENT);
    assert_int_not_equal(stat(test_scratch("bad.parian"), &status), 0);
}

static void element_names(void **state)
{
    (void)state;
    assert_string_equal(parian_element_name(PARIAN_ELEMENT_F16), "f16");
    assert_null(parian_element_name((parian_element)77));
    assert_int_equal(parian_element_size(PARIAN_ELEMENT_U64), 8);
    assert_int_equal(parian_element_size((parian_element)-1), 0);
    assert_string_equal(parian_codec_name(PARIAN_CODEC_SHUFFLE_ZSTD), "shuffle+zstd");
    assert_null(parian_codec_name((parian_codec)9));
}

/* A chunk of several blocks goes over as it is stored, and what is damaged does not. */
static void copies_keep_stored_blocks(void **state)
{
    (void)state;
    enum { COUNT = 700000 };
    const char *first = test_scratch("first.parian"), *second = test_scratch("second.parian");
    const parian_chunk_info info =
        describe("a", PARIAN_ELEMENT_U32, PARIAN_CODEC_SHUFFLE_ZSTD, COUNT);
    uint32_t *data = malloc(COUNT * sizeof *data);
    parian_reader *reader, *copy;
    assert_non_null(data);
    fill(data, COUNT * sizeof *data, 5);
    parian_writer *writer = begin(NULL, first, false);
    assert_int_equal(parian_writer_chunk(writer, &info, data), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    assert_int_equal(parian_reader_open(NULL, first, NULL, &reader), PARIAN_OK);
    writer = begin(NULL, second, true);
    assert_int_equal(parian_writer_copy(writer, reader, 0), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    assert_int_equal(parian_reader_open(NULL, second, NULL, &copy), PARIAN_OK);
    check_chunk(copy, &info, data, COUNT * sizeof *data);
    assert_memory_equal(parian_reader_chunk(copy, 0), parian_reader_chunk(reader, 0),
                        sizeof(parian_chunk_info));
    writer = begin(NULL, second, false);
    assert_int_equal(parian_writer_copy(writer, reader, 0), PARIAN_OK);
    assert_int_equal(parian_writer_copy(writer, reader, 0), PARIAN_E_ARGUMENT); /* twice */
    parian_writer_abort(writer);
    writer = begin(NULL, second, false);
    assert_int_equal(parian_writer_copy(writer, reader, 1), PARIAN_E_ARGUMENT); /* not there */
    parian_writer_abort(writer);
    parian_reader_close(reader);
    parian_reader_close(copy);

    uint8_t *bytes;
    size_t size;
    assert_int_equal(parian_file_read(NULL, first, UINT64_MAX, &bytes, &size), PARIAN_OK);
    bytes[1000] ^= 1;
    assert_int_equal(parian_reader_open_memory(NULL, "damaged", bytes, size, NULL, &reader),
                     PARIAN_OK);
    writer = begin(NULL, second, false);
    assert_int_equal(parian_writer_copy(writer, reader, 0), PARIAN_E_FORMAT);
    parian_writer_abort(writer);
    parian_reader_close(reader);
    free(bytes);
    free(data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(copies_keep_stored_blocks),
        cmocka_unit_test(every_element_codec_and_size),
        cmocka_unit_test(shapes_names_and_flags),
        cmocka_unit_test(raw_is_mapped_without_a_copy),
        cmocka_unit_test(same_bytes_for_any_number_of_threads),
        cmocka_unit_test(empty_container),
        cmocka_unit_test(bad_descriptions_are_refused),
        cmocka_unit_test(element_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
