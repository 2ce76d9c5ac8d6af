/* picture.h - PNG and OpenEXR files.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_PICTURE_H
#define PARIAN_TOOL_PICTURE_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

enum {
    PARIAN_PICTURE_SIDE_MAX = 16384,
    PARIAN_PICTURE_PIXELS_MAX = 1 << 27, /* of a picture that is read: 1.5 GiB of floats */
    PARIAN_PICTURE_FILE_MAX = 1 << 30    /* bytes of a picture file that is read */
};

/* All writers are atomic; rows go from top to bottom.
 * Errors: PARIAN_E_ARGUMENT (size), PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_png_write(const parian_env *env, const char *path, uint32_t width,
                               uint32_t height, const uint8_t (*rgba)[4]);
/* 32-bit float RGBA, ZIP; through OpenEXRCore. */
parian_result parian_exr_write(const parian_env *env, const char *path, uint32_t width,
                               uint32_t height, const float (*rgba)[4]);

/* Read a PNG, JPEG-free: 8 or 16 bit of any kind to linear RGB floats (sRGB decoded); transparency
 * is dropped. Limits: 16384 a side. Errors: PARIAN_E_IO, PARIAN_E_FORMAT, PARIAN_E_LIMIT,
 * PARIAN_E_NOMEM. */
parian_result parian_png_read_linear(const parian_env *env, const char *path, uint32_t *width,
                                     uint32_t *height, float (**rgb)[3]);
/* Read scanline or tiled OpenEXR (first part, data window), channels R G B (or Y), any compression
 * and element type. The values are as in the file: NaN and infinities included. Limits and errors
 * as above, and PARIAN_E_UNSUPPORTED (deep data, other channels, subsampling). */
parian_result parian_exr_read(const parian_env *env, const char *path, uint32_t *width,
                              uint32_t *height, float (**rgb)[3]);
/* Either of them, by the first bytes of the file. Anything else is PARIAN_E_FORMAT. */
parian_result parian_picture_read_linear(const parian_env *env, const char *path, uint32_t *width,
                                         uint32_t *height, float (**rgb)[3]);

/* 8-bit sRGB code of a linear value in [0, 1] (clamped; NaN is 0), and back. */
uint8_t parian_srgb_encode(float linear);
float parian_srgb_decode(uint8_t code);
/* Linear value of an sRGB value in [0, 1]. */
float parian_srgb_to_linear(float value);

#endif
