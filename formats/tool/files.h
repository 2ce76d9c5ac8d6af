/* files.h - reading whole files, writing them atomically, folders, npy arrays.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_FILES_H
#define PARIAN_TOOL_FILES_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/format.h"
#include "parian/result.h"

/* Read a whole file (at most size_max bytes; "-" is stdin); one NUL is added behind it. */
parian_result parian_file_read(const parian_env *env, const char *path, uint64_t size_max, uint8_t **data,
                               size_t *size);
/* Write to a temporary file beside the target and rename; "-" is stdout. */
parian_result parian_file_write(const parian_env *env, const char *path, const void *data, size_t size);
/* Create a folder and its parents. */
parian_result parian_folder_create(const parian_env *env, const char *path);
/* XXH3-64 of a file's bytes. */
parian_result parian_file_hash(const parian_env *env, const char *path, uint64_t *hash);

/* Write FOLDER/NAME as a little-endian C-order .npy (version 1.0). Element types as in the container. */
parian_result parian_npy_write(const parian_env *env, const char *folder, const char *name,
                               parian_element element, uint32_t rank, const uint64_t *shape, const void *data);

#endif
