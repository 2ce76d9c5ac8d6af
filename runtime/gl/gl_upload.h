/* gl_upload.h - what a renderer must upload, as a list of jobs that are planned without GL and done
 * in slices.
 *
 * Planning describes every texture and mesh, so that their bytes are known before any of them
 * exists. Running a job makes its storage, then writes its elements a few rows at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_GL_UPLOAD_H
#define PARIAN_GL_UPLOAD_H

#include "gl/gl_device.h"

/* A mesh with its corners unrolled: position, normal, uv, chart colour. */
typedef struct gl_mesh {
    GLuint vertex_array, buffer;
    uint32_t corner_count;
    uint64_t size;
} gl_mesh;

/* Write elements [first, first + count) to `to`; first is a multiple of a row. Several calls may
 * run at a time. */
typedef void (*gl_array_source)(const void *context, uint64_t first, uint64_t count, void *to);

/* What jobs read may have to be computed first, and may be dropped after them. */
typedef struct gl_preparation {
    parian_result (*make)(const parian_env *env, void *context);
    void (*drop)(const parian_env *env, void *context); /* also of what was never made */
    void *context;
} gl_preparation;

typedef struct gl_upload {
    parian_memory_part part;
    gl_texture *texture;    /* described; or */
    gl_mesh *mesh;          /* counted */
    gl_array_source source; /* NULL: context is the elements, or NULL for no contents */
    const void *context;
    uint64_t count, done;       /* elements */
    uint32_t first_of, last_of; /* preparations that this job begins and ends, from 1; 0: none */
} gl_upload;

typedef struct gl_upload_list {
    const parian_env *env;
    gl_upload *job;
    gl_preparation *preparation;
    uint32_t count, capacity, next, preparation_count, preparation_capacity;
    bool failed; /* no memory to plan */
    uint8_t *scratch;
} gl_upload_list;

/* Add jobs. A failure is remembered, so that gl_upload_plan_end alone need be asked. */
void gl_upload_texture(gl_upload_list *list, parian_memory_part part, gl_texture *texture,
                       uint64_t count, gl_array_source source, const void *context);
/* A texture without contents: a target of passes. */
void gl_upload_target(gl_upload_list *list, parian_memory_part part, gl_texture *texture);
void gl_upload_mesh(gl_upload_list *list, gl_mesh *mesh, gl_array_source source,
                    const void *context);
/* Jobs added between the two read what the preparation makes. */
void gl_upload_prepare_begin(gl_upload_list *list, gl_preparation preparation);
void gl_upload_prepare_end(gl_upload_list *list);
/* Errors: PARIAN_E_NOMEM. */
parian_result gl_upload_plan_end(const gl_upload_list *list);

/* Bytes of all jobs, added by part; bytes that are not done yet. */
void gl_upload_count(const gl_upload_list *list, parian_memory *memory);
uint64_t gl_upload_left(const gl_upload_list *list);

/* Do jobs until about max_bytes are written (at least one row; a row is up to 256 kB). After a
 * failure the job that failed is tried anew by the next call. Errors: PARIAN_E_NOMEM,
 * PARIAN_E_UNSUPPORTED, PARIAN_E_DEVICE. */
parian_result gl_upload_run(gl_device *device, gl_upload_list *list, uint64_t max_bytes);

/* Forget the jobs; textures and meshes stay. A zeroed list is fine. */
void gl_upload_list_free(gl_upload_list *list);

#endif
