/* temp_files.c - the temporary files that a signal handler has to remove.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

#include "tool/files.h"

enum { SLOT_COUNT = 16, PATH_LENGTH_MAX = 4096 };

/* A slot goes EMPTY -> BUSY -> FULL -> BUSY -> EMPTY; a handler touches only FULL ones, and only
 * reads. */
enum { SLOT_EMPTY = 0, SLOT_BUSY = 1, SLOT_FULL = 2 };

static struct {
    atomic_int state;
    char path[PATH_LENGTH_MAX];
} slots[SLOT_COUNT];

void parian_temp_register(const char *path)
{
    size_t length = strlen(path);
    if (length >= PATH_LENGTH_MAX) {
        return;
    }
    for (size_t i = 0; i < SLOT_COUNT; i++) {
        int expected = SLOT_EMPTY;
        if (atomic_compare_exchange_strong(&slots[i].state, &expected, SLOT_BUSY)) {
            memcpy(slots[i].path, path, length + 1);
            atomic_store(&slots[i].state, SLOT_FULL);
            return;
        }
    }
}

void parian_temp_unregister(const char *path)
{
    for (size_t i = 0; i < SLOT_COUNT; i++) {
        int expected = SLOT_FULL;
        if (atomic_load(&slots[i].state) == SLOT_FULL && strcmp(slots[i].path, path) == 0 &&
            atomic_compare_exchange_strong(&slots[i].state, &expected, SLOT_BUSY)) {
            atomic_store(&slots[i].state, SLOT_EMPTY);
            return;
        }
    }
}

void parian_temp_unlink_all(void)
{
    for (size_t i = 0; i < SLOT_COUNT; i++) {
        if (atomic_load(&slots[i].state) == SLOT_FULL) {
            unlink(slots[i].path);
        }
    }
}
