/* test_npy_read.c - npy arrays as written, as NumPy writes them, cut short, and with headers that
 * lie.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"

static char said[512];
static int lines;

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(said, sizeof said, "%s", text);
        lines++;
    }
}

static const parian_env listening = {.log = keep_error};

/* A file of version 1 with this dictionary (padded by nothing) and these bytes. */
static const char *write_file(const char *dictionary, const void *data, size_t size)
{
    const char *path = test_scratch("array.npy");
    size_t length = strlen(dictionary);
    uint8_t prefix[10] = {
        0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (uint8_t)(length & 255), (uint8_t)(length >> 8)};
    parian_piece pieces[3] = {{prefix, sizeof prefix}, {dictionary, length}, {data, size}};
    assert_int_equal(parian_file_write_pieces(NULL, path, pieces, 3), PARIAN_OK);
    return path;
}

static void assert_refused(const char *path, const char *word)
{
    parian_npy array;
    said[0] = 0;
    lines = 0;
    assert_int_not_equal(parian_npy_read(&listening, path, &array), PARIAN_OK);
    if (lines != 1 || !strstr(said, word)) {
        print_error("%d lines, '%s', expected one with '%s'\n", lines, said, word);
        fail();
    }
    parian_npy_free(&listening, &array);
}

static void every_type_comes_back(void **state)
{
    const uint64_t shape[2] = {2, 3};
    const uint8_t u8[6] = {0, 1, 2, 3, 254, 255};
    const int8_t s8[6] = {0, -1, 2, -3, 127, -128};
    const uint16_t u16[6] = {0, 1, 2, 3, 4, 65535};
    const int16_t s16[6] = {0, -1, 2, -3, 4, -32768};
    const uint32_t u32[6] = {0, 1, 2, 3, 4, 4294967295u};
    const int32_t s32[6] = {0, -1, 2, -3, 4, INT32_MIN};
    const uint64_t u64[6] = {0, 1, 2, 3, 4, UINT64_C(1) << 52};
    const parian_half f16[6] = {0, 0x3c00, 0xbc00, 0x4000, 0x3800, 0x7bff};
    const float f32[6] = {0, 0.1f, -1e-30f, 1e30f, 5, 6};
    const double f64[6] = {0, 0.1, -1e-300, 1e300, 5, 6};
    const struct {
        parian_element element;
        const void *data;
        double second, last;
    } cases[] = {{PARIAN_ELEMENT_U8, u8, 1, 255},
                 {PARIAN_ELEMENT_S8, s8, -1, -128},
                 {PARIAN_ELEMENT_U16, u16, 1, 65535},
                 {PARIAN_ELEMENT_S16, s16, -1, -32768},
                 {PARIAN_ELEMENT_U32, u32, 1, 4294967295},
                 {PARIAN_ELEMENT_S32, s32, -1, INT32_MIN},
                 {PARIAN_ELEMENT_U64, u64, 1, 0x1p52},
                 {PARIAN_ELEMENT_F16, f16, 1, 65504},
                 {PARIAN_ELEMENT_F32, f32, (double)0.1f, 6},
                 {PARIAN_ELEMENT_F64, f64, 0.1, 6}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        parian_npy array;
        assert_int_equal(parian_npy_write(NULL, test_scratch("types"), "t", cases[i].element, 2,
                                          shape, cases[i].data),
                         PARIAN_OK);
        assert_int_equal(parian_npy_read(NULL, test_scratch("types/t.npy"), &array), PARIAN_OK);
        assert_true(array.rank == 2 && array.shape[0] == 2 && array.shape[1] == 3 &&
                    array.count == 6);
        assert_true(array.value[1] == cases[i].second && array.value[5] == cases[i].last);
        parian_npy_free(NULL, &array);
    }
}

