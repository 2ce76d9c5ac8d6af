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
    if (size > device->memory_budget || device->memory > device->memory_budget - size) {
        return parian_fail(
            device->env, PARIAN_E_NOMEM,
            "%llu bytes more would exceed the budget of %llu bytes of GL memory (%llu in use)",
            (unsigned long long)size, (unsigned long long)device->memory_budget,
            (unsigned long long)device->memory);
    }
    device->memory += size;
    return PARIAN_OK;
}

/* Name and nearest look-up; counts the memory. */
static parian_result begin_texture(gl_device *device, GLenum target, gl_texture *texture)
{
    const parian_gl_api *gl = &device->gl;
    uint64_t size = (uint64_t)texture->width * texture->height * texture->layers *
                    traits_of[texture->format].size;
    parian_result result = gl_memory_add(device, size);
    if (result != PARIAN_OK) {
        return result;
    }
    texture->target = target;
    texture->size = size;
    gl->GenTextures(1, &texture->name);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(target, texture->name);
    gl->TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl->TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl->TexParameteri(target, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(target, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl->TexParameteri(target, GL_TEXTURE_MAX_LEVEL, 0);
    return PARIAN_OK;
}

/* GL answers a failed upload with an error; keep it from reaching a later call. */
static parian_result end_texture(gl_device *device, const gl_texture *texture)
{
    GLenum error = device->gl.GetError();
    if (error != GL_NO_ERROR) {
        return parian_fail(device->env,
                           error == GL_OUT_OF_MEMORY ? PARIAN_E_NOMEM : PARIAN_E_DEVICE,
                           "OpenGL error 0x%04X for a texture of %u x %u x %u", error,
                           texture->width, texture->height, texture->layers);
    }
    return PARIAN_OK;
}

static parian_result refuse_size(gl_device *device, uint64_t width, uint64_t height,
                                 uint64_t layers)
{
    return parian_fail(
        device->env, PARIAN_E_UNSUPPORTED,
        "a texture of %llu x %llu x %llu is needed, this OpenGL has at most %d x %d x %d",
        (unsigned long long)width, (unsigned long long)height, (unsigned long long)layers,
        device->texture_max, device->texture_max, device->layers_max);
}

parian_result gl_texture_create(gl_device *device, gl_format format, uint32_t width,
                                uint32_t height, const void *data, gl_texture *texture)
{
    const format_traits *traits = &traits_of[format];
    *texture = (gl_texture){.format = format, .width = width, .height = height, .layers = 1};
    if (width > (uint32_t)device->texture_max || height > (uint32_t)device->texture_max) {
        return refuse_size(device, width, height, 1);
    }
    parian_result result = begin_texture(device, GL_TEXTURE_2D, texture);
    if (result != PARIAN_OK) {
        return result;
    }
    device->gl.TexImage2D(GL_TEXTURE_2D, 0, traits->internal, (GLsizei)width, (GLsizei)height, 0,
                          traits->format, traits->type, data);
    return end_texture(device, texture);
}

parian_result gl_vector_create(gl_device *device, uint64_t count, gl_texture *texture)
{
    uint64_t rows = count ? (count + GL_VECTOR_WIDTH - 1) / GL_VECTOR_WIDTH : 1;
    if (rows > (uint64_t)device->texture_max) {
        return refuse_size(device, GL_VECTOR_WIDTH, rows, 1);
    }
    return gl_texture_create(device, GL_FORMAT_RGBA32F, GL_VECTOR_WIDTH, (uint32_t)rows, NULL,
                             texture);
}

/* Fill one layer: whole rows, then what is left of the last one. */
static void upload_layer(gl_device *device, const format_traits *traits, uint32_t layer,
                         uint64_t count, const uint8_t *data)
{
    GLsizei rows = (GLsizei)(count / GL_ARRAY_WIDTH), rest = (GLsizei)(count % GL_ARRAY_WIDTH);
    if (rows > 0) {
        device->gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, (GLint)layer, GL_ARRAY_WIDTH, rows,
                                 1, traits->format, traits->type, data);
    }
    if (rest > 0) {
        device->gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, rows, (GLint)layer, rest, 1, 1,
                                 traits->format, traits->type,
                                 data + (size_t)rows * GL_ARRAY_WIDTH * traits->size);
    }
}

