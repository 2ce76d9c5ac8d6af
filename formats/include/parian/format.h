/* format.h - reading and writing .parian files: a container of typed, named, shaped arrays.
 *
 * The byte layout is specified in docs/format.md, which outranks this code.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_FORMAT_H
#define PARIAN_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* what a shared library exports */
#endif

enum {
    PARIAN_FORMAT_VERSION = 1, /* major: a reader refuses any other */
    PARIAN_FORMAT_VERSION_MINOR = 0,
    PARIAN_CHUNK_NAME_MAX = 40, /* bytes with the terminating NUL */
    PARIAN_CHUNK_RANK_MAX = 4,
    PARIAN_BLOCK_SIZE = 1 << 20 /* bytes of a block before coding */
};

typedef enum parian_element {
    PARIAN_ELEMENT_U8 = 1,
    PARIAN_ELEMENT_S8 = 2,
    PARIAN_ELEMENT_U16 = 3,
    PARIAN_ELEMENT_S16 = 4,
    PARIAN_ELEMENT_U32 = 5,
    PARIAN_ELEMENT_S32 = 6,
    PARIAN_ELEMENT_U64 = 7,
    PARIAN_ELEMENT_F16 = 8,
    PARIAN_ELEMENT_F32 = 9,
    PARIAN_ELEMENT_F64 = 10
} parian_element;

/* Bytes of an element, or 0 for an unknown type; its short name ("f32"), or NULL. */
size_t parian_element_size(parian_element element);
const char *parian_element_name(parian_element element);

/* Codecs are flags of transforms, then zstd. RAW chunks are one contiguous range aligned to 64 bytes. */
typedef enum parian_codec {
    PARIAN_CODEC_RAW = 0,
    PARIAN_CODEC_ZSTD = 1,         /* zstd of the plain bytes */
    PARIAN_CODEC_SHUFFLE_ZSTD = 2, /* bytes grouped by significance within a block, then zstd */
    PARIAN_CODEC_DELTA_ZSTD = 3    /* integers: difference to the previous element (mod 2^n), shuffled, zstd */
} parian_codec;

/* "raw", "zstd", "shuffle+zstd", "delta+zstd"; NULL for an unknown codec. */
const char *parian_codec_name(parian_codec codec);

enum { PARIAN_CHUNK_REQUIRED = 1u }; /* a reader that does not know the chunk must refuse the file */
#define PARIAN_CHUNK_FLAGS_UNUSED 0xffff0000u /* a later minor version may give them a meaning */

/* Description of a chunk: a typed array with a shape, of one object and level of detail. */
typedef struct parian_chunk_info {
    char name[PARIAN_CHUNK_NAME_MAX]; /* semantic, e.g. "texel.area": [a-z0-9_.]+ */
    uint32_t object;
    uint32_t level;
    parian_element element;
    parian_codec codec;
    uint32_t flags;
    uint32_t rank;
    uint64_t shape[PARIAN_CHUNK_RANK_MAX]; /* [rank], slowest first; the rest is 0 */
    uint64_t size;        /* bytes of the decoded array */
    uint64_t offset;      /* in the file; set by the reader */
    uint64_t stored_size; /* bytes in the file; set by the reader */
} parian_chunk_info;

/* ------------------------------------------------------------------------------------------------
 * Writing. Nothing appears under the target's name before finish has succeeded. */
typedef struct parian_writer parian_writer;
typedef struct parian_reader parian_reader;

typedef struct parian_writer_desc {
    const char *path;      /* target; the bytes go to a temporary file beside it first */
    int compression_level; /* zstd level, 1 to 19; 0 takes 3 */
    bool no_compression;   /* every chunk raw */
    uint32_t version_minor; /* the file states at least this one; 0: the lowest that has what is written */
} parian_writer_desc;

/* Errors: PARIAN_E_ARGUMENT, PARIAN_E_IO, PARIAN_E_NOMEM. Threads: a writer belongs to one thread; blocks
 * are coded through env->par. env is copied; its functions must stay valid until finish or abort. */
parian_result parian_writer_begin(const parian_env *env, const parian_writer_desc *desc,
                                  parian_writer **writer);

