/* picture_exr.c - reads and writes OpenEXR through OpenEXRCore, from and to memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include <openexr.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture.h"
#include "tool/picture_internal.h"

enum { CHANNELS_READ = 3, CHANNELS_WRITTEN = 4, FLOAT_SIZE = 4 };

typedef struct exr_job {
    parian_byte_stream stream;
    const char *path;
    exr_context_t context;
    uint32_t width, height;
    int32_t top; /* of the data window */
    float (*rgb)[3];
    bool dwa; /* compressed in a way that OpenEXRCore does not know */
    bool no_memory; /* while writing */
    char message[200];
} exr_job;

static void on_error(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    (void)code;
    if (context && exr_get_user_data(context, &user) == EXR_ERR_SUCCESS && user) {
        exr_job *job = user;
        if (!job->message[0] && message) {
            strncpy(job->message, message, sizeof job->message - 1);
        }
    }
}

/* A context that writes is locked while it calls back: asking it for our job would wait forever. */
static void ignore_error(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

static int64_t read_bytes(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t error)
{
    const parian_byte_stream *stream = &((exr_job *)user)->stream;
    (void)context;
    (void)error;
    if (offset >= stream->size) {
        return 0;
    }
    uint64_t left = stream->size - offset;
    size = size < left ? size : left;
    memcpy(buffer, stream->data + offset, size);
    return (int64_t)size;
}

static int64_t file_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((exr_job *)user)->stream.size;
}

static int64_t write_bytes(exr_const_context_t context, void *user, const void *buffer,
                           uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t error)
{
    exr_job *job = user;
    (void)context;
    (void)error;
    if (!parian_byte_stream_put(&job->stream, offset, buffer, size)) {
        job->no_memory = true;
        return -1;
    }
    return (int64_t)size;
}

static exr_context_initializer_t make_initializer(exr_job *job)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = on_error;
    init.user_data = job;
    init.max_image_width = init.max_tile_width = PARIAN_PICTURE_SIDE_MAX;
    init.max_image_height = init.max_tile_height = PARIAN_PICTURE_SIDE_MAX;
    return init;
}

static parian_result fail_exr(const exr_job *job, parian_result result, exr_result_t code)
{
    const char *text = job->message[0] ? job->message : exr_get_default_error_message(code);
    result = code == EXR_ERR_OUT_OF_MEMORY ? PARIAN_E_NOMEM : result;
    return parian_fail(job->stream.env, result, "%s: %s: %s", job->path,
                       result == PARIAN_E_FORMAT ? "not a valid OpenEXR picture" : "OpenEXR", text);
}

/* ---- writing -----------------------------------------------------------------------------------
 */
static exr_result_t write_header(exr_job *job)
{
    static const char *const names[CHANNELS_WRITTEN] = {"A", "B", "G", "R"};
    exr_attr_box2i_t window = {.max.x = (int32_t)job->width - 1, .max.y = (int32_t)job->height - 1};
    exr_attr_v2f_t centre = {.x = 0, .y = 0};
    int part;
    exr_result_t code = exr_add_part(job->context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS) {
        code = exr_initialize_required_attr(job->context, part, &window, &window, 1, &centre, 1,
                                            EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    }
    for (int c = 0; c < CHANNELS_WRITTEN && code == EXR_ERR_SUCCESS; c++) {
        code = exr_add_channel(job->context, part, names[c], EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LINEAR, 1, 1);
    }
    return code == EXR_ERR_SUCCESS ? exr_write_header(job->context) : code;
}

/* The channels of a chunk come in the order of their names: A B G R. */
static void bind_sources(const exr_job *job, exr_encode_pipeline_t *pipeline, int32_t y,
                         const float (*rgba)[4])
{
    for (int c = 0; c < pipeline->channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_bytes_per_element = FLOAT_SIZE;
        channel->user_pixel_stride = CHANNELS_WRITTEN * FLOAT_SIZE;
        channel->user_line_stride = (int32_t)job->width * CHANNELS_WRITTEN * FLOAT_SIZE;
        channel->encode_from_ptr =
            (const uint8_t *)&rgba[(size_t)y * job->width][CHANNELS_WRITTEN - 1 - c];
    }
}

static exr_result_t write_rows(exr_job *job, const float (*rgba)[4])
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    int32_t rows_each = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(job->context, 0, &rows_each);
    bool begun = false;
    for (int32_t y = 0; y < (int32_t)job->height && code == EXR_ERR_SUCCESS; y += rows_each) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(job->context, 0, y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = begun ? exr_encoding_update(job->context, 0, &chunk, &pipeline)
                         : exr_encoding_initialize(job->context, 0, &chunk, &pipeline);
        }
        if (code == EXR_ERR_SUCCESS) {
            bind_sources(job, &pipeline, y, rgba);
            code = begun ? code : exr_encoding_choose_default_routines(job->context, 0, &pipeline);
            begun = true;
        }
        if (code == EXR_ERR_SUCCESS) {
            code = exr_encoding_run(job->context, 0, &pipeline);
        }
    }
    exr_encoding_destroy(job->context, &pipeline);
    return code;
}

