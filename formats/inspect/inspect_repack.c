/* inspect_repack.c - parian-info repack: the same arrays with another compression.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "inspect/inspect.h"
#include "inspect/inspect_values.h"
#include "tool/files.h"

enum { PATH_MAX_LENGTH = 4096 };

/* The order of the choices of --codec. */
typedef enum repack_codec {
    REPACK_DEFAULT, /* what parian-bake gives the chunk */
    REPACK_KEEP,
    REPACK_RAW,
    REPACK_ZSTD,
    REPACK_SHUFFLE,
    REPACK_DELTA
} repack_codec;

typedef struct repack {
    const parian_env *env;
    const inspect_options *options;
    parian_reader *reader;
    parian_writer *writer;
    uint32_t copied;
    uint64_t size_after;
} repack;

static parian_codec choose_codec(const repack *work, const parian_chunk_info *info,
                                 parian_codec by_schema)
{
    switch ((repack_codec)work->options->codec) {
    case REPACK_DEFAULT:
        return by_schema;
    case REPACK_KEEP:
        return info->codec;
    case REPACK_RAW:
        return PARIAN_CODEC_RAW;
    case REPACK_ZSTD:
        return PARIAN_CODEC_ZSTD;
    case REPACK_SHUFFLE:
        return PARIAN_CODEC_SHUFFLE_ZSTD;
    case REPACK_DELTA:
        return inspect_is_real(info->element) ? PARIAN_CODEC_SHUFFLE_ZSTD : PARIAN_CODEC_DELTA_ZSTD;
    }
    return by_schema;
}

static parian_result recode_chunk(const repack *work, uint32_t index, parian_codec by_schema)
{
    parian_chunk_info info = *parian_reader_chunk(work->reader, index);
    void *data = parian_alloc(work->env, info.size, 1);
    if (!data) {
        return parian_fail(work->env, PARIAN_E_NOMEM, "%s: no memory for the %s bytes of %s",
                           parian_reader_name(work->reader), inspect_count(info.size), info.name);
    }
    parian_result result = parian_reader_read(work->reader, index, data);
    if (result == PARIAN_OK) {
        info.codec = choose_codec(work, &info, by_schema);
        result = parian_writer_chunk(work->writer, &info, data);
    }
    parian_free(work->env, data);
    return result;
}

/* What this program does not know stays as it is stored: other chunks, and chunks with flags that a
 * later version has given a meaning. */
static parian_result repack_chunks(repack *work)
{
    parian_result result = PARIAN_OK;
    for (uint32_t i = 0; i < parian_reader_chunk_count(work->reader) && result == PARIAN_OK; i++) {
        const parian_chunk_info *info = parian_reader_chunk(work->reader, i);
        parian_codec by_schema;
        if (!parian_scene_knows_chunk(info->name, &by_schema) ||
            (info->flags & PARIAN_CHUNK_FLAGS_UNUSED)) {
            result = parian_writer_copy(work->writer, work->reader, i);
            work->copied++;
        } else {
            result = recode_chunk(work, i, by_schema);
        }
    }
    return result;
}

static parian_result write_output(repack *work)
{
    const inspect_options *options = work->options;
    parian_writer_desc desc = {.path = options->output,
                               .compression_level = (int)options->level,
                               .version_minor = parian_reader_version_minor(work->reader)};
    char temporary[PATH_MAX_LENGTH]; /* outlives the writer */
    parian_result result = parian_folder_create_parent(work->env, options->output);
    if (result == PARIAN_OK) {
        result = parian_writer_begin(work->env, &desc, &work->writer);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    snprintf(temporary, sizeof temporary, "%s", parian_writer_temporary(work->writer));
    parian_temp_register(temporary);
    result = repack_chunks(work);
    if (result != PARIAN_OK) {
        parian_writer_abort(work->writer);
    } else {
        result = parian_writer_finish(work->writer);
    }
    parian_temp_unregister(temporary);
    return result;
}

static parian_result measure_output(repack *work)
{
    parian_reader *written;
    parian_result result = parian_reader_open(work->env, work->options->output, NULL, &written);
    if (result == PARIAN_OK) {
        work->size_after = parian_reader_file_size(written);
        parian_reader_close(written);
    }
    return result;
}

static parian_result print_outcome(const repack *work)
{
    uint64_t before = parian_reader_file_size(work->reader);
    uint32_t chunks = parian_reader_chunk_count(work->reader);
    if (work->options->json) {
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "asset", parian_reader_name(work->reader));
        cJSON_AddStringToObject(json, "output", work->options->output);
        cJSON_AddNumberToObject(json, "file_bytes", (double)before);
        cJSON_AddNumberToObject(json, "output_bytes", (double)work->size_after);
        cJSON_AddNumberToObject(json, "chunks", chunks);
        cJSON_AddNumberToObject(json, "chunks_copied", work->copied);
        return inspect_print_json(work->env, json);
    }
    if (!work->options->common.quiet) {
        printf("%s: %s -> %s (%.1f %%), %u chunks", work->options->output, inspect_bytes(before),
               inspect_bytes(work->size_after), 100.0 * (double)work->size_after / (double)before,
               chunks);
        printf(work->copied ? ", %u of them unknown and copied as they are\n" : "\n", work->copied);
    }
    return PARIAN_OK;
}

parian_result inspect_repack(const parian_env *env, const inspect_options *options,
                             const char *path)
{
    repack work = {.env = env, .options = options};
    parian_result result = parian_reader_open(env, path, NULL, &work.reader);
    if (result != PARIAN_OK) {
        return result;
    }
    result = parian_scene_check_required(env, work.reader);
    if (result == PARIAN_OK) {
        result = write_output(&work);
    }
    if (result == PARIAN_OK) {
        result = measure_output(&work);
    }
    if (result == PARIAN_OK) {
        result = print_outcome(&work);
    }
    parian_reader_close(work.reader);
    return result;
}
