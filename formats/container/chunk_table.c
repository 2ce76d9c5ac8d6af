/* chunk_table.c - reads header and table of a file with every check that needs no block's bytes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "container/chunk_table.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <xxhash.h>

#include "container/chunk_info.h"
#include "container/container_layout.h"
#include "core/memory.h"

enum { CHUNK_COUNT_MAX_DEFAULT = 65536, EXPANSION_MAX_DEFAULT = 64 };
#define DECODED_SIZE_MAX_DEFAULT ((uint64_t)1 << 36)
#define EXPANSION_FREE           ((uint64_t)64 << 20) /* bytes that any file may decode to */

parian_result parian_file_fail(const parian_file_view *file, parian_result result, int rule,
                               uint64_t offset, const char *format, ...)
{
    char finding[512];
    va_list args;
    va_start(args, format);
    vsnprintf(finding, sizeof finding, format, args);
    va_end(args);
    return parian_fail(file->env, result, "%s: rule %d: %s (at byte %" PRIu64 ")", file->name, rule,
                       finding, offset);
}

/* ---- header -------------------------------------------------------------------------------------
 */

static parian_result check_header(const parian_file_view *file)
{
    const uint8_t *header = file->data;
    if (file->size < MAGIC_SIZE || memcmp(header, PARIAN_MAGIC, MAGIC_SIZE) != 0) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_MAGIC, 0,
                                "not a .parian file: it does not begin with the magic bytes");
    }
    if (file->size < HEADER_SIZE) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_HEADER_SHORT, file->size,
                                "the file ends inside its header of %d bytes", HEADER_SIZE);
    }
    if (XXH3_64bits(header, HEADER_CHECKSUM) != load_u64(header + HEADER_CHECKSUM)) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_HEADER_CHECKSUM, HEADER_CHECKSUM,
                                "the header is damaged: its checksum does not match");
    }
    if (load_u16(header + HEADER_MAJOR) != PARIAN_FORMAT_VERSION) {
        return parian_file_fail(file, PARIAN_E_UNSUPPORTED, RULE_VERSION, HEADER_MAJOR,
                                "format version %u.%u, this program reads %d.x",
                                load_u16(header + HEADER_MAJOR), load_u16(header + HEADER_MINOR),
                                PARIAN_FORMAT_VERSION);
    }
    if (load_u64(header + HEADER_RESERVED) != 0) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_HEADER_RESERVED, HEADER_RESERVED,
                                "reserved bytes of the header are not zero");
    }
    if (load_u64(header + HEADER_FILE_SIZE) != file->size) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_FILE_SIZE, HEADER_FILE_SIZE,
                                "the file has %" PRIu64 " bytes, its header says %" PRIu64,
                                file->size, load_u64(header + HEADER_FILE_SIZE));
    }
    return PARIAN_OK;
}

static parian_result check_table_place(const parian_file_view *file,
                                       const parian_reader_limits *limits,
                                       parian_chunk_table *table)
{
    const uint8_t *header = file->data;
    uint64_t chunk_max =
        limits->chunk_count_max ? limits->chunk_count_max : CHUNK_COUNT_MAX_DEFAULT;
    table->chunk_count = load_u32(header + HEADER_CHUNK_COUNT);
    table->block_count = load_u64(header + HEADER_BLOCK_COUNT);
    table->table_offset = load_u64(header + HEADER_TABLE_OFFSET);
    if (table->block_count > file->size / BLOCK_ENTRY_SIZE || table->table_offset > file->size ||
        table->table_offset < HEADER_SIZE || table->table_offset % CHUNK_ALIGNMENT != 0 ||
        parian_table_size(table->chunk_count, table->block_count) !=
            file->size - table->table_offset) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_TABLE_PLACE, HEADER_TABLE_OFFSET,
                                "the table of %u chunks and %" PRIu64
                                " blocks does not fill the file from byte "
                                "%" PRIu64 " to its end",
                                table->chunk_count, table->block_count, table->table_offset);
    }
    if (table->chunk_count > chunk_max) {
        return parian_file_fail(file, PARIAN_E_LIMIT, RULE_LIMIT_CHUNKS, HEADER_CHUNK_COUNT,
                                "%u chunks, the limit is %" PRIu64, table->chunk_count, chunk_max);
    }
    uint64_t checksum =
        XXH3_64bits(file->data + table->table_offset, file->size - table->table_offset);
    if (checksum != load_u64(header + HEADER_TABLE_CHECKSUM)) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_TABLE_CHECKSUM, table->table_offset,
                                "the table is damaged: its checksum does not match");
    }
    return PARIAN_OK;
}