/* Append one chunk. info: name, object, level, element, codec, flags, rank, shape are read; the codec is
 * replaced by RAW when coding does not make the chunk smaller. data: [info->size] bytes (size is derived
 * from the shape), may be NULL for an empty array. (name, object, level) must be new.
 * Errors: PARIAN_E_ARGUMENT, PARIAN_E_IO, PARIAN_E_NOMEM; after an error only abort is allowed. */
parian_result parian_writer_chunk(parian_writer *writer, const parian_chunk_info *info, const void *data);

/* Append a chunk of another file as it is stored there: entry, flags of later versions and coded blocks stay byte
 * for byte. The blocks are checked. Errors: as of parian_writer_chunk and parian_reader_read. */
parian_result parian_writer_copy(parian_writer *writer, const parian_reader *reader, uint32_t index);

/* The env that the writer was begun with, and the temporary file that it writes (to be unlinked by a handler
 * that ends the process at once). */
const parian_env *parian_writer_env(const parian_writer *writer);
const char *parian_writer_temporary(const parian_writer *writer);

/* Write the table, flush, rename. Frees the writer in every case; on error no file is left. */
parian_result parian_writer_finish(parian_writer *writer);

/* Give up: remove the temporary file, free the writer. NULL is fine. */
void parian_writer_abort(parian_writer *writer);

/* ------------------------------------------------------------------------------------------------
 * Reading. Files are always validated: header and table on open, every block before its bytes are used. */
typedef struct parian_reader_limits {
    uint64_t chunk_count_max;  /* 0 takes 65,536 */
    uint64_t decoded_size_max; /* bytes of one chunk; 0 takes 2^36; never above what the file can hold */
    uint64_t expansion_max;    /* all chunks together: 64 MiB and this times the file's size; 0 takes 64 */
} parian_reader_limits;

/* Map and validate the header and table of a file. limits may be NULL.
 * Errors: PARIAN_E_IO, PARIAN_E_FORMAT (log names rule and byte offset), PARIAN_E_UNSUPPORTED (newer
 * major version; an element or codec that only a newer minor version can have; an unknown required chunk is
 * judged by the schema, not here), PARIAN_E_LIMIT, PARIAN_E_NOMEM.
 * Threads: one thread per reader, except that the const functions may be called from many. */
parian_result parian_reader_open(const parian_env *env, const char *path, const parian_reader_limits *limits,
                                 parian_reader **reader);
/* The same from bytes that the caller keeps alive; name stands for the file in messages. */
parian_result parian_reader_open_memory(const parian_env *env, const char *name, const void *data, size_t size,
                                        const parian_reader_limits *limits, parian_reader **reader);
void parian_reader_close(parian_reader *reader);

uint32_t parian_reader_chunk_count(const parian_reader *reader);
const parian_chunk_info *parian_reader_chunk(const parian_reader *reader, uint32_t index);
uint64_t parian_reader_file_size(const parian_reader *reader);
uint32_t parian_reader_version_minor(const parian_reader *reader); /* that the file states; the major is ours */
const char *parian_reader_name(const parian_reader *reader); /* the path or name it was opened with */
/* Index of a chunk, or -1. */
int64_t parian_reader_find(const parian_reader *reader, const char *name, uint32_t object, uint32_t level);

/* Decode a chunk into destination: [info->size] bytes. Checks every block's checksum. */
parian_result parian_reader_read(const parian_reader *reader, uint32_t index, void *destination);
/* Do everything that read does, and keep nothing. */
parian_result parian_reader_check(const parian_reader *reader, uint32_t index);
/* Pointer into the mapping of a RAW chunk after its blocks' checksums were verified, without a copy; valid
 * until close. PARIAN_E_UNSUPPORTED for a coded chunk. */
parian_result parian_reader_map(const parian_reader *reader, uint32_t index, const void **data);
/* The same without a look at the blocks: for files that were verified before, since damage goes unnoticed. */
parian_result parian_reader_map_unverified(const parian_reader *reader, uint32_t index, const void **data);
/* Verify everything that can be verified without the schema: what open has verified (header, table, zero
 * padding, no stray or overlapping bytes), and every block. The first finding is logged with its rule number
 * and byte offset. */
parian_result parian_reader_verify(const parian_reader *reader);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
