/* test_asset_writing.c - what writers and readers leave behind when memory, disk or permission is
 * missing.
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

#include "core/body_file.h"
#include "core/memory.h"
#include "support/sealed_file.h"
#include "support/test_support.h"
#include "support/tiny_body.h"
#include "tool/files.h"

static const char *fresh_folder(const char *name)
{
    const char *path = test_scratch(name);
    mkdir(path, 0777);
    return path;
}

static size_t count_files(const char *folder)
{
    DIR *open_folder = opendir(folder);
    size_t count = 0;
    assert_non_null(open_folder);
    while (readdir(open_folder)) {
        count++;
    }
    closedir(open_folder);
    return count - 2;
}

static parian_result save(const parian_env *env, const char *path, const parian_scene_data *scene)
{
    parian_writer *writer;
    parian_result result = parian_writer_begin(env, &(parian_writer_desc){.path = path}, &writer);
    if (result != PARIAN_OK) {
        return result;
    }
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

/* ---- memory -------------------------------------------------------------------------------------
 */

static void every_failing_allocation_of_a_writer(void **state)
{
    (void)state;
    char path[512];
    const char *folder = fresh_folder("memory");
    parian_scene_data scene;
    snprintf(path, sizeof path, "%s/a.parian", folder);
    unlink(path);
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_F16, 5, &scene), PARIAN_OK);
    parian_result result = PARIAN_E_NOMEM;
    size_t attempts = 0;
    for (; result != PARIAN_OK; attempts++) {
        test_memory memory = {.fail_at = attempts};
        parian_env env = test_failing_env(&memory);
        result = save(&env, path, &scene);
        assert_true(result == PARIAN_OK || result == PARIAN_E_NOMEM);
        assert_int_equal(memory.live, 0);
        assert_int_equal(count_files(folder), result == PARIAN_OK);
    }
    assert_true(attempts > 10);
    parian_scene_data_free(NULL, &scene);
}

static void every_failing_allocation_of_a_reader(void **state)
{
    (void)state;
    const char *path = test_scratch("memory.parian");
    parian_scene_data scene, back;
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_U8, 5, &scene), PARIAN_OK);
    assert_int_equal(save(NULL, path, &scene), PARIAN_OK);
    parian_result result = PARIAN_E_NOMEM;
    size_t attempts = 0;
    for (; result != PARIAN_OK; attempts++) {
        test_memory memory = {.fail_at = attempts};
        parian_env env = test_failing_env(&memory);
        result = load(&env, path, &back);
        assert_true(result == PARIAN_OK || result == PARIAN_E_NOMEM);
        if (result == PARIAN_OK) {
            assert_true(test_scene_equal(&scene, &back));
            parian_scene_data_free(&env, &back);
        }
        assert_int_equal(memory.live, 0);
    }
    assert_true(attempts > 50);
    parian_scene_data_free(NULL, &scene);
}

/* ---- disk ---------------------------------------------------------------------------------------
 */

static void abort_leaves_nothing(void **state)
{
    (void)state;
    char path[512];
    const char *folder = fresh_folder("abort");
    parian_writer *writer;
    parian_scene_data scene;
    snprintf(path, sizeof path, "%s/a.parian", folder);
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 5, &scene), PARIAN_OK);
    assert_int_equal(parian_writer_begin(NULL, &(parian_writer_desc){.path = path}, &writer),
                     PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, &scene), PARIAN_OK);
    assert_int_equal(count_files(folder), 1); /* the temporary file, under another name */
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_equal(access(parian_writer_temporary(writer), F_OK), 0);
    parian_writer_abort(writer);
    assert_int_equal(count_files(folder), 0);
    parian_writer_abort(NULL);
    parian_scene_data_free(NULL, &scene);
}

/* A limit of the file size stands for a full disk: a write fails in the middle, at every point. */
static void full_disk(void **state)
{
    (void)state;
    char path[512], old[4] = "";
    const char *folder = fresh_folder("full");
    parian_scene_data scene;
    struct rlimit before, limit;
    limited_memory memory = {.limit = SIZE_MAX};
    parian_env env = limited_env(&memory);
    snprintf(path, sizeof path, "%s/a.parian", folder);
    assert_int_equal(parian_file_write(NULL, path, "old", 3), PARIAN_OK);
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_U8, 5, &scene), PARIAN_OK);
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    for (rlim_t size = 0; size < 9000; size += 500) {
        limit = before;
        limit.rlim_cur = size;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
        memory.error[0] = 0;
        parian_result result = save(&env, path, &scene);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        assert_int_equal(result, PARIAN_E_IO);
        assert_non_null(strstr(memory.error, "a.parian: cannot write"));
        assert_int_equal(memory.live, 0);
        assert_int_equal(count_files(folder), 1); /* what was there stays as it was */
        FILE *file = fopen(path, "r");
        assert_non_null(file);
        assert_int_equal(fread(old, 1, sizeof old, file), 3);
        fclose(file);
        assert_memory_equal(old, "old", 3);
    }
    assert_int_equal(save(&env, path, &scene), PARIAN_OK);
    parian_scene_data_free(NULL, &scene);
}

