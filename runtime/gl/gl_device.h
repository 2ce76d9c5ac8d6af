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
#include "parian/runtime.h"

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
    uint64_t size;           /* bytes, as counted */
    parian_memory_part part; /* for which they count */
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

enum {
    GL_VECTOR_WIDTH = 2048,
    GL_ARRAY_WIDTH = 2048,
    GL_ARRAY_HEIGHT = 512,
    GL_ARRAY_LAYERS_MAX = 4096, /* shaders count elements with 32 bits */
    GL_UNIT_MAX = 16,
    GL_TARGET_MAX = 4 /* which both APIs promise */
};

/* The application's state that our passes change or depend on, and put back. */
enum {
    GL_KEPT_ENABLE_MAX = 24,
    GL_KEPT_PIXEL_STORE_MAX = 12,
    GL_KEPT_BUFFER_MAX = 8 /* draw buffers with colour masks and blending of their own */
};
typedef struct gl_kept_state {
    GLint draw_framebuffer, read_framebuffer, renderbuffer, program, vertex_array, array_buffer,
        pack_buffer, unpack_buffer, active_texture, depth_func, clamp_read;
    GLint viewport[4], polygon_mode[2], pixel_store[GL_KEPT_PIXEL_STORE_MAX];
    GLint texture[GL_UNIT_MAX], texture_array[GL_UNIT_MAX], sampler[GL_UNIT_MAX];
    GLfloat depth_range[2];
    GLint buffer_count;
    GLboolean blend[GL_KEPT_BUFFER_MAX], color_mask[GL_KEPT_BUFFER_MAX][4], depth_mask,
        enabled[GL_KEPT_ENABLE_MAX];
} gl_kept_state;

typedef struct gl_device {
    const parian_env *env;
    parian_gl_api gl;
    bool es;
    int version; /* 33 is 3.3 */
    bool lost; /* the context is: nothing works any more */
    GLint texture_max, layers_max;
    parian_memory memory; /* in use */
    uint64_t memory_budget;
    parian_memory_part part; /* to which new textures and buffers count */
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

/* Whether each draw buffer has a colour mask and blending of its own. */
static inline bool gl_device_has_indexed(const gl_device *device)
{
    return !device->es || device->version >= 32;
}

/* gl_kept.c: bracket all work in the application's context. Its state is kept and put back; an
 * error that was pending before is dropped with a warning. gl_device_leave turns a GL error into a
 * result.
 */
void gl_device_enter(gl_device *device);
parian_result gl_device_leave(gl_device *device, parian_result result, const char *what);

/* What textures would be, without making them: a 2-D one, a vector of count elements, a long array,
 * layers of depth maps. */
gl_texture gl_texture_describe(gl_format format, uint32_t width, uint32_t height);
gl_texture gl_vector_describe(uint64_t count);
gl_texture gl_array_describe(gl_format format, uint64_t count);
gl_texture gl_depth_describe(uint32_t size, uint32_t layers);
uint32_t gl_format_size(gl_format format); /* bytes of an element */

/* Storage of a described texture, contents undefined. Errors: PARIAN_E_NOMEM (budget or GL),
 * PARIAN_E_UNSUPPORTED (too large for this device), PARIAN_E_DEVICE; it is then still only
 * described. */
parian_result gl_texture_allocate(gl_device *device, gl_texture *texture);
/* Write elements [first, first + count), row by row; first is the start of a row. */
void gl_texture_write(gl_device *device, const gl_texture *texture, uint64_t first, uint64_t count,
                      const void *data);
/* Storage and contents at once; data may be NULL. After an error *texture is as it was. A zeroed
 * texture may be destroyed. */
parian_result gl_texture_create(gl_device *device, gl_format format, uint32_t width,
                                uint32_t height, const void *data, gl_texture *texture);
parian_result gl_array_upload(gl_device *device, gl_format format, uint64_t count, const void *data,
                              gl_texture *texture);
/* New contents; storage is made anew only where the description changed. After an error the texture
 * is absent or holds what it held. */
parian_result gl_texture_update(gl_device *device, const gl_texture *wanted, uint64_t count,
                                const void *data, gl_texture *texture);
void gl_texture_destroy(gl_device *device, gl_texture *texture);

/* Count memory of buffers for the current part; PARIAN_E_NOMEM above the budget. */
parian_result gl_memory_add(gl_device *device, uint64_t size);
void gl_memory_remove(gl_device *device, parian_memory_part part, uint64_t size);
/* GL answers a failed allocation with an error: make it a result, so that it reaches no later call.
 */
parian_result gl_error_check(gl_device *device, const char *what, uint64_t size);

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
