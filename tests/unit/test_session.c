/* test_session.c - threads, log lines, progress and Ctrl-C of the tools.
 *
 * SPDX-License-Identifier: MIT
 */
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"
#include "tool/session.h"
#include "tool/thread_pool.h"

enum { TEXT_MAX = 8192, ITEMS = 10007 };

/* ---- threads -----------------------------------------------------------------------------------
 */
typedef struct sums {
    const parian_env *env;
    atomic_uint seen[ITEMS];
    atomic_size_t inner;
} sums;

static void count_inner(void *context, size_t index)
{
    (void)index;
    atomic_fetch_add(&((sums *)context)->inner, 1);
}

static void count_once(void *context, size_t index)
{
    sums *s = context;
    atomic_fetch_add(&s->seen[index], 1u);
    if (index % 1000 == 0) {
        parian_par(s->env, 50, count_inner, s); /* nested: runs inline */
    }
}

static void test_each_index_once(void **state)
{
    static const unsigned threads[] = {1, 2, 7, 40};
    static sums s;
    (void)state;
    for (size_t t = 0; t < sizeof threads / sizeof threads[0]; t++) {
        memset(&s, 0, sizeof s);
        s.env = test_env(threads[t]);
        for (unsigned round = 1; round <= 20; round++) {
            parian_par(s.env, ITEMS, count_once, &s);
            for (size_t i = 0; i < ITEMS; i++) {
                assert_int_equal(atomic_load(&s.seen[i]), round);
            }
        }
        assert_int_equal(atomic_load(&s.inner), 20 * 11 * 50);
    }
    parian_par(test_env(2), 0, count_once, &s);
}

static void note_thread(void *context, size_t index)
{
    atomic_uint *count = context;
    (void)index;
    atomic_fetch_add(count, 1u);
    for (int i = 0; i < 1000 && atomic_load(count) < 2; i++) {
        usleep(1000); /* until another thread has come too */
    }
}

static void test_threads_really_run_together(void **state)
{
    atomic_uint count = 0;
    parian_thread_pool *pool;
    (void)state;
    assert_int_equal(parian_thread_pool_create(2, &pool), PARIAN_OK);
    const double start = parian_seconds();
    parian_thread_pool_run(pool, 2, note_thread, &count);
    assert_true(parian_seconds() - start < 0.9); /* alone, the first would wait a second */
    parian_thread_pool_destroy(pool);
}

/* ---- a tool in a child process -----------------------------------------------------------------
 */
/* Runs body in a child with stderr in a file; returns its exit status. */
static int run_tool(int (*body)(void), char text[TEXT_MAX])
{
    const char *path = test_scratch("stderr.txt");
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        if (!freopen(path, "wb", stderr)) {
            _exit(99);
        }
        int status = body();
        fflush(NULL);
        _exit(status);
    }
    int status = 0;
    assert_true(child > 0 && waitpid(child, &status, 0) == child);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    text[fread(text, 1, TEXT_MAX - 1, file)] = '\0';
    fclose(file);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

static parian_session *open_session(parian_common_options common)
{
    parian_session *session = NULL;
    common.threads = 2;
    if (parian_session_create("parian-test", &common, &session) != PARIAN_OK) {
        _exit(98);
    }
    return session;
}

static int close_session(parian_session *session, parian_result result)
{
    int status = parian_session_exit(session, result);
    parian_session_destroy(session);
    return status;
}

static parian_result work_and_fail(const parian_env *env)
{
    parian_log(env, PARIAN_LOG_WARNING, "a hole\nwas closed");
    parian_log(env, PARIAN_LOG_INFO, "busy");
    parian_log(env, PARIAN_LOG_DEBUG, "details");
    parian_fail(env, PARIAN_E_FORMAT, "bad.obj: line 3: 'vx' found, 'v' expected");
    return parian_fail(env, PARIAN_E_FORMAT, "bad.obj: cannot be imported");
}

static int failing_tool(void)
{
    parian_session *session = open_session((parian_common_options){0});
    return close_session(session, work_and_fail(parian_session_env(session)));
}

