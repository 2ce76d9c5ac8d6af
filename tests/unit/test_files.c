/* test_files.c - reading, atomic writing, folders, hashes and npy files of the tools.
 *
 * SPDX-License-Identifier: MIT
 */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"

static char said[512];

static void keep_error(void *user, parian_log_level level, const char *text)
{
    (void)user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(said, sizeof said, "%s", text);
    }
}

static const parian_env listening = {.log = keep_error};

static size_t count_entries(const char *folder)
{
    size_t count = 0;
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    while (readdir(dir)) {
        count++;
    }
    closedir(dir);
    return count - 2; /* . and .. */
}

static void test_round_trip(void **state)
{
    const char *path = test_scratch("some/new folder/file.bin");
    uint8_t *data;
    size_t size;
    (void)state;
    assert_int_equal(parian_file_write(NULL, path, "abc\0def", 7), PARIAN_OK);
    assert_int_equal(parian_file_write(NULL, path, "ABC\0DEF!", 8), PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, path, 8, &data, &size), PARIAN_OK);
    assert_int_equal(size, 8);
    assert_memory_equal(data, "ABC\0DEF!", 9); /* with the NUL behind it */
    parian_free(NULL, data);
    assert_int_equal(count_entries(test_scratch("some/new folder")), 1);
    assert_int_equal(parian_file_read(&listening, path, 7, &data, &size), PARIAN_E_LIMIT);
    assert_non_null(strstr(said, "8 bytes"));
}

static void test_empty_file(void **state)
{
    uint8_t *data;
    size_t size;
    (void)state;
    assert_int_equal(parian_file_write(NULL, test_scratch("empty"), NULL, 0), PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("empty"), 100, &data, &size), PARIAN_OK);
    assert_int_equal(size, 0);
    assert_int_equal(data[0], 0);
    parian_free(NULL, data);
}

static void test_messages(void **state)
{
    uint8_t *data;
    size_t size;
    uint64_t hash;
    (void)state;
    assert_int_equal(parian_file_read(&listening, test_scratch("absent"), 9, &data, &size),
                     PARIAN_E_IO);
    assert_non_null(strstr(said, "No such file"));
    assert_int_equal(parian_file_hash(&listening, test_scratch("absent"), &hash), PARIAN_E_IO);
    assert_int_equal(parian_file_read(&listening, test_scratch("."), 9, &data, &size), PARIAN_E_IO);
    assert_non_null(strstr(said, "it is a folder"));
    assert_int_equal(parian_file_write(&listening, test_scratch("."), "x", 1), PARIAN_E_IO);
    assert_non_null(strstr(said, "it is a folder"));
    assert_int_equal(parian_file_write(NULL, test_scratch("plain"), "x", 1), PARIAN_OK);
    assert_int_equal(parian_file_write(&listening, test_scratch("plain/x"), "x", 1), PARIAN_E_IO);
    assert_non_null(strstr(said, "a file of that name exists"));
}

/* /dev/full takes every open and refuses every byte. */
static void test_full_disk(void **state)
{
    (void)state;
    if (access("/dev/full", W_OK) != 0) {
        skip();
    }
    assert_int_equal(parian_file_write(&listening, "/dev/full", "x", 1), PARIAN_E_IO);
    assert_non_null(strstr(said, "No space left"));
    assert_int_equal(parian_file_write(NULL, "/dev/null", "x", 1), PARIAN_OK);
}

/* A write that fails half way leaves the old file and nothing else. */
static void test_failed_write_leaves_nothing(void **state)
{
    static uint8_t big[1 << 16];
    struct rlimit old, small;
    uint8_t *data;
    size_t size;
    const char *path = test_scratch("limited/file");
    (void)state;
    assert_int_equal(parian_file_write(NULL, path, "old", 3), PARIAN_OK);
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small = old;
    small.rlim_cur = 1000;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    parian_result result = parian_file_write(&listening, path, big, sizeof big);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(result, PARIAN_E_IO);
    assert_int_equal(count_entries(test_scratch("limited")), 1);
    assert_int_equal(parian_file_read(NULL, path, 100, &data, &size), PARIAN_OK);
    assert_string_equal((char *)data, "old");
    parian_free(NULL, data);
}

