/* color_map.h - colours of numbers: a sequential map, and a diverging one from blue over white to
 * red.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_COLOR_MAP_H
#define PARIAN_MEASURE_COLOR_MAP_H

#include <stdint.h>

/* sRGB of t in [0, 1] (clamped), from black over purple and orange to pale yellow: lightness rises
 * evenly. */
void parian_color_map_sequential(double t, uint8_t rgb[3]);
/* sRGB of t in [-1, 1] (clamped): blue below zero, white at zero, red above; even steps in CIELAB
 * to either side. */
void parian_color_map_diverging(double t, uint8_t rgb[3]);

#endif