static void shapes_of_every_rank(void **state)
{
    static const double numbers[24] = {[0] = 7, [23] = 9};
    (void)state;
    for (uint32_t rank = 0; rank <= 4; rank++) {
        const uint64_t shape[4] = {rank < 4 ? 2 : 4, 3, rank < 4 ? 4 : 2, 1};
        uint64_t count = 1;
        parian_npy array;
        for (uint32_t k = 0; k < rank; k++) {
            count *= shape[k];
        }
        assert_int_equal(parian_npy_write(NULL, test_scratch("ranks"), "r", PARIAN_ELEMENT_F64,
                                          rank, shape, numbers),
                         PARIAN_OK);
        assert_int_equal(parian_npy_read(NULL, test_scratch("ranks/r.npy"), &array), PARIAN_OK);
        assert_true(array.rank == rank && array.count == count && array.value[0] == 7);
        assert_memory_equal(array.shape, shape, rank * sizeof *shape);
        parian_npy_free(NULL, &array);
    }
    const uint64_t none[2] = {0, 3};
    parian_npy array;
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("ranks"), "z", PARIAN_ELEMENT_F32, 2, none, NULL),
        PARIAN_OK);
    assert_int_equal(parian_npy_read(NULL, test_scratch("ranks/z.npy"), &array), PARIAN_OK);
    assert_true(array.count == 0 && array.shape[1] == 3);
    parian_npy_free(NULL, &array);
}

/* Keys in another order, double quotes, more spaces, and the longer header of version 2. */
static void headers_as_others_write_them(void **state)
{
    const float data[2] = {1.5f, -2.5f};
    parian_npy array;
    (void)state;
    const char *path = write_file(
        "{ \"shape\" : ( 2 , ) , \"fortran_order\":False,'descr': '<f4'}\n", data, sizeof data);
    assert_int_equal(parian_npy_read(NULL, path, &array), PARIAN_OK);
    assert_true(array.rank == 1 && array.value[1] == -2.5);
    parian_npy_free(NULL, &array);
    const char text[] = "{'descr': '<f4', 'fortran_order': False, 'shape': (2,), }\n";
    uint8_t prefix[12] = {0x93, 'N', 'U', 'M', 'P', 'Y', 2, 0, sizeof text - 1, 0, 0, 0};
    parian_piece pieces[3] = {
        {prefix, sizeof prefix}, {text, sizeof text - 1}, {data, sizeof data}};
    assert_int_equal(parian_file_write_pieces(NULL, test_scratch("v2.npy"), pieces, 3), PARIAN_OK);
    assert_int_equal(parian_npy_read(NULL, test_scratch("v2.npy"), &array), PARIAN_OK);
    assert_true(array.value[0] == 1.5);
    parian_npy_free(NULL, &array);
}

/* Every shorter file is refused with one line. */
static void truncated_files_are_refused(void **state)
{
    const uint64_t shape[2] = {2, 3};
    const double data[6] = {1, 2, 3, 4, 5, 6};
    uint8_t *whole;
    size_t size;
    (void)state;
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("cut"), "c", PARIAN_ELEMENT_F64, 2, shape, data),
        PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("cut/c.npy"), 4096, &whole, &size),
                     PARIAN_OK);
    for (size_t length = 0; length < size; length++) {
        assert_int_equal(parian_file_write(NULL, test_scratch("cut/s.npy"), whole, length),
                         PARIAN_OK);
        assert_refused(test_scratch("cut/s.npy"), "s.npy");
    }
    parian_free(NULL, whole);
    assert_refused(test_scratch("cut/absent.npy"), "absent.npy");
}

