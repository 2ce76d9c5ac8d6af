/* sealed_file.c - the bytes of an asset that can be changed and given fitting checksums again.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/sealed_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "container/container_layout.h"
#include "core/body_file.h"
#include "core/memory.h"
#include "support/test_support.h"
#include "tool/files.h"

sealed_file sealed_file_make(const parian_scene_data *scene, const char *path, bool no_compression)
{
    sealed_file file;
    parian_writer *writer;
    parian_writer_desc desc = {.path = path, .no_compression = no_compression};
    assert_int_equal(parian_writer_begin(NULL, &desc, &writer), PARIAN_OK);
    assert_int_equal(parian_scene_data_write(writer, scene), PARIAN_OK);
    assert_int_equal(parian_writer_finish(writer), PARIAN_OK);
    assert_int_equal(parian_file_read(NULL, path, UINT64_MAX, &file.data, &file.size), PARIAN_OK);
    return file;
}

size_t sealed_file_entry(const sealed_file *file, uint32_t chunk)
{
    return load_u64(file->data + HEADER_TABLE_OFFSET) + (size_t)chunk * CHUNK_ENTRY_SIZE;
}

size_t sealed_file_block(const sealed_file *file, uint64_t block)
{
    return sealed_file_entry(file, load_u32(file->data + HEADER_CHUNK_COUNT)) +
           block * BLOCK_ENTRY_SIZE;
}

/* Blocks lie one behind the other from each chunk's offset on. */
static void seal_blocks(sealed_file *file, uint32_t chunks, uint64_t blocks)
{
    uint64_t block = 0;
    for (uint32_t c = 0; c < chunks; c++) {
        const uint8_t *entry = file->data + sealed_file_entry(file, c);
        uint64_t offset = load_u64(entry + ENTRY_OFFSET),
                 end = offset + load_u64(entry + ENTRY_STORED_SIZE);
        while (offset < end && block < blocks) {
            uint8_t *record = file->data + sealed_file_block(file, block++);
            uint32_t stored = load_u32(record + BLOCK_STORED_SIZE);
            if (stored == 0 || offset > file->size || stored > file->size - offset) {
                return;
            }
            store_u64(record + BLOCK_CHECKSUM, XXH3_64bits(file->data + offset, stored));
            offset += stored;
        }
    }
}

void sealed_file_seal(sealed_file *file)
{
    uint64_t table = load_u64(file->data + HEADER_TABLE_OFFSET),
             blocks = load_u64(file->data + HEADER_BLOCK_COUNT);
    uint32_t chunks = load_u32(file->data + HEADER_CHUNK_COUNT);
    if (table <= file->size) {
        uint64_t room = file->size - table;
        if (blocks <= room / BLOCK_ENTRY_SIZE &&
            (uint64_t)chunks * CHUNK_ENTRY_SIZE + blocks * BLOCK_ENTRY_SIZE == room) {
            seal_blocks(file, chunks, blocks);
        }
        store_u64(file->data + HEADER_TABLE_CHECKSUM, XXH3_64bits(file->data + table, room));
    }
    store_u64(file->data + HEADER_CHECKSUM, XXH3_64bits(file->data, HEADER_CHECKSUM));
}

/* ---- memory with a limit; each block carries its size -------------------------------------------
 */

enum { SIZE_PREFIX = 16 };

static void *limited_alloc(void *user, size_t size)
{
    limited_memory *memory = user;
    if (size > memory->limit || memory->live > memory->limit - size) {
        memory->refused++;
        return NULL;
    }
    uint8_t *block = malloc(size + SIZE_PREFIX);
    if (!block) {
        return NULL;
    }
    memcpy(block, &size, sizeof size);
    memory->live += size;
    memory->peak = memory->live > memory->peak ? memory->live : memory->peak;
    return block + SIZE_PREFIX;
}

static void limited_free(void *user, void *ptr)
{
    limited_memory *memory = user;
    size_t size;
    if (ptr) {
        memcpy(&size, (uint8_t *)ptr - SIZE_PREFIX, sizeof size);
        memory->live -= size;
        free((uint8_t *)ptr - SIZE_PREFIX);
    }
}

static void keep_error(void *user, parian_log_level level, const char *text)
{
    limited_memory *memory = user;
    if (level == PARIAN_LOG_ERROR) {
        snprintf(memory->error, sizeof memory->error, "%s", text);
    }
}

parian_env limited_env(limited_memory *memory)
{
    return (parian_env){
        .alloc = limited_alloc, .free = limited_free, .log = keep_error, .user = memory};
}
