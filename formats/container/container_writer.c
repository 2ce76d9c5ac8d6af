/* container_writer.c - writes a .parian file chunk by chunk; the same bytes for any number of
 * threads.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include <xxhash.h>

#include "container/block_codec.h"
#include "container/chunk_info.h"
#include "container/chunk_table.h"
#include "container/container_layout.h"
#include "container/container_output.h"
#include "core/memory.h"

enum { LANE_MAX = 16, LEVEL_DEFAULT = 3, LEVEL_MAX = 19 };

/* One block of a batch: what a thread codes it with, and what came out. */
typedef struct lane {
    parian_block_coder coder;
    uint8_t *coded; /* [PARIAN_BLOCK_SIZE], made on first use */
    const uint8_t *plain;
    size_t size, stored_size;
    uint64_t checksum;
    parian_result result;
} lane;

struct parian_writer {
    parian_env env;
    parian_output output;
    int level;
    bool no_compression;
    uint32_t version_minor; /* the lowest that has what was written */
    parian_result failed;   /* the first error: nothing but abort is left */
    parian_chunk_info *chunk;
    uint32_t chunk_count, chunk_capacity;
    parian_block_record *block;
    uint64_t block_count, block_capacity;
    lane lanes[LANE_MAX];
};

static const uint8_t zeros[CHUNK_ALIGNMENT];

/* ---- begin and abort ----------------------------------------------------------------------------
 */

parian_result parian_writer_begin(const parian_env *env, const parian_writer_desc *desc,
                                  parian_writer **writer)
{
    parian_writer *made;
    if (!desc || !desc->path || desc->compression_level < 0 ||
        desc->compression_level > LEVEL_MAX || desc->version_minor > UINT16_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "a writer needs a path, a level of 0 to %d and a 16-bit minor version",
                           LEVEL_MAX);
    }
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for a writer", desc->path);
    }
    if (env) {
        made->env = *env;
    }
    made->level = desc->compression_level ? desc->compression_level : LEVEL_DEFAULT;
    made->no_compression = desc->no_compression;
    made->version_minor = desc->version_minor;
    parian_result result = parian_output_open(&made->env, desc->path, &made->output);
    if (result == PARIAN_OK) {
        result = parian_output_append(&made->output, zeros, HEADER_SIZE);
    }
    if (result != PARIAN_OK) {
        parian_writer_abort(made);
        return result;
    }
    *writer = made;
    return PARIAN_OK;
}

void parian_writer_abort(parian_writer *writer)
{
    if (!writer) {
        return;
    }
    parian_env env = writer->env;
    parian_output_discard(&writer->output);
    for (int i = 0; i < LANE_MAX; i++) {
        parian_block_encoder_destroy(&env, &writer->lanes[i].coder);
        parian_free(&env, writer->lanes[i].coded);
    }
    parian_free(&env, writer->chunk);
    parian_free(&env, writer->block);
    parian_free(&env, writer);
}

const parian_env *parian_writer_env(const parian_writer *writer)
{
    return &writer->env;
}

const char *parian_writer_temporary(const parian_writer *writer)
{
    return writer->output.temporary;
}

/* ---- growing lists ------------------------------------------------------------------------------
 */

static void *grow(const parian_env *env, void *old, uint64_t count, uint64_t capacity, size_t size)
{
    void *larger = parian_alloc(env, capacity, size);
    if (larger) {
        if (count) {
            memcpy(larger, old, count * size);
        }
        parian_free(env, old);
    }
    return larger;
}

static bool reserve_chunk(parian_writer *writer)
{
    if (writer->chunk_count < writer->chunk_capacity) {
        return true;
    }
    uint32_t capacity = writer->chunk_capacity ? 2 * writer->chunk_capacity : 64;
    void *larger =
        grow(&writer->env, writer->chunk, writer->chunk_count, capacity, sizeof *writer->chunk);
    if (larger) {
        writer->chunk = larger;
        writer->chunk_capacity = capacity;
    }
    return larger != NULL;
}

static bool reserve_blocks(parian_writer *writer, uint64_t count)
{
    uint64_t wanted = writer->block_count + count;
    if (wanted <= writer->block_capacity) {
        return true;
    }
    uint64_t capacity = wanted < 64 ? 64 : 2 * wanted;
    void *larger =
        grow(&writer->env, writer->block, writer->block_count, capacity, sizeof *writer->block);
    if (larger) {
        writer->block = larger;
        writer->block_capacity = capacity;
    }
    return larger != NULL;
}

/* ---- coding -------------------------------------------------------------------------------------
 */