static void lying_headers_are_refused(void **state)
{
    static const struct {
        const char *dictionary, *word;
    } cases[] = {{"{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }", "2 elements"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 3), }",
                  "elements"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (4294967296, 4294967296), }",
                  "elements"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999999,), }",
                  "elements"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1, 1, 1, 1), }", "shape"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (-2,), }", "shape"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': (2,", "shape"},
                 {"{'descr': '<f8', 'fortran_order': False, 'shape': 2, }", "shape"},
                 {"{'descr': '<f8', 'fortran_order': False}", "shape"},
                 {"{'descr': '<f8', 'fortran_order': True, 'shape': (1, 2), }", "Fortran"},
                 {"{'descr': '>f8', 'fortran_order': False, 'shape': (2,), }", ">f8"},
                 {"{'descr': '|O', 'fortran_order': False, 'shape': (2,), }", "|O"},
                 {"{'descr': '<c16', 'fortran_order': False, 'shape': (1,), }", "<c16"},
                 {"{'descr': '<U4', 'fortran_order': False, 'shape': (1,), }", "<U4"},
                 {"{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (1,), }", "expected"},
                 {"{'fortran_order': False, 'shape': (2,), }", "described"},
                 {"", "described"},
                 {"'descr':", "expected"}};
    const double data[2] = {1, 2};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_refused(write_file(cases[i].dictionary, data, sizeof data), cases[i].word);
    }
    const uint8_t version[12] = {0x93, 'N', 'U', 'M', 'P', 'Y', 9, 0, 0, 0};
    assert_int_equal(parian_file_write(NULL, test_scratch("v9.npy"), version, sizeof version),
                     PARIAN_OK);
    assert_refused(test_scratch("v9.npy"), "version 9");
    const uint8_t endless[12] = {0x93, 'N', 'U', 'M', 'P', 'Y', 2, 0, 0xff, 0xff, 0xff, 0xff};
    assert_int_equal(parian_file_write(NULL, test_scratch("long.npy"), endless, sizeof endless),
                     PARIAN_OK);
    assert_refused(test_scratch("long.npy"), "header");
}

/* Any one byte of a sound file changed: refused, or read as some other sound file. */
static void changed_bytes_never_harm(void **state)
{
    const uint64_t shape[2] = {2, 3};
    const float data[6] = {1, 2, 3, 4, 5, 6};
    uint8_t *whole;
    size_t size;
    (void)state;
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("flip"), "c", PARIAN_ELEMENT_F32, 2, shape, data),
        PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("flip/c.npy"), 4096, &whole, &size),
                     PARIAN_OK);
    for (size_t at = 0; at < size; at++) {
        static const uint8_t changes[] = {0x01, 0x10, 0x80, 0xff};
        for (size_t k = 0; k < sizeof changes; k++) {
            parian_npy array;
            whole[at] ^= changes[k];
            assert_int_equal(parian_file_write(NULL, test_scratch("flip/s.npy"), whole, size),
                             PARIAN_OK);
            whole[at] ^= changes[k];
            if (parian_npy_read(NULL, test_scratch("flip/s.npy"), &array) == PARIAN_OK) {
                assert_true(array.rank <= 4 && array.count <= size);
            }
            parian_npy_free(NULL, &array);
        }
    }
    parian_free(NULL, whole);
}

static void failed_allocations_are_reported(void **state)
{
    const uint64_t shape[1] = {3};
    const double data[3] = {1, 2, 3};
    (void)state;
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("mem"), "m", PARIAN_ELEMENT_F64, 1, shape, data),
        PARIAN_OK);
    for (size_t fail_at = 0;; fail_at++) {
        test_memory memory = {.fail_at = fail_at};
        parian_env env = test_failing_env(&memory);
        parian_npy array;
        parian_result r = parian_npy_read(&env, test_scratch("mem/m.npy"), &array);
        parian_npy_free(&env, &array);
        assert_int_equal(memory.live, 0);
        if (r == PARIAN_OK) {
            assert_true(fail_at >= 2);
            return;
        }
        assert_int_equal(r, PARIAN_E_NOMEM);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type_comes_back),
        cmocka_unit_test(shapes_of_every_rank),
        cmocka_unit_test(headers_as_others_write_them),
        cmocka_unit_test(truncated_files_are_refused),
        cmocka_unit_test(lying_headers_are_refused),
        cmocka_unit_test(changed_bytes_never_harm),
        cmocka_unit_test(failed_allocations_are_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
