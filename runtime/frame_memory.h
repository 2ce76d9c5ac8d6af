/* frame_memory.h - memory that is freed and asked for again each frame, kept in between.
 *
 * An env that serves what it can from blocks that were freed lately. So a renderer that relights
 * and draws the same thing over and over asks its application for memory in the first frames alone.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_FRAME_MEMORY_H
#define PARIAN_FRAME_MEMORY_H

#include <stdatomic.h>
#include <stdint.h>

#include "parian/env.h"

enum { PARIAN_FRAME_BLOCKS = 64, PARIAN_FRAME_AGE_MAX = 256 };

typedef struct parian_frame_memory {
    parian_env parent; /* of the application */
    atomic_flag busy;
    uint32_t now, count;
    struct parian_frame_block *block[PARIAN_FRAME_BLOCKS]; /* [count] freed ones that are kept */
} parian_frame_memory;

/* Start with the application's env (NULL as everywhere) and make the env that keeps blocks: its
 * functions are those of the application but for memory. memory stays where it is as long as env is
 * used. Threads: env may be used by several at a time. */
void parian_frame_memory_init(parian_frame_memory *memory, const parian_env *parent,
                              parian_env *env);
/* A frame begins: blocks that were not used for PARIAN_FRAME_AGE_MAX of them are given back. */
void parian_frame_memory_tick(parian_frame_memory *memory);
/* Give back all blocks that are kept. */
void parian_frame_memory_trim(parian_frame_memory *memory);

#endif
