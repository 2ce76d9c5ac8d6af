/* frame_memory.c - memory that is freed and asked for again each frame, kept in between.
 *
 * SPDX-License-Identifier: MIT
 */
#include "frame_memory.h"

#include <stddef.h>

#include "core/memory.h"

/* What stands before each block. */
typedef struct parian_frame_block {
    size_t size;    /* bytes that follow */
    uint32_t freed; /* frame in which it was freed */
    max_align_t bytes[];
} frame_block;

static void lock(parian_frame_memory *memory)
{
    while (atomic_flag_test_and_set_explicit(&memory->busy, memory_order_acquire)) {
    }
}

static void unlock(parian_frame_memory *memory)
{
    atomic_flag_clear_explicit(&memory->busy, memory_order_release);
}

/* The smallest kept block that holds size bytes without wasting more than it uses. */
static frame_block *take(parian_frame_memory *memory, size_t size)
{
    uint32_t best = memory->count;
    for (uint32_t i = 0; i < memory->count; i++) {
        size_t held = memory->block[i]->size;
        if (held >= size && held / 2 <= size &&
            (best == memory->count || held < memory->block[best]->size)) {
            best = i;
        }
    }
    if (best == memory->count) {
        return NULL;
    }
    frame_block *block = memory->block[best];
    memory->block[best] = memory->block[--memory->count];
    return block;
}

static void *frame_alloc(void *user, size_t size)
{
    parian_frame_memory *memory = user;
    lock(memory);
    frame_block *block = take(memory, size);
    unlock(memory);
    if (!block && size < SIZE_MAX / 2) {
        block = parian_alloc(&memory->parent, 1, sizeof *block + size);
        if (block) {
            block->size = size;
        }
    }
    return block ? block->bytes : NULL;
}

static void frame_free(void *user, void *ptr)
{
    parian_frame_memory *memory = user;
    if (!ptr) {
        return;
    }
    frame_block *block = (frame_block *)((char *)ptr - offsetof(frame_block, bytes));
    lock(memory);
    if (memory->count < PARIAN_FRAME_BLOCKS) {
        block->freed = memory->now;
        memory->block[memory->count++] = block;
        block = NULL;
    }
    unlock(memory);
    parian_free(&memory->parent, block);
}

/* ---- the application's other functions ---- */

static void frame_log(void *user, parian_log_level level, const char *text)
{
    const parian_env *parent = &((parian_frame_memory *)user)->parent;
    parent->log(parent->user, level, text);
}

static void frame_par(void *user, size_t count, void (*body)(void *context, size_t index),
                      void *context)
{
    const parian_env *parent = &((parian_frame_memory *)user)->parent;
    parent->par(parent->user, count, body, context);
}

static void frame_progress(void *user, const char *stage, double fraction)
{
    const parian_env *parent = &((parian_frame_memory *)user)->parent;
    parent->progress(parent->user, stage, fraction);
}

static bool frame_cancelled(void *user)
{
    const parian_env *parent = &((parian_frame_memory *)user)->parent;
    return parent->cancelled(parent->user);
}

void parian_frame_memory_init(parian_frame_memory *memory, const parian_env *parent,
                              parian_env *env)
{
    const parian_env nothing = {.user = NULL};
    *memory = (parian_frame_memory){.parent = parent ? *parent : nothing, .busy = ATOMIC_FLAG_INIT};
    parent = &memory->parent;
    *env = (parian_env){.alloc = frame_alloc,
                        .free = frame_free,
                        .log = parent->log ? frame_log : NULL,
                        .par = parent->par ? frame_par : NULL,
                        .progress = parent->progress ? frame_progress : NULL,
                        .cancelled = parent->cancelled ? frame_cancelled : NULL,
                        .user = memory};
}

/* ---- giving back ---- */

static void give_back(parian_frame_memory *memory, uint32_t age_min)
{
    lock(memory);
    for (uint32_t i = memory->count; i-- > 0;) {
        if (memory->now - memory->block[i]->freed >= age_min) {
            parian_free(&memory->parent, memory->block[i]);
            memory->block[i] = memory->block[--memory->count];
        }
    }
    unlock(memory);
}

void parian_frame_memory_tick(parian_frame_memory *memory)
{
    memory->now++;
    give_back(memory, PARIAN_FRAME_AGE_MAX);
}

void parian_frame_memory_trim(parian_frame_memory *memory)
{
    give_back(memory, 0);
}
