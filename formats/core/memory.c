/* memory.c - checked allocation, logging and parallel-for through an env that may be NULL or zeroed.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LOG_LINE_MAX = 1024 };

void *parian_alloc(const parian_env *env, size_t count, size_t size)
{
    if (size != 0 && count > (SIZE_MAX / 2) / size) {
        return NULL;
    }
    size_t bytes = count * size;
    if (bytes == 0) {
        bytes = 1;
    }
    return env && env->alloc ? env->alloc(env->user, bytes) : malloc(bytes);
}

void *parian_zalloc(const parian_env *env, size_t count, size_t size)
{
    void *ptr;
    if (env && env->alloc) {
        ptr = parian_alloc(env, count, size);
        if (ptr) {
            memset(ptr, 0, count * size);
        }
        return ptr;
    }
    return calloc(count ? count : 1, size ? size : 1);
}

void parian_free(const parian_env *env, void *ptr)
{
    if (!ptr) {
        return;
    }
    if (env && env->free) {
        env->free(env->user, ptr);
    } else {
        free(ptr);
    }
}

static void log_va(const parian_env *env, parian_log_level level, const char *format, va_list args)
{
    char line[LOG_LINE_MAX];
    if (!env || !env->log) {
        return;
    }
    vsnprintf(line, sizeof line, format, args);
    env->log(env->user, level, line);
}

void parian_log(const parian_env *env, parian_log_level level, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_va(env, level, format, args);
    va_end(args);
}

parian_result parian_fail(const parian_env *env, parian_result result, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    log_va(env, PARIAN_LOG_ERROR, format, args);
    va_end(args);
    return result;
}

void parian_par(const parian_env *env, size_t count, void (*body)(void *context, size_t index),
                void *context)
{
    if (env && env->par) {
        env->par(env->user, count, body, context);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        body(context, i);
    }
}

void parian_progress(const parian_env *env, const char *stage, double fraction)
{
    if (env && env->progress) {
        env->progress(env->user, stage, fraction);
    }
}

bool parian_cancelled(const parian_env *env)
{
    return env && env->cancelled && env->cancelled(env->user);
}
