/* session.c - a tool's surroundings: threads, log to stderr, progress bar, Ctrl-C.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/session.h"

#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "tool/files.h"
#include "tool/progress.h"
#include "tool/thread_pool.h"

enum {
    WARNINGS_KEPT_MAX = 1000, /* a flood is printed, but not kept */
    EXIT_INTERRUPTED = 130,
    ARENAS_MAX = 4 /* each reserves 64 MiB of address space, which runs under a limit would miss */
};

struct parian_session {
    char *tool;
    bool quiet, verbose, colour;
    parian_env env;
    parian_thread_pool *pool;
    pthread_mutex_t mutex; /* everything below */
    parian_progress_display progress;
    char *error; /* the first error line since the last exit */
    char **warning;
    size_t warning_count;
};

static volatile sig_atomic_t signal_count;

static void on_signal(int number)
{
    (void)number;
    signal_count = signal_count + 1;
    if (signal_count > 1) {
        parian_temp_unlink_all();
        _exit(EXIT_INTERRUPTED);
    }
}

static void install_signals(void)
{
    struct sigaction action = {.sa_handler = on_signal};
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    signal_count = 0;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ, SIG_IGN); /* a file size limit is then an error of write(), not a death */
}

/* A copy in which control characters (of file names, of foreign messages) cannot break the line. */
static char *copy_line(const char *text)
{
    char *line = strdup(text);
    for (char *c = line; c && *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f) {
            *c = *c == '\t' || *c == '\n' ? ' ' : '?';
        }
    }
    return line;
}

static void print_line(parian_session *session, parian_log_level level, const char *line)
{
    static const char *const label[] = {"error: ", "warning: ", "", ""};
    static const char *const paint[] = {"\033[1;31m", "\033[1;33m", "", ""};
    bool colour = session->colour && paint[level][0];
    parian_progress_clear(&session->progress);
    fprintf(stderr, "%s: %s%s%s%s\n", session->tool, colour ? paint[level] : "", label[level],
            colour ? "\033[0m" : "", line);
}

static void keep_warning(parian_session *session, const char *line)
{
    if (session->warning_count >= WARNINGS_KEPT_MAX) {
        return;
    }
    if (!session->warning) {
        session->warning = calloc(WARNINGS_KEPT_MAX, sizeof *session->warning);
    }
    char *copy = session->warning ? strdup(line) : NULL;
    if (copy) {
        session->warning[session->warning_count++] = copy;
    }
}

static void session_log(void *user, parian_log_level level, const char *text)
{
    parian_session *session = user;
    char *line = copy_line(text);
    if (!line) {
        return;
    }
    pthread_mutex_lock(&session->mutex);
    if (level == PARIAN_LOG_ERROR && !session->error) {
        session->error = line;
        line = NULL;
    } else {
        bool shown = level <= PARIAN_LOG_ERROR || level >= PARIAN_LOG_DEBUG ? session->verbose
                                                                            : !session->quiet;
        if (level == PARIAN_LOG_WARNING) {
            keep_warning(session, line);
        }
        if (shown && !session->quiet) {
            print_line(session, level, line);
        }
    }
    pthread_mutex_unlock(&session->mutex);
    free(line);
}

static void session_par(void *user, size_t count, void (*body)(void *, size_t), void *context)
{
    parian_session *session = user;
    parian_thread_pool_run(session->pool, count, body, context);
}

static void session_progress(void *user, const char *stage, double fraction)
{
    parian_session *session = user;
    pthread_mutex_lock(&session->mutex);
    parian_progress_show(&session->progress, stage, fraction);
    pthread_mutex_unlock(&session->mutex);
}

static bool session_cancelled(void *user)
{
    (void)user;
    return signal_count > 0;
}

static void *session_alloc(void *user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void session_free(void *user, void *ptr)
{
    (void)user;
    free(ptr);
}

static parian_progress_mode choose_progress(const parian_common_options *common)
{
    if (common->quiet) {
        return PARIAN_PROGRESS_NONE;
    }
    if (common->progress == PARIAN_PROGRESS_AUTO) {
        const char *term = getenv("TERM");
        bool dumb = !term || strcmp(term, "dumb") == 0;
        return isatty(STDERR_FILENO) && !dumb ? PARIAN_PROGRESS_BAR : PARIAN_PROGRESS_NONE;
    }
    return (parian_progress_mode)common->progress;
}

static bool want_colour(void)
{
    const char *no_color = getenv("NO_COLOR");
    return isatty(STDERR_FILENO) && !(no_color && no_color[0]);
}

parian_result parian_session_create(const char *tool, const parian_common_options *common,
                                    parian_session **out)
{
    parian_session *session = calloc(1, sizeof *session);
    mallopt(M_ARENA_MAX, ARENAS_MAX);
    if (!session || !(session->tool = strdup(tool)) ||
        parian_thread_pool_create(common->threads, &session->pool) != PARIAN_OK) {
        fprintf(stderr, "%s: error: %s\n", tool, parian_result_text(PARIAN_E_NOMEM));
        free(session ? session->tool : NULL);
        free(session);
        return PARIAN_E_NOMEM;
    }
    pthread_mutex_init(&session->mutex, NULL);
    session->quiet = common->quiet;
    session->verbose = common->verbose;
    session->colour = want_colour();
    session->progress.mode = choose_progress(common);
    session->env = (parian_env){.alloc = session_alloc,
                                .free = session_free,
                                .log = session_log,
                                .par = session_par,
                                .progress = session_progress,
                                .cancelled = session_cancelled,
                                .user = session};
    install_signals();
    *out = session;
    return PARIAN_OK;
}

void parian_session_destroy(parian_session *session)
{
    if (!session) {
        return;
    }
    parian_session_end_progress(session);
    parian_thread_pool_destroy(session->pool);
    for (size_t i = 0; i < session->warning_count; i++) {
        free(session->warning[i]);
    }
    free(session->warning);
    free(session->error);
    free(session->tool);
    pthread_mutex_destroy(&session->mutex);
    free(session);
}

const parian_env *parian_session_env(parian_session *session)
{
    return &session->env;
}

void parian_session_end_progress(parian_session *session)
{
    pthread_mutex_lock(&session->mutex);
    parian_progress_clear(&session->progress);
    pthread_mutex_unlock(&session->mutex);
}

int parian_session_exit(parian_session *session, parian_result result)
{
    pthread_mutex_lock(&session->mutex);
    parian_progress_clear(&session->progress);
    if (result == PARIAN_E_INTERRUPTED) {
        print_line(session, PARIAN_LOG_ERROR, parian_result_text(result));
    } else if (result != PARIAN_OK) {
        print_line(session, PARIAN_LOG_ERROR,
                   session->error ? session->error : parian_result_text(result));
    }
    free(session->error);
    session->error = NULL;
    pthread_mutex_unlock(&session->mutex);
    return parian_result_exit_status(result);
}

size_t parian_session_warning_count(const parian_session *session)
{
    return session->warning_count;
}

const char *parian_session_warning(const parian_session *session, size_t index)
{
    return session->warning[index];
}

double parian_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

unsigned long long parian_peak_memory(void)
{
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) {
        return 0;
    }
    return (unsigned long long)usage.ru_maxrss * 1024u;
}
