/* picture.h - PNG and OpenEXR files.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_PICTURE_H
#define PARIAN_TOOL_PICTURE_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* All writers are atomic; rows go from top to bottom. */
parian_result parian_png_write(const parian_env *env, const char *path, uint32_t width, uint32_t height,
                               const uint8_t (*rgba)[4]);
/* 32-bit float RGBA, ZIP; through OpenEXRCore. */
parian_result parian_exr_write(const parian_env *env, const char *path, uint32_t width, uint32_t height,
                               const float (*rgba)[4]);
/* Read a PNG, JPEG-free: 8 or 16 bit of any kind to linear RGB floats (sRGB decoded). Limits: 16384 a side. */
parian_result parian_png_read_linear(const parian_env *env, const char *path, uint32_t *width,
                                     uint32_t *height, float (**rgb)[3]);
/* Read scanline or tiled OpenEXR, channels R G B (or Y), any compression. */
parian_result parian_exr_read(const parian_env *env, const char *path, uint32_t *width, uint32_t *height,
                              float (**rgb)[3]);

/* 8-bit sRGB code of a linear value in [0, 1] (clamped), and back. */
uint8_t parian_srgb_encode(float linear);
float parian_srgb_decode(uint8_t code);

#endif