static void test_link_and_mode_stay(void **state)
{
    struct stat status;
    const char *path = test_scratch("real"), *symbolic = test_scratch("link");
    (void)state;
    unlink(symbolic);
    assert_int_equal(parian_file_write(NULL, path, "1", 1), PARIAN_OK);
    assert_int_equal(chmod(path, 0640), 0);
    assert_int_equal(symlink("real", symbolic), 0);
    assert_int_equal(parian_file_write(NULL, symbolic, "22", 2), PARIAN_OK);
    assert_int_equal(lstat(symbolic, &status), 0);
    assert_true(S_ISLNK(status.st_mode));
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_size, 2);
    assert_int_equal(status.st_mode & 0777, 0640);
}

static void test_hash(void **state)
{
    uint64_t empty, a, b;
    (void)state;
    assert_int_equal(parian_file_write(NULL, test_scratch("h0"), "", 0), PARIAN_OK);
    assert_int_equal(parian_file_write(NULL, test_scratch("h1"), "a", 1), PARIAN_OK);
    assert_int_equal(parian_file_hash(NULL, test_scratch("h0"), &empty), PARIAN_OK);
    assert_int_equal(parian_file_hash(NULL, test_scratch("h1"), &a), PARIAN_OK);
    assert_int_equal(parian_file_hash(NULL, test_scratch("h1"), &b), PARIAN_OK);
    assert_true(empty == 0x2D06800538D394C2u); /* XXH3-64 of nothing, from its specification */
    assert_true(a == b && a != empty);
}

static void test_npy(void **state)
{
    const float values[2][3] = {{1, 2, 3}, {4, 5, 6}};
    const uint64_t shape[2] = {2, 3}, one[1] = {6}, none[2] = {0, 3};
    uint8_t *data;
    size_t size;
    (void)state;
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("dump"), "a", PARIAN_ELEMENT_F32, 2, shape, values),
        PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("dump/a.npy"), 4096, &data, &size),
                     PARIAN_OK);
    assert_memory_equal(data, "\x93NUMPY\x01\x00", 8);
    const size_t header = 10u + data[8] + 256u * data[9];
    assert_int_equal(header % 64, 0);
    assert_int_equal(data[header - 1], '\n');
    assert_non_null(
        strstr((char *)data + 10, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }"));
    assert_int_equal(size, header + sizeof values);
    assert_memory_equal(data + header, values, sizeof values);
    parian_free(NULL, data);
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("dump"), "b.npy", PARIAN_ELEMENT_F32, 1, one, values),
        PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, test_scratch("dump/b.npy"), 4096, &data, &size),
                     PARIAN_OK);
    assert_non_null(strstr((char *)data + 10, "'shape': (6,), }"));
    parian_free(NULL, data);
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("dump"), "c", PARIAN_ELEMENT_F32, 2, none, NULL),
        PARIAN_OK);
    assert_int_equal(
        parian_npy_write(NULL, test_scratch("dump"), "d", (parian_element)99, 1, one, values),
        PARIAN_E_ARGUMENT);
}

static void test_temp_registry(void **state)
{
    const char *gone = test_scratch("temp-gone"), *stays = test_scratch("temp-stays");
    (void)state;
    assert_int_equal(parian_file_write(NULL, gone, "x", 1), PARIAN_OK);
    assert_int_equal(parian_file_write(NULL, stays, "x", 1), PARIAN_OK);
    parian_temp_register(gone);
    parian_temp_register(stays);
    parian_temp_unregister(stays);
    parian_temp_unlink_all();
    assert_int_not_equal(access(gone, F_OK), 0);
    assert_int_equal(access(stays, F_OK), 0);
    parian_temp_unregister(gone);
}

static void test_paths(void **state)
{
    static const char *const cases[][2] = {{"a/b/c", "a/b"}, {"c", "."}, {"/c", "/"}, {"a/", "a"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char *folder = parian_path_folder(NULL, cases[i][0]);
        assert_string_equal(folder, cases[i][1]);
        parian_free(NULL, folder);
    }
    char *joined = parian_path_join(NULL, "a", "b"), *slashed = parian_path_join(NULL, "a/", "b");
    assert_string_equal(joined, "a/b");
    assert_string_equal(slashed, "a/b");
    parian_free(NULL, joined);
    parian_free(NULL, slashed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_empty_file),
        cmocka_unit_test(test_messages),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_failed_write_leaves_nothing),
        cmocka_unit_test(test_link_and_mode_stay),
        cmocka_unit_test(test_hash),
        cmocka_unit_test(test_npy),
        cmocka_unit_test(test_temp_registry),
        cmocka_unit_test(test_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
