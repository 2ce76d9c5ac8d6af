/* light_check.c - tells lights that mean something from those that do not.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/reference/light_parts.h"

enum { IMAGE_SIDE_MAX = 16384 };

static bool is_finite(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static bool has_length(const float v[3])
{
    return is_finite(v) && (v[0] != 0 || v[1] != 0 || v[2] != 0);
}

static bool spans_area(const float u[3], const float v[3])
{
    double square = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double part = (double)u[i] * v[j] - (double)u[j] * v[i];
        square += part * part;
    }
    return square > 0 && isfinite(square);
}

static const char *image_fault(const parian_light_image *image)
{
    if (!image->pixel) {
        return NULL;
    }
    if (image->width < 1 || image->height < 1 || image->width > IMAGE_SIDE_MAX ||
        image->height > IMAGE_SIDE_MAX) {
        return "the image is not of 1 to 16384 pixels a side";
    }
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        for (int c = 0; c < 3; c++) {
            if (!(image->pixel[i][c] >= 0 && isfinite(image->pixel[i][c]))) {
                return "the image has a negative or non-finite pixel";
            }
        }
    }
    return NULL;
}

static const char *place_fault(const parian_light *light)
{
    const bool placed = light->type == PARIAN_LIGHT_POINT || light->type == PARIAN_LIGHT_SPOT ||
                        light->type == PARIAN_LIGHT_RECT;
    if (placed && !is_finite(light->position)) {
        return "position is not finite";
    }
    if ((light->type == PARIAN_LIGHT_DIRECTIONAL || light->type == PARIAN_LIGHT_SPOT) &&
        !has_length(light->direction)) {
        return "direction is not finite or has no length";
    }
    if (light->type == PARIAN_LIGHT_RECT && !spans_area(light->axis_u, light->axis_v)) {
        return "the axes span no rectangle";
    }
    return NULL;
}

const char *parian_light_fault(const parian_light *light)
{
    if ((unsigned)light->type > PARIAN_LIGHT_ENVIRONMENT) {
        return "unknown type";
    }
    for (int c = 0; c < 3; c++) {
        if (!(light->color[c] >= 0 && isfinite(light->color[c]))) {
            return "colour is negative or not finite";
        }
    }
    if (light->type == PARIAN_LIGHT_SPOT &&
        !(light->inner_deg >= 0 && light->inner_deg <= light->outer_deg && light->outer_deg > 0 &&
          light->outer_deg < 90 && is_finite(light->up))) {
        return "cone is not 0 <= inner <= outer < 90 degrees";
    }
    if (light->type == PARIAN_LIGHT_ENVIRONMENT && !isfinite(light->rotation_deg)) {
        return "rotation is not finite";
    }
    const char *fault = place_fault(light);
    const bool pictured =
        light->type == PARIAN_LIGHT_SPOT || light->type == PARIAN_LIGHT_ENVIRONMENT;
    return fault || !pictured ? fault : image_fault(&light->image);
}