parian_result gl_array_create(gl_device *device, gl_format format, uint64_t count,
                              gl_array_source source, const void *context, gl_texture *texture)
{
    const format_traits *traits = &traits_of[format];
    const uint64_t layer_count = (uint64_t)GL_ARRAY_WIDTH * GL_ARRAY_HEIGHT;
    uint64_t layers = count ? (count + layer_count - 1) / layer_count : 1;
    uint64_t rows = count ? (count + GL_ARRAY_WIDTH - 1) / GL_ARRAY_WIDTH : 1;
    uint8_t *part = NULL;
    if (layers > (uint64_t)device->layers_max || count > UINT32_MAX) {
        return refuse_size(device, GL_ARRAY_WIDTH, GL_ARRAY_HEIGHT, layers);
    }
    *texture = (gl_texture){.format = format,
                            .width = GL_ARRAY_WIDTH,
                            .height = layers > 1 ? GL_ARRAY_HEIGHT : (uint32_t)rows,
                            .layers = (uint32_t)layers};
    parian_result result = begin_texture(device, GL_TEXTURE_2D_ARRAY, texture);
    if (result != PARIAN_OK) {
        return result;
    }
    device->gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, traits->internal, GL_ARRAY_WIDTH,
                          (GLsizei)texture->height, (GLsizei)layers, 0, traits->format,
                          traits->type, NULL);
    part = parian_alloc(device->env, count < layer_count ? count : layer_count, traits->size);
    if (!part) {
        return parian_fail(device->env, PARIAN_E_NOMEM, "no memory to upload %llu elements",
                           (unsigned long long)count);
    }
    for (uint64_t first = 0; first < count; first += layer_count) {
        uint64_t many = count - first < layer_count ? count - first : layer_count;
        source(context, first, many, part);
        upload_layer(device, traits, (uint32_t)(first / layer_count), many, part);
    }
    parian_free(device->env, part);
    return end_texture(device, texture);
}

typedef struct memory_source {
    const uint8_t *data;
    size_t size;
} memory_source;

static void copy_memory(const void *context, uint64_t first, uint64_t count, void *to)
{
    const memory_source *source = context;
    memcpy(to, source->data + first * source->size, count * source->size);
}

parian_result gl_array_upload(gl_device *device, gl_format format, uint64_t count, const void *data,
                              gl_texture *texture)
{
    memory_source source = {data, traits_of[format].size};
    return gl_array_create(device, format, count, copy_memory, &source, texture);
}

parian_result gl_depth_create(gl_device *device, uint32_t size, uint32_t layers,
                              gl_texture *texture)
{
    const format_traits *traits = &traits_of[GL_FORMAT_DEPTH32F];
    *texture =
        (gl_texture){.format = GL_FORMAT_DEPTH32F, .width = size, .height = size, .layers = layers};
    if (size > (uint32_t)device->texture_max || layers > (uint32_t)device->layers_max) {
        return refuse_size(device, size, size, layers);
    }
    parian_result result = begin_texture(device, GL_TEXTURE_2D_ARRAY, texture);
    if (result != PARIAN_OK) {
        return result;
    }
    device->gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, traits->internal, (GLsizei)size, (GLsizei)size,
                          (GLsizei)layers, 0, traits->format, traits->type, NULL);
    return end_texture(device, texture);
}

void gl_texture_destroy(gl_device *device, gl_texture *texture)
{
    if (texture->name) {
        device->gl.DeleteTextures(1, &texture->name);
        device->memory -= texture->size;
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
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT1, GL_TEXTURE_2D, 0, 0);
    gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT2, GL_TEXTURE_2D, 0, 0);
    gl->ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl->ReadPixels(0, 0, (GLsizei)texture->width, (GLsizei)texture->height, traits->format,
                   traits->type, pixels);
}
