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

/* Read a whole file (at most size_max bytes; "-" is stdin); one NUL is added behind it.
 * Errors: PARIAN_E_IO, PARIAN_E_LIMIT, PARIAN_E_NOMEM. */
parian_result parian_file_read(const parian_env *env, const char *path, uint64_t size_max,
                               uint8_t **data, size_t *size);
/* Write to a temporary file beside the target and rename; "-" is stdout. Missing folders of the
 * path are created. What is not a regular file (a pipe, /dev/null) is written to directly. Errors:
 * PARIAN_E_IO. */
parian_result parian_file_write(const parian_env *env, const char *path, const void *data,
                                size_t size);

/* The same from pieces that follow each other. */
typedef struct parian_piece {
    const void *data;
    size_t size;
} parian_piece;
parian_result parian_file_write_pieces(const parian_env *env, const char *path,
                                       const parian_piece *pieces, size_t count);

/* Create a folder and its parents; fine if it exists. Errors: PARIAN_E_IO. */
parian_result parian_folder_create(const parian_env *env, const char *path);
/* The same for the folder that a file of this path would be in. */
parian_result parian_folder_create_parent(const parian_env *env, const char *path);
/* FOLDER/NAME; free with parian_free. NULL when there is no memory. */
char *parian_path_join(const parian_env *env, const char *folder, const char *name);
/* The folder part of a path ("." if it has none); free with parian_free. NULL when there is no
 * memory. */
char *parian_path_folder(const parian_env *env, const char *path);

/* XXH3-64 of a file's bytes. Errors: PARIAN_E_IO. */
parian_result parian_file_hash(const parian_env *env, const char *path, uint64_t *hash);

/* Write FOLDER/NAME as a little-endian C-order .npy (version 1.0); ".npy" is added to a name
 * without it. Element types as in the container. Errors: PARIAN_E_ARGUMENT, PARIAN_E_IO. */
parian_result parian_npy_write(const parian_env *env, const char *folder, const char *name,
                               parian_element element, uint32_t rank, const uint64_t *shape,
                               const void *data);

/* An array of numbers as a .npy file holds it, in doubles and C order. */
typedef struct parian_npy {
    uint32_t rank;
    uint64_t shape[PARIAN_CHUNK_RANK_MAX];
    size_t count; /* product of the shape */
    double *value;
} parian_npy;

/* Read a .npy file (versions 1 to 3, little-endian floats and integers); free with parian_npy_free in every
 * case. Errors: PARIAN_E_IO, PARIAN_E_FORMAT (what was found), PARIAN_E_LIMIT, PARIAN_E_NOMEM. */
parian_result parian_npy_read(const parian_env *env, const char *path, parian_npy *array);
void parian_npy_free(const parian_env *env, parian_npy *array);

/* Temporary files that must go when a second Ctrl-C ends the process at once. A few slots; a path
 * that finds none, or is too long, is simply not remembered. Any thread. */
void parian_temp_register(const char *path);
void parian_temp_unregister(const char *path);
/* Unlink what is registered: async-signal-safe. */
void parian_temp_unlink_all(void);

#endif
