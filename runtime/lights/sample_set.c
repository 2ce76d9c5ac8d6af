/* sample_set.c - other points of lights with an extent.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/sample_set.h"

#include <string.h>

#include "core/random.h"
#include "lights/sky_cells.h"
#include "vec3.h"

void parian_set_point(parian_set_axis axis, uint64_t index, uint32_t set, double point[2])
{
    /* Powers of 1 / g, where g^5 = g + 1, for texels; for lights, whose points matter alone where
     * no shadow's edge is, the best pair in the plane: powers of 1 / g, where g^3 = g + 1. */
    static const double step[4] = {0.8566748838545029, 0.7338918566271260, 0.7548776662466927,
                                   0.5698402909980532};
    parian_random random = parian_random_stream(0x5E7, (uint64_t)axis, index, 0);
    for (int c = 0; c < 2; c++) {
        double at = parian_random_unit(&random) + step[2 * (int)axis + c] * set;
        point[c] = fmin(at - floor(at), 1.0 - 0x1p-30);
    }
}

static void vary_rect(const parian_rect_source *rect, uint32_t set, parian_light_sample *sample)
{
    for (uint32_t i = 0; i < PARIAN_RECT_GRID * PARIAN_RECT_GRID; i++) {
        double at[2];
        parian_set_point(PARIAN_SET_LIGHT, rect->first_sample + i, set, at);
        double u = 2.0 * (i % PARIAN_RECT_GRID + at[0]) / PARIAN_RECT_GRID - 1.0;
        double v = 2.0 * (i / PARIAN_RECT_GRID + at[1]) / PARIAN_RECT_GRID - 1.0;
        vec3_copy(sample[i].position, rect->position);
        vec3_add_scaled(sample[i].position, rect->axis_u, (float)u);
        vec3_add_scaled(sample[i].position, rect->axis_v, (float)v);
        vec3_copy(sample[i].color, rect->power);
        vec3_scale(sample[i].color, 1.0f / (PARIAN_RECT_GRID * PARIAN_RECT_GRID));
    }
}

void parian_light_list_vary(const parian_light_list *list, uint32_t set,
                            parian_light_sample *sample)
{
    if (list->sample_count > 0) {
        memcpy(sample, list->sample, list->sample_count * sizeof *sample);
    }
    for (uint32_t r = 0; r < list->rect_count; r++) {
        vary_rect(&list->rect[r], set, sample + list->rect[r].first_sample);
    }
    for (uint32_t s = 0; s < list->sky_count; s++) {
        const parian_sky *sky = &list->sky[s];
        for (uint32_t c = 0; c < sky->cell_count; c++) {
            double at[2];
            parian_set_point(PARIAN_SET_LIGHT, sky->first_sample + c, set, at);
            parian_sky_draw(sky, c, at, &sample[sky->first_sample + c]);
        }
    }
}
