/* npy.c - writes arrays in the .npy format, version 1.0.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"

enum { HEADER_MAX = 256, PREFIX_SIZE = 10, ALIGNMENT = 64 };

static const char *element_code(parian_element element)
{
    switch (element) {
    case PARIAN_ELEMENT_U8:
        return "|u1";
    case PARIAN_ELEMENT_S8:
        return "|i1";
    case PARIAN_ELEMENT_U16:
        return "<u2";
    case PARIAN_ELEMENT_S16:
        return "<i2";
    case PARIAN_ELEMENT_U32:
        return "<u4";
    case PARIAN_ELEMENT_S32:
        return "<i4";
    case PARIAN_ELEMENT_U64:
        return "<u8";
    case PARIAN_ELEMENT_F16:
        return "<f2";
    case PARIAN_ELEMENT_F32:
        return "<f4";
    case PARIAN_ELEMENT_F64:
        return "<f8";
    }
    return NULL;
}

/* Magic, length and the padded dictionary; returns the size. */
static size_t make_header(uint8_t header[HEADER_MAX], const char *code, uint32_t rank,
                          const uint64_t *shape)
{
    char *text = (char *)header + PREFIX_SIZE;
    size_t room = HEADER_MAX - PREFIX_SIZE;
    size_t used =
        (size_t)snprintf(text, room, "{'descr': '%s', 'fortran_order': False, 'shape': (", code);
    for (uint32_t i = 0; i < rank; i++) {
        used += (size_t)snprintf(text + used, room - used, i ? " %" PRIu64 "," : "%" PRIu64 ",",
                                 shape[i]);
    }
    if (rank > 1) {
        used--; /* only a single number needs its comma */
    }
    used += (size_t)snprintf(text + used, room - used, "), }");
    size_t size = (PREFIX_SIZE + used + 1 + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    memset(text + used, ' ', size - PREFIX_SIZE - used);
    header[size - 1] = '\n';
    memcpy(header, "\x93NUMPY\x01\x00", 8);
    header[8] = (uint8_t)((size - PREFIX_SIZE) & 0xff);
    header[9] = (uint8_t)((size - PREFIX_SIZE) >> 8);
    return size;
}

static char *npy_path(const parian_env *env, const char *folder, const char *name)
{
    size_t length = strlen(name);
    bool complete = length > 4 && strcmp(name + length - 4, ".npy") == 0;
    char full[256];
    if (snprintf(full, sizeof full, "%s%s", name, complete ? "" : ".npy") >= (int)sizeof full) {
        return NULL;
    }
    return parian_path_join(env, folder, full);
}

parian_result parian_npy_write(const parian_env *env, const char *folder, const char *name,
                               parian_element element, uint32_t rank, const uint64_t *shape,
                               const void *data)
{
    uint8_t header[HEADER_MAX];
    const char *code = element_code(element);
    size_t size = code ? parian_element_size(element) : 0;
    if (!code || rank > PARIAN_CHUNK_RANK_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "%s: no npy type for element %d of rank %u",
                           name, (int)element, (unsigned)rank);
    }
    for (uint32_t i = 0; i < rank; i++) {
        if (shape[i] != 0 && size > SIZE_MAX / shape[i]) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "%s: the array is larger than memory", name);
        }
        size *= shape[i];
    }
    char *path = npy_path(env, folder, name);
    if (!path) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its path", name);
    }
    parian_piece pieces[2] = {{header, make_header(header, code, rank, shape)}, {data, size}};
    parian_result result = parian_file_write_pieces(env, path, pieces, 2);
    parian_free(env, path);
    return result;
}
