/* container_layout.h - the bytes of header, chunk entries and block entries (docs/format.md), and
 * rule numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CONTAINER_LAYOUT_H
#define PARIAN_CONTAINER_LAYOUT_H

#include <stdint.h>
#include <string.h>

#include "parian/format.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "array bytes are little-endian and are not swapped"
#endif

#define PARIAN_MAGIC "\x89PARIAN\n"

enum {
    MAGIC_SIZE = 8,
    HEADER_SIZE = 64,
    CHUNK_ENTRY_SIZE = 128,
    BLOCK_ENTRY_SIZE = 16,
    CHUNK_ALIGNMENT = 64,

    /* Offsets in the header. */
    HEADER_MAJOR = 8,
    HEADER_MINOR = 10,
    HEADER_CHUNK_COUNT = 12,
    HEADER_FILE_SIZE = 16,
    HEADER_TABLE_OFFSET = 24,
    HEADER_BLOCK_COUNT = 32,
    HEADER_TABLE_CHECKSUM = 40,
    HEADER_RESERVED = 48,
    HEADER_CHECKSUM = 56,

    /* Offsets in a chunk entry. */
    ENTRY_NAME = 0,
    ENTRY_OBJECT = 40,
    ENTRY_LEVEL = 44,
    ENTRY_ELEMENT = 48,
    ENTRY_CODEC = 50,
    ENTRY_RANK = 51,
    ENTRY_FLAGS = 52,
    ENTRY_SHAPE = 56,
    ENTRY_OFFSET = 88,
    ENTRY_STORED_SIZE = 96,
    ENTRY_RESERVED = 104,

    /* Offsets in a block entry. */
    BLOCK_STORED_SIZE = 0,
    BLOCK_RESERVED = 4,
    BLOCK_CHECKSUM = 8
};

#define FLAGS_RESERVED (0xffffffffu ^ PARIAN_CHUNK_REQUIRED ^ PARIAN_CHUNK_FLAGS_UNUSED)

/* Rules of the container, numbered as in docs/format.md. */
enum {
    RULE_HEADER_SHORT = 101,
    RULE_MAGIC = 102,
    RULE_HEADER_CHECKSUM = 103,
    RULE_VERSION = 104,
    RULE_HEADER_RESERVED = 105,
    RULE_FILE_SIZE = 106,
    RULE_TABLE_PLACE = 107,
    RULE_TABLE_CHECKSUM = 108,
    RULE_NAME = 111,
    RULE_ELEMENT = 112,
    RULE_CODEC = 113,
    RULE_SHAPE = 114,
    RULE_SIZE = 115,
    RULE_ENTRY_RESERVED = 116,
    RULE_OFFSET = 117,
    RULE_BLOCK_SIZE = 118,
    RULE_BLOCK_COUNT = 119,
    RULE_DUPLICATE = 120,
    RULE_STRAY = 121,
    RULE_PADDING = 122,
    RULE_PLAIN = 123,
    RULE_STORED_SIZE = 124,
    RULE_BLOCK_CHECKSUM = 131,
    RULE_FRAME = 132,
    RULE_DECODE = 133,
    RULE_LIMIT_CHUNKS = 141,
    RULE_LIMIT_CHUNK_SIZE = 142,
    RULE_LIMIT_EXPANSION = 143
};

static inline uint16_t load_u16(const uint8_t *bytes)
{
    uint16_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static inline uint32_t load_u32(const uint8_t *bytes)
{
    uint32_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static inline uint64_t load_u64(const uint8_t *bytes)
{
    uint64_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static inline void store_u16(uint8_t *bytes, uint16_t value)
{
    memcpy(bytes, &value, sizeof value);
}

static inline void store_u32(uint8_t *bytes, uint32_t value)
{
    memcpy(bytes, &value, sizeof value);
}

static inline void store_u64(uint8_t *bytes, uint64_t value)
{
    memcpy(bytes, &value, sizeof value);
}

static inline uint64_t align_chunk(uint64_t offset)
{
    return (offset + (CHUNK_ALIGNMENT - 1)) & ~(uint64_t)(CHUNK_ALIGNMENT - 1);
}

/* Blocks of a chunk of size bytes, and bytes of its block `index` before coding. */
static inline uint64_t block_count_of(uint64_t size)
{
    return size / PARIAN_BLOCK_SIZE + (size % PARIAN_BLOCK_SIZE != 0);
}

static inline uint32_t block_size_of(uint64_t size, uint64_t index)
{
    uint64_t rest = size - index * PARIAN_BLOCK_SIZE;
    return rest < PARIAN_BLOCK_SIZE ? (uint32_t)rest : (uint32_t)PARIAN_BLOCK_SIZE;
}

#endif
