/* light_image.c - mip levels of projected pictures, and spherical harmonics.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/light_image.h"

#include <string.h>

#include "vec3.h"

uint32_t parian_image_level_side(uint32_t side, uint32_t level)
{
    uint32_t shifted = level < 32 ? side >> level : 0;
    return shifted ? shifted : 1;
}

uint32_t parian_image_level_count(uint32_t width, uint32_t height)
{
    uint32_t side = width > height ? width : height;
    uint32_t levels = 1;
    while (side >>= 1) {
        levels++;
    }
    return levels;
}

uint64_t parian_image_pixel_total(uint32_t width, uint32_t height)
{
    uint64_t total = 0;
    for (uint32_t l = 0; l < parian_image_level_count(width, height); l++) {
        total += (uint64_t)parian_image_level_side(width, l) * parian_image_level_side(height, l);
    }
    return total;
}

/* Mean of the source pixels under [x0, x1) x [y0, y1), with the parts of pixels at its rim. */
static void mean_box(const float (*source)[4], uint32_t width, uint32_t height, double x0,
                     double x1, double y0, double y1, float to[4])
{
    double sum[3] = {0}, weight_sum = 0;
    for (uint32_t y = (uint32_t)y0; y < height && y < y1; y++) {
        double wy = fmin(y + 1.0, y1) - fmax(y, y0);
        for (uint32_t x = (uint32_t)x0; x < width && x < x1; x++) {
            double w = wy * (fmin(x + 1.0, x1) - fmax(x, x0));
            const float *p = source[(size_t)y * width + x];
            for (int c = 0; c < 3; c++) {
                sum[c] += w * p[c];
            }
            weight_sum += w;
        }
    }
    for (int c = 0; c < 3; c++) {
        to[c] = (float)(sum[c] / weight_sum);
    }
    to[3] = 1.0f;
}

void parian_image_build_levels(const parian_light_image *image, float (*pixel)[4])
{
    uint32_t width = image->width, height = image->height;
    for (size_t i = 0; i < (size_t)width * height; i++) {
        vec3_copy(pixel[i], image->pixel[i]);
        pixel[i][3] = 1.0f;
    }
    const float(*source)[4] = (const float(*)[4])pixel;
    for (uint32_t l = 1; l < parian_image_level_count(image->width, image->height); l++) {
        uint32_t w = parian_image_level_side(image->width, l);
        uint32_t h = parian_image_level_side(image->height, l);
        float(*to)[4] = pixel + (source - (const float(*)[4])pixel) + (size_t)width * height;
        double sx = (double)width / w, sy = (double)height / h;
        for (uint32_t y = 0; y < h; y++) {
            for (uint32_t x = 0; x < w; x++) {
                mean_box(source, width, height, x * sx, (x + 1) * sx, y * sy, (y + 1) * sy,
                         to[(size_t)y * w + x]);
            }
        }
        source = (const float(*)[4])to;
        width = w;
        height = h;
    }
}

void parian_sh_evaluate(const float d[3], float y[PARIAN_SH_COUNT])
{
    y[0] = 0.282094792f;
    y[1] = 0.488602512f * d[1];
    y[2] = 0.488602512f * d[2];
    y[3] = 0.488602512f * d[0];
    y[4] = 1.092548431f * d[0] * d[1];
    y[5] = 1.092548431f * d[1] * d[2];
    y[6] = 0.315391565f * (3.0f * d[2] * d[2] - 1.0f);
    y[7] = 1.092548431f * d[0] * d[2];
    y[8] = 0.546274215f * (d[0] * d[0] - d[1] * d[1]);
}