/* ---- chunk entries ------------------------------------------------------------------------------
 */

static void load_entry(const uint8_t *entry, parian_chunk_info *info)
{
    memset(info, 0, sizeof *info);
    memcpy(info->name, entry + ENTRY_NAME, PARIAN_CHUNK_NAME_MAX);
    info->object = load_u32(entry + ENTRY_OBJECT);
    info->level = load_u32(entry + ENTRY_LEVEL);
    info->element = (parian_element)load_u16(entry + ENTRY_ELEMENT);
    info->codec = (parian_codec)entry[ENTRY_CODEC];
    info->rank = entry[ENTRY_RANK];
    info->flags = load_u32(entry + ENTRY_FLAGS);
    for (int i = 0; i < PARIAN_CHUNK_RANK_MAX; i++) {
        info->shape[i] = load_u64(entry + ENTRY_SHAPE + 8 * i);
    }
    info->offset = load_u64(entry + ENTRY_OFFSET);
    info->stored_size = load_u64(entry + ENTRY_STORED_SIZE);
}

static bool is_zero(const uint8_t *bytes, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        if (bytes[i] != 0) {
            return false;
        }
    }
    return true;
}

static parian_result read_entry(const parian_file_view *file, const parian_reader_limits *limits,
                                uint32_t index, parian_chunk_table *table)
{
    uint64_t place = table->table_offset + (uint64_t)index * CHUNK_ENTRY_SIZE;
    parian_chunk_info *info = &table->chunk[index];
    const char *finding;
    load_entry(file->data + place, info);
    int rule = parian_chunk_info_check(info, &info->size, &finding);
    if (rule == 0 &&
        !is_zero(file->data + place + ENTRY_RESERVED, CHUNK_ENTRY_SIZE - ENTRY_RESERVED)) {
        rule = RULE_ENTRY_RESERVED;
        finding = "reserved bytes of the entry are not zero";
    }
    if (rule != 0) {
        unsigned minor = load_u16(file->data + HEADER_MINOR);
        if ((rule == RULE_ELEMENT || rule == RULE_CODEC) && minor > PARIAN_FORMAT_VERSION_MINOR) {
            return parian_file_fail(file, PARIAN_E_UNSUPPORTED, rule, place,
                                    "chunk %u: %s in format %d.%u, this program knows %d.%d", index,
                                    finding, PARIAN_FORMAT_VERSION, minor, PARIAN_FORMAT_VERSION,
                                    PARIAN_FORMAT_VERSION_MINOR);
        }
        return parian_file_fail(file, PARIAN_E_FORMAT, rule, place, "chunk %u: %s", index, finding);
    }
    uint64_t size_max =
        limits->decoded_size_max ? limits->decoded_size_max : DECODED_SIZE_MAX_DEFAULT;
    if (info->size > size_max) {
        return parian_file_fail(file, PARIAN_E_LIMIT, RULE_LIMIT_CHUNK_SIZE, place,
                                "chunk %s has %" PRIu64 " bytes, the limit is %" PRIu64, info->name,
                                info->size, size_max);
    }
    table->first_block[index + 1] = table->first_block[index] + block_count_of(info->size);
    if (table->first_block[index + 1] > table->block_count) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_BLOCK_COUNT, place,
                                "chunk %s of %" PRIu64
                                " bytes needs more blocks than the table has",
                                info->name, info->size);
    }
    return PARIAN_OK;
}

