/* gl_body.h - what the passes read and write of one body, as textures.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_BODY_H
#define PARIAN_GL_BODY_H

#include "core/body.h"
#include "core/kernel.h"
#include "gl/gl_upload.h"
#include "method/restriction.h"
#include "renderer_internal.h"

enum { GL_REGISTER_MAX = 2 * PARIAN_MAX_OPERATORS };

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
    gl_texture origin;             /* where rays of the first set of samples start */
    gl_texture set_origin,
        irradiance_spare; /* of another set, and E with it; absent until refined */
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
    gl_texture radiosity; /* local and global, with gutters; absent until it is handed out */
    gl_texture registers[GL_REGISTER_MAX];
} gl_lit;

/* An operator's rows cut into segments, as long as they are uploaded. */
typedef struct gl_operator_source {
    const parian_operator *op;
    uint32_t segment_count;
    struct gl_segment *segment; /* [segment_count] */
    uint32_t *row_segment;      /* [row_count + 1] */
} gl_operator_source;

/* What the jobs of a body read; lives until they are done. */
typedef struct gl_body_source {
    const parian_body *body;
    gl_body *made;
    parian_kernels kernels;
    parian_restriction restriction;
    float (*origin)[3]; /* [texel_count] */
    gl_operator_source operators[PARIAN_MAX_OPERATORS];
} gl_body_source;

/* Describe all textures of a body and add the jobs that fill them. Needs no GL. */
void gl_body_plan(const parian_body *body, gl_body_source *source, gl_body *made,
                  gl_upload_list *list);
/* Jobs that write an edited body's weights, kernels, factors and scales over those that are there.
 */
parian_result gl_body_edit(const parian_edited_body *edited, gl_body_source *source, gl_body *made,
                           gl_upload_list *list);
/* Values to paint on the body, [texel_count]. */
parian_result gl_body_set_values(gl_device *device, const parian_body *body,
                                 const float (*value)[3], gl_body *made);
void gl_body_destroy(gl_device *device, gl_body *made);

/* The textures of an instance, empty; and their bytes. */
parian_result gl_lit_create(gl_device *device, const parian_body *body, gl_lit *made);
void gl_lit_count(const parian_body *body, uint32_t instance_count, parian_memory *memory);
/* Errors: those of gl_texture_allocate. */
parian_result gl_lit_add_radiosity(gl_device *device, gl_lit *made);
void gl_lit_destroy(gl_device *device, gl_lit *made);

void gl_mesh_plan_body(gl_upload_list *list, const parian_body *body, gl_mesh *mesh);
void gl_mesh_plan_surrounding(gl_upload_list *list, const parian_surrounding *surrounding,
                              gl_mesh *mesh);
uint32_t gl_mesh_corner_size(void); /* bytes */
/* Storage of a planned mesh; then its corners [first, first + count). */
parian_result gl_mesh_allocate(gl_device *device, gl_mesh *mesh);
void gl_mesh_write(gl_device *device, const gl_mesh *mesh, uint64_t first, uint64_t count,
                   const void *corners);
void gl_mesh_destroy(gl_device *device, gl_mesh *mesh);
void gl_mesh_draw(gl_device *device, const gl_mesh *mesh);

void gl_operator_plan(const parian_operator *op, gl_operator_source *source, gl_operator *made,
                      gl_upload_list *list);
/* Jobs that write another operator with the same runs over one that is there. */
void gl_operator_edit(const parian_operator *op, gl_operator *made, gl_upload_list *list);
void gl_operator_destroy(gl_device *device, gl_operator *made);

#endif
