/* block_codec.c - codes and decodes one block of a chunk: byte transforms and zstd.
 *
 * SPDX-License-Identifier: MIT
 */
#include "container/block_codec.h"

#include <zstd.h>
#include <zstd_errors.h>

#include "container/container_layout.h"
#include "core/memory.h"

/* ---- byte transforms: byte j of every element goes to plane j ----------------------------------
 */

static void shuffle(size_t width, const uint8_t *restrict plain, size_t count,
                    uint8_t *restrict planes)
{
    for (size_t j = 0; j < width; j++) {
        for (size_t i = 0; i < count; i++) {
            planes[j * count + i] = plain[i * width + j];
        }
    }
}

static void unshuffle_2(const uint8_t *restrict planes, size_t count, uint8_t *restrict plain)
{
    for (size_t i = 0; i < count; i++) {
        plain[2 * i] = planes[i];
        plain[2 * i + 1] = planes[count + i];
    }
}

static void unshuffle_4(const uint8_t *restrict planes, size_t count, uint8_t *restrict plain)
{
    for (size_t i = 0; i < count; i++) {
        plain[4 * i] = planes[i];
        plain[4 * i + 1] = planes[count + i];
        plain[4 * i + 2] = planes[2 * count + i];
        plain[4 * i + 3] = planes[3 * count + i];
    }
}

static void unshuffle(size_t width, const uint8_t *planes, size_t count, uint8_t *plain)
{
    if (width == 2) {
        unshuffle_2(planes, count, plain);
    } else if (width == 4) {
        unshuffle_4(planes, count, plain);
    } else {
        for (size_t j = 0; j < width; j++) {
            for (size_t i = 0; i < count; i++) {
                plain[i * width + j] = planes[j * count + i];
            }
        }
    }
}

static uint64_t load_element(size_t width, const uint8_t *bytes)
{
    uint64_t value = 0;
    memcpy(&value, bytes, width);
    return value;
}

/* Difference to the previous element of the block modulo 2^(8 width), shuffled. */
static void delta_shuffle(size_t width, const uint8_t *plain, size_t count, uint8_t *planes)
{
    uint64_t previous = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t value = load_element(width, plain + i * width);
        uint64_t difference = value - previous;
        for (size_t j = 0; j < width; j++) {
            planes[j * count + i] = (uint8_t)(difference >> (8 * j));
        }
        previous = value;
    }
}

/* Replace each element by the sum of all up to it: written for each width, for speed. */
static void sum_up_2(uint8_t *plain, size_t count)
{
    uint16_t sum = 0, value;
    for (size_t i = 0; i < count; i++) {
        memcpy(&value, plain + 2 * i, sizeof value);
        sum = (uint16_t)(sum + value);
        memcpy(plain + 2 * i, &sum, sizeof sum);
    }
}

static void sum_up_4(uint8_t *plain, size_t count)
{
    uint32_t sum = 0, value;
    for (size_t i = 0; i < count; i++) {
        memcpy(&value, plain + 4 * i, sizeof value);
        sum += value;
        memcpy(plain + 4 * i, &sum, sizeof sum);
    }
}

static void undelta_shuffle(size_t width, const uint8_t *planes, size_t count, uint8_t *plain)
{
    unshuffle(width, planes, count, plain);
    if (width == 2) {
        sum_up_2(plain, count);
    } else if (width == 4) {
        sum_up_4(plain, count);
    } else {
        uint64_t sum = 0;
        for (size_t i = 0; i < count; i++) {
            sum += load_element(width, plain + i * width);
            memcpy(plain + i * width, &sum, width);
        }
    }
}

/* ---- coders
 * -------------------------------------------------------------------------------------- */

static parian_result finish_create(const parian_env *env, size_t size_max,
                                   parian_block_coder *coder)
{
    coder->transformed = coder->context ? parian_alloc(env, 1, size_max) : NULL;
    return coder->transformed ? PARIAN_OK : PARIAN_E_NOMEM;
}

parian_result parian_block_encoder_create(const parian_env *env, size_t size_max,
                                          parian_block_coder *coder)
{
    coder->context = ZSTD_createCCtx();
    parian_result result = finish_create(env, size_max, coder);
    if (result != PARIAN_OK) {
        parian_block_encoder_destroy(env, coder);
    }
    return result;
}

parian_result parian_block_decoder_create(const parian_env *env, size_t size_max,
                                          parian_block_coder *coder)
{
    coder->context = ZSTD_createDCtx();
    parian_result result = finish_create(env, size_max, coder);
    if (result != PARIAN_OK) {
        parian_block_decoder_destroy(env, coder);
    }
    return result;
}

void parian_block_encoder_destroy(const parian_env *env, parian_block_coder *coder)
{
    ZSTD_freeCCtx(coder->context);
    parian_free(env, coder->transformed);
    memset(coder, 0, sizeof *coder);
}

void parian_block_decoder_destroy(const parian_env *env, parian_block_coder *coder)
{
    ZSTD_freeDCtx(coder->context);
    parian_free(env, coder->transformed);
    memset(coder, 0, sizeof *coder);
}

parian_result parian_block_encode(parian_block_coder *coder, parian_codec codec,
                                  size_t element_size, int level, const uint8_t *plain, size_t size,
                                  uint8_t *coded, size_t *coded_size)
{
    const uint8_t *source = plain;
    size_t count = size / element_size;
    if (codec == PARIAN_CODEC_DELTA_ZSTD) {
        delta_shuffle(element_size, plain, count, coder->transformed);
        source = coder->transformed;
    } else if (codec == PARIAN_CODEC_SHUFFLE_ZSTD && element_size > 1) {
        shuffle(element_size, plain, count, coder->transformed);
        source = coder->transformed;
    }
    size_t written = ZSTD_compressCCtx(coder->context, coded, size - 1, source, size, level);
    if (!ZSTD_isError(written)) {
        *coded_size = written;
        return PARIAN_OK;
    }
    *coded_size = size;
    bool saves_nothing = ZSTD_getErrorCode(written) == ZSTD_error_dstSize_tooSmall;
    return saves_nothing ? PARIAN_OK : PARIAN_E_NOMEM;
}

int parian_block_decode(parian_block_coder *coder, parian_codec codec, size_t element_size,
                        const uint8_t *coded, size_t coded_size, uint8_t *plain, size_t size)
{
    bool transformed = codec == PARIAN_CODEC_DELTA_ZSTD ||
                       (codec == PARIAN_CODEC_SHUFFLE_ZSTD && element_size > 1);
    uint8_t *target = transformed ? coder->transformed : plain;
    if (ZSTD_getFrameContentSize(coded, coded_size) != size ||
        ZSTD_findFrameCompressedSize(coded, coded_size) != coded_size) {
        return RULE_FRAME;
    }
    if (ZSTD_decompressDCtx(coder->context, target, size, coded, coded_size) != size) {
        return RULE_DECODE;
    }
    if (codec == PARIAN_CODEC_DELTA_ZSTD) {
        undelta_shuffle(element_size, target, size / element_size, plain);
    } else if (transformed) {
        unshuffle(element_size, target, size / element_size, plain);
    }
    return 0;
}
