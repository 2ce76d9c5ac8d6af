/* thread_pool.c - a pool of threads that share out the pieces of a parallel-for.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/thread_pool.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

/* Threads beyond the cores only cost address space, which runs under a limit would miss. */
enum {
    THREADS_BEYOND_CORES_MAX = 64,
    STACK_SIZE = 2 << 20,
    PIECES_PER_THREAD = 32,
    GRAIN_MAX = 256
};

struct parian_thread_pool {
    unsigned size; /* workers and the caller */
    pthread_t *worker;
    pthread_mutex_t user; /* held by the thread whose job runs */
    pthread_mutex_t mutex;
    pthread_cond_t wake, done;
    unsigned long job; /* number of the current job; a worker runs each once */
    unsigned busy;     /* workers that have not finished the current job */
    bool quit;
    /* The current job. */
    void (*body)(void *context, size_t index);
    void *context;
    size_t count, grain;
    atomic_size_t next;
};

/* Set on a thread that is inside a body, so that a nested call runs inline. */
static _Thread_local bool inside_job;

static void take_pieces(parian_thread_pool *pool)
{
    inside_job = true;
    for (;;) {
        size_t first = atomic_fetch_add_explicit(&pool->next, pool->grain, memory_order_relaxed);
        if (first >= pool->count) {
            break;
        }
        size_t end = pool->count - first < pool->grain ? pool->count : first + pool->grain;
        for (size_t i = first; i < end; i++) {
            pool->body(pool->context, i);
        }
    }
    inside_job = false;
}

static void *worker_main(void *argument)
{
    parian_thread_pool *pool = argument;
    unsigned long seen = 0;
    pthread_mutex_lock(&pool->mutex);
    for (;;) {
        while (pool->job == seen && !pool->quit) {
            pthread_cond_wait(&pool->wake, &pool->mutex);
        }
        if (pool->quit) {
            break;
        }
        seen = pool->job;
        pthread_mutex_unlock(&pool->mutex);
        take_pieces(pool);
        pthread_mutex_lock(&pool->mutex);
        if (--pool->busy == 0) {
            pthread_cond_signal(&pool->done);
        }
    }
    pthread_mutex_unlock(&pool->mutex);
    return NULL;
}

static unsigned core_count(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) {
        return (unsigned)CPU_COUNT(&set);
    }
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 ? (unsigned)online : 1;
}

static void start_workers(parian_thread_pool *pool, unsigned wanted)
{
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, STACK_SIZE);
    while (pool->size < wanted) {
        if (pthread_create(&pool->worker[pool->size - 1], &attributes, worker_main, pool) != 0) {
            break;
        }
        pool->size++;
    }
    pthread_attr_destroy(&attributes);
}

parian_result parian_thread_pool_create(unsigned threads, parian_thread_pool **out)
{
    parian_thread_pool *pool = calloc(1, sizeof *pool);
    if (!pool) {
        return PARIAN_E_NOMEM;
    }
    const unsigned cores = core_count();
    const unsigned threads_max =
        cores > THREADS_BEYOND_CORES_MAX ? cores : THREADS_BEYOND_CORES_MAX;
    threads = threads ? threads : cores;
    threads = threads < threads_max ? threads : threads_max;
    pool->worker = calloc(threads, sizeof *pool->worker);
    if (!pool->worker) {
        free(pool);
        return PARIAN_E_NOMEM;
    }
    pthread_mutex_init(&pool->user, NULL);
    pthread_mutex_init(&pool->mutex, NULL);
    pthread_cond_init(&pool->wake, NULL);
    pthread_cond_init(&pool->done, NULL);
    pool->size = 1;
    start_workers(pool, threads);
    *out = pool;
    return PARIAN_OK;
}

void parian_thread_pool_destroy(parian_thread_pool *pool)
{
    if (!pool) {
        return;
    }
    pthread_mutex_lock(&pool->mutex);
    pool->quit = true;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    for (unsigned i = 0; i + 1 < pool->size; i++) {
        pthread_join(pool->worker[i], NULL);
    }
    pthread_cond_destroy(&pool->done);
    pthread_cond_destroy(&pool->wake);
    pthread_mutex_destroy(&pool->mutex);
    pthread_mutex_destroy(&pool->user);
    free(pool->worker);
    free(pool);
}

static void run_shared(parian_thread_pool *pool, size_t count, void (*body)(void *, size_t),
                       void *context)
{
    size_t grain = count / ((size_t)pool->size * PIECES_PER_THREAD);
    pthread_mutex_lock(&pool->mutex);
    pool->body = body;
    pool->context = context;
    pool->count = count;
    pool->grain = grain < 1 ? 1 : grain > GRAIN_MAX ? GRAIN_MAX : grain;
    atomic_store(&pool->next, 0);
    pool->busy = pool->size - 1;
    pool->job++;
    pthread_cond_broadcast(&pool->wake);
    pthread_mutex_unlock(&pool->mutex);
    take_pieces(pool);
    pthread_mutex_lock(&pool->mutex);
    while (pool->busy > 0) {
        pthread_cond_wait(&pool->done, &pool->mutex);
    }
    pthread_mutex_unlock(&pool->mutex);
}

void parian_thread_pool_run(parian_thread_pool *pool, size_t count, void (*body)(void *, size_t),
                            void *context)
{
    if (pool->size > 1 && count > 1 && !inside_job && pthread_mutex_trylock(&pool->user) == 0) {
        run_shared(pool, count, body, context);
        pthread_mutex_unlock(&pool->user);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        body(context, i);
    }
}

unsigned parian_thread_pool_size(const parian_thread_pool *pool)
{
    return pool->size;
}
