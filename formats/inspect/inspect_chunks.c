/* inspect_chunks.c - parian-info chunks and validate: the table of an asset, and whether it is
 * sound.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "core/body_file.h"
#include "core/memory.h"
#include "inspect/inspect.h"

enum { SHAPE_MAX = 100, FINDING_MAX = 1024 };

/* ---- chunks -------------------------------------------------------------------------------------
 */

static void print_shape(const parian_chunk_info *info, char text[SHAPE_MAX])
{
    size_t used = (size_t)snprintf(text, SHAPE_MAX, "%s ", parian_element_name(info->element));
    for (uint32_t i = 0; i < info->rank; i++) {
        used += (size_t)snprintf(text + used, SHAPE_MAX - used, "[%" PRIu64 "]", info->shape[i]);
    }
}

/* Columns as wide as their longest entry. */
static void measure_columns(const parian_reader *reader, int *name_width, int *shape_width)
{
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        char name[INSPECT_NAME_MAX], shape[SHAPE_MAX];
        inspect_chunk_name(parian_reader_chunk(reader, i), name);
        print_shape(parian_reader_chunk(reader, i), shape);
        *name_width = (int)strlen(name) > *name_width ? (int)strlen(name) : *name_width;
        *shape_width = (int)strlen(shape) > *shape_width ? (int)strlen(shape) : *shape_width;
    }
}

static void print_chunks(const parian_reader *reader)
{
    int width = 5, shape_width = 5;
    measure_columns(reader, &width, &shape_width);
    printf("%-*s  %-*s  %-12s  %8s  %8s\n", width, "chunk", shape_width, "array", "codec", "stored",
           "decoded");
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        char name[INSPECT_NAME_MAX], shape[SHAPE_MAX];
        inspect_chunk_name(info, name);
        print_shape(info, shape);
        printf("%-*s  %-*s  %-12s  %8s  %8s\n", width, name, shape_width, shape,
               parian_codec_name(info->codec), inspect_bytes(info->stored_size),
               inspect_bytes(info->size));
    }
}

static cJSON *make_chunk(const parian_chunk_info *info)
{
    char name[INSPECT_NAME_MAX];
    cJSON *json = cJSON_CreateObject();
    inspect_chunk_name(info, name);
    cJSON_AddStringToObject(json, "name", name);
    cJSON_AddStringToObject(json, "semantic", info->name);
    cJSON_AddNumberToObject(json, "object", info->object);
    cJSON_AddNumberToObject(json, "level", info->level);
    cJSON_AddStringToObject(json, "element", parian_element_name(info->element));
    cJSON *shape = cJSON_AddArrayToObject(json, "shape");
    for (uint32_t i = 0; i < info->rank; i++) {
        cJSON_AddItemToArray(shape, cJSON_CreateNumber((double)info->shape[i]));
    }
    cJSON_AddStringToObject(json, "codec", parian_codec_name(info->codec));
    cJSON_AddBoolToObject(json, "required", (info->flags & PARIAN_CHUNK_REQUIRED) != 0);
    cJSON_AddNumberToObject(json, "offset", (double)info->offset);
    cJSON_AddNumberToObject(json, "stored_bytes", (double)info->stored_size);
    cJSON_AddNumberToObject(json, "decoded_bytes", (double)info->size);
    return json;
}

parian_result inspect_chunks(const parian_env *env, const inspect_options *options,
                             const char *path)
{
    parian_reader *reader;
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result != PARIAN_OK) {
        return result;
    }
    if (options->json) {
        cJSON *list = cJSON_CreateArray();
        for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
            cJSON_AddItemToArray(list, make_chunk(parian_reader_chunk(reader, i)));
        }
        result = inspect_print_json(env, list);
    } else {
        print_chunks(reader);
    }
    parian_reader_close(reader);
    return result;
}

/* ---- validate -----------------------------------------------------------------------------------
 */

/* Container, then schema; the counts are for the line that says that all is well. */
static parian_result validate(const parian_env *env, const char *path, uint32_t *chunks,
                              uint64_t *bytes)
{
    parian_reader *reader;
    parian_scene_data scene;
    parian_result result = parian_reader_open(env, path, NULL, &reader);
    if (result != PARIAN_OK) {
        return result;
    }
    *chunks = parian_reader_chunk_count(reader);
    *bytes = parian_reader_file_size(reader);
    result = parian_reader_verify(reader);
    if (result == PARIAN_OK) {
        result = parian_scene_data_read(env, reader, &scene);
    }
    if (result == PARIAN_OK) {
        parian_scene_data_free(env, &scene);
    }
    parian_reader_close(reader);
    return result;
}

/* An env that keeps the first error line and passes everything on. */
typedef struct finding_keeper {
    const parian_env *env;
    char finding[FINDING_MAX];
} finding_keeper;

static void keep_finding(void *user, parian_log_level level, const char *text)
{
    finding_keeper *keeper = user;
    if (level == PARIAN_LOG_ERROR && !keeper->finding[0]) {
        snprintf(keeper->finding, sizeof keeper->finding, "%s", text);
    }
    parian_log(keeper->env, level, "%s", text);
}

static void pass_par(void *user, size_t count, void (*body)(void *context, size_t index),
                     void *context)
{
    parian_par(((finding_keeper *)user)->env, count, body, context);
}

parian_result inspect_validate(const parian_env *env, const inspect_options *options,
                               const char *path)
{
    finding_keeper keeper = {.env = env};
    parian_env watched = {.log = keep_finding, .par = pass_par, .user = &keeper};
    uint32_t chunks = 0;
    uint64_t bytes = 0;
    parian_result result = validate(&watched, path, &chunks, &bytes);
    if (options->json) {
        cJSON *json = cJSON_CreateObject();
        cJSON_AddStringToObject(json, "asset", path);
        cJSON_AddBoolToObject(json, "valid", result == PARIAN_OK);
        if (result != PARIAN_OK) {
            cJSON_AddStringToObject(json, "finding", keeper.finding);
        }
        parian_result printed = inspect_print_json(env, json);
        result = result == PARIAN_OK ? printed : result;
    } else if (result == PARIAN_OK && !options->common.quiet) {
        printf("%s: valid, %u chunks, %s bytes\n", path, chunks, inspect_count(bytes));
    }
    return result;
}