static void refuse_target(const char *path, const char *expected)
{
    limited_memory memory = {.limit = SIZE_MAX};
    parian_env env = limited_env(&memory);
    parian_writer *writer;
    assert_int_equal(parian_writer_begin(&env, &(parian_writer_desc){.path = path}, &writer),
                     PARIAN_E_IO);
    if (!strstr(memory.error, expected)) {
        fail_msg("%s: expected \"%s\" in \"%s\"", path, expected, memory.error);
    }
    assert_int_equal(memory.live, 0);
}

static void targets_that_cannot_be(void **state)
{
    (void)state;
    char path[600];
    const char *folder = fresh_folder("target");
    refuse_target("", "empty");
    refuse_target(folder, "is a folder");
    snprintf(path, sizeof path, "%s/missing/a.parian", folder);
    refuse_target(path, "No such file or directory");
    snprintf(path, sizeof path, "%s/new/", folder);
    refuse_target(path, "ends with a slash");
    refuse_target("/dev/full", "not a regular file");
    parian_file_write(NULL, test_scratch("target/file"), "x", 1);
    snprintf(path, sizeof path, "%s/file/b.parian", folder);
    refuse_target(path, "Not a directory");
    if (geteuid() != 0) { /* nothing is forbidden to root */
        assert_int_equal(chmod(folder, 0555), 0);
        snprintf(path, sizeof path, "%s/a.parian", folder);
        refuse_target(path, "Permission denied");
        assert_int_equal(chmod(folder, 0777), 0);
    }
}

static void refuse_source(const char *path, parian_result expected_result, const char *expected)
{
    limited_memory memory = {.limit = SIZE_MAX};
    parian_env env = limited_env(&memory);
    parian_reader *reader;
    assert_int_equal(parian_reader_open(&env, path, NULL, &reader), expected_result);
    assert_non_null(strstr(memory.error, path));
    assert_non_null(strstr(memory.error, expected));
    assert_int_equal(memory.live, 0);
}

static void sources_that_cannot_be(void **state)
{
    (void)state;
    const char *pipe_path = test_scratch("pipe"), *empty = test_scratch("zero.parian");
    refuse_source(fresh_folder("source"), PARIAN_E_IO, "is a folder");
    refuse_source("/nonexistent/a.parian", PARIAN_E_IO, "No such file");
    unlink(pipe_path);
    assert_int_equal(mkfifo(pipe_path, 0666), 0);
    refuse_source(pipe_path, PARIAN_E_IO,
                  "not a regular file"); /* and does not wait for a writer */
    assert_int_equal(parian_file_write(NULL, empty, "", 0), PARIAN_OK);
    refuse_source(empty, PARIAN_E_FORMAT, "rule 102");
    assert_int_equal(parian_file_write(NULL, empty, "\x89PARIAN\n", 8), PARIAN_OK);
    refuse_source(empty, PARIAN_E_FORMAT, "rule 101");
}

/* Interrupted in the middle of a long chunk. */
static bool always(void *user)
{
    (void)user;
    return true;
}

static void interrupted_writer(void **state)
{
    (void)state;
    char path[512];
    const char *folder = fresh_folder("interrupt");
    parian_env env = {.cancelled = always};
    parian_scene_data scene;
    snprintf(path, sizeof path, "%s/a.parian", folder);
    assert_int_equal(test_tiny_scene(NULL, PARIAN_LOCAL_NONE, 5, &scene), PARIAN_OK);
    assert_int_equal(save(&env, path, &scene), PARIAN_E_INTERRUPTED);
    assert_int_equal(count_files(folder), 0);
    parian_scene_data_free(NULL, &scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_failing_allocation_of_a_writer),
        cmocka_unit_test(every_failing_allocation_of_a_reader),
        cmocka_unit_test(abort_leaves_nothing),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(targets_that_cannot_be),
        cmocka_unit_test(sources_that_cannot_be),
        cmocka_unit_test(interrupted_writer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
