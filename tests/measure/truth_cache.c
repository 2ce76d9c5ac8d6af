/* truth_cache.c - names truths by what they depend on; carries them to and from files.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "bake/reference/scene_hash.h"
#include "core/memory.h"
#include "parian/format.h"
#include "tests/measure/content_hash.h"
#include "tests/measure/truth.h"

/* Raised when a reference model changes what it means; a build alone does not cost the truths that
 * are kept. */
enum { TRUTH_VERSION = 2 };

/* ---- the name
 * -----------------------------------------------------------------------------------------------
 */
static void hash_desc(parian_content_hash *hash, const parian_truth_desc *desc)
{
    parian_content_hash_count(hash, TRUTH_VERSION);
    parian_content_hash_count(hash, (uint64_t)desc->model);
    parian_content_hash_count(hash, desc->fit_fdr);
    parian_content_hash_count(hash, desc->normalise);
    parian_content_hash_count(hash, desc->samples);
    parian_content_hash_number(hash, desc->standard_error);
    parian_content_hash_count(hash, desc->seed);
}

parian_result parian_truth_name(const parian_env *env, const parian_reference_scene *scene,
                                const parian_receivers *receivers, const parian_truth_desc *desc,
                                char name[PARIAN_TRUTH_NAME_MAX])
{
    char digits[PARIAN_HASH_TEXT_MAX];
    parian_content_hash *hash = NULL;
    parian_result r = parian_content_hash_begin(env, &hash);
    if (r == PARIAN_OK) {
        uint64_t content[2] = {0};
        r = parian_reference_scene_hash(env, scene, receivers, content);
        hash_desc(hash, desc);
        parian_content_hash_count(hash, content[0]);
        parian_content_hash_count(hash, content[1]);
        parian_content_hash_end(hash, digits);
        snprintf(name, PARIAN_TRUTH_NAME_MAX, "truth-%s", digits);
    }
    return r;
}

/* ---- the file: a container of arrays, whose every block is checked
 * ------------------------------------------- */
enum { NUMBER_COUNT = 21 };

static void pack_numbers(const parian_reference_result *result, double number[NUMBER_COUNT])
{
    const double *triple[] = {result->in,
                              result->out,
                              result->absorbed,
                              result->roulette_added,
                              result->roulette_removed,
                              result->lost};
    number[0] = (double)result->samples;
    number[1] = result->seconds;
    number[2] = (double)result->scattering_events;
    for (int k = 0; k < 18; k++) {
        number[3 + k] = triple[k / 3][k % 3];
    }
}

static void unpack_numbers(const double number[NUMBER_COUNT], parian_reference_result *result)
{
    double *triple[] = {result->in,
                        result->out,
                        result->absorbed,
                        result->roulette_added,
                        result->roulette_removed,
                        result->lost};
    result->samples = (uint64_t)number[0];
    result->seconds = number[1];
    result->scattering_events = (uint64_t)number[2];
    for (int k = 0; k < 18; k++) {
        triple[k / 3][k % 3] = number[3 + k];
    }
}

static parian_result write_array(parian_writer *writer, const char *name, size_t count,
                                 size_t width, const void *data)
{
    parian_chunk_info info = {
        .element = PARIAN_ELEMENT_F64, .codec = PARIAN_CODEC_SHUFFLE_ZSTD, .rank = 2};
    info.shape[0] = count;
    info.shape[1] = width;
    snprintf(info.name, sizeof info.name, "%s", name);
    return data ? parian_writer_chunk(writer, &info, data) : PARIAN_OK;
}

parian_result parian_truth_save(const parian_env *env, const char *path, size_t count,
                                const parian_reference_result *result)
{
    double number[NUMBER_COUNT];
    parian_writer_desc desc = {.path = path};
    parian_writer *writer = NULL;
    parian_result r = parian_writer_begin(env, &desc, &writer);
    if (r != PARIAN_OK) {
        return r;
    }
    pack_numbers(result, number);
    r = write_array(writer, "truth.numbers", 1, NUMBER_COUNT, number);
    r = r == PARIAN_OK ? write_array(writer, "truth.irradiance", count, 3, result->irradiance) : r;
    r = r == PARIAN_OK ? write_array(writer, "truth.radiosity", count, 3, result->radiosity) : r;
    r = r == PARIAN_OK
            ? write_array(writer, "truth.standard_error", count, 3, result->standard_error)
            : r;
    r = r == PARIAN_OK ? write_array(writer, "truth.unscattered", count, 3, result->unscattered)
                       : r;
    if (r != PARIAN_OK) {
        parian_writer_abort(writer);
        return r;
    }
    return parian_writer_finish(writer);
}

static bool read_array(const parian_reader *reader, const char *name, size_t count, size_t width,
                       void *data)
{
    int64_t index = parian_reader_find(reader, name, 0, 0);
    if (index < 0) {
        return false;
    }
    const parian_chunk_info *info = parian_reader_chunk(reader, (uint32_t)index);
    return info->element == PARIAN_ELEMENT_F64 && info->rank == 2 && info->shape[0] == count &&
           info->shape[1] == width &&
           parian_reader_read(reader, (uint32_t)index, data) == PARIAN_OK;
}

static bool read_arrays(const parian_reader *reader, size_t count, parian_reference_result *result)
{
    double number[NUMBER_COUNT];
    bool sound = read_array(reader, "truth.numbers", 1, NUMBER_COUNT, number) &&
                 read_array(reader, "truth.irradiance", count, 3, result->irradiance) &&
                 read_array(reader, "truth.radiosity", count, 3, result->radiosity) &&
                 read_array(reader, "truth.standard_error", count, 3, result->standard_error) &&
                 (!result->unscattered ||
                  read_array(reader, "truth.unscattered", count, 3, result->unscattered));
    if (sound) {
        unpack_numbers(number, result);
    }
    return sound;
}

bool parian_truth_load(const parian_env *env, const char *path, size_t count,
                       parian_reference_result *result)
{
    parian_env silent = env ? *env : (parian_env){0};
    parian_reader *reader = NULL;
    silent.log = NULL; /* a damaged file is no fault of the run */
    *result = (parian_reference_result){0};
    if (parian_reader_open(&silent, path, NULL, &reader) != PARIAN_OK) {
        return false;
    }
    bool unscattered = parian_reader_find(reader, "truth.unscattered", 0, 0) >= 0;
    bool sound = parian_reference_result_init(env, count, unscattered, result) == PARIAN_OK &&
                 read_arrays(reader, count, result);
    parian_reader_close(reader);
    if (!sound) {
        parian_reference_result_free(env, result);
    }
    return sound;
}
