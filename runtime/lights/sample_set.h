/* sample_set.h - the points at which one set of samples asks: of lights with an extent, and of
 * texels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_SAMPLE_SET_H
#define PARIAN_SAMPLE_SET_H

#include "lights/light_list.h"

typedef enum parian_set_axis {
    PARIAN_SET_TEXEL = 0, /* points of texels */
    PARIAN_SET_LIGHT = 1  /* points of rectangles, directions of environments */
} parian_set_axis;

/* Point `set` of a lattice in the unit square, [0, 1)^2, with a random shift of its own for each
 * index. Points of texels and of lights have steps that share no ratio, so that any part of a texel
 * meets any point of any light. Source   [Roberts18] */
void parian_set_point(parian_set_axis axis, uint64_t index, uint32_t set, double point[2]);

/* The samples of set `set` > 0, [list->sample_count]: rectangles by one random point in each of
 * their pieces, environments by one direction drawn from each of their cells. The mean of E over
 * sets approaches the integral over the lights. Shadow maps do not follow. */
void parian_light_list_vary(const parian_light_list *list, uint32_t set,
                            parian_light_sample *sample);

#endif
