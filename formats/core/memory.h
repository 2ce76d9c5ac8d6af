/* memory.h - checked allocation, logging and parallel-for through an env that may be NULL or zeroed.
 *
 * Internal to Parian's own libraries and tools.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_MEMORY_H
#define PARIAN_CORE_MEMORY_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Allocate count elements of size bytes. A product that overflows is NULL, as is no memory. A count of
 * zero gives a valid pointer that must be freed. Contents are undefined (alloc) or zero (zalloc). */
void *parian_alloc(const parian_env *env, size_t count, size_t size);
void *parian_zalloc(const parian_env *env, size_t count, size_t size);
/* Free what parian_alloc gave; NULL is fine. */
void parian_free(const parian_env *env, void *ptr);

/* Allocate and store in a typed pointer; evaluates to false when there is no memory.
 *   float(*p)[3];  if (!PARIAN_NEW(env, p, n)) ... */
#define PARIAN_NEW(env, ptr, count) (((ptr) = parian_alloc((env), (count), sizeof *(ptr))) != NULL)
#define PARIAN_NEW0(env, ptr, count) (((ptr) = parian_zalloc((env), (count), sizeof *(ptr))) != NULL)

/* Send a printf-formatted line to env->log; silent without one. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void parian_log(const parian_env *env, parian_log_level level, const char *format, ...);

/* Log an error line and return result, so that a failing path is one statement. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
parian_result parian_fail(const parian_env *env, parian_result result, const char *format, ...);

/* Call body for every index, through env->par or in a plain loop. Split work into pieces whose number
 * does not depend on the number of threads. */
void parian_par(const parian_env *env, size_t count, void (*body)(void *context, size_t index),
                void *context);

void parian_progress(const parian_env *env, const char *stage, double fraction);
bool parian_cancelled(const parian_env *env);

#ifdef __cplusplus
}
#endif
#endif
