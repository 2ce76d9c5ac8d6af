/* chunk_table.h - header and table of a file: reading with every check, and writing.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CHUNK_TABLE_H
#define PARIAN_CHUNK_TABLE_H

#include "parian/format.h"

/* The bytes of a file and what stands for it in messages. */
typedef struct parian_file_view {
    const parian_env *env;
    const char *name;
    const uint8_t *data; /* [size] */
    uint64_t size;
} parian_file_view;

typedef struct parian_chunk_table {
    uint32_t chunk_count;
    uint64_t block_count;
    uint64_t table_offset;
    parian_chunk_info *chunk; /* [chunk_count] in the order of the file */
    uint64_t *first_block;    /* [chunk_count + 1] */
    uint64_t *block_offset;   /* [block_count] in the file */
    uint32_t *order;          /* [chunk_count] sorted by parian_chunk_info_order */
} parian_chunk_table;

/* Log "NAME: rule R: finding (at byte OFFSET)" and return result. */
#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
parian_result
parian_file_fail(const parian_file_view *file, parian_result result, int rule, uint64_t offset,
                 const char *format, ...);

/* Check header, table, places and padding; no allocation exceeds a small multiple of the file's
 * size. */
parian_result parian_chunk_table_read(const parian_file_view *file,
                                      const parian_reader_limits *limits,
                                      parian_chunk_table *table);
void parian_chunk_table_free(const parian_env *env, parian_chunk_table *table);

/* Stored bytes and checksum of a block. */
uint32_t parian_block_stored_size(const parian_file_view *file, const parian_chunk_table *table,
                                  uint64_t block);
uint64_t parian_block_checksum(const parian_file_view *file, const parian_chunk_table *table,
                               uint64_t block);

/* A block as the writer remembers it. */
typedef struct parian_block_record {
    uint32_t stored_size;
    uint64_t checksum;
} parian_block_record;

/* Bytes of a table, its content, and the header that goes with it. */
uint64_t parian_table_size(uint32_t chunk_count, uint64_t block_count);
void parian_table_encode(const parian_chunk_info *chunk, uint32_t chunk_count,
                         const parian_block_record *block, uint64_t block_count, uint8_t *bytes);
void parian_header_encode(const uint8_t *table, uint32_t chunk_count, uint64_t block_count,
                          uint64_t table_offset, uint32_t version_minor, uint8_t *header);

/* The bytes and the table behind a reader, for those who copy blocks as they are. */
const parian_file_view *parian_reader_file(const parian_reader *reader);
const parian_chunk_table *parian_reader_table(const parian_reader *reader);

#endif
