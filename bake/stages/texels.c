/* texels.c - the texels stage: coverage by clipping, border lists, gutter.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/texels.h"

#include "bake/stages/texels_parts.h"
#include "core/memory.h"

static void drop_texels(const parian_env *env, parian_body *body)
{
    void *const arrays[] = {body->texel_index,     body->texel_triangle, body->texel_barycentric,
                            body->texel_area,      body->gutter_index,   body->gutter_source,
                            body->gutter_weight,   body->border_texel,   body->border_offset,
                            body->border_neighbour};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        parian_free(env, arrays[i]);
    }
    body->texel_index = body->texel_triangle = NULL;
    body->texel_barycentric = NULL;
    body->texel_area = NULL;
    body->gutter_index = NULL;
    body->gutter_source = NULL;
    body->gutter_weight = NULL;
    body->border_texel = body->border_offset = body->border_neighbour = NULL;
    body->texel_count = body->gutter_count = body->border_count = 0;
}

/* Every corner must lie in the atlas, or cells would be addressed that do not exist. */
static parian_result check_corners(const parian_env *env, const parian_body *body)
{
    float side = (float)body->atlas_size;
    if (!body->corner_uv || !body->triangle_chart || body->kernel_width % 2 == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "texels need an atlas and an odd kernel width, found width %u",
                           body->kernel_width);
    }
    for (uint32_t t = 0; t < body->triangle_count; t++) {
        for (int k = 0; k < 6; k++) {
            float x = body->corner_uv[t][k / 2][k % 2];
            if (!(x >= 0.0f && x <= side)) {
                return parian_fail(env, PARIAN_E_ARGUMENT,
                                   "triangle %u has the atlas coordinate %g outside [0, %u]", t,
                                   (double)x, body->atlas_size);
            }
        }
    }
    return PARIAN_OK;
}

parian_result parian_stage_texels(const parian_env *env, parian_body *body)
{
    float *covered = NULL;
    parian_result result = check_corners(env, body);
    if (result != PARIAN_OK) {
        return result;
    }
    drop_texels(env, body);
    parian_progress(env, "texels", 0.0);
    result = texels_clip(env, body, &covered);
    if (result == PARIAN_OK) {
        parian_progress(env, "texels", 0.4);
        result = parian_body_derive(env, body);
    }
    if (result == PARIAN_OK && parian_cancelled(env)) {
        result = PARIAN_E_INTERRUPTED;
    }
    if (result == PARIAN_OK) {
        result = texels_gutter(env, body);
    }
    if (result == PARIAN_OK) {
        parian_progress(env, "texels", 0.6);
        result = texels_border(env, body, covered);
    }
    for (uint32_t b = 0; b < body->border_count && result == PARIAN_OK; b++) {
        body->texel_border[body->border_texel[b]] = b;
    }
    if (result == PARIAN_OK && parian_cancelled(env)) {
        result = PARIAN_E_INTERRUPTED;
    }
    parian_free(env, covered);
    parian_progress(env, "texels", 1.0);
    return result;
}
