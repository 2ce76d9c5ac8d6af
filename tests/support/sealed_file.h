/* sealed_file.h - the bytes of an asset that can be changed and given fitting checksums again.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_SEALED_FILE_H
#define PARIAN_TEST_SEALED_FILE_H

#include <stddef.h>
#include <stdint.h>

#include "core/body.h"

typedef struct sealed_file {
    uint8_t *data; /* [size], malloc */
    size_t size;
} sealed_file;

/* Write a scene to path and load the bytes. */
sealed_file sealed_file_make(const parian_scene_data *scene, const char *path, bool no_compression);
/* Make header, table and block checksums fit what is there, as far as table and blocks lie in the
 * file. */
void sealed_file_seal(sealed_file *file);

/* Places in the file: of a header field, of a field of chunk entry `chunk`, of a field of block
 * entry `block`. */
size_t sealed_file_entry(const sealed_file *file, uint32_t chunk);
size_t sealed_file_block(const sealed_file *file, uint64_t block);

/* An env that refuses to allocate more than `limit` bytes in all, and remembers that it was asked
 * to. */
typedef struct limited_memory {
    size_t limit, live, peak;
    int refused;
    char error[1024]; /* the last error line */
} limited_memory;
parian_env limited_env(limited_memory *memory);

#endif
