/* gl_upload.c - uploads as a list of jobs, done in slices.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_upload.h"

#include <string.h>

#include "core/memory.h"
#include "gl/gl_body.h"

enum { SCRATCH_SIZE = 2 << 20, PIECES = 8 };

/* ---- planning ---- */

/* Room for one more element; false marks the list as failed. */
static bool grow(gl_upload_list *list, void **array, uint32_t count, uint32_t *capacity,
                 size_t size)
{
    if (list->failed || count < *capacity) {
        return !list->failed;
    }
    uint32_t wanted = *capacity ? 2 * *capacity : 32;
    void *more = parian_alloc(list->env, wanted, size);
    if (!more) {
        list->failed = true;
        return false;
    }
    if (count > 0) {
        memcpy(more, *array, count * size);
    }
    parian_free(list->env, *array);
    *array = more;
    *capacity = wanted;
    return true;
}

static void add(gl_upload_list *list, gl_upload job)
{
    void *array = list->job;
    if (grow(list, &array, list->count, &list->capacity, sizeof job)) {
        list->job = array;
        list->job[list->count++] = job;
    }
}

void gl_upload_texture(gl_upload_list *list, parian_memory_part part, gl_texture *texture,
                       uint64_t count, gl_array_source source, const void *context)
{
    add(list, (gl_upload){part, texture, NULL, source, context, count, 0, 0, 0});
}

void gl_upload_target(gl_upload_list *list, parian_memory_part part, gl_texture *texture)
{
    add(list, (gl_upload){part, texture, NULL, NULL, NULL, 0, 0, 0, 0});
}

void gl_upload_mesh(gl_upload_list *list, gl_mesh *mesh, gl_array_source source,
                    const void *context)
{
    add(list, (gl_upload){PARIAN_MEMORY_MESHES, NULL, mesh, source, context, mesh->corner_count, 0,
                          0, 0});
}

/* A job without any work carries the preparation, so that one that has no texture is made and
 * dropped too. */
void gl_upload_prepare_begin(gl_upload_list *list, gl_preparation preparation)
{
    void *array = list->preparation;
    if (grow(list, &array, list->preparation_count, &list->preparation_capacity,
             sizeof preparation)) {
        list->preparation = array;
        list->preparation[list->preparation_count++] = preparation;
        add(list, (gl_upload){.first_of = list->preparation_count});
    }
}

void gl_upload_prepare_end(gl_upload_list *list)
{
    add(list, (gl_upload){.last_of = list->preparation_count});
}

parian_result gl_upload_plan_end(const gl_upload_list *list)
{
    return list->failed ? parian_fail(list->env, PARIAN_E_NOMEM, "no memory to plan the upload")
                        : PARIAN_OK;
}

/* ---- counting ---- */

static uint64_t bytes_of(const gl_upload *job)
{
    return job->texture ? job->texture->size : job->mesh ? job->mesh->size : 0;
}

void gl_upload_count(const gl_upload_list *list, parian_memory *memory)
{
    for (uint32_t j = 0; j < list->count; j++) {
        memory->bytes[list->job[j].part] += bytes_of(&list->job[j]);
        memory->total += bytes_of(&list->job[j]);
    }
}

static uint64_t element_size(const gl_upload *job)
{
    return job->mesh ? gl_mesh_corner_size() : gl_format_size(job->texture->format);
}

uint64_t gl_upload_left(const gl_upload_list *list)
{
    uint64_t left = 0;
    for (uint32_t j = list->next; j < list->count; j++) {
        const gl_upload *job = &list->job[j];
        uint64_t done = job->done ? job->done * element_size(job) : 0;
        left += bytes_of(job) > done ? bytes_of(job) - done : 0;
    }
    return left;
}

/* ---- running ---- */

typedef struct fill_work {
    const gl_upload *job;
    uint64_t first, count, piece, size;
    uint8_t *to;
} fill_work;

static void fill_piece(void *context, size_t index)
{
    const fill_work *work = context;
    uint64_t first = index * work->piece;
    if (first < work->count) {
        uint64_t rest = work->count - first;
        work->job->source(work->job->context, work->first + first,
                          rest < work->piece ? rest : work->piece, work->to + first * work->size);
    }
}

