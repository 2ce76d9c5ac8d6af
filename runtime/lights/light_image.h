/* light_image.h - mip levels of projected pictures, and spherical harmonics.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_LIGHT_IMAGE_H
#define PARIAN_LIGHT_IMAGE_H

#include "lights/light_list.h"

/* Pixels of a picture with all its levels. */
uint64_t parian_image_pixel_total(uint32_t width, uint32_t height);
/* Fill [parian_image_pixel_total] pixels: level 0 is the picture, each next one the area-weighted
 * mean of the one before. */
void parian_image_build_levels(const parian_light_image *image, float (*pixel)[4]);

/* The nine real spherical harmonics of a unit direction. */
void parian_sh_evaluate(const float direction[3], float y[PARIAN_SH_COUNT]);

#endif