static int quiet_failing_tool(void)
{
    parian_session *session = open_session((parian_common_options){.quiet = true, .progress = 2});
    parian_progress(parian_session_env(session), "import", 0.5);
    return close_session(session, work_and_fail(parian_session_env(session)));
}

static int silent_failing_tool(void)
{
    return close_session(open_session((parian_common_options){0}), PARIAN_E_NOMEM);
}

static int recovering_tool(void)
{
    parian_session *session = open_session((parian_common_options){0});
    parian_result result = work_and_fail(parian_session_env(session));
    (void)result;
    bool kept = parian_session_warning_count(session) == 1 &&
                strcmp(parian_session_warning(session, 0), "a hole was closed") == 0;
    int status = close_session(session, PARIAN_OK);
    return kept ? status : 97;
}

static int json_tool(void)
{
    parian_session *session = open_session((parian_common_options){.progress = 2});
    parian_progress(parian_session_env(session), "import", 0);
    parian_progress(parian_session_env(session), "import", 1);
    parian_progress(parian_session_env(session), "atlas", 0.25);
    return close_session(session, PARIAN_OK);
}

static void test_lines(void **state)
{
    static const char line[] = "parian-test: error: bad.obj: line 3: 'vx' found, 'v' expected\n";
    char text[TEXT_MAX], expected[TEXT_MAX];
    (void)state;
    assert_int_equal(run_tool(failing_tool, text), 3);
    snprintf(expected, sizeof expected,
             "parian-test: warning: a hole was closed\nparian-test: busy\n%s", line);
    assert_string_equal(text, expected);
    assert_int_equal(run_tool(quiet_failing_tool, text), 3);
    assert_string_equal(text, line);
    assert_int_equal(run_tool(silent_failing_tool, text), 4);
    assert_string_equal(text, "parian-test: error: out of memory\n");
    assert_int_equal(run_tool(recovering_tool, text), 0);
    assert_string_equal(text, "parian-test: warning: a hole was closed\nparian-test: busy\n");
}

static void test_progress_as_json(void **state)
{
    char text[TEXT_MAX];
    (void)state;
    assert_int_equal(run_tool(json_tool, text), 0);
    assert_non_null(strstr(text, "{\"stage\":\"import\",\"fraction\":0.000,\"seconds\":"));
    assert_non_null(strstr(text, "{\"stage\":\"import\",\"fraction\":1.000,"));
    assert_non_null(strstr(text, "{\"stage\":\"atlas\",\"fraction\":0.250,"));
}

/* ---- signals -----------------------------------------------------------------------------------
 */
static int interrupted_tool(void)
{
    parian_session *session = open_session((parian_common_options){0});
    const parian_env *env = parian_session_env(session);
    if (parian_cancelled(env)) {
        return 96;
    }
    raise(SIGTERM);
    return close_session(session, parian_cancelled(env) ? PARIAN_E_INTERRUPTED : PARIAN_OK);
}

static int twice_interrupted_tool(void)
{
    open_session((parian_common_options){0});
    parian_temp_register(test_scratch("half-written.tmp"));
    raise(SIGINT);
    raise(SIGINT);
    return 95;
}

static void test_signals(void **state)
{
    char text[TEXT_MAX];
    (void)state;
    assert_int_equal(run_tool(interrupted_tool, text), 130);
    assert_string_equal(text, "parian-test: error: interrupted\n");
    assert_int_equal(parian_file_write(NULL, test_scratch("half-written.tmp"), "x", 1), PARIAN_OK);
    assert_int_equal(run_tool(twice_interrupted_tool, text), 130);
    assert_int_not_equal(access(test_scratch("half-written.tmp"), F_OK), 0);
}

static void test_peak_memory(void **state)
{
    (void)state;
    assert_true(parian_peak_memory() > 1u << 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lines),           cmocka_unit_test(test_progress_as_json),
        cmocka_unit_test(test_signals),         cmocka_unit_test(test_peak_memory),
        cmocka_unit_test(test_each_index_once), cmocka_unit_test(test_threads_really_run_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
