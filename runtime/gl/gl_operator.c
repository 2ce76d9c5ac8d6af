/* gl_operator.c - a sparse operator as textures: rows cut into segments of a few hundred factors,
 * so that no fragment has to walk a long row alone.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_body.h"

enum { SEGMENT_FACTORS = 256 };

typedef struct gl_segment {
    uint32_t run, run_count, factor, unused;
} gl_segment;

/* Cut the runs of each row; with no place to write, counts the segments. */
static uint32_t cut_rows(const parian_operator *op, gl_segment *segment, uint32_t *row_segment)
{
    uint32_t count = 0;
    for (uint32_t row = 0; row < op->row_count; row++) {
        if (row_segment) {
            row_segment[row] = count;
        }
        uint32_t run = op->run_offset[row], last = op->run_offset[row + 1];
        while (run < last) {
            uint32_t first = run, factors = op->run_count[run++];
            while (run < last && factors + op->run_count[run] <= SEGMENT_FACTORS) {
                factors += op->run_count[run++];
            }
            if (segment) {
                segment[count] =
                    (gl_segment){first, run - first, (uint32_t)op->run_factor[first], 0};
            }
            count++;
        }
    }
    if (row_segment) {
        row_segment[op->row_count] = count;
    }
    return count;
}

static void copy_runs(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_operator *op = context;
    uint32_t(*run)[2] = to;
    for (uint64_t i = 0; i < count; i++) {
        run[i][0] = op->run_column[first + i];
        run[i][1] = op->run_count[first + i];
    }
}

static void copy_scales(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_operator *op = context;
    float(*scale)[4] = to;
    for (uint64_t i = 0; i < count; i++) {
        memcpy(scale[i], op->scale[first + i], sizeof op->scale[0]);
        scale[i][3] = 1.0f;
    }
}

static void drop_segments(const parian_env *env, void *context)
{
    gl_operator_source *source = context;
    parian_free(env, source->segment);
    parian_free(env, source->row_segment);
    source->segment = NULL;
    source->row_segment = NULL;
}

static parian_result make_segments(const parian_env *env, void *context)
{
    gl_operator_source *source = context;
    if (!PARIAN_NEW(env, source->segment, source->segment_count) ||
        !PARIAN_NEW(env, source->row_segment, (size_t)source->op->row_count + 1)) {
        drop_segments(env, source);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u segments", source->segment_count);
    }
    cut_rows(source->op, source->segment, source->row_segment);
    return PARIAN_OK;
}

static void copy_segments(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_operator_source *source = context;
    memcpy(to, source->segment + first, count * sizeof *source->segment);
}

static void copy_row_segments(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_operator_source *source = context;
    memcpy(to, source->row_segment + first, count * sizeof *source->row_segment);
}

void gl_operator_plan(const parian_operator *op, gl_operator_source *source, gl_operator *made,
                      gl_upload_list *list)
{
    const parian_memory_part part = PARIAN_MEMORY_FACTORS;
    const gl_preparation segments = {make_segments, drop_segments, source};
    uint64_t rows = (uint64_t)op->row_count + 1;
    *source = (gl_operator_source){.op = op, .segment_count = cut_rows(op, NULL, NULL)};
    made->segment_count = source->segment_count;
    made->segment = gl_array_describe(GL_FORMAT_RGBA32UI, made->segment_count);
    made->row_segment = gl_array_describe(GL_FORMAT_R32UI, rows);
    made->run = gl_array_describe(GL_FORMAT_RG32UI, op->run_total);
    made->factor = gl_array_describe(GL_FORMAT_RGB16F, op->factor_total);
    made->scale = gl_array_describe(GL_FORMAT_RGBA32F, op->row_count);
    made->partial = gl_vector_describe(made->segment_count);
    gl_upload_prepare_begin(list, segments);
    gl_upload_texture(list, part, &made->segment, made->segment_count, copy_segments, source);
    gl_upload_texture(list, part, &made->row_segment, rows, copy_row_segments, source);
    gl_upload_prepare_end(list);
    gl_upload_texture(list, part, &made->run, op->run_total, copy_runs, op);
    gl_upload_texture(list, part, &made->factor, op->factor_total, NULL, op->factor);
    gl_upload_texture(list, part, &made->scale, op->row_count, copy_scales, op);
    gl_upload_target(list, part, &made->partial);
}

void gl_operator_edit(const parian_operator *op, gl_operator *made, gl_upload_list *list)
{
    const parian_memory_part part = PARIAN_MEMORY_FACTORS;
    gl_upload_texture(list, part, &made->factor, op->factor_total, NULL, op->factor);
    gl_upload_texture(list, part, &made->scale, op->row_count, copy_scales, op);
}

void gl_operator_destroy(gl_device *device, gl_operator *made)
{
    gl_texture_destroy(device, &made->segment);
    gl_texture_destroy(device, &made->run);
    gl_texture_destroy(device, &made->factor);
    gl_texture_destroy(device, &made->row_segment);
    gl_texture_destroy(device, &made->scale);
    gl_texture_destroy(device, &made->partial);
}