parian_result parian_exr_write(const parian_env *env, const char *path, uint32_t width,
                               uint32_t height, const float (*rgba)[4])
{
    exr_job job = {.stream.env = env, .path = path, .width = width, .height = height};
    exr_context_initializer_t init = make_initializer(&job);
    init.write_fn = write_bytes;
    init.error_handler_fn = ignore_error;
    if (parian_picture_check_size(env, path, width, height) != PARIAN_OK) {
        return PARIAN_E_ARGUMENT;
    }
    exr_result_t code = exr_start_write(&job.context, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (code == EXR_ERR_SUCCESS) {
        code = write_header(&job);
        code = code == EXR_ERR_SUCCESS ? write_rows(&job, rgba) : code;
        exr_result_t finished = exr_finish(&job.context);
        code = code == EXR_ERR_SUCCESS ? finished : code;
    }
    code = job.no_memory ? EXR_ERR_OUT_OF_MEMORY : code;
    parian_result result = code == EXR_ERR_SUCCESS
                               ? parian_file_write(env, path, job.stream.data, job.stream.size)
                               : fail_exr(&job, PARIAN_E_COMPUTE, code);
    parian_free(env, job.stream.data);
    return result;
}

/* ---- reading -----------------------------------------------------------------------------------
 */
/* Which of our channels a channel of the file gives: bits 0 to 2 for R, G, B; Y gives all three. */
static unsigned channel_bits(const char *name)
{
    static const struct {
        const char *name;
        unsigned bits;
    } known[] = {{"R", 1}, {"G", 2}, {"B", 4}, {"Y", 7}};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(name, known[i].name) == 0) {
            return known[i].bits;
        }
    }
    return 0;
}

static parian_result check_channels(const exr_job *job)
{
    const exr_attr_chlist_t *list;
    exr_result_t code = exr_get_channels(job->context, 0, &list);
    unsigned have = 0;
    if (code != EXR_ERR_SUCCESS) {
        return fail_exr(job, PARIAN_E_FORMAT, code);
    }
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        unsigned bits = channel_bits(entry->name.str);
        if (bits && (entry->x_sampling != 1 || entry->y_sampling != 1)) {
            return parian_fail(job->stream.env, PARIAN_E_UNSUPPORTED,
                               "%s: channel %s is subsampled", job->path, entry->name.str);
        }
        have |= bits;
    }
    if (have != 7) {
        return parian_fail(job->stream.env, PARIAN_E_UNSUPPORTED,
                           "%s: no channels R, G, B and no Y", job->path);
    }
    return PARIAN_OK;
}

static parian_result read_header(exr_job *job)
{
    exr_attr_box2i_t window;
    exr_compression_t compression;
    exr_result_t code = exr_get_data_window(job->context, 0, &window);
    code = code == EXR_ERR_SUCCESS ? exr_get_compression(job->context, 0, &compression) : code;
    if (code != EXR_ERR_SUCCESS) {
        return fail_exr(job, PARIAN_E_FORMAT, code);
    }
    int64_t width = (int64_t)window.max.x - window.min.x + 1,
            height = (int64_t)window.max.y - window.min.y + 1;
    parian_result result =
        parian_picture_check_size(job->stream.env, job->path, width > 0 ? (uint64_t)width : 0,
                                  height > 0 ? (uint64_t)height : 0);
    job->width = (uint32_t)width;
    job->height = (uint32_t)height;
    job->top = window.min.y;
    job->dwa = compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB;
    return result == PARIAN_OK ? check_channels(job) : result;
}

/* Tell a chunk whose pixels begin at column x, row y of the picture where to put them. */
static void bind_targets(const exr_job *job, exr_decode_pipeline_t *pipeline, size_t x, size_t y)
{
    for (int c = 0; c < pipeline->channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        unsigned bits = channel_bits(channel->channel_name);
        int first = bits & 1 ? 0 : bits & 2 ? 1 : 2;
        channel->decode_to_ptr = NULL;
        if (bits) {
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_bytes_per_element = FLOAT_SIZE;
            channel->user_pixel_stride = CHANNELS_READ * FLOAT_SIZE;
            channel->user_line_stride = (int32_t)job->width * CHANNELS_READ * FLOAT_SIZE;
            channel->decode_to_ptr = (uint8_t *)&job->rgb[y * job->width + x][first];
        }
    }
}

static exr_result_t decode_chunk(const exr_job *job, exr_decode_pipeline_t *pipeline, bool first,
                                 const exr_chunk_info_t *chunk, size_t x, size_t y)
{
    if (x >= job->width || y >= job->height || (size_t)chunk->width > job->width - x ||
        (size_t)chunk->height > job->height - y) {
        return EXR_ERR_BAD_CHUNK_LEADER;
    }
    exr_result_t code = first ? exr_decoding_initialize(job->context, 0, chunk, pipeline)
                              : exr_decoding_update(job->context, 0, chunk, pipeline);
    if (code == EXR_ERR_SUCCESS) {
        bind_targets(job, pipeline, x, y);
        code = exr_decoding_choose_default_routines(job->context, 0, pipeline);
    }
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(job->context, 0, pipeline) : code;
}