typedef struct batch {
    parian_writer *writer;
    const parian_chunk_info *info;
} batch;

static void code_lane(void *context, size_t index)
{
    const batch *work = context;
    lane *mine = &work->writer->lanes[index];
    mine->stored_size = mine->size;
    mine->result = PARIAN_OK;
    if (work->info->codec != PARIAN_CODEC_RAW) {
        mine->result = parian_block_encode(
            &mine->coder, work->info->codec, parian_element_size(work->info->element),
            work->writer->level, mine->plain, mine->size, mine->coded, &mine->stored_size);
    }
    const uint8_t *stored = mine->stored_size < mine->size ? mine->coded : mine->plain;
    mine->checksum = XXH3_64bits(stored, mine->stored_size);
}

static parian_result prepare_lane(parian_writer *writer, lane *mine)
{
    if (!mine->coder.context &&
        parian_block_encoder_create(&writer->env, PARIAN_BLOCK_SIZE, &mine->coder) != PARIAN_OK) {
        return PARIAN_E_NOMEM;
    }
    if (!mine->coded && !PARIAN_NEW(&writer->env, mine->coded, PARIAN_BLOCK_SIZE)) {
        return PARIAN_E_NOMEM;
    }
    return PARIAN_OK;
}

static parian_result append_lane(parian_writer *writer, const lane *mine, bool *coded)
{
    if (mine->result != PARIAN_OK) {
        return parian_fail(&writer->env, mine->result, "%s: no memory to code a block",
                           writer->output.path);
    }
    bool is_coded = mine->stored_size < mine->size;
    writer->block[writer->block_count].stored_size = (uint32_t)mine->stored_size;
    writer->block[writer->block_count].checksum = mine->checksum;
    writer->block_count++;
    *coded |= is_coded;
    return parian_output_append(&writer->output, is_coded ? mine->coded : mine->plain,
                                mine->stored_size);
}