static parian_result read_entries(const parian_file_view *file, const parian_reader_limits *limits,
                                  parian_chunk_table *table)
{
    uint64_t expansion = limits->expansion_max ? limits->expansion_max : EXPANSION_MAX_DEFAULT;
    uint64_t total = 0;
    for (uint32_t i = 0; i < table->chunk_count; i++) {
        parian_result result = read_entry(file, limits, i, table);
        if (result != PARIAN_OK) {
            return result;
        }
        total += table->chunk[i].size; /* at most block_count MiB: no overflow */
    }
    if (table->first_block[table->chunk_count] != table->block_count) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_BLOCK_COUNT, HEADER_BLOCK_COUNT,
                                "the table has %" PRIu64 " blocks, its chunks need %" PRIu64,
                                table->block_count, table->first_block[table->chunk_count]);
    }
    if (total > EXPANSION_FREE && (total - EXPANSION_FREE) / expansion > file->size) {
        return parian_file_fail(file, PARIAN_E_LIMIT, RULE_LIMIT_EXPANSION, table->table_offset,
                                "the chunks decode to %" PRIu64
                                " bytes, more than 64 MiB and %" PRIu64 " times the file",
                                total, expansion);
    }
    return PARIAN_OK;
}

/* ---- blocks and places --------------------------------------------------------------------------
 */

static const uint8_t *block_entry(const parian_file_view *file, const parian_chunk_table *table,
                                  uint64_t block)
{
    return file->data + table->table_offset + (uint64_t)table->chunk_count * CHUNK_ENTRY_SIZE +
           block * BLOCK_ENTRY_SIZE;
}

uint32_t parian_block_stored_size(const parian_file_view *file, const parian_chunk_table *table,
                                  uint64_t block)
{
    return load_u32(block_entry(file, table, block) + BLOCK_STORED_SIZE);
}

uint64_t parian_block_checksum(const parian_file_view *file, const parian_chunk_table *table,
                               uint64_t block)
{
    return load_u64(block_entry(file, table, block) + BLOCK_CHECKSUM);
}

/* Place the blocks of a chunk one behind the other; *coded tells whether any is coded. */
static parian_result place_blocks(const parian_file_view *file, parian_chunk_table *table,
                                  uint32_t index, bool *coded)
{
    const parian_chunk_info *info = &table->chunk[index];
    uint64_t offset = info->offset;
    for (uint64_t b = table->first_block[index]; b < table->first_block[index + 1]; b++) {
        const uint8_t *entry = block_entry(file, table, b);
        uint64_t place = (uint64_t)(entry - file->data);
        uint32_t stored = load_u32(entry + BLOCK_STORED_SIZE);
        uint32_t plain = block_size_of(info->size, b - table->first_block[index]);
        if (load_u32(entry + BLOCK_RESERVED) != 0) {
            return parian_file_fail(file, PARIAN_E_FORMAT, RULE_ENTRY_RESERVED, place,
                                    "reserved bytes of a block of chunk %s are not zero",
                                    info->name);
        }
        if (stored == 0 || stored > plain || stored > table->table_offset - offset) {
            return parian_file_fail(file, PARIAN_E_FORMAT, RULE_BLOCK_SIZE, place,
                                    "a block of chunk %s stores %u bytes for %u", info->name,
                                    stored, plain);
        }
        *coded |= stored < plain;
        table->block_offset[b] = offset;
        offset += stored;
    }
    if (offset - info->offset != info->stored_size) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_STORED_SIZE, info->offset,
                                "chunk %s stores %" PRIu64 " bytes, its blocks %" PRIu64,
                                info->name, info->stored_size, offset - info->offset);
    }
    return PARIAN_OK;
}

static parian_result place_chunk(const parian_file_view *file, parian_chunk_table *table,
                                 uint32_t index, uint64_t *end)
{
    const parian_chunk_info *info = &table->chunk[index];
    uint64_t expected = align_chunk(*end);
    bool coded = false;
    if (info->offset != expected || expected > table->table_offset) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_OFFSET,
                                table->table_offset + (uint64_t)index * CHUNK_ENTRY_SIZE +
                                    ENTRY_OFFSET,
                                "chunk %s is at byte %" PRIu64 ", expected %" PRIu64, info->name,
                                info->offset, expected);
    }
    parian_result result = place_blocks(file, table, index, &coded);
    if (result != PARIAN_OK) {
        return result;
    }
    if (coded != (info->codec != PARIAN_CODEC_RAW)) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_PLAIN, info->offset,
                                "chunk %s is called %s and %s coded block", info->name,
                                parian_codec_name(info->codec), coded ? "has a" : "has no");
    }
    if (!is_zero(file->data + *end, expected - *end)) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_PADDING, *end,
                                "padding before chunk %s is not zero", info->name);
    }
    *end = info->offset + info->stored_size;
    return PARIAN_OK;
}

