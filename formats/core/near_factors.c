/* near_factors.c - what the global part already carries between near texels.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/near_factors.h"

#include <string.h>

#include "core/half.h"
#include "core/memory.h"

static const uint32_t NO_SLOT = 0xffffffffu;

void parian_operator_factor(const parian_operator *op, uint32_t row, uint32_t column,
                            float factor[3])
{
    uint32_t low = op->run_offset[row], high = op->run_offset[row + 1];
    uint32_t first = low;
    while (low < high) { /* the first run that begins beyond the column */
        uint32_t middle = low + (high - low) / 2;
        if (op->run_column[middle] <= column) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    factor[0] = factor[1] = factor[2] = 0;
    if (low == first) {
        return;
    }
    uint32_t run = low - 1, within = column - op->run_column[run];
    if (within < op->run_count[run]) {
        const parian_half *half = op->factor[op->run_factor[run] + within];
        for (int c = 0; c < 3; c++) {
            factor[c] = parian_half_to_float(half[c]) * op->scale[row][c];
        }
    }
}

parian_result parian_texel_lists_make(const parian_env *env, const parian_body *body,
                                      parian_texel_lists *lists)
{
    size_t triangles = body->triangle_count;
    memset(lists, 0, sizeof *lists);
    if (!PARIAN_NEW0(env, lists->offset, triangles + 1) ||
        !PARIAN_NEW(env, lists->texel, body->texel_count)) {
        parian_texel_lists_free(env, lists);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to list %u texels", body->texel_count);
    }
    uint32_t *offset = lists->offset;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        offset[body->texel_triangle[i] + 1]++;
    }
    for (size_t t = 0; t < triangles; t++) {
        offset[t + 1] += offset[t];
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        lists->texel[offset[body->texel_triangle[i]]++] = i;
    }
    memmove(offset + 1, offset, triangles * sizeof *offset);
    offset[0] = 0;
    return PARIAN_OK;
}

void parian_texel_lists_free(const parian_env *env, parian_texel_lists *lists)
{
    parian_free(env, lists->offset);
    parian_free(env, lists->texel);
    memset(lists, 0, sizeof *lists);
}

static parian_result reserve(parian_patch *patch, uint32_t capacity)
{
    uint32_t *vertex;
    if (!PARIAN_NEW(patch->env, vertex, capacity)) {
        return parian_fail(patch->env, PARIAN_E_NOMEM, "no memory for a patch of %u vertices",
                           capacity);
    }
    if (patch->count) {
        memcpy(vertex, patch->vertex, patch->count * sizeof *vertex);
    }
    parian_free(patch->env, patch->vertex);
    parian_free(patch->env, patch->factor);
    parian_free(patch->env, patch->mix);
    patch->vertex = vertex;
    patch->capacity = capacity;
    if (!PARIAN_NEW(patch->env, patch->factor, capacity) ||
        !PARIAN_NEW(patch->env, patch->mix, capacity)) {
        return parian_fail(patch->env, PARIAN_E_NOMEM, "no memory for a patch of %u vertices",
                           capacity);
    }
    return PARIAN_OK;
}

parian_result parian_patch_make(const parian_env *env, const parian_body *body, parian_patch *patch)
{
    memset(patch, 0, sizeof *patch);
    patch->env = env;
    patch->body = body;
    if (!PARIAN_NEW(env, patch->slot, body->vertex_count) ||
        !PARIAN_NEW0(env, patch->triangle_stamp, body->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a patch of %u vertices",
                           body->vertex_count);
    }
    memset(patch->slot, 0xff, body->vertex_count * sizeof *patch->slot);
    return reserve(patch, 64);
}

void parian_patch_free(parian_patch *patch)
{
    parian_free(patch->env, patch->slot);
    parian_free(patch->env, patch->triangle_stamp);
    parian_free(patch->env, patch->vertex);
    parian_free(patch->env, patch->factor);
    parian_free(patch->env, patch->mix);
    memset(patch, 0, sizeof *patch);
}

void parian_patch_begin(parian_patch *patch, uint32_t triangle)
{
    for (uint32_t i = 0; i < patch->count; i++) {
        patch->slot[patch->vertex[i]] = NO_SLOT;
    }
    patch->count = 0;
    patch->triangle = triangle;
}

parian_result parian_patch_add(parian_patch *patch, uint32_t texel)
{
    uint32_t triangle = patch->body->texel_triangle[texel];
    if (patch->triangle_stamp[triangle] == patch->triangle + 1) {
        return PARIAN_OK;
    }
    if (patch->count + 3 > patch->capacity) {
        parian_result result = reserve(patch, patch->capacity * 2);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    patch->triangle_stamp[triangle] = patch->triangle + 1;
    for (int k = 0; k < 3; k++) {
        uint32_t v = patch->body->triangle[triangle][k];
        if (patch->slot[v] == NO_SLOT) {
            patch->slot[v] = patch->count;
            patch->vertex[patch->count++] = v;
        }
    }
    return PARIAN_OK;
}

void parian_patch_gather(parian_patch *patch, bool corners_receive)
{
    const parian_operator *op = &patch->body->operators[0];
    const uint32_t *corner = patch->body->triangle[patch->triangle];
    for (uint32_t n = 0; n < patch->count; n++) {
        uint32_t v = patch->vertex[n];
        for (int k = 0; k < 3; k++) {
            parian_operator_factor(op, corners_receive ? corner[k] : v,
                                   corners_receive ? v : corner[k], patch->factor[n][k]);
        }
    }
}

void parian_patch_mix(parian_patch *patch, const float weight[3])
{
    for (uint32_t n = 0; n < patch->count; n++) {
        for (int c = 0; c < 3; c++) {
            patch->mix[n][c] = weight[0] * patch->factor[n][0][c] +
                               weight[1] * patch->factor[n][1][c] +
                               weight[2] * patch->factor[n][2][c];
        }
    }
}
