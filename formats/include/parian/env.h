/* env.h - what a library function may use of its surroundings: memory, log, threads.
 *
 * Parian's libraries never print, never exit, hold no mutable globals and own no threads. What they
 * need they take from this struct. A NULL or zeroed env means malloc/free, silence, one thread.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ENV_H
#define PARIAN_ENV_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum parian_log_level {
    PARIAN_LOG_ERROR = 0, /* one line for each failing call: what was found, expected, and where */
    PARIAN_LOG_WARNING = 1,
    PARIAN_LOG_INFO = 2,
    PARIAN_LOG_DEBUG = 3
} parian_log_level;

typedef struct parian_env {
    /* Allocate size bytes (never called with 0), aligned as malloc does; NULL on failure. */
    void *(*alloc)(void *user, size_t size);
    /* Free what alloc returned; ptr may be NULL. */
    void (*free)(void *user, void *ptr);
    /* Receive one line of text, without a newline. May be called from any thread of par. */
    void (*log)(void *user, parian_log_level level, const char *text);
    /* Call body(context, i) for every i in [0, count), in any order, on any number of threads; return
     * when all are done. Results never depend on the order. */
    void (*par)(void *user, size_t count, void (*body)(void *context, size_t index), void *context);
    /* Receive progress of a long function: fraction in [0, 1] of the named stage. May be NULL. */
    void (*progress)(void *user, const char *stage, double fraction);
    /* True when the caller wants out: long functions then return PARIAN_E_INTERRUPTED. May be NULL. */
    bool (*cancelled)(void *user);
    void *user;
} parian_env;

#ifdef __cplusplus
}
#endif
#endif
