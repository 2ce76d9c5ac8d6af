/* light_image.c - mip levels of projected pictures, and spherical harmonics and probes of
 * environments.
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

/* Directions that share the sphere evenly (a spherical Fibonacci spiral about +y). */
static void spiral_direction(uint32_t i, uint32_t count, float direction[3])
{
    double y = 1.0 - (2.0 * i + 1.0) / count;
    double r = sqrt(fmax(0.0, 1.0 - y * y));
    double phi = 2.39996322972865332 * i; /* golden angle */
    direction[0] = (float)(r * cos(phi));
    direction[1] = (float)y;
    direction[2] = (float)(r * sin(phi));
}

/* One patch of sky: radiance from a direction (towards the sky) and its solid angle. */
static void add_sky(const float direction[3], const float radiance[3], float solid_angle,
                    float sh[PARIAN_SH_COUNT][3], float (*spiral)[3],
                    parian_light_sample probe[PARIAN_ENVIRONMENT_PROBES])
{
    float y[PARIAN_SH_COUNT];
    parian_sh_evaluate(direction, y);
    for (int k = 0; k < PARIAN_SH_COUNT; k++) {
        vec3_add_scaled(sh[k], radiance, y[k] * solid_angle);
    }
    int nearest = 0;
    for (int i = 1; i < PARIAN_ENVIRONMENT_PROBES; i++) {
        if (vec3_dot(direction, spiral[i]) > vec3_dot(direction, spiral[nearest])) {
            nearest = i;
        }
    }
    float luminance = (radiance[0] + radiance[1] + radiance[2]) * solid_angle;
    vec3_add_scaled(probe[nearest].color, radiance, solid_angle);
    vec3_add_scaled(probe[nearest].direction, direction, -luminance);
}

/* Direction of a point of the picture, u and v in [0, 1], turned by `rotation` about +y. */
static void sky_direction(double u, double v, double rotation, float direction[3])
{
    double phi = (u - 0.5) * 2.0 * M_PI - rotation; /* 0 looks along -z, growing towards +x */
    double theta = v * M_PI;
    direction[0] = (float)(sin(theta) * sin(phi));
    direction[1] = (float)cos(theta);
    direction[2] = (float)(-sin(theta) * cos(phi));
}

static void project_cells(const parian_light *light, uint32_t width, uint32_t height,
                          float sh[PARIAN_SH_COUNT][3], float (*spiral)[3],
                          parian_light_sample probe[PARIAN_ENVIRONMENT_PROBES])
{
    const parian_light_image *image = &light->image;
    for (uint32_t y = 0; y < height; y++) {
        double band = cos(M_PI * y / height) - cos(M_PI * (y + 1) / height);
        float solid_angle = (float)(band * 2.0 * M_PI / width);
        for (uint32_t x = 0; x < width; x++) {
            float direction[3], radiance[3];
            sky_direction((x + 0.5) / width, (y + 0.5) / height, light->rotation_deg * M_PI / 180.0,
                          direction);
            for (int c = 0; c < 3; c++) {
                radiance[c] = light->color[c] *
                              (image->pixel ? image->pixel[(size_t)y * width + x][c] : 1.0f);
            }
            add_sky(direction, radiance, solid_angle, sh, spiral, probe);
        }
    }
}

void parian_environment_project(const parian_light *light, float sh[PARIAN_SH_COUNT][3],
                                parian_light_sample probe[PARIAN_ENVIRONMENT_PROBES])
{
    float spiral[PARIAN_ENVIRONMENT_PROBES][3];
    for (uint32_t i = 0; i < PARIAN_ENVIRONMENT_PROBES; i++) {
        spiral_direction(i, PARIAN_ENVIRONMENT_PROBES, spiral[i]);
        memset(&probe[i], 0, sizeof probe[i]);
        probe[i].kind = PARIAN_SAMPLE_PROBE;
    }
    bool image = light->image.pixel != NULL;
    project_cells(light, image ? light->image.width : 256, image ? light->image.height : 128, sh,
                  spiral, probe);
    for (uint32_t i = 0; i < PARIAN_ENVIRONMENT_PROBES; i++) {
        if (vec3_dot(probe[i].direction, probe[i].direction) <= 0.0f) {
            vec3_add_scaled(probe[i].direction, spiral[i], -1.0f);
        }
        vec3_normalize(probe[i].direction);
    }
}
