/* picture.c - sRGB coding, limits, and the choice of a reader for a picture file.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/picture.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture_internal.h"

enum { MAGIC_SIZE = 4, STREAM_START = 1 << 16 };

float parian_srgb_to_linear(float value)
{
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}

float parian_srgb_decode(uint8_t code)
{
    return parian_srgb_to_linear((float)code / 255.0f);
}

uint8_t parian_srgb_encode(float linear)
{
    if (!(linear > 0)) {
        return 0;
    }
    if (linear >= 1) {
        return 255;
    }
    float value = linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1 / 2.4f) - 0.055f;
    return (uint8_t)(value * 255.0f + 0.5f);
}

bool parian_byte_stream_put(parian_byte_stream *stream, size_t offset, const void *data,
                            size_t size)
{
    if (size > SIZE_MAX / 4 - offset) {
        return false;
    }
    size_t end = offset + size;
    if (end > stream->capacity) {
        size_t capacity = stream->capacity ? stream->capacity : STREAM_START;
        while (capacity < end) {
            capacity *= 2;
        }
        uint8_t *larger = parian_alloc(stream->env, capacity, 1);
        if (!larger) {
            return false;
        }
        if (stream->size) {
            memcpy(larger, stream->data, stream->size);
        }
        parian_free(stream->env, stream->data);
        stream->data = larger;
        stream->capacity = capacity;
    }
    if (offset > stream->size) {
        memset(stream->data + stream->size, 0, offset - stream->size);
    }
    memcpy(stream->data + offset, data, size);
    stream->size = end > stream->size ? end : stream->size;
    return true;
}

parian_result parian_picture_check_size(const parian_env *env, const char *path, uint64_t width,
                                        uint64_t height)
{
    if (width < 1 || height < 1 || width > PARIAN_PICTURE_SIDE_MAX ||
        height > PARIAN_PICTURE_SIDE_MAX || width * height > PARIAN_PICTURE_PIXELS_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT,
                           "%s: a picture of %" PRIu64 " x %" PRIu64
                           " pixels; 1 to %d a side and %d in all are read",
                           path, width, height, PARIAN_PICTURE_SIDE_MAX, PARIAN_PICTURE_PIXELS_MAX);
    }
    return PARIAN_OK;
}

parian_result parian_picture_read_linear(const parian_env *env, const char *path, uint32_t *width,
                                         uint32_t *height, float (**rgb)[3])
{
    uint8_t *data;
    size_t size;
    parian_result result = parian_file_read(env, path, PARIAN_PICTURE_FILE_MAX, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    bool png = size >= MAGIC_SIZE && memcmp(data, "\x89PNG", MAGIC_SIZE) == 0;
    bool exr = size >= MAGIC_SIZE && memcmp(data, "\x76\x2f\x31\x01", MAGIC_SIZE) == 0;
    parian_free(env, data);
    if (png) {
        return parian_png_read_linear(env, path, width, height, rgb);
    }
    if (exr) {
        return parian_exr_read(env, path, width, height, rgb);
    }
    return parian_fail(env, PARIAN_E_FORMAT, "%s: neither a PNG nor an OpenEXR picture", path);
}
