/* detail_color.c - the base colour of the source surface, averaged over the footprint of a texel.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/detail_color.h"

#include <math.h>

#include "core/small_maths.h"

enum { SAMPLES_MAX = 8 }; /* per side of the footprint */

const parian_source_material *parian_detail_material(const parian_detail_desc *desc,
                                                     uint32_t triangle)
{
    uint32_t material = desc->source->material ? desc->source->material[triangle] : desc->material;
    return desc->materials && material < desc->material_count ? &desc->materials[material] : NULL;
}

/* The picture of a material whose triangles have texture coordinates; NULL for none. */
static const parian_picture *find_picture(const parian_detail_desc *desc,
                                          const parian_source_material *material)
{
    int32_t picture = material->base_color_picture;
    if (!desc->source->corner_uv || picture < 0 || (uint32_t)picture >= desc->picture_count) {
        return NULL;
    }
    const parian_picture *found = &desc->pictures[picture];
    return found->pixel && found->width && found->height ? found : NULL;
}

bool parian_detail_has_color(const parian_detail_desc *desc)
{
    for (uint32_t t = 0; t < desc->source->triangle_count; t++) {
        const parian_source_material *material = parian_detail_material(desc, t);
        if (!material) {
            continue;
        }
        const float *factor = material->base_color;
        if (factor[0] != 1.0f || factor[1] != 1.0f || factor[2] != 1.0f ||
            find_picture(desc, material)) {
            return true;
        }
    }
    return false;
}

static uint32_t repeat(double index, uint32_t count)
{
    double wrapped = index - floor(index / count) * count;
    return wrapped < count ? (uint32_t)wrapped : 0;
}

static void add_bilinear(const parian_picture *picture, const float srgb_to_linear[256], double u,
                         double v, double color[3])
{
    double x = u * picture->width - 0.5, y = v * picture->height - 0.5;
    double x0 = floor(x), y0 = floor(y);
    for (int corner = 0; corner < 4; corner++) {
        int dx = corner & 1, dy = corner >> 1;
        size_t column = repeat(x0 + dx, picture->width), row = repeat(y0 + dy, picture->height);
        double weight = (dx ? x - x0 : 1.0 - (x - x0)) * (dy ? y - y0 : 1.0 - (y - y0));
        const uint8_t *pixel = picture->pixel[row * picture->width + column];
        for (int c = 0; c < 3; c++) {
            color[c] += weight * srgb_to_linear[pixel[c]];
        }
    }
}

/* How texture coordinates change over a triangle: uv at the hit, and the change over one metre
 * along two directions of its plane that are perpendicular to each other. */
typedef struct uv_frame {
    double at[2], along[2][2];
} uv_frame;

static void make_frame(const parian_mesh *mesh, const parian_closest_hit *hit, uv_frame *frame)
{
    const float(*uv)[2] = (const float(*)[2])mesh->corner_uv[hit->triangle];
    const double *corner[3];
    double e[2][3], n[3];
    for (int k = 0; k < 3; k++) {
        corner[k] = mesh->position[mesh->triangle[hit->triangle][k]];
    }
    for (int k = 0; k < 3; k++) {
        e[0][k] = corner[1][k] - corner[0][k];
        e[1][k] = corner[2][k] - corner[0][k];
    }
    parian_cross3(e[0], e[1], n);
    double base = sqrt(parian_dot3(e[0], e[0])), height = sqrt(parian_dot3(n, n)) / base;
    double foot = parian_dot3(e[0], e[1]) / base; /* of corner 2 on the line from 0 to 1 */
    for (int k = 0; k < 2; k++) {
        double d1 = (double)uv[1][k] - uv[0][k], d2 = (double)uv[2][k] - uv[0][k];
        frame->at[k] = hit->barycentric[0] * uv[0][k] + hit->barycentric[1] * uv[1][k] +
                       hit->barycentric[2] * uv[2][k];
        frame->along[0][k] = base > 0.0 ? d1 / base : 0.0;
        frame->along[1][k] = height > 0.0 ? (d2 - frame->along[0][k] * foot) / height : 0.0;
    }
}

/* One sample for each pixel that a side of the footprint crosses, up to SAMPLES_MAX. */
static int count_samples(const parian_picture *picture, const uv_frame *frame, double footprint_m)
{
    double pixels = 0.0;
    for (int axis = 0; axis < 2; axis++) {
        double x = frame->along[axis][0] * picture->width;
        double y = frame->along[axis][1] * picture->height;
        pixels = fmax(pixels, footprint_m * sqrt(x * x + y * y));
    }
    return pixels < SAMPLES_MAX ? 1 + (int)pixels : SAMPLES_MAX;
}

void parian_detail_color(const parian_detail_desc *desc, const float srgb_to_linear[256],
                         const parian_closest_hit *hit, double footprint_m, float color[3])
{
    const parian_source_material *material = parian_detail_material(desc, hit->triangle);
    const parian_picture *picture = material ? find_picture(desc, material) : NULL;
    double sum[3] = {0.0, 0.0, 0.0};
    int side = 1;
    if (picture) {
        uv_frame frame;
        make_frame(desc->source, hit, &frame);
        side = count_samples(picture, &frame, footprint_m);
        for (int i = 0; i < side * side; i++) {
            double a = ((i % side + 0.5) / side - 0.5) * footprint_m;
            double b = ((i / side + 0.5) / side - 0.5) * footprint_m;
            add_bilinear(picture, srgb_to_linear,
                         frame.at[0] + a * frame.along[0][0] + b * frame.along[1][0],
                         frame.at[1] + a * frame.along[0][1] + b * frame.along[1][1], sum);
        }
    }
    for (int c = 0; c < 3; c++) {
        double factor = material ? material->base_color[c] : 1.0;
        color[c] = (float)(factor * (picture ? sum[c] / ((double)side * side) : 1.0));
    }
}
