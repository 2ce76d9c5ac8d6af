/* gl_operator.c - a sparse operator as textures: rows cut into segments of a few hundred factors,
 * so that no fragment has to walk a long row alone.
 *
 * SPDX-License-Identifier: MIT
 */
#include <string.h>

#include "core/memory.h"
#include "gl/gl_body.h"

enum { SEGMENT_FACTORS = 256 };

typedef struct segment_entry {
    uint32_t run, run_count, factor, unused;
} segment_entry;

/* Cut the runs of each row; with no place to write, counts the segments. */
static uint32_t cut_rows(const parian_operator *op, segment_entry *segment, uint32_t *row_segment)
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
                    (segment_entry){first, run - first, (uint32_t)op->run_factor[first], 0};
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

static parian_result create_segments(gl_device *device, const parian_operator *op,
                                     gl_operator *made)
{
    segment_entry *segment = NULL;
    uint32_t *row_segment = NULL;
    made->segment_count = cut_rows(op, NULL, NULL);
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(device->env, segment, made->segment_count) ||
        !PARIAN_NEW(device->env, row_segment, (size_t)op->row_count + 1)) {
        parian_fail(device->env, result, "no memory for %u segments", made->segment_count);
        goto done;
    }
    cut_rows(op, segment, row_segment);
    result =
        gl_array_upload(device, GL_FORMAT_RGBA32UI, made->segment_count, segment, &made->segment);
    if (result == PARIAN_OK) {
        result = gl_array_upload(device, GL_FORMAT_R32UI, (uint64_t)op->row_count + 1, row_segment,
                                 &made->row_segment);
    }
done:
    parian_free(device->env, segment);
    parian_free(device->env, row_segment);
    return result;
}

parian_result gl_operator_create(gl_device *device, const parian_operator *op, gl_operator *made)
{
    if (op->factor_total > UINT32_MAX) {
        return parian_fail(device->env, PARIAN_E_UNSUPPORTED,
                           "an operator of %llu factors, at most 2^32 are possible",
                           (unsigned long long)op->factor_total);
    }
    parian_result result = create_segments(device, op, made);
    if (result == PARIAN_OK) {
        result =
            gl_array_create(device, GL_FORMAT_RG32UI, op->run_total, copy_runs, op, &made->run);
    }
    if (result == PARIAN_OK) {
        result =
            gl_array_upload(device, GL_FORMAT_RGB16F, op->factor_total, op->factor, &made->factor);
    }
    if (result == PARIAN_OK) {
        result = gl_array_create(device, GL_FORMAT_RGBA32F, op->row_count, copy_scales, op,
                                 &made->scale);
    }
    return result == PARIAN_OK ? gl_vector_create(device, made->segment_count, &made->partial)
                               : result;
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
