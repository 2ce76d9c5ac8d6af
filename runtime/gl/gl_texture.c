/* gl_texture.c - textures: atlases, vectors, long arrays folded into layers.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_device.h"

typedef struct format_traits {
    GLint internal;
    GLenum format, type;
    uint32_t size; /* bytes of an element */
} format_traits;

static const format_traits traits_of[GL_FORMAT_COUNT] = {
    [GL_FORMAT_RGBA32F] = {GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    [GL_FORMAT_RG32F] = {GL_RG32F, GL_RG, GL_FLOAT, 8},
    [GL_FORMAT_RGB16F] = {GL_RGB16F, GL_RGB, GL_HALF_FLOAT, 6},
    [GL_FORMAT_RG32UI] = {GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8},
    [GL_FORMAT_RGBA32UI] = {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    [GL_FORMAT_R32UI] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    [GL_FORMAT_RGBA8] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [GL_FORMAT_DEPTH32F] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
};

parian_result gl_memory_add(gl_device *device, uint64_t size)
{
    if (size > device->memory_budget || device->memory.total > device->memory_budget - size) {
        return parian_fail(
            device->env, PARIAN_E_NOMEM,
            "%.1f MB more would exceed the budget of %.1f MB of GL memory (%.1f MB in "
            "use): raise memory_budget or draw less",
            1e-6 * (double)size, 1e-6 * (double)device->memory_budget,
            1e-6 * (double)device->memory.total);
    }
    device->memory.bytes[device->part] += size;
    device->memory.total += size;
    return PARIAN_OK;
}

void gl_memory_remove(gl_device *device, parian_memory_part part, uint64_t size)
{
    device->memory.bytes[part] -= size;
    device->memory.total -= size;
}

parian_result gl_error_check(gl_device *device, const char *what, uint64_t size)
{
    GLenum error = device->gl.GetError();
    if (error == GL_NO_ERROR) {
        return PARIAN_OK;
    }
    if (error == GL_OUT_OF_MEMORY) {
        return parian_fail(device->env, PARIAN_E_NOMEM,
                           "OpenGL has no memory for a %s of %.1f MB (%.1f MB in use)", what,
                           1e-6 * (double)size, 1e-6 * (double)device->memory.total);
    }
    return parian_fail(device->env, PARIAN_E_DEVICE, "OpenGL error 0x%04X for a %s of %.1f MB",
                       error, what, 1e-6 * (double)size);
}

/* ---- descriptions ---- */

static gl_texture describe(GLenum target, gl_format format, uint32_t width, uint32_t height,
                           uint32_t layers)
{
    gl_texture texture = {
        .target = target, .format = format, .width = width, .height = height, .layers = layers};
    texture.size = (uint64_t)width * height * layers * traits_of[format].size;
    return texture;
}

gl_texture gl_texture_describe(gl_format format, uint32_t width, uint32_t height)
{
    return describe(GL_TEXTURE_2D, format, width, height, 1);
}

gl_texture gl_vector_describe(uint64_t count)
{
    uint64_t rows = count ? (count + GL_VECTOR_WIDTH - 1) / GL_VECTOR_WIDTH : 1;
    return describe(GL_TEXTURE_2D, GL_FORMAT_RGBA32F, GL_VECTOR_WIDTH,
                    rows < UINT32_MAX ? (uint32_t)rows : UINT32_MAX, 1);
}

gl_texture gl_array_describe(gl_format format, uint64_t count)
{
    const uint64_t layer_count = (uint64_t)GL_ARRAY_WIDTH * GL_ARRAY_HEIGHT;
    uint64_t layers = count ? (count + layer_count - 1) / layer_count : 1;
    uint64_t rows = count ? (count + GL_ARRAY_WIDTH - 1) / GL_ARRAY_WIDTH : 1;
    return describe(GL_TEXTURE_2D_ARRAY, format, GL_ARRAY_WIDTH,
                    layers > 1 ? GL_ARRAY_HEIGHT : (uint32_t)rows,
                    layers <= GL_ARRAY_LAYERS_MAX ? (uint32_t)layers : UINT32_MAX);
}

gl_texture gl_depth_describe(uint32_t size, uint32_t layers)
{
    return describe(GL_TEXTURE_2D_ARRAY, GL_FORMAT_DEPTH32F, size, size, layers);
}

uint32_t gl_format_size(gl_format format)
{
    return traits_of[format].size;
}

/* ---- storage ---- */

static parian_result check_limits(gl_device *device, const gl_texture *texture)
{
    uint32_t side = (uint32_t)device->texture_max;
    if (texture->width <= side && texture->height <= side &&
        texture->layers <= (uint32_t)device->layers_max) {
        return PARIAN_OK;
    }
    return parian_fail(device->env, PARIAN_E_UNSUPPORTED,
                       "a texture of %u x %u x %u is needed, this OpenGL has at most %d x %d x %d",
                       texture->width, texture->height, texture->layers, device->texture_max,
                       device->texture_max, device->layers_max);
}

/* Name and nearest look-up. */
static void begin_texture(const parian_gl_api *gl, gl_texture *texture)
{
    GLenum target = texture->target;
    gl->GenTextures(1, &texture->name);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(target, texture->name);
    gl->TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
}

parian_result gl_texture_allocate(gl_device *device, gl_texture *texture)
{
    const parian_gl_api *gl = &device->gl;
    const format_traits *traits = &traits_of[texture->format];
    parian_result result = check_limits(device, texture);
    if (result == PARIAN_OK) {
        result = gl_memory_add(device, texture->size);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    texture->part = device->part;
    begin_texture(gl, texture);
    if (texture->target == GL_TEXTURE_2D) {
        gl->TexImage2D(GL_TEXTURE_2D, 0, traits->internal, (GLsizei)texture->width,
                       (GLsizei)texture->height, 0, traits->format, traits->type, NULL);
    } else {
        gl->TexImage3D(GL_TEXTURE_2D_ARRAY, 0, traits->internal, (GLsizei)texture->width,
                       (GLsizei)texture->height, (GLsizei)texture->layers, 0, traits->format,
                       traits->type, NULL);
    }
    result = gl_error_check(device, "texture", texture->size);
    if (result != PARIAN_OK) {
        gl->DeleteTextures(1, &texture->name);
        gl_memory_remove(device, texture->part, texture->size);
        texture->name = 0;
    }
    return result;
}

/* A block of texels of one layer; texture is bound. */
static void write_block(gl_device *device, const gl_texture *texture, uint64_t row, uint64_t width,
                        uint64_t rows, const uint8_t *data)
{
    const format_traits *traits = &traits_of[texture->format];
    GLint y = (GLint)(row % texture->height), layer = (GLint)(row / texture->height);
    if (texture->target == GL_TEXTURE_2D) {
        device->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, y, (GLsizei)width, (GLsizei)rows,
                                 traits->format, traits->type, data);
    } else {
        device->gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, y, layer, (GLsizei)width, (GLsizei)rows,
                                 1, traits->format, traits->type, data);
    }
}

void gl_texture_write(gl_device *device, const gl_texture *texture, uint64_t first, uint64_t count,
                      const void *data)
{
    const uint8_t *from = data;
    const size_t size = traits_of[texture->format].size;
    uint64_t row = first / texture->width;
    device->gl.ActiveTexture(GL_TEXTURE0);
    device->gl.BindTexture(texture->target, texture->name);
    while (count >= texture->width) {
        uint64_t rows = count / texture->width, room = texture->height - row % texture->height;
        rows = rows < room ? rows : room;
        write_block(device, texture, row, texture->width, rows, from);
        row += rows;
        count -= rows * texture->width;
        from += rows * texture->width * size;
    }
    if (count > 0) {
        write_block(device, texture, row, count, 1, from);
    }
}

/* Storage and contents of a described texture; after a failure there is no texture. */
static parian_result create(gl_device *device, gl_texture wanted, uint64_t count, const void *data,
                            gl_texture *texture)
{
    parian_result result = gl_texture_allocate(device, &wanted);
    if (result != PARIAN_OK) {
        return result;
    }
    if (data) {
        gl_texture_write(device, &wanted, 0, count, data);
        result = gl_error_check(device, "texture", wanted.size);
    }
    if (result != PARIAN_OK) {
        gl_texture_destroy(device, &wanted);
        return result;
    }
    *texture = wanted;
    return PARIAN_OK;
}

parian_result gl_texture_create(gl_device *device, gl_format format, uint32_t width,
                                uint32_t height, const void *data, gl_texture *texture)
{
    return create(device, gl_texture_describe(format, width, height), (uint64_t)width * height,
                  data, texture);
}

parian_result gl_array_upload(gl_device *device, gl_format format, uint64_t count, const void *data,
                              gl_texture *texture)
{
    return create(device, gl_array_describe(format, count), count, data, texture);
}

static bool same_storage(const gl_texture *a, const gl_texture *b)
{
    return a->name && a->target == b->target && a->format == b->format && a->width == b->width &&
           a->height == b->height && a->layers == b->layers;
}

parian_result gl_texture_update(gl_device *device, const gl_texture *wanted, uint64_t count,
                                const void *data, gl_texture *texture)
{
    if (!same_storage(texture, wanted)) {
        gl_texture_destroy(device, texture);
        return create(device, *wanted, count, data, texture);
    }
    if (data) {
        gl_texture_write(device, texture, 0, count, data);
    }
    return PARIAN_OK;
}

void gl_texture_destroy(gl_device *device, gl_texture *texture)
{
    if (texture->name) {
        device->gl.DeleteTextures(1, &texture->name);
        gl_memory_remove(device, texture->part, texture->size);
    }
    memset(texture, 0, sizeof *texture);
}

void gl_texture_read(gl_device *device, const gl_texture *texture, void *pixels)
{
    const format_traits *traits = &traits_of[texture->format];
    const parian_gl_api *gl = &device->gl;
    gl->BindFramebuffer(GL_FRAMEBUFFER, device->framebuffer);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture->name, 0);
    for (GLenum a = 1; a < GL_TARGET_MAX; a++) {
        gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + a, GL_TEXTURE_2D, 0, 0);
    }
    gl->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl->ReadPixels(0, 0, (GLsizei)texture->width, (GLsizei)texture->height, traits->format,
                   traits->type, pixels);
}