static void write_elements(gl_device *device, const gl_upload *job, uint64_t count,
                           const void *data)
{
    if (job->mesh) {
        gl_mesh_write(device, job->mesh, job->done, count, data);
    } else {
        gl_texture_write(device, job->texture, job->done, count, data);
    }
}

/* Storage for a job that has none. */
static parian_result allocate(gl_device *device, const gl_upload *job)
{
    device->part = job->part;
    return job->mesh ? gl_mesh_allocate(device, job->mesh)
                     : gl_texture_allocate(device, job->texture);
}

/* Elements of the next slice: whole rows, as far as room allows. */
static uint64_t slice_count(const gl_upload *job, uint64_t bytes)
{
    uint64_t row = job->mesh ? 64 : job->texture->width, left = job->count - job->done;
    uint64_t rows = bytes / (row * element_size(job));
    uint64_t count = rows ? rows * row : row;
    return count < left ? count : left;
}

static parian_result write_slice(gl_device *device, gl_upload_list *list, gl_upload *job,
                                 uint64_t max_bytes, uint64_t *written)
{
    const uint64_t size = element_size(job);
    uint64_t count;
    if (!job->source) {
        count = slice_count(job, max_bytes);
        write_elements(device, job, count, (const uint8_t *)job->context + job->done * size);
    } else {
        count = slice_count(job, max_bytes < SCRATCH_SIZE ? max_bytes : SCRATCH_SIZE);
        if (!list->scratch && !PARIAN_NEW(list->env, list->scratch, SCRATCH_SIZE)) {
            return parian_fail(list->env, PARIAN_E_NOMEM, "no memory to upload a slice of %d bytes",
                               SCRATCH_SIZE);
        }
        fill_work work = {job,  job->done,    count, (count + PIECES - 1) / PIECES,
                          size, list->scratch};
        parian_par(list->env, PIECES, fill_piece, &work);
        write_elements(device, job, count, list->scratch);
    }
    job->done += count;
    *written += count * size;
    return gl_error_check(device, "slice of an upload", count * size);
}

static parian_result run_job(gl_device *device, gl_upload_list *list, gl_upload *job,
                             uint64_t max_bytes, uint64_t *written)
{
    bool exists = job->mesh ? job->mesh->buffer != 0 : job->texture->name != 0;
    if (!exists) {
        parian_result result = allocate(device, job);
        if (result != PARIAN_OK) {
            return result;
        }
        *written += job->count ? 0 : bytes_of(job);
    }
    while (job->done < job->count && *written < max_bytes) {
        uint64_t done = job->done;
        parian_result result = write_slice(device, list, job, max_bytes - *written, written);
        if (result != PARIAN_OK) {
            job->done = done;
            return result;
        }
    }
    return PARIAN_OK;
}

static parian_result prepare(const gl_upload_list *list, const gl_upload *job)
{
    if (job->last_of) {
        const gl_preparation *old = &list->preparation[job->last_of - 1];
        old->drop(list->env, old->context);
    }
    if (job->first_of) {
        const gl_preparation *made = &list->preparation[job->first_of - 1];
        return made->make(list->env, made->context);
    }
    return PARIAN_OK;
}

parian_result gl_upload_run(gl_device *device, gl_upload_list *list, uint64_t max_bytes)
{
    uint64_t written = 0;
    parian_result result = PARIAN_OK;
    while (list->next < list->count && written < max_bytes) {
        gl_upload *job = &list->job[list->next];
        if (job->texture || job->mesh) {
            result = run_job(device, list, job, max_bytes, &written);
        } else {
            result = prepare(list, job);
        }
        if (result != PARIAN_OK) {
            return result;
        }
        if (job->done == job->count) {
            list->next++;
        }
    }
    return PARIAN_OK;
}

void gl_upload_list_free(gl_upload_list *list)
{
    for (uint32_t p = 0; p < list->preparation_count; p++) {
        list->preparation[p].drop(list->env, list->preparation[p].context);
    }
    parian_free(list->env, list->job);
    parian_free(list->env, list->preparation);
    parian_free(list->env, list->scratch);
    memset(list, 0, sizeof *list);
}