static exr_result_t read_scanlines(const exr_job *job, exr_decode_pipeline_t *pipeline)
{
    int32_t rows_each = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(job->context, 0, &rows_each);
    if (code == EXR_ERR_SUCCESS && rows_each < 1) {
        return EXR_ERR_BAD_CHUNK_LEADER;
    }
    for (size_t y = 0; y < job->height && code == EXR_ERR_SUCCESS; y += (size_t)rows_each) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(job->context, 0, job->top + (int32_t)y, &chunk);
        if (code == EXR_ERR_SUCCESS) {
            code = decode_chunk(job, pipeline, y == 0, &chunk, 0, y);
        }
    }
    return code;
}

static exr_result_t read_tiles(const exr_job *job, exr_decode_pipeline_t *pipeline)
{
    uint32_t tile_width, tile_height;
    exr_tile_level_mode_t level;
    exr_tile_round_mode_t rounding;
    exr_result_t code =
        exr_get_tile_descriptor(job->context, 0, &tile_width, &tile_height, &level, &rounding);
    if (code == EXR_ERR_SUCCESS && (tile_width < 1 || tile_height < 1)) {
        return EXR_ERR_BAD_CHUNK_LEADER;
    }
    for (size_t y = 0; y < job->height && code == EXR_ERR_SUCCESS; y += tile_height) {
        for (size_t x = 0; x < job->width && code == EXR_ERR_SUCCESS; x += tile_width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(job->context, 0, (int)(x / tile_width),
                                            (int)(y / tile_height), 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS) {
                code = decode_chunk(job, pipeline, x == 0 && y == 0, &chunk, x, y);
            }
        }
    }
    return code;
}

static parian_result read_pixels(exr_job *job)
{
    exr_storage_t storage;
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code = exr_get_storage(job->context, 0, &storage);
    if (code == EXR_ERR_SUCCESS && job->dwa) {
        return parian_exr_read_dwa(job->stream.env, job->path, &job->width, &job->height,
                                   &job->rgb);
    }
    if (code == EXR_ERR_SUCCESS && storage != EXR_STORAGE_SCANLINE &&
        storage != EXR_STORAGE_TILED) {
        return parian_fail(job->stream.env, PARIAN_E_UNSUPPORTED,
                           "%s: deep OpenEXR data, a flat picture was expected", job->path);
    }
    job->rgb = parian_zalloc(job->stream.env, (size_t)job->width * job->height, sizeof *job->rgb);
    if (!job->rgb) {
        return parian_fail(job->stream.env, PARIAN_E_NOMEM, "%s: no memory for %u x %u pixels",
                           job->path, (unsigned)job->width, (unsigned)job->height);
    }
    if (code == EXR_ERR_SUCCESS) {
        code = storage == EXR_STORAGE_TILED ? read_tiles(job, &pipeline)
                                            : read_scanlines(job, &pipeline);
        exr_decoding_destroy(job->context, &pipeline);
    }
    return code == EXR_ERR_SUCCESS ? PARIAN_OK : fail_exr(job, PARIAN_E_FORMAT, code);
}

/* A lone Y was decoded into the first channel. */
static void spread_luminance(exr_job *job)
{
    const exr_attr_chlist_t *list;
    bool coloured = false;
    if (exr_get_channels(job->context, 0, &list) != EXR_ERR_SUCCESS) {
        return;
    }
    for (int i = 0; i < list->num_channels; i++) {
        coloured = coloured || strcmp(list->entries[i].name.str, "G") == 0;
    }
    for (size_t i = 0; !coloured && i < (size_t)job->width * job->height; i++) {
        job->rgb[i][1] = job->rgb[i][2] = job->rgb[i][0];
    }
}

parian_result parian_exr_read(const parian_env *env, const char *path, uint32_t *width,
                              uint32_t *height, float (**rgb)[3])
{
    exr_job job = {.stream.env = env, .path = path};
    exr_context_initializer_t init = make_initializer(&job);
    init.read_fn = read_bytes;
    init.size_fn = file_size;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    parian_result result =
        parian_file_read(env, path, PARIAN_PICTURE_FILE_MAX, &job.stream.data, &job.stream.size);
    if (result != PARIAN_OK) {
        return result;
    }
    exr_result_t code = exr_start_read(&job.context, path, &init);
    result = code == EXR_ERR_SUCCESS ? read_header(&job) : fail_exr(&job, PARIAN_E_FORMAT, code);
    if (result == PARIAN_OK) {
        result = read_pixels(&job);
    }
    if (result == PARIAN_OK) {
        spread_luminance(&job);
        *width = job.width;
        *height = job.height;
        *rgb = job.rgb;
    } else {
        parian_free(env, job.rgb);
    }
    if (code == EXR_ERR_SUCCESS) {
        exr_finish(&job.context);
    }
    parian_free(env, job.stream.data);
    return result;
}
