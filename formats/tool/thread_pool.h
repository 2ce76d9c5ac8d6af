/* thread_pool.h - a pool of threads that share out the pieces of a parallel-for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_THREAD_POOL_H
#define PARIAN_TOOL_THREAD_POOL_H

#include <stddef.h>

#include "parian/result.h"

typedef struct parian_thread_pool parian_thread_pool;

/* threads: how many work at once, the calling thread included; 0 takes one for each core that this
 * process may use. At most 64, or the cores if they are more, are made, and fewer when the system
 * refuses. Errors: PARIAN_E_NOMEM. */
parian_result parian_thread_pool_create(unsigned threads, parian_thread_pool **pool);
/* Ends and joins the threads; NULL is fine. */
void parian_thread_pool_destroy(parian_thread_pool *pool);

/* Call body for every index in [0, count) and return when all are done. The calling thread works
 * too. From inside a body, or while another thread uses the pool, the pieces run in a plain loop on
 * the caller. */
void parian_thread_pool_run(parian_thread_pool *pool, size_t count,
                            void (*body)(void *context, size_t index), void *context);

unsigned parian_thread_pool_size(const parian_thread_pool *pool);

#endif
