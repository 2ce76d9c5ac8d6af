/* atlas_picture.c - paints charts, border texels and gutter.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/atlas_picture.h"

#include <math.h>
#include <string.h>

#include "bake/stages/texels_parts.h"
#include "core/memory.h"

typedef struct picture_job {
    const parian_body *body;
    uint8_t (*rgba)[4];
} picture_job;

/* Colours of successive charts: hues a golden ratio of the circle apart, so that no two are close
 * soon. */
static void chart_colour(uint32_t chart, double brightness, uint8_t out[4])
{
    double hue = 6.0 * fmod(0.61803398875 * chart, 1.0), pale = 0.25 + 0.15 * (chart % 3);
    for (int c = 0; c < 3; c++) {
        double away = fabs(fmod(hue + 6.0 - 2.0 * c, 6.0) - 3.0) - 1.0;
        double value = pale + (1.0 - pale) * fmin(1.0, fmax(0.0, away));
        out[c] = (uint8_t)(255.0 * brightness * value);
    }
    out[3] = 255;
}

static void paint_row(void *context, size_t row)
{
    const picture_job *job = context;
    const parian_body *body = job->body;
    for (size_t i = row * body->atlas_size; i < (row + 1) * body->atlas_size; i++) {
        static const uint8_t background[4] = {16, 16, 16, 255};
        uint32_t texel = body->texel_at[i];
        memcpy(job->rgba[i], background, sizeof background);
        if (texel != UINT32_MAX) {
            bool border = body->texel_border[texel] != PARIAN_NO_BORDER;
            chart_colour(texel_chart(body, texel), border ? 0.6 : 0.95, job->rgba[i]);
        }
    }
}

parian_result parian_atlas_picture(const parian_env *env, const parian_body *body,
                                   uint8_t (*rgba)[4])
{
    static const uint8_t gutter[4] = {96, 96, 96, 255};
    picture_job job = {body, rgba};
    if (!body->texel_at || !body->texel_border) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "a picture of the atlas needs texels, found none");
    }
    parian_par(env, body->atlas_size, paint_row, &job);
    for (uint32_t g = 0; g < body->gutter_count; g++) {
        memcpy(rgba[body->gutter_index[g]], gutter, sizeof gutter);
    }
    return PARIAN_OK;
}
