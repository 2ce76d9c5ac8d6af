/* coarse_points.c - coarse points among the transfer vertices, read back from an asset, and the maker
 * of factors between them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/coarse_points.h"

#include <math.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "core/small_maths.h"

static const uint32_t NONE = UINT32_MAX;

parian_result parian_coarse_init(const parian_env *env, uint32_t fine_count, parian_coarse *coarse)
{
    memset(coarse, 0, sizeof *coarse);
    coarse->fine_count = fine_count;
    if (!PARIAN_NEW(env, coarse->vertex, fine_count) ||
        !PARIAN_NEW0(env, coarse->near, fine_count) ||
        !PARIAN_NEW0(env, coarse->weight, fine_count) ||
        !PARIAN_NEW0(env, coarse->moment, fine_count)) {
        parian_coarse_free(env, coarse);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to interpolate %u points", fine_count);
    }
    return PARIAN_OK;
}

void parian_coarse_free(const parian_env *env, parian_coarse *coarse)
{
    parian_free(env, coarse->vertex);
    parian_free(env, coarse->near);
    parian_free(env, coarse->weight);
    parian_free(env, coarse->moment);
    memset(coarse, 0, sizeof *coarse);
}

/* ---- reading back ---- */

/* The weights of finer point i; a coarse point that it equals is known by weight 1. */
static bool read_weights(const parian_operator *up, const uint32_t *fine, uint32_t i,
                         parian_coarse *coarse)
{
    uint32_t n = 0;
    for (uint32_t r = up->run_offset[i]; r < up->run_offset[i + 1]; r++) {
        for (uint32_t k = 0; k < up->run_count[r]; k++, n++) {
            if (n == 3) {
                return false;
            }
            const parian_half *half = up->factor[up->run_factor[r] + k];
            float weight = parian_half_to_float(half[0]) * up->scale[i][0];
            uint32_t a = up->run_column[r] + k;
            coarse->near[i][n] = a;
            coarse->weight[i][n] = weight;
            if (weight == 1 && coarse->vertex[a] == NONE) {
                coarse->vertex[a] = fine ? fine[i] : i;
            }
        }
    }
    return n > 0;
}

static void measure_moment(const parian_body *body, const uint32_t *fine, uint32_t i,
                           parian_coarse *coarse)
{
    const float(*position)[3] = (const float(*)[3])body->vertex_position;
    const float *x = position[fine ? fine[i] : i];
    for (int k = 0; k < 3; k++) {
        float r2 = parian_distance2f(position[coarse->vertex[coarse->near[i][k]]], x);
        coarse->moment[i] += coarse->weight[i][k] * r2;
    }
}

parian_result parian_coarse_read(const parian_env *env, const parian_body *body,
                                 const uint32_t *fine, const parian_operator *up,
                                 parian_coarse *coarse)
{
    bool good = up->column_count <= up->row_count;
    parian_result result = parian_coarse_init(env, up->row_count, coarse);
    if (result != PARIAN_OK) {
        return result;
    }
    coarse->count = good ? up->column_count : 0;
    memset(coarse->vertex, 0xff, coarse->fine_count * sizeof *coarse->vertex);
    for (uint32_t i = 0; i < coarse->fine_count && good; i++) {
        good = read_weights(up, fine, i, coarse);
    }
    for (uint32_t a = 0; a < coarse->count && good; a++) {
        good = coarse->vertex[a] != NONE;
    }
    if (!good) {
        parian_coarse_free(env, coarse);
        return parian_fail(env, PARIAN_E_UNSUPPORTED,
                           "an operator of %u rows and %u columns interpolates no coarse points",
                           up->row_count, up->column_count);
    }
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        measure_moment(body, fine, i, coarse);
    }
    return PARIAN_OK;
}

/* ---- maker ---- */

static void sum_frame(const parian_coarse *coarse, const parian_vertex_frame *finer,
                      parian_vertex_frame *frame)
{
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t a = coarse->near[i][k];
            float area = coarse->weight[i][k] * finer->area[i];
            frame->area[a] += area;
            frame->bias[a] += area * (finer->bias[i] + 0.25f * coarse->moment[i]);
        }
    }
    for (uint32_t a = 0; a < coarse->count; a++) {
        frame->bias[a] = frame->area[a] > 0 ? frame->bias[a] / frame->area[a] : 0;
        frame->bias_max = fmaxf(frame->bias_max, frame->bias[a]);
    }
}

/* On a curved surface what is interpolated lies beside the surface, on the average by as much as
 * this moves the coarse points the other way. */
static parian_result shift_points(const parian_env *env, const parian_coarse *coarse,
                                  const parian_factor_maker *finer, parian_factor_maker *maker)
{
    double(*sum)[3];
    if (!PARIAN_NEW0(env, sum, coarse->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u coarse points", coarse->count);
    }
    for (uint32_t i = 0; i < coarse->fine_count; i++) {
        for (int c = 0; c < 3; c++) {
            double off = -(double)finer->position[i][c];
            for (int k = 0; k < 3; k++) {
                off += coarse->weight[i][k] * maker->own_position[coarse->near[i][k]][c];
            }
            for (int k = 0; k < 3; k++) {
                sum[coarse->near[i][k]][c] += coarse->weight[i][k] * finer->frame.area[i] * off;
            }
        }
    }
    for (uint32_t a = 0; a < coarse->count; a++) {
        for (int c = 0; c < 3 && maker->frame.area[a] > 0; c++) {
            maker->own_position[a][c] -= (float)(sum[a][c] / maker->frame.area[a]);
        }
    }
    parian_free(env, sum);
    return PARIAN_OK;
}

parian_result parian_coarse_maker_make(const parian_env *env, const parian_coarse *coarse,
                                       const parian_factor_maker *vertices,
                                       const parian_factor_maker *finer,
                                       parian_factor_maker *maker)
{
    uint32_t count = coarse->count;
    size_t padded = ((size_t)count + 15) & ~(size_t)15;
    parian_vertex_frame *frame = &maker->frame;
    memset(maker, 0, sizeof *maker);
    maker->body = vertices->body;
    maker->model = vertices->model;
    if (!PARIAN_NEW(env, maker->own_position, count) || !PARIAN_NEW(env, frame->normal, count) ||
        !PARIAN_NEW0(env, frame->area, padded) || !PARIAN_NEW0(env, frame->bias, padded)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u coarse points", count);
    }
    for (uint32_t a = 0; a < count; a++) {
        uint32_t v = coarse->vertex[a];
        memcpy(maker->own_position[a], vertices->position[v], sizeof maker->own_position[a]);
        memcpy(frame->normal[a], vertices->frame.normal[v], sizeof frame->normal[a]);
    }
    sum_frame(coarse, &finer->frame, frame);
    maker->position = (const float(*)[3])maker->own_position;
    parian_result result = shift_points(env, coarse, finer, maker);
    if (result == PARIAN_OK) {
        result = parian_point_arrays_make(env, maker->position, (const float(*)[3])frame->normal,
                                          count, &frame->points);
    }
    return result == PARIAN_OK ? parian_factor_cap(env, maker) : result;
}

void parian_coarse_maker_free(const parian_env *env, parian_factor_maker *maker)
{
    memset(&maker->model, 0, sizeof maker->model); /* the vertices' */
    parian_factor_maker_free(env, maker);
}
