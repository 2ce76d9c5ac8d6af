/* picture_png.c - reads and writes PNG through libpng.
 *
 * libpng leaves by longjmp: everything that must survive it lives in a struct on the frame of the
 * caller.
 *
 * SPDX-License-Identifier: MIT
 */
#include <png.h>
#include <setjmp.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture.h"
#include "tool/picture_internal.h"

enum { CHUNK_MEMORY_MAX = 8 << 20, DEFLATE_RATIO_MAX = 1032 };

typedef struct png_job {
    const parian_env *env;
    const char *path;
    png_structp png;
    png_infop info;
    parian_byte_stream stream;
    uint32_t width, height;
    size_t row_size;
    uint8_t *pixels; /* [height][row_size] */
    parian_result result;
    char message[160];
} png_job;

static void on_error(png_structp png, png_const_charp message)
{
    png_job *job = png_get_error_ptr(png);
    strncpy(job->message, message, sizeof job->message - 1);
    png_longjmp(png, 1);
}

static void on_warning(png_structp png, png_const_charp message)
{
    png_job *job = png_get_error_ptr(png);
    parian_log(job->env, PARIAN_LOG_DEBUG, "%s: %s", job->path, message);
}

/* ---- writing -----------------------------------------------------------------------------------
 */
static void write_bytes(png_structp png, png_bytep data, size_t size)
{
    png_job *job = png_get_io_ptr(png);
    if (!parian_byte_stream_put(&job->stream, job->stream.size, data, size)) {
        job->result = PARIAN_E_NOMEM;
        png_error(png, "no memory");
    }
}

static void flush_bytes(png_structp png)
{
    (void)png;
}

