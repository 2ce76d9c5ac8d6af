/* picture_internal.h - what the readers and writers of pictures share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_PICTURE_INTERNAL_H
#define PARIAN_TOOL_PICTURE_INTERNAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* Bytes in memory that a codec library reads from or writes to. */
typedef struct parian_byte_stream {
    const parian_env *env;
    uint8_t *data;
    size_t size, capacity, position;
} parian_byte_stream;

/* Put bytes at an offset, growing the stream; false when there is no memory. */
bool parian_byte_stream_put(parian_byte_stream *stream, size_t offset, const void *data,
                            size_t size);

/* PARIAN_E_LIMIT unless both sides and the area are within the limits of pictures. */
parian_result parian_picture_check_size(const parian_env *env, const char *path, uint64_t width,
                                        uint64_t height);

/* As parian_exr_read, for DWAA and DWAB compression; values are halves. */
parian_result parian_exr_read_dwa(const parian_env *env, const char *path, uint32_t *width,
                                  uint32_t *height, float (**rgb)[3]);

#endif
