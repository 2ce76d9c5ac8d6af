/* container_reader.c - opens a .parian file and decodes, maps or verifies its chunks.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdatomic.h>
#include <string.h>

#include <xxhash.h>

#include "container/block_codec.h"
#include "container/chunk_info.h"
#include "container/chunk_table.h"
#include "container/container_layout.h"
#include "container/file_mapping.h"
#include "core/memory.h"

struct parian_reader {
    parian_env env;
    parian_file_view file;
    parian_file_mapping mapping;
    parian_chunk_table table;
    char *name;
};

/* ---- open and close -----------------------------------------------------------------------------
 */

static parian_result create(const parian_env *env, const char *name, parian_reader **reader)
{
    size_t size = strlen(name) + 1;
    parian_reader *made;
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for a reader", name);
    }
    if (env) {
        made->env = *env;
    }
    made->name = parian_alloc(env, size, 1);
    if (!made->name) {
        parian_free(env, made);
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for a reader", name);
    }
    memcpy(made->name, name, size);
    made->file.env = &made->env;
    made->file.name = made->name;
    *reader = made;
    return PARIAN_OK;
}

void parian_reader_close(parian_reader *reader)
{
    if (!reader) {
        return;
    }
    parian_env env = reader->env;
    parian_chunk_table_free(&env, &reader->table);
    parian_file_mapping_close(&env, &reader->mapping);
    parian_free(&env, reader->name);
    parian_free(&env, reader);
}

static parian_result open_table(parian_reader *made, const parian_reader_limits *limits,
                                parian_reader **reader)
{
    parian_result result = parian_chunk_table_read(&made->file, limits, &made->table);
    if (result != PARIAN_OK) {
        parian_reader_close(made);
        return result;
    }
    *reader = made;
    return PARIAN_OK;
}

parian_result parian_reader_open(const parian_env *env, const char *path,
                                 const parian_reader_limits *limits, parian_reader **reader)
{
    parian_reader *made = NULL;
    parian_result result = create(env, path, &made);
    if (result != PARIAN_OK) {
        return result;
    }
    result = parian_file_mapping_open(&made->env, path, &made->mapping);
    if (result != PARIAN_OK) {
        parian_reader_close(made);
        return result;
    }
    made->file.data = made->mapping.data;
    made->file.size = made->mapping.size;
    return open_table(made, limits, reader);
}

parian_result parian_reader_open_memory(const parian_env *env, const char *name, const void *data,
                                        size_t size, const parian_reader_limits *limits,
                                        parian_reader **reader)
{
    parian_reader *made = NULL;
    parian_result result = create(env, name, &made);
    if (result != PARIAN_OK) {
        return result;
    }
    made->file.data = data;
    made->file.size = size;
    return open_table(made, limits, reader);
}

/* ---- the table ----------------------------------------------------------------------------------
 */

uint32_t parian_reader_chunk_count(const parian_reader *reader)
{
    return reader->table.chunk_count;
}

const parian_chunk_info *parian_reader_chunk(const parian_reader *reader, uint32_t index)
{
    return index < reader->table.chunk_count ? &reader->table.chunk[index] : NULL;
}

uint64_t parian_reader_file_size(const parian_reader *reader)
{
    return reader->file.size;
}

uint32_t parian_reader_version_minor(const parian_reader *reader)
{
    return load_u16(reader->file.data + HEADER_MINOR);
}

const parian_file_view *parian_reader_file(const parian_reader *reader)
{
    return &reader->file;
}

const parian_chunk_table *parian_reader_table(const parian_reader *reader)
{
    return &reader->table;
}

const char *parian_reader_name(const parian_reader *reader)
{
    return reader->name;
}

int64_t parian_reader_find(const parian_reader *reader, const char *name, uint32_t object,
                           uint32_t level)
{
    parian_chunk_info wanted = {.object = object, .level = level};
    size_t length = strlen(name);
    if (length >= PARIAN_CHUNK_NAME_MAX) {
        return -1;
    }
    memcpy(wanted.name, name, length);
    uint32_t low = 0, high = reader->table.chunk_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        uint32_t index = reader->table.order[middle];
        int order = parian_chunk_info_order(&reader->table.chunk[index], &wanted);
        if (order == 0) {
            return index;
        }
        if (order < 0) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return -1;
}

/* ---- blocks, in lanes: lane l does blocks l, l + lane_count, ...
 * --------------------------------- */

enum { LANE_MAX = 16 };

typedef struct lane {
    int rule;       /* of the first finding, or 0 */
    uint64_t block; /* where */
} lane;

/* What a lane works with. A lane that begins takes the first that is free, so that few threads
 * touch few of them. */
typedef struct workplace {
    atomic_int taken;
    parian_block_coder coder;
    uint8_t *decoded; /* a block, where no destination is given; or NULL */
} workplace;

typedef struct read_job {
    const parian_reader *reader;
    const parian_chunk_info *info;
    uint64_t first_block, block_count;
    uint8_t *destination; /* NULL: check alone */
    size_t lane_count;
    lane lanes[LANE_MAX];
    workplace places[LANE_MAX];
} read_job;

