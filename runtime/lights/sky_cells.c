/* sky_cells.c - cuts environments into cells of much light or large extent.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lights/sky_cells.h"

#include <string.h>

#include "core/memory.h"
#include "lights/light_image.h"
#include "vec3.h"

enum { PLAIN_WIDTH = 64, PLAIN_HEIGHT = 32 }; /* pixels of an environment without an image */

/* A cell is a sun when it is narrower than this and holds at least half of an even share. */
static const double SUN_DIAMETER = 0.2;

static double column_edge(const parian_sky *sky, double x)
{
    return fmin(x * sky->join, sky->source_width) / sky->source_width;
}

static double row_edge(const parian_sky *sky, uint32_t y)
{
    return fmin((double)y * sky->join, sky->source_height) / sky->source_height;
}

/* Towards the sky: column in pixels, cosine of the angle to +y. */
static void direction_at(const parian_sky *sky, double x, double cosine, float direction[3])
{
    double phi = (column_edge(sky, x) - 0.5) * 2.0 * M_PI - sky->rotation;
    double sine = sqrt(fmax(0.0, 1.0 - cosine * cosine));
    direction[0] = (float)(sine * sin(phi));
    direction[1] = (float)cosine;
    direction[2] = (float)(-sine * cos(phi));
}

static double solid_angle(const parian_sky *sky, uint32_t x, uint32_t y)
{
    return (sky->row_cosine[y] - sky->row_cosine[y + 1]) * 2.0 * M_PI *
           (column_edge(sky, x + 1.0) - column_edge(sky, x));
}

static double brightness(const float radiance[3])
{
    return (double)radiance[0] + (double)radiance[1] + (double)radiance[2];
}

/* ---- sums ---- */

