/* cpu_transfer.c - restriction, local filter and interpolation: the C evaluation of the transfer
 * passes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_transfer.h"

#include <string.h>

#include "core/clones.h"
#include "core/half.h"
#include "core/memory.h"
#include "vec3.h"

enum { VERTEX_PIECE = 256, TEXEL_PIECE = 1024, LIST_PIECE = 64, WIDTH_MAX = 15 };

typedef struct restrict_job {
    const parian_restriction *restriction;
    const float (*irradiance)[3];
    float (*flux)[3], (*direct)[3];
} restrict_job;

static void restrict_vertex(const restrict_job *job, uint32_t v)
{
    const parian_restriction *r = job->restriction;
    float flux[3] = {0}, direct[3] = {0};
    for (uint32_t k = r->offset[v]; k < r->offset[v + 1]; k++) {
        const float *e = job->irradiance[r->feed[k].texel];
        vec3_add_scaled(flux, e, r->feed[k].flux);
        for (int c = 0; r->weight && c < 3; c++) {
            direct[c] += parian_half_to_float(r->weight[k][c]) * e[c];
        }
    }
    vec3_copy(job->flux[v], flux);
    if (job->direct) {
        vec3_copy(job->direct[v], direct);
    }
}

static void restrict_piece(void *context, size_t piece)
{
    const restrict_job *job = context;
    uint32_t first = (uint32_t)piece * VERTEX_PIECE;
    for (uint32_t v = first; v < first + VERTEX_PIECE && v < job->restriction->vertex_count; v++) {
        restrict_vertex(job, v);
    }
}

void parian_cpu_restrict(const parian_env *env, const parian_restriction *restriction,
                         const float (*irradiance)[3], float (*flux)[3], float (*direct)[3])
{
    restrict_job job = {restriction, irradiance, flux, direct};
    parian_par(env, (restriction->vertex_count + VERTEX_PIECE - 1) / VERTEX_PIECE, restrict_piece,
               &job);
}

typedef struct filter_job {
    const parian_body *body;
    const parian_kernels *kernels;
    const float (*irradiance)[3], (*vertex_radiosity)[3];
    float (*local)[3], (*global)[3];
} filter_job;

/* lane[i] += tap[i] e[i]: the channels of neighbouring taps lie side by side in both. */
PARIAN_CLONES
static void add_products(const float *restrict tap, const float *restrict e, uint32_t count,
                         float *restrict lane)
{
    for (uint32_t i = 0; i < count; i++) {
        lane[i] += tap[i] * e[i];
    }
}

static void add_lanes(const float *lane, uint32_t count, float sum[3])
{
    for (uint32_t i = 0; i < count; i += 3) {
        for (int c = 0; c < 3; c++) {
            sum[c] += lane[i + (uint32_t)c];
        }
    }
}

/* Square window around an interior texel; all its texels are owned, so that a row of it has
 * consecutive ordinals. */
static void filter_window(const filter_job *job, uint32_t texel, uint32_t interior, float sum[3])
{
    const parian_body *body = job->body;
    uint32_t width = body->kernel_width, half = width / 2, row = 3 * width;
    float tap[3 * WIDTH_MAX * WIDTH_MAX], lane[3 * WIDTH_MAX] = {0};
    const parian_half(*stored)[3] =
        (const parian_half(*)[3])job->kernels->interior + (size_t)interior * width * width;
    uint32_t corner = body->texel_index[texel] - half * body->atlas_size - half;
    parian_half_to_float_array(stored[0], tap, (size_t)row * width);
    for (uint32_t dv = 0; dv < width; dv++) {
        uint32_t source = body->texel_at[corner + dv * body->atlas_size];
        add_products(tap + dv * row, job->irradiance[source], row, lane);
    }
    add_lanes(lane, row, sum);
}

static void filter_list(const filter_job *job, uint32_t border, float sum[3])
{
    const parian_body *body = job->body;
    uint32_t last = body->border_offset[border + 1];
    float tap[LIST_PIECE][3];
    for (uint32_t k = body->border_offset[border]; k < last; k += LIST_PIECE) {
        uint32_t count = last - k < LIST_PIECE ? last - k : LIST_PIECE;
        parian_half_to_float_array(job->kernels->border[k], tap[0], 3 * (size_t)count);
        for (uint32_t i = 0; i < count; i++) {
            const float *e = job->irradiance[body->border_neighbour[k + i]];
            for (int c = 0; c < 3; c++) {
                sum[c] += tap[i][c] * e[c];
            }
        }
    }
}

static void filter_texel(const filter_job *job, uint32_t t, uint32_t interior)
{
    const parian_body *body = job->body;
    float local[3] = {0}, global[3] = {0};
    if (body->local_form != PARIAN_LOCAL_NONE) {
        if (body->texel_border[t] == PARIAN_NO_BORDER) {
            filter_window(job, t, interior, local);
        } else {
            filter_list(job, body->texel_border[t], local);
        }
        for (int c = 0; c < 3; c++) {
            local[c] *= job->kernels->channel_scale[c];
        }
    }
    const uint32_t *triangle = body->triangle[body->texel_triangle[t]];
    float b0 = body->texel_barycentric[t][0], b1 = body->texel_barycentric[t][1];
    const float beta[3] = {b0, b1, 1.0f - b0 - b1};
    for (int corner = 0; corner < 3; corner++) {
        vec3_add_scaled(global, job->vertex_radiosity[triangle[corner]], beta[corner]);
    }
    vec3_copy(job->local[t], local);
    vec3_copy(job->global[t], global);
}

/* Border texels before a texel, for its ordinal among the interior ones (border_texel ascends). */
static uint32_t borders_before(const parian_body *body, uint32_t texel)
{
    uint32_t low = 0, high = body->border_count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (body->border_texel[middle] < texel) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static void filter_piece(void *context, size_t piece)
{
    const filter_job *job = context;
    uint32_t first = (uint32_t)piece * TEXEL_PIECE;
    uint32_t borders = borders_before(job->body, first);
    for (uint32_t t = first; t < first + TEXEL_PIECE && t < job->body->texel_count; t++) {
        filter_texel(job, t, t - borders);
        borders += job->body->texel_border[t] != PARIAN_NO_BORDER;
    }
}

void parian_cpu_filter(const parian_env *env, const parian_body *body,
                       const parian_kernels *kernels, const float (*irradiance)[3],
                       const float (*vertex_radiosity)[3], float (*local)[3], float (*global)[3])
{
    filter_job job = {body, kernels, irradiance, vertex_radiosity, local, global};
    parian_par(env, (body->texel_count + TEXEL_PIECE - 1) / TEXEL_PIECE, filter_piece, &job);
}