static int read_block(const read_job *job, workplace *mine, uint64_t index)
{
    const parian_reader *reader = job->reader;
    uint64_t block = job->first_block + index;
    const uint8_t *stored = reader->file.data + reader->table.block_offset[block];
    uint32_t stored_size = parian_block_stored_size(&reader->file, &reader->table, block);
    uint32_t size = block_size_of(job->info->size, index);
    if (XXH3_64bits(stored, stored_size) !=
        parian_block_checksum(&reader->file, &reader->table, block)) {
        return RULE_BLOCK_CHECKSUM;
    }
    uint8_t *target =
        job->destination ? job->destination + index * PARIAN_BLOCK_SIZE : mine->decoded;
    if (stored_size < size) {
        return parian_block_decode(&mine->coder, job->info->codec,
                                   parian_element_size(job->info->element), stored, stored_size,
                                   target, size);
    }
    if (job->destination) {
        memcpy(target, stored, size);
    }
    return 0;
}

/* There are as many as lanes: one is free. */
static workplace *take_workplace(read_job *job)
{
    for (size_t i = 0;; i = (i + 1) % job->lane_count) {
        if (!atomic_exchange(&job->places[i].taken, 1)) {
            return &job->places[i];
        }
    }
}

static void read_lane(void *context, size_t index)
{
    read_job *job = context;
    lane *mine = &job->lanes[index];
    workplace *place = take_workplace(job);
    for (uint64_t b = index; b < job->block_count && mine->rule == 0; b += job->lane_count) {
        mine->rule = read_block(job, place, b);
        mine->block = b;
    }
    atomic_store(&place->taken, 0);
}

static parian_result create_lanes(const parian_env *env, read_job *job)
{
    size_t size = job->info->size < PARIAN_BLOCK_SIZE ? (size_t)job->info->size : PARIAN_BLOCK_SIZE;
    job->lane_count = job->block_count < LANE_MAX ? (size_t)job->block_count : LANE_MAX;
    if (job->info->codec == PARIAN_CODEC_RAW) {
        return PARIAN_OK;
    }
    for (size_t i = 0; i < job->lane_count; i++) {
        if (parian_block_decoder_create(env, size, &job->places[i].coder) != PARIAN_OK) {
            return PARIAN_E_NOMEM;
        }
        if (!job->destination && !PARIAN_NEW(env, job->places[i].decoded, size)) {
            return PARIAN_E_NOMEM;
        }
    }
    return PARIAN_OK;
}

static parian_result report_finding(const read_job *job)
{
    const lane *first = NULL;
    for (size_t i = 0; i < job->lane_count; i++) {
        const lane *candidate = &job->lanes[i];
        if (candidate->rule != 0 && (!first || candidate->block < first->block)) {
            first = candidate;
        }
    }
    if (!first) {
        return PARIAN_OK;
    }
    const char *finding =
        first->rule == RULE_BLOCK_CHECKSUM ? "is damaged: its checksum does not match"
        : first->rule == RULE_FRAME        ? "is not one zstd frame of the size it stands for"
                                           : "does not decode";
    return parian_file_fail(&job->reader->file, PARIAN_E_FORMAT, first->rule,
                            job->reader->table.block_offset[job->first_block + first->block],
                            "block %" PRIu64 " of chunk %s of object %u %s", first->block,
                            job->info->name, job->info->object, finding);
}

/* Check and decode all blocks of a chunk; destination NULL checks alone. */
static parian_result read_blocks(const parian_reader *reader, uint32_t index, void *destination)
{
    const parian_env *env = &reader->env;
    const parian_chunk_info *info = parian_reader_chunk(reader, index);
    if (!info) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "%s: there is no chunk %u", reader->name, index);
    }
    read_job job = {.reader = reader, .info = info, .destination = destination};
    job.first_block = reader->table.first_block[index];
    job.block_count = reader->table.first_block[index + 1] - job.first_block;
    parian_result result = create_lanes(env, &job);
    if (result != PARIAN_OK) {
        parian_fail(env, result, "%s: no memory to decode chunk %s", reader->name, info->name);
    } else {
        parian_par(env, job.lane_count, read_lane, &job);
        result = report_finding(&job);
    }
    for (size_t i = 0; i < job.lane_count; i++) {
        parian_block_decoder_destroy(env, &job.places[i].coder);
        parian_free(env, job.places[i].decoded);
    }
    return result;
}

parian_result parian_reader_read(const parian_reader *reader, uint32_t index, void *destination)
{
    uint8_t nothing; /* where the bytes of an empty chunk would go */
    return read_blocks(reader, index, destination ? destination : &nothing);
}

parian_result parian_reader_check(const parian_reader *reader, uint32_t index)
{
    return read_blocks(reader, index, NULL);
}

parian_result parian_reader_map_unverified(const parian_reader *reader, uint32_t index,
                                           const void **data)
{
    const parian_chunk_info *info = parian_reader_chunk(reader, index);
    if (!info) {
        return parian_fail(&reader->env, PARIAN_E_ARGUMENT, "%s: there is no chunk %u",
                           reader->name, index);
    }
    if (info->codec != PARIAN_CODEC_RAW) {
        return parian_fail(&reader->env, PARIAN_E_UNSUPPORTED,
                           "%s: chunk %s is coded and cannot be mapped", reader->name, info->name);
    }
    *data = reader->file.data + info->offset;
    return PARIAN_OK;
}

parian_result parian_reader_map(const parian_reader *reader, uint32_t index, const void **data)
{
    const void *view = NULL;
    parian_result result = parian_reader_map_unverified(reader, index, &view);
    if (result == PARIAN_OK) {
        result = read_blocks(reader, index, NULL);
    }
    if (result == PARIAN_OK) {
        *data = view;
    }
    return result;
}

parian_result parian_reader_verify(const parian_reader *reader)
{
    for (uint32_t i = 0; i < reader->table.chunk_count; i++) {
        parian_result result = read_blocks(reader, i, NULL);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}