/* Mean radiance of the source's pixels under one of ours, by solid angle. */
static void join_pixels(const parian_sky *sky, const parian_light *light, uint32_t x, uint32_t y,
                        float radiance[3])
{
    const parian_light_image *image = &light->image;
    uint32_t x1 = (x + 1) * sky->join, y1 = (y + 1) * sky->join;
    double sum[3] = {0}, weights = 0.0;
    x1 = x1 < sky->source_width ? x1 : sky->source_width;
    y1 = y1 < sky->source_height ? y1 : sky->source_height;
    for (uint32_t v = y * sky->join; v < y1; v++) {
        double band = cos(M_PI * v / sky->source_height) - cos(M_PI * (v + 1) / sky->source_height);
        for (uint32_t u = x * sky->join; u < x1; u++) {
            weights += band;
            for (int c = 0; c < 3; c++) {
                sum[c] +=
                    band *
                    (double)(image->pixel ? image->pixel[(size_t)v * image->width + u][c] : 1.0f);
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        radiance[c] = light->color[c] * (float)(sum[c] / weights);
    }
}

static void fill_sums(parian_sky *sky, const parian_light *light)
{
    const size_t stride = (size_t)sky->width + 1;
    for (uint32_t y = 0; y <= sky->height; y++) {
        sky->row_cosine[y] = cos(M_PI * row_edge(sky, y));
    }
    memset(sky->power, 0, stride * sizeof *sky->power);
    for (uint32_t y = 0; y < sky->height; y++) {
        double row = 0.0;
        sky->power[(y + 1) * stride] = 0.0;
        for (uint32_t x = 0; x < sky->width; x++) {
            float *radiance = sky->radiance[(size_t)y * sky->width + x];
            join_pixels(sky, light, x, y, radiance);
            row += brightness(radiance) * solid_angle(sky, x, y);
            sky->power[(y + 1) * stride + x + 1] = sky->power[y * stride + x + 1] + row;
        }
    }
}

static double power_of(const parian_sky *sky, const parian_sky_cell *cell)
{
    const size_t stride = (size_t)sky->width + 1;
    const double *low = sky->power + cell->y0 * stride, *high = sky->power + cell->y1 * stride;
    return fmax(0.0, (high[cell->x1] - high[cell->x0]) - (low[cell->x1] - low[cell->x0]));
}

/* ---- cells ---- */

/* Height and width of a cell, radians. */
static void cell_extent(const parian_sky *sky, const parian_sky_cell *cell, double extent[2])
{
    double top = M_PI * row_edge(sky, cell->y0), bottom = M_PI * row_edge(sky, cell->y1);
    double sine = top < 0.5 * M_PI && bottom > 0.5 * M_PI ? 1.0 : fmax(sin(top), sin(bottom));
    extent[0] = bottom - top;
    extent[1] = 2.0 * M_PI * (column_edge(sky, cell->x1) - column_edge(sky, cell->x0)) * sine;
}

static double diameter_of(const parian_sky *sky, const parian_sky_cell *cell)
{
    double extent[2];
    cell_extent(sky, cell, extent);
    return fmin(hypot(extent[0], extent[1]), M_PI);
}

static double cost_of(const parian_sky *sky, const parian_sky_cell *cell)
{
    double power = power_of(sky, cell);
    bool single = cell->x1 - cell->x0 == 1 && cell->y1 - cell->y0 == 1;
    return single ? 0.0 : power * power * diameter_of(sky, cell);
}

/* Where along an axis the power of a cell reaches a share of the whole; strictly inside. */
static uint32_t find_half(const parian_sky *sky, const parian_sky_cell *cell, bool rows)
{
    uint32_t low = rows ? cell->y0 : cell->x0, high = rows ? cell->y1 : cell->x1;
    uint32_t first = low + 1, last = high - 1;
    double half = 0.5 * power_of(sky, cell);
    while (first < last) {
        uint32_t middle = first + (last - first) / 2;
        parian_sky_cell part = *cell;
        *(rows ? &part.y1 : &part.x1) = middle;
        if (power_of(sky, &part) < half) {
            first = middle + 1;
        } else {
            last = middle;
        }
    }
    return first;
}

static void cut_cell(const parian_sky *sky, parian_sky_cell *cell, parian_sky_cell *rest)
{
    double extent[2];
    cell_extent(sky, cell, extent);
    bool rows = extent[0] >= extent[1];
    if ((rows ? cell->y1 - cell->y0 : cell->x1 - cell->x0) == 1) {
        rows = !rows;
    }
    uint32_t at = find_half(sky, cell, rows);
    *rest = *cell;
    *(rows ? &cell->y1 : &cell->x1) = at;
    *(rows ? &rest->y0 : &rest->x0) = at;
}

static void cut_cells(parian_sky *sky, uint32_t cell_max)
{
    uint32_t count = 1, kept = 0;
    sky->cell[0] = (parian_sky_cell){0, sky->width, 0, sky->height};
    while (count < cell_max) {
        uint32_t worst = 0;
        for (uint32_t c = 1; c < count; c++) {
            worst = cost_of(sky, &sky->cell[c]) > cost_of(sky, &sky->cell[worst]) ? c : worst;
        }
        if (!(cost_of(sky, &sky->cell[worst]) > 0.0)) {
            break;
        }
        cut_cell(sky, &sky->cell[worst], &sky->cell[count++]);
    }
    for (uint32_t c = 0; c < count; c++) {
        if (power_of(sky, &sky->cell[c]) > 0.0) {
            sky->cell[kept++] = sky->cell[c];
        }
    }
    sky->cell_count = kept;
}

parian_result parian_sky_build(const parian_env *env, const parian_light *light, uint32_t cell_max,
                               parian_sky *sky)
{
    bool image = light->image.pixel != NULL;
    parian_sky made = {.rotation = (double)light->rotation_deg * M_PI / 180.0};
    made.source_width = image ? light->image.width : PLAIN_WIDTH;
    made.source_height = image ? light->image.height : PLAIN_HEIGHT;
    uint32_t longer =
        made.source_width > made.source_height ? made.source_width : made.source_height;
    made.join = (longer + PARIAN_SKY_WIDTH_MAX - 1) / PARIAN_SKY_WIDTH_MAX;
    made.width = (made.source_width + made.join - 1) / made.join;
    made.height = (made.source_height + made.join - 1) / made.join;
    size_t corners = ((size_t)made.width + 1) * ((size_t)made.height + 1);
    if (!PARIAN_NEW(env, made.radiance, (size_t)made.width * made.height) ||
        !PARIAN_NEW(env, made.row_cosine, (size_t)made.height + 1) ||
        !PARIAN_NEW(env, made.power, corners) || !PARIAN_NEW(env, made.cell, cell_max)) {
        parian_sky_free(env, &made);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for an environment of %u x %u pixels",
                           made.width, made.height);
    }
    fill_sums(&made, light);
    cut_cells(&made, cell_max);
    *sky = made;
    return PARIAN_OK;
}

bool parian_sky_equal(const parian_sky *a, const parian_sky *b)
{
    return a->width == b->width && a->height == b->height && a->source_width == b->source_width &&
           a->source_height == b->source_height && a->rotation == b->rotation &&
           a->cell_count == b->cell_count &&
           memcmp(a->radiance, b->radiance, (size_t)a->width * a->height * sizeof *a->radiance) ==
               0;
}

void parian_sky_free(const parian_env *env, parian_sky *sky)
{
    if (sky) {
        parian_free(env, sky->radiance);
        parian_free(env, sky->row_cosine);
        parian_free(env, sky->power);
        parian_free(env, sky->cell);
        memset(sky, 0, sizeof *sky);
    }
}

/* ---- samples ---- */

static bool is_sun(const parian_sky *sky, const parian_sky_cell *cell)
{
    const parian_sky_cell whole = {0, sky->width, 0, sky->height};
    return diameter_of(sky, cell) < SUN_DIAMETER &&
           power_of(sky, cell) * 2.0 * sky->cell_count > power_of(sky, &whole);
}

/* Mean direction and irradiance of a cell; with sh its radiance is added there. */
static void sum_cell(const parian_sky *sky, const parian_sky_cell *cell,
                     parian_light_sample *sample, float (*sh)[3])
{
    double sum[3] = {0}, mean[3] = {0};
    for (uint32_t y = cell->y0; y < cell->y1; y++) {
        double cosine = 0.5 * (sky->row_cosine[y] + sky->row_cosine[y + 1]);
        for (uint32_t x = cell->x0; x < cell->x1; x++) {
            const float *radiance = sky->radiance[(size_t)y * sky->width + x];
            double angle = solid_angle(sky, x, y), power = brightness(radiance) * angle;
            float direction[3], harmonic[PARIAN_SH_COUNT];
            direction_at(sky, x + 0.5, cosine, direction);
            for (int c = 0; c < 3; c++) {
                sum[c] += (double)radiance[c] * angle;
                mean[c] -= (double)direction[c] * power;
            }
            if (sh) {
                parian_sh_evaluate(direction, harmonic);
                for (int k = 0; k < PARIAN_SH_COUNT; k++) {
                    vec3_add_scaled(sh[k], radiance, harmonic[k] * (float)angle);
                }
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        sample->color[c] = (float)sum[c];
        sample->direction[c] = (float)(mean[c] / fmax(power_of(sky, cell), 1e-300));
    }
    vec3_normalize(sample->direction);
}

void parian_sky_samples(const parian_sky *sky, parian_light_sample *sample,
                        float sh[PARIAN_SH_COUNT][3])
{
    uint32_t suns = 0;
    for (uint32_t c = 0; c < sky->cell_count; c++) {
        bool sun = suns < PARIAN_SKY_SUN_MAX && is_sun(sky, &sky->cell[c]);
        memset(&sample[c], 0, sizeof sample[c]);
        sample[c].kind = sun ? PARIAN_SAMPLE_DIRECTIONAL : PARIAN_SAMPLE_PROBE;
        sum_cell(sky, &sky->cell[c], &sample[c], sun ? NULL : sh);
        suns += sun ? 1 : 0;
    }
}

/* The row or column of a cell in which a share of its power falls; the share within it takes its
 * place. */
static uint32_t draw_along(const parian_sky *sky, parian_sky_cell *cell, bool rows, double *share)
{
    uint32_t *low = rows ? &cell->y0 : &cell->x0, *high = rows ? &cell->y1 : &cell->x1;
    uint32_t start = *low, first = *low, last = *high - 1;
    double target = *share * power_of(sky, cell), before = 0.0;
    while (first < last) {
        uint32_t middle = first + (last - first) / 2;
        *low = start, *high = middle + 1;
        if (power_of(sky, cell) > target) {
            last = middle;
        } else {
            first = middle + 1;
        }
    }
    if (first > start) {
        *low = start, *high = first;
        before = power_of(sky, cell);
    }
    *low = first, *high = first + 1;
    double inside = power_of(sky, cell);
    *share = inside > 0.0 ? fmin(fmax((target - before) / inside, 0.0), 1.0) : 0.5;
    return first;
}

void parian_sky_draw(const parian_sky *sky, uint32_t cell, const double at[2],
                     parian_light_sample *sample)
{
    parian_sky_cell part = sky->cell[cell];
    double power = power_of(sky, &part), u = at[0], v = at[1];
    uint32_t y = draw_along(sky, &part, true, &v), x = draw_along(sky, &part, false, &u);
    const float *radiance = sky->radiance[(size_t)y * sky->width + x];
    double bright = brightness(radiance);
    memset(sample, 0, sizeof *sample);
    sample->kind = PARIAN_SAMPLE_DIRECTIONAL;
    direction_at(sky, x + u, sky->row_cosine[y] + v * (sky->row_cosine[y + 1] - sky->row_cosine[y]),
                 sample->direction);
    vec3_scale(sample->direction, -1.0f);
    for (int c = 0; c < 3; c++) {
        sample->color[c] = bright > 0.0 ? (float)((double)radiance[c] / bright * power) : 0.0f;
    }
}
