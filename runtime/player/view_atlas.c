/* view_atlas.c - the atlases of all bodies laid flat, as a picture.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_atlas.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

static const double PI = 3.14159265358979323846;
static const double MARGIN = 0.02; /* of a cell, around its atlas */

parian_view_cell parian_view_atlas_cell(uint32_t body_count, uint32_t body, uint32_t width,
                                        uint32_t height)
{
    uint32_t columns = 1, best = 1;
    double side = 0;
    for (columns = 1; columns <= body_count; columns++) {
        const uint32_t rows = (body_count + columns - 1) / columns;
        const double fits = fmin((double)width / columns, (double)height / rows);
        best = fits > side ? columns : best;
        side = fmax(side, fits);
    }
    const uint32_t rows = (body_count + best - 1) / best;
    return (parian_view_cell){.x = 0.5 * (width - best * side) + (body % best + MARGIN) * side,
                              .y = 0.5 * (height - rows * side) + (body / best + MARGIN) * side,
                              .side = (1 - 2 * MARGIN) * side};
}

typedef struct texel_values {
    uint32_t (*place)[2];
    uint32_t *chart;
    float (*value)[3];
} texel_values;

static void chart_color(uint32_t chart, float color[3])
{
    const uint32_t hash = (chart + 1) * 2654435761u;
    for (int c = 0; c < 3; c++) {
        color[c] = 0.05f + 0.75f * (float)(hash >> (8 * c + 8) & 255u) / 255;
    }
}

static parian_result read_values(const parian_env *env, parian_renderer *renderer,
                                 parian_view_display display, uint64_t count, texel_values *made)
{
    const bool charts = display == PARIAN_DISPLAY_ATLAS_CHARTS;
    if (!PARIAN_NEW(env, made->place, count) || !PARIAN_NEW(env, made->value, count) ||
        !PARIAN_NEW(env, made->chart, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the atlas of %llu texels",
                           (unsigned long long)count);
    }
    const parian_texel_arrays arrays = {
        .place = made->place,
        .chart = made->chart,
        .irradiance = display == PARIAN_DISPLAY_ATLAS_IRRADIANCE ? made->value : NULL,
        .radiosity = display == PARIAN_DISPLAY_ATLAS_RADIOSITY ? made->value : NULL};
    parian_result result = parian_renderer_read_texels(renderer, &arrays);
    for (uint64_t t = 0; t < count && result == PARIAN_OK; t++) {
        if (charts) {
            chart_color(made->chart[t], made->value[t]);
            continue;
        }
        for (int c = 0; c < 3; c++) {
            made->value[t][c] /= (float)PI;
        }
    }
    return result;
}

/* Spread texels over a square of atlas_size^2, then take the square into its cell. */
static parian_result draw_body(const parian_env *env, const texel_values *values, size_t first,
                               const parian_scene_body *body, const parian_view_cell *cell,
                               uint32_t width, uint32_t height, float (*radiance)[4])
{
    float(*square)[4];
    const double side = body->atlas_size;
    if (!PARIAN_NEW0(env, square, (size_t)body->atlas_size * body->atlas_size)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for an atlas of %u texels a side",
                           body->atlas_size);
    }
    for (size_t t = first; t < first + body->texel_count; t++) {
        float *to = square[(size_t)values->place[t][1] * body->atlas_size + values->place[t][0]];
        memcpy(to, values->value[t], sizeof values->value[t]);
        to[3] = 1;
    }
    for (uint32_t y = 0; y < height; y++) {
        const double v = (y + 0.5 - cell->y) / cell->side * side;
        for (uint32_t x = 0; x < width && v >= 0 && v < side; x++) {
            const double u = (x + 0.5 - cell->x) / cell->side * side;
            if (u >= 0 && u < side) {
                memcpy(radiance[(size_t)y * width + x],
                       square[(size_t)v * body->atlas_size + (size_t)u], sizeof *radiance);
            }
        }
    }
    parian_free(env, square);
    return PARIAN_OK;
}

parian_result parian_view_atlas_draw(const parian_env *env, const parian_scene *scene,
                                     parian_renderer *renderer, parian_view_display display,
                                     uint32_t width, uint32_t height, float (*radiance)[4])
{
    const parian_scene_info info = parian_scene_get_info(scene);
    texel_values values = {NULL, NULL, NULL};
    size_t first = 0;
    parian_result result = read_values(env, renderer, display, info.texel_count, &values);
    memset(radiance, 0, (size_t)width * height * sizeof *radiance);
    for (uint32_t b = 0; b < info.body_count && result == PARIAN_OK; b++) {
        const parian_scene_body body = parian_scene_get_body(scene, b);
        const parian_view_cell cell = parian_view_atlas_cell(info.body_count, b, width, height);
        result = draw_body(env, &values, first, &body, &cell, width, height, radiance);
        first += body.texel_count;
    }
    parian_free(env, values.place);
    parian_free(env, values.chart);
    parian_free(env, values.value);
    return result;
}