/* Code and append count blocks of a chunk, first the one at index first. */
static parian_result append_batch(parian_writer *writer, const parian_chunk_info *info,
                                  const uint8_t *data, uint64_t first, size_t count, bool *coded)
{
    batch work = {writer, info};
    for (size_t i = 0; i < count; i++) {
        lane *mine = &writer->lanes[i];
        mine->plain = data + (first + i) * PARIAN_BLOCK_SIZE;
        mine->size = block_size_of(info->size, first + i);
        if (info->codec != PARIAN_CODEC_RAW && prepare_lane(writer, mine) != PARIAN_OK) {
            return parian_fail(&writer->env, PARIAN_E_NOMEM, "%s: no memory to code chunk %s",
                               writer->output.path, info->name);
        }
    }
    parian_par(&writer->env, count, code_lane, &work);
    for (size_t i = 0; i < count; i++) {
        parian_result result = append_lane(writer, &writer->lanes[i], coded);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return parian_cancelled(&writer->env) ? parian_fail(&writer->env, PARIAN_E_INTERRUPTED,
                                                        "%s: interrupted", writer->output.path)
                                          : PARIAN_OK;
}

static parian_result append_padding(parian_writer *writer)
{
    uint64_t size = writer->output.size;
    return parian_output_append(&writer->output, zeros, align_chunk(size) - size);
}

static parian_result append_blocks(parian_writer *writer, parian_chunk_info *info,
                                   const uint8_t *data)
{
    uint64_t count = block_count_of(info->size);
    bool coded = false;
    for (uint64_t first = 0; first < count; first += LANE_MAX) {
        size_t lanes = count - first < LANE_MAX ? (size_t)(count - first) : LANE_MAX;
        parian_result result = append_batch(writer, info, data, first, lanes, &coded);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    if (!coded) {
        info->codec = PARIAN_CODEC_RAW;
    }
    return PARIAN_OK;
}

/* ---- chunks -------------------------------------------------------------------------------------
 */

static parian_result check_chunk(parian_writer *writer, parian_chunk_info *info, const void *data)
{
    const char *finding = NULL;
    int rule = parian_chunk_info_check(info, &info->size, &finding);
    if (rule != 0) {
        return parian_fail(&writer->env, PARIAN_E_ARGUMENT, "%s: rule %d: chunk \"%.39s\": %s",
                           writer->output.path, rule, info->name, finding);
    }
    if (info->size != 0 && !data) {
        return parian_fail(&writer->env, PARIAN_E_ARGUMENT, "%s: chunk %s has no data",
                           writer->output.path, info->name);
    }
    for (uint32_t i = 0; i < writer->chunk_count; i++) {
        if (parian_chunk_info_order(&writer->chunk[i], info) == 0) {
            return parian_fail(&writer->env, PARIAN_E_ARGUMENT,
                               "%s: rule %d: chunk %s of object %u, level %u was written before",
                               writer->output.path, RULE_DUPLICATE, info->name, info->object,
                               info->level);
        }
    }
    return PARIAN_OK;
}

/* Check a chunk, make room for it in the table, and go to its place in the file. */
static parian_result begin_chunk(parian_writer *writer, parian_chunk_info *info, const void *data)
{
    parian_result result = check_chunk(writer, info, data);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!reserve_chunk(writer) || !reserve_blocks(writer, block_count_of(info->size))) {
        return parian_fail(&writer->env, PARIAN_E_NOMEM, "%s: no memory for the table",
                           writer->output.path);
    }
    result = append_padding(writer);
    info->offset = writer->output.size;
    return result;
}

static parian_result append_chunk(parian_writer *writer, const parian_chunk_info *wanted,
                                  const void *data)
{
    parian_chunk_info info = *wanted;
    size_t length = strnlen(info.name, sizeof info.name);
    memset(info.name + length, 0, sizeof info.name - length);
    info.flags &= ~PARIAN_CHUNK_FLAGS_UNUSED;
    if (writer->no_compression) {
        info.codec = PARIAN_CODEC_RAW;
    }
    parian_result result = begin_chunk(writer, &info, data);
    if (result != PARIAN_OK) {
        return result;
    }
    result = append_blocks(writer, &info, data);
    info.stored_size = writer->output.size - info.offset;
    writer->chunk[writer->chunk_count++] = info;
    return result;
}

parian_result parian_writer_chunk(parian_writer *writer, const parian_chunk_info *info,
                                  const void *data)
{
    if (writer->failed == PARIAN_OK) {
        writer->failed = append_chunk(writer, info, data);
    }
    return writer->failed;
}

/* ---- copies ----------------------------------------------------------------------------------
 */

static parian_result append_stored(parian_writer *writer, const parian_reader *reader,
                                   uint32_t index)
{
    const parian_file_view *file = parian_reader_file(reader);
    const parian_chunk_table *table = parian_reader_table(reader);
    for (uint64_t b = table->first_block[index]; b < table->first_block[index + 1]; b++) {
        parian_block_record *record = &writer->block[writer->block_count++];
        record->stored_size = parian_block_stored_size(file, table, b);
        record->checksum = parian_block_checksum(file, table, b);
        parian_result result = parian_output_append(
            &writer->output, file->data + table->block_offset[b], record->stored_size);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}

static parian_result copy_chunk(parian_writer *writer, const parian_reader *reader, uint32_t index)
{
    parian_result result = parian_reader_check(reader, index);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_chunk_info info = *parian_reader_chunk(reader, index);
    result = begin_chunk(writer, &info, parian_reader_file(reader)->data);
    if (result == PARIAN_OK) {
        result = append_stored(writer, reader, index);
        writer->chunk[writer->chunk_count++] = info;
    }
    return result;
}

parian_result parian_writer_copy(parian_writer *writer, const parian_reader *reader, uint32_t index)
{
    if (writer->failed == PARIAN_OK) {
        writer->failed = copy_chunk(writer, reader, index);
    }
    return writer->failed;
}

/* ---- finish -------------------------------------------------------------------------------------
 */

static parian_result append_table(parian_writer *writer)
{
    uint8_t header[HEADER_SIZE];
    uint64_t table_size = parian_table_size(writer->chunk_count, writer->block_count);
    uint8_t *table = parian_alloc(&writer->env, table_size, 1);
    if (!table) {
        return parian_fail(&writer->env, PARIAN_E_NOMEM, "%s: no memory for the table",
                           writer->output.path);
    }
    parian_result result = append_padding(writer);
    parian_table_encode(writer->chunk, writer->chunk_count, writer->block, writer->block_count,
                        table);
    parian_header_encode(table, writer->chunk_count, writer->block_count, writer->output.size,
                         writer->version_minor, header);
    if (result == PARIAN_OK) {
        result = parian_output_append(&writer->output, table, table_size);
    }
    if (result == PARIAN_OK) {
        result = parian_output_rewrite(&writer->output, header, sizeof header);
    }
    parian_free(&writer->env, table);
    return result;
}

parian_result parian_writer_finish(parian_writer *writer)
{
    parian_result result = writer->failed;
    if (result == PARIAN_OK) {
        result = append_table(writer);
    }
    if (result == PARIAN_OK) {
        result = parian_output_commit(&writer->output);
    }
    parian_writer_abort(writer);
    return result;
}
