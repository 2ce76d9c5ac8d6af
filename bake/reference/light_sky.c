/* light_sky.c - environments: pixels drawn by their power, radiance of a direction.
 *
 * The picture's centre column looks along -z, its right quarter along +x, its upper edge along +y;
 * rotation turns it about +y, counterclockwise from above. Radiance is constant over a pixel, as
 * the runtime integrates it.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/light_parts.h"
#include "bake/reference/vec3d.h"
#include "core/memory.h"

static const double pi = 3.14159265358979323846;

static double pixel_power(const parian_sky_table *table, size_t pixel)
{
    const float *p = table->image->pixel[pixel];
    return table->color[0] * (double)p[0] + table->color[1] * (double)p[1] +
           table->color[2] * (double)p[2];
}

static void fill_sums(parian_sky_table *table)
{
    const uint32_t width = table->image->width, height = table->image->height;
    double total = 0;
    for (uint32_t y = 0; y <= height; y++) {
        table->row_cosine[y] = cos(pi * y / height);
    }
    for (uint32_t y = 0; y < height; y++) {
        double sum = 0, band = table->row_cosine[y] - table->row_cosine[y + 1];
        for (size_t x = 0; x < width; x++) {
            sum += band * pixel_power(table, (size_t)y * width + x);
            table->pixel_sum[(size_t)y * width + x] = sum;
        }
        total += sum;
        table->row_sum[y] = total;
    }
}

parian_result parian_sky_table_make(const parian_env *env, const parian_light *light,
                                    parian_sky_table *table)
{
    const parian_light_image *image = &light->image;
    size_t count = (size_t)image->width * image->height;
    *table = (parian_sky_table){.image = image, .rotation = light->rotation_deg * pi / 180};
    vec3d_from_float(table->color, light->color);
    if (!PARIAN_NEW(env, table->row_cosine, (size_t)image->height + 1) ||
        !PARIAN_NEW(env, table->row_sum, image->height) ||
        !PARIAN_NEW(env, table->pixel_sum, count)) {
        parian_sky_table_free(env, table);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for an environment of %u x %u pixels",
                           image->width, image->height);
    }
    fill_sums(table);
    return PARIAN_OK;
}

void parian_sky_table_free(const parian_env *env, parian_sky_table *table)
{
    parian_free(env, table->row_cosine);
    parian_free(env, table->row_sum);
    parian_free(env, table->pixel_sum);
    *table = (parian_sky_table){0};
}

/* First entry of ascending sums that exceeds the share u of the last; u becomes the place within
 * that entry. */
static uint32_t draw(const double *sum, uint32_t count, double *u)
{
    double target = *u * sum[count - 1];
    uint32_t first = 0, last = count - 1;
    while (first < last) {
        uint32_t middle = first + (last - first) / 2;
        if (sum[middle] > target) {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    double before = first > 0 ? sum[first - 1] : 0, share = sum[first] - before;
    *u = share > 0 ? fmin(fmax((target - before) / share, 0), 1) : 0.5;
    return first;
}

bool parian_sky_sample(const parian_sky_table *table, double u, double v, double direction[3],
                       double irradiance[3])
{
    const uint32_t width = table->image->width, height = table->image->height;
    double total = table->row_sum[height - 1];
    if (!(total > 0)) {
        return false;
    }
    uint32_t y = draw(table->row_sum, height, &v);
    uint32_t x = draw(table->pixel_sum + (size_t)y * width, width, &u);
    size_t pixel = (size_t)y * width + x;
    double power = pixel_power(table, pixel);
    if (!(power > 0)) {
        return false;
    }
    double cosine = table->row_cosine[y] + v * (table->row_cosine[y + 1] - table->row_cosine[y]);
    double sine = sqrt(fmax(0, 1 - cosine * cosine));
    double phi = ((x + u) / width - 0.5) * 2 * pi - table->rotation;
    direction[0] = sine * sin(phi);
    direction[1] = cosine;
    direction[2] = -sine * cos(phi);
    /* density = power / (total * 2 pi / width) */
    double inverse = total * 2 * pi / width / power;
    for (int c = 0; c < 3; c++) {
        irradiance[c] = table->color[c] * (double)table->image->pixel[pixel][c] * inverse;
    }
    return true;
}

void parian_sky_radiance(const parian_sky_table *table, const double direction[3],
                         double radiance[3])
{
    const uint32_t width = table->image->width, height = table->image->height;
    double u = (atan2(direction[0], -direction[2]) + table->rotation) / (2 * pi) + 0.5;
    double v = acos(fmin(1, fmax(-1, direction[1]))) / pi;
    u -= floor(u);
    uint32_t x = (uint32_t)(u * width), y = (uint32_t)(v * height);
    x = x < width ? x : width - 1;
    y = y < height ? y : height - 1;
    for (int c = 0; c < 3; c++) {
        radiance[c] = table->color[c] * (double)table->image->pixel[(size_t)y * width + x][c];
    }
}