static bool encode(png_job *job, const uint8_t (*rgba)[4])
{
    if (setjmp(png_jmpbuf(job->png))) {
        return false;
    }
    png_set_write_fn(job->png, job, write_bytes, flush_bytes);
    png_set_IHDR(job->png, job->info, job->width, job->height, 8, PNG_COLOR_TYPE_RGBA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(job->png, job->info);
    for (uint32_t y = 0; y < job->height; y++) {
        png_write_row(job->png, rgba[(size_t)y * job->width]);
    }
    png_write_end(job->png, job->info);
    return true;
}

parian_result parian_png_write(const parian_env *env, const char *path, uint32_t width,
                               uint32_t height, const uint8_t (*rgba)[4])
{
    png_job job = {
        .env = env, .path = path, .width = width, .height = height, .result = PARIAN_E_COMPUTE};
    job.stream.env = env;
    parian_result result = parian_picture_check_size(env, path, width, height);
    if (result != PARIAN_OK) {
        return PARIAN_E_ARGUMENT;
    }
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    if (!job.info) {
        result = parian_fail(env, PARIAN_E_NOMEM, "%s: no memory to write a picture", path);
    } else if (!encode(&job, rgba)) {
        result = parian_fail(env, job.result, "%s: %s", path, job.message);
    } else {
        result = parian_file_write(env, path, job.stream.data, job.stream.size);
    }
    png_destroy_write_struct(&job.png, &job.info);
    parian_free(env, job.stream.data);
    return result;
}

/* ---- reading -----------------------------------------------------------------------------------
 */
static void read_bytes(png_structp png, png_bytep data, size_t size)
{
    png_job *job = png_get_io_ptr(png);
    if (size > job->stream.size - job->stream.position) {
        png_error(png, "the file ends within the picture");
    }
    memcpy(data, job->stream.data + job->stream.position, size);
    job->stream.position += size;
}

static void ask_for_rgb(png_job *job)
{
    png_set_expand(job->png);
    png_set_gray_to_rgb(job->png);
    png_set_strip_alpha(job->png);
}

static bool decode_header(png_job *job)
{
    if (setjmp(png_jmpbuf(job->png))) {
        return false;
    }
    png_set_user_limits(job->png, PARIAN_PICTURE_SIDE_MAX, PARIAN_PICTURE_SIDE_MAX);
    png_set_chunk_malloc_max(job->png, CHUNK_MEMORY_MAX);
    png_set_read_fn(job->png, job, read_bytes);
    png_read_info(job->png, job->info);
    job->width = png_get_image_width(job->png, job->info);
    job->height = png_get_image_height(job->png, job->info);
    if (png_get_rowbytes(job->png, job->info) / DEFLATE_RATIO_MAX >
        job->stream.size / job->height) {
        png_error(job->png, "the file is too short for the size it states");
    }
    ask_for_rgb(job);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    job->row_size = png_get_rowbytes(job->png, job->info);
    return true;
}

static bool decode_rows(png_job *job)
{
    if (setjmp(png_jmpbuf(job->png))) {
        return false;
    }
    int passes = png_get_interlace_type(job->png, job->info) == PNG_INTERLACE_ADAM7
                     ? PNG_INTERLACE_ADAM7_PASSES
                     : 1;
    for (int pass = 0; pass < passes; pass++) {
        for (uint32_t y = 0; y < job->height; y++) {
            png_read_row(job->png, job->pixels + y * job->row_size, NULL);
        }
    }
    png_read_end(job->png, NULL);
    return true;
}

static void to_linear(const png_job *job, float (*rgb)[3])
{
    float table[256];
    bool wide = png_get_bit_depth(job->png, job->info) == 16;
    for (int i = 0; i < 256; i++) {
        table[i] = parian_srgb_decode((uint8_t)i);
    }
    for (uint32_t y = 0; y < job->height; y++) {
        const uint8_t *row = job->pixels + y * job->row_size;
        float *out = rgb[(size_t)y * job->width];
        for (size_t i = 0; i < (size_t)job->width * 3; i++) {
            out[i] =
                wide ? parian_srgb_to_linear((float)(row[2 * i] << 8 | row[2 * i + 1]) / 65535.0f)
                     : table[row[i]];
        }
    }
}

static parian_result decode(png_job *job, float (**rgb)[3])
{
    if (!decode_header(job)) {
        return parian_fail(job->env, PARIAN_E_FORMAT, "%s: not a valid PNG: %s", job->path,
                           job->message);
    }
    parian_result result = parian_picture_check_size(job->env, job->path, job->width, job->height);
    if (result != PARIAN_OK) {
        return result;
    }
    job->pixels = parian_alloc(job->env, job->height, job->row_size);
    float(*linear)[3] = parian_alloc(job->env, (size_t)job->width * job->height, sizeof *linear);
    if (!job->pixels || !linear) {
        parian_free(job->env, linear);
        return parian_fail(job->env, PARIAN_E_NOMEM, "%s: no memory for %u x %u pixels", job->path,
                           (unsigned)job->width, (unsigned)job->height);
    }
    if (!decode_rows(job)) {
        parian_free(job->env, linear);
        return parian_fail(job->env, PARIAN_E_FORMAT, "%s: not a valid PNG: %s", job->path,
                           job->message);
    }
    to_linear(job, linear);
    *rgb = linear;
    return PARIAN_OK;
}

parian_result parian_png_read_linear(const parian_env *env, const char *path, uint32_t *width,
                                     uint32_t *height, float (**rgb)[3])
{
    png_job job = {.env = env, .path = path};
    parian_result result =
        parian_file_read(env, path, PARIAN_PICTURE_FILE_MAX, &job.stream.data, &job.stream.size);
    if (result != PARIAN_OK) {
        return result;
    }
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    job.info = job.png ? png_create_info_struct(job.png) : NULL;
    result = job.info ? decode(&job, rgb)
                      : parian_fail(env, PARIAN_E_NOMEM, "%s: no memory to read it", path);
    if (result == PARIAN_OK) {
        *width = job.width;
        *height = job.height;
    }
    png_destroy_read_struct(&job.png, &job.info, NULL);
    parian_free(env, job.pixels);
    parian_free(env, job.stream.data);
    return result;
}
