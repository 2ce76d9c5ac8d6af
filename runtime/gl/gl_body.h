/* gl_body.h - what the passes read and write of one body, as textures.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_BODY_H
#define PARIAN_GL_BODY_H

#include "core/body.h"
#include "core/kernel.h"
#include "gl/gl_device.h"
#include "renderer_internal.h"

enum { GL_REGISTER_MAX = 2 * PARIAN_MAX_OPERATORS };

/* A mesh with its corners unrolled: position, normal, uv, chart colour. */
typedef struct gl_mesh {
    GLuint vertex_array, buffer;
    uint32_t corner_count;
    uint64_t size;
} gl_mesh;

typedef struct gl_operator {
    uint32_t segment_count;
    gl_texture segment, run, factor, row_segment, scale, partial;
} gl_operator;

/* What all instances of a body share. */
typedef struct gl_body {
    gl_mesh mesh;
    /* Atlases. */
    gl_texture position, normal, barycentric, info;
    gl_texture normal_map, albedo; /* with gutters; absent where the body has none */
    gl_texture values;             /* to paint on the body; absent until they are given */
    /* Restriction, filter, gutter. */
    gl_texture feed_offset, feed, feed_weight;
    gl_texture kernel, border, neighbour, border_kernel;
    gl_texture gutter_source, gutter_weight;
    uint32_t interior_count;
    float channel_scale[3];
    /* Operators; registers to write to while others are read. */
    gl_operator operators[PARIAN_MAX_OPERATORS];
    uint32_t register_count;
    gl_texture spare[GL_REGISTER_MAX];
} gl_body;

/* What a body of one instance has of its own: the light on it and in it. */
typedef struct gl_lit {
    gl_texture irradiance, local, global;
    gl_texture shown_irradiance, shown_local, shown_global; /* with gutters */
    gl_texture registers[GL_REGISTER_MAX];
} gl_lit;

parian_result gl_body_create(gl_device *device, const parian_body *body, gl_body *made);
/* Values to paint on the body, [texel_count]. */
parian_result gl_body_set_values(gl_device *device, const parian_body *body,
                                 const float (*value)[3], gl_body *made);
void gl_body_destroy(gl_device *device, gl_body *made);

parian_result gl_lit_create(gl_device *device, const parian_body *body, gl_lit *made);
void gl_lit_destroy(gl_device *device, gl_lit *made);

parian_result gl_mesh_create(gl_device *device, const parian_body *body,
                             const parian_surrounding *surrounding, gl_mesh *mesh);
void gl_mesh_destroy(gl_device *device, gl_mesh *mesh);
void gl_mesh_draw(gl_device *device, const gl_mesh *mesh);

parian_result gl_operator_create(gl_device *device, const parian_operator *op, gl_operator *made);
void gl_operator_destroy(gl_device *device, gl_operator *made);

#endif
