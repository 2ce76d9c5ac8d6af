/* chunk_table_encode.c - the bytes of table and header.
 *
 * SPDX-License-Identifier: MIT
 */
#include <xxhash.h>

#include "container/chunk_table.h"
#include "container/container_layout.h"

uint64_t parian_table_size(uint32_t chunk_count, uint64_t block_count)
{
    return (uint64_t)chunk_count * CHUNK_ENTRY_SIZE + block_count * BLOCK_ENTRY_SIZE;
}

static void encode_entry(const parian_chunk_info *info, uint8_t *entry)
{
    memset(entry, 0, CHUNK_ENTRY_SIZE);
    memcpy(entry + ENTRY_NAME, info->name, PARIAN_CHUNK_NAME_MAX);
    store_u32(entry + ENTRY_OBJECT, info->object);
    store_u32(entry + ENTRY_LEVEL, info->level);
    store_u16(entry + ENTRY_ELEMENT, (uint16_t)info->element);
    entry[ENTRY_CODEC] = (uint8_t)info->codec;
    entry[ENTRY_RANK] = (uint8_t)info->rank;
    store_u32(entry + ENTRY_FLAGS, info->flags);
    for (int i = 0; i < PARIAN_CHUNK_RANK_MAX; i++) {
        store_u64(entry + ENTRY_SHAPE + 8 * i, info->shape[i]);
    }
    store_u64(entry + ENTRY_OFFSET, info->offset);
    store_u64(entry + ENTRY_STORED_SIZE, info->stored_size);
}

void parian_table_encode(const parian_chunk_info *chunk, uint32_t chunk_count,
                         const parian_block_record *block, uint64_t block_count, uint8_t *bytes)
{
    for (uint32_t i = 0; i < chunk_count; i++) {
        encode_entry(&chunk[i], bytes);
        bytes += CHUNK_ENTRY_SIZE;
    }
    for (uint64_t i = 0; i < block_count; i++) {
        store_u32(bytes + BLOCK_STORED_SIZE, block[i].stored_size);
        store_u32(bytes + BLOCK_RESERVED, 0);
        store_u64(bytes + BLOCK_CHECKSUM, block[i].checksum);
        bytes += BLOCK_ENTRY_SIZE;
    }
}

void parian_header_encode(const uint8_t *table, uint32_t chunk_count, uint64_t block_count,
                          uint64_t table_offset, uint32_t version_minor, uint8_t *header)
{
    uint64_t size = parian_table_size(chunk_count, block_count);
    memset(header, 0, HEADER_SIZE);
    memcpy(header, PARIAN_MAGIC, MAGIC_SIZE);
    store_u16(header + HEADER_MAJOR, PARIAN_FORMAT_VERSION);
    store_u16(header + HEADER_MINOR, (uint16_t)version_minor);
    store_u32(header + HEADER_CHUNK_COUNT, chunk_count);
    store_u64(header + HEADER_FILE_SIZE, table_offset + size);
    store_u64(header + HEADER_TABLE_OFFSET, table_offset);
    store_u64(header + HEADER_BLOCK_COUNT, block_count);
    store_u64(header + HEADER_TABLE_CHECKSUM, XXH3_64bits(table, size));
    store_u64(header + HEADER_CHECKSUM, XXH3_64bits(header, HEADER_CHECKSUM));
}
