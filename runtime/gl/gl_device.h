/* gl_device.h - a GL context with our programs: textures, gather passes, kept state.
 *
 * Long arrays are textures of layers of 2048 x 512 texels, vectors (results of passes) are textures
 * of rows of 2048, atlases are square. shaders/arrays.glsl computes the places.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_DEVICE_H
#define PARIAN_GL_DEVICE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "gl/gl_api.h"

typedef enum gl_format {
    GL_FORMAT_RGBA32F,
    GL_FORMAT_RG32F,
    GL_FORMAT_RGB16F,
    GL_FORMAT_RG32UI,
    GL_FORMAT_RGBA32UI,
    GL_FORMAT_R32UI,
    GL_FORMAT_RGBA8,
    GL_FORMAT_DEPTH32F,
    GL_FORMAT_COUNT
} gl_format;

typedef struct gl_texture {
    GLuint name;
    GLenum target;
    gl_format format;
    uint32_t width, height, layers;
    uint64_t size; /* bytes, as counted */
} gl_texture;

typedef enum gl_program_id {
    GL_PROGRAM_SHADOW,
    GL_PROGRAM_IRRADIANCE,
    GL_PROGRAM_RESTRICT,
    GL_PROGRAM_SEGMENT,
    GL_PROGRAM_ROWS,
    GL_PROGRAM_FILTER,
    GL_PROGRAM_GUTTER,
    GL_PROGRAM_BODY,
    GL_PROGRAM_SURROUNDING,
    GL_PROGRAM_RESOLVE,
    GL_PROGRAM_LUMINANCE,
    GL_PROGRAM_TONE,
    GL_PROGRAM_COUNT
} gl_program_id;

enum { GL_VECTOR_WIDTH = 2048, GL_ARRAY_WIDTH = 2048, GL_ARRAY_HEIGHT = 512, GL_UNIT_MAX = 16 };

/* What of the application's state our passes change, and put back. */
typedef struct gl_kept_state {
    GLint draw_framebuffer, read_framebuffer, renderbuffer, viewport[4], program, vertex_array,
        array_buffer;
    GLint active_texture, depth_func, pack_buffer, unpack_buffer, pixel_store[8];
    GLint sampler[GL_UNIT_MAX];
    GLboolean color_mask[4], depth_mask, enabled[8];
} gl_kept_state;

typedef struct gl_device {
    const parian_env *env;
    parian_gl_api gl;
    bool es;
    GLint texture_max, layers_max;
    uint64_t memory, memory_budget;
    GLuint framebuffer, empty_vertex_array;
    GLuint program[GL_PROGRAM_COUNT];
    gl_program_id current;
    int unit; /* next free one of the current pass */
    gl_kept_state kept;
} gl_device;

/* Load functions, check version and extensions, build programs. name: room for the renderer's name.
 * Errors: PARIAN_E_UNSUPPORTED, PARIAN_E_DEVICE. After an error the device is destroyed as usual.
 */
parian_result gl_device_init(const parian_env *env, void *(*get_proc_address)(const char *name),
                             uint64_t memory_budget, gl_device *device, char *name,
                             size_t name_size);
void gl_device_destroy(gl_device *device);

/* Bracket all work in the application's context: state is kept and put back, texture units that
 * were used end up without textures. gl_device_leave turns a GL error into a result. */
void gl_device_enter(gl_device *device);
parian_result gl_device_leave(gl_device *device, parian_result result, const char *what);

/* Textures. data may be NULL (2-D: contents undefined). Errors: PARIAN_E_NOMEM (budget or GL),
 * PARIAN_E_UNSUPPORTED (too large for this device). A zeroed texture may be destroyed. */
parian_result gl_texture_create(gl_device *device, gl_format format, uint32_t width,
                                uint32_t height, const void *data, gl_texture *texture);
/* A vector of count elements. */
parian_result gl_vector_create(gl_device *device, uint64_t count, gl_texture *texture);
/* Write elements [first, first + count) of a long array to `to`. */
typedef void (*gl_array_source)(const void *context, uint64_t first, uint64_t count, void *to);
parian_result gl_array_create(gl_device *device, gl_format format, uint64_t count,
                              gl_array_source source, const void *context, gl_texture *texture);
/* The same from memory. */
parian_result gl_array_upload(gl_device *device, gl_format format, uint64_t count, const void *data,
                              gl_texture *texture);
/* Layers of a depth map. */
parian_result gl_depth_create(gl_device *device, uint32_t size, uint32_t layers,
                              gl_texture *texture);
void gl_texture_destroy(gl_device *device, gl_texture *texture);
/* Count memory of buffers; PARIAN_E_NOMEM above the budget. */
parian_result gl_memory_add(gl_device *device, uint64_t size);

/* A pass: begin with targets (count may be 0: framebuffer is the caller's), set inputs, draw. */
void gl_pass_begin(gl_device *device, gl_program_id program, const gl_texture *const *target,
                   int count);
void gl_pass_use(gl_device *device, gl_program_id program); /* program alone */
void gl_pass_texture(gl_device *device, const char *name, const gl_texture *texture);
void gl_pass_int(gl_device *device, const char *name, int value);
void gl_pass_float(gl_device *device, const char *name, float value);
void gl_pass_vec3(gl_device *device, const char *name, int count, const float *value);
void gl_pass_vec4(gl_device *device, const char *name, int count, const float *value);
void gl_pass_mat4(gl_device *device, const char *name, const float value[16]);
void gl_pass_quad(gl_device *device); /* one fragment for each texel of the target */

/* Read a 2-D float texture: [height * width][4], row 0 first. */
void gl_texture_read(gl_device *device, const gl_texture *texture, void *pixels);

/* gl_program.c: compile and link every program. */
parian_result gl_programs_build(gl_device *device);

#endif