static parian_result place_chunks(const parian_file_view *file, parian_chunk_table *table)
{
    uint64_t end = HEADER_SIZE;
    for (uint32_t i = 0; i < table->chunk_count; i++) {
        parian_result result = place_chunk(file, table, i, &end);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    if (align_chunk(end) != table->table_offset) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_STRAY, end,
                                "%" PRIu64 " bytes before the table belong to no chunk",
                                table->table_offset - end);
    }
    if (!is_zero(file->data + end, table->table_offset - end)) {
        return parian_file_fail(file, PARIAN_E_FORMAT, RULE_PADDING, end,
                                "padding before the table is not zero");
    }
    return PARIAN_OK;
}

/* ---- order and uniqueness -----------------------------------------------------------------------
 */

static int compare_chunks(const void *a, const void *b, void *context)
{
    const parian_chunk_info *chunk = context;
    return parian_chunk_info_order(&chunk[*(const uint32_t *)a], &chunk[*(const uint32_t *)b]);
}

static parian_result sort_chunks(const parian_file_view *file, parian_chunk_table *table)
{
    for (uint32_t i = 0; i < table->chunk_count; i++) {
        table->order[i] = i;
    }
    qsort_r(table->order, table->chunk_count, sizeof *table->order, compare_chunks, table->chunk);
    for (uint32_t i = 1; i < table->chunk_count; i++) {
        const parian_chunk_info *chunk = &table->chunk[table->order[i]];
        if (parian_chunk_info_order(&table->chunk[table->order[i - 1]], chunk) == 0) {
            return parian_file_fail(file, PARIAN_E_FORMAT, RULE_DUPLICATE, chunk->offset,
                                    "chunk %s of object %u, level %u is there twice", chunk->name,
                                    chunk->object, chunk->level);
        }
    }
    return PARIAN_OK;
}

static parian_result allocate(const parian_env *env, parian_chunk_table *table)
{
    if (!PARIAN_NEW(env, table->chunk, table->chunk_count) ||
        !PARIAN_NEW(env, table->first_block, (size_t)table->chunk_count + 1) ||
        !PARIAN_NEW(env, table->block_offset, table->block_count) ||
        !PARIAN_NEW(env, table->order, table->chunk_count)) {
        return PARIAN_E_NOMEM;
    }
    table->first_block[0] = 0;
    return PARIAN_OK;
}

parian_result parian_chunk_table_read(const parian_file_view *file,
                                      const parian_reader_limits *limits, parian_chunk_table *table)
{
    static const parian_reader_limits defaults;
    limits = limits ? limits : &defaults;
    memset(table, 0, sizeof *table);
    parian_result result = check_header(file);
    if (result == PARIAN_OK) {
        result = check_table_place(file, limits, table);
    }
    if (result == PARIAN_OK && allocate(file->env, table) != PARIAN_OK) {
        result = parian_fail(file->env, PARIAN_E_NOMEM, "%s: no memory for a table of %u chunks",
                             file->name, table->chunk_count);
    }
    if (result == PARIAN_OK) {
        result = read_entries(file, limits, table);
    }
    if (result == PARIAN_OK) {
        result = place_chunks(file, table);
    }
    if (result == PARIAN_OK) {
        result = sort_chunks(file, table);
    }
    if (result != PARIAN_OK) {
        parian_chunk_table_free(file->env, table);
    }
    return result;
}

void parian_chunk_table_free(const parian_env *env, parian_chunk_table *table)
{
    parian_free(env, table->chunk);
    parian_free(env, table->first_block);
    parian_free(env, table->block_offset);
    parian_free(env, table->order);
    memset(table, 0, sizeof *table);
}
