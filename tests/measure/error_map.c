/* error_map.c - pictures of an error: pixels through a colour map, a scale and a title under them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/error_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tests/measure/bitmap_font.h"
#include "tests/measure/chart_axis.h"
#include "tests/measure/chart_text.h"
#include "tests/measure/color_map.h"
#include "tool/files.h"
#include "tool/picture.h"

enum {
    WIDTH_MIN = 512,  /* of a picture: smaller maps are magnified by a whole number, then centred */
    TEXT_WIDTH = 400, /* pixels of picture for each step of the size of letters */
    TITLE_LINES_MAX = 4,
    NAME_MAX_BYTES = 200,
    LINE_MAX_BYTES = 96,
    LINE_HEIGHT = 10 /* at letters of size 1 */
};

static const uint8_t INK[3] = {0x20, 0x20, 0x20}, PAPER[3] = {0xff, 0xff, 0xff},
                     NONE[3] = {0x80, 0x80, 0x80};
static const double LIMIT_SHARE = 0.99;

typedef struct sheet {
    const parian_env *env;
    const parian_error_map *map;
    double limit, smallest, largest;
    size_t none;   /* pixels without a value */
    uint32_t zoom; /* pixels of the picture for one of the map */
    uint32_t left; /* of the map in the picture */
    int scale;     /* of letters */
    uint32_t width, height, map_height;
    uint8_t (*rgba)[4];
} sheet;

/* ---- the limit ---------------------------------------------------------------------------------
 */
static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Range of the values, and 99th percentile of what is finite in size. */
static parian_result survey(sheet *s)
{
    size_t count = (size_t)s->map->width * s->map->height, used = 0;
    float *size;
    if (!PARIAN_NEW(s->env, size, count)) {
        return parian_fail(s->env, PARIAN_E_NOMEM, "no memory for an error map of %u x %u pixels",
                           s->map->width, s->map->height);
    }
    s->smallest = INFINITY, s->largest = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        float v = s->map->value[i];
        s->none += isnan(v);
        s->smallest = v < s->smallest ? v : s->smallest;
        s->largest = v > s->largest ? v : s->largest;
        if (isfinite(v)) {
            size[used++] = fabsf(v);
        }
    }
    qsort(size, used, sizeof *size, by_size);
    s->limit = s->map->limit;
    if (!(s->limit > 0 && isfinite(s->limit))) {
        s->limit = used ? size[(size_t)ceil(LIMIT_SHARE * (double)used) - 1] : 0;
        s->limit = s->limit > 0 ? s->limit : used ? size[used - 1] : 0;
        s->limit = s->limit > 0 ? s->limit : 1;
    }
    parian_free(s->env, size);
    return PARIAN_OK;
}

/* ---- drawing -----------------------------------------------------------------------------------
 */
static void color_of(const sheet *s, double value, uint8_t rgb[3])
{
    if (isnan(value)) {
        memcpy(rgb, NONE, sizeof NONE);
    } else if (s->map->is_signed) {
        parian_color_map_diverging(value / s->limit, rgb);
    } else {
        parian_color_map_sequential(value / s->limit, rgb);
    }
}

static void fill(sheet *s, long x0, long y0, long x1, long y1, const uint8_t color[3])
{
    for (long y = y0 < 0 ? 0 : y0; y < y1 && y < (long)s->height; y++) {
        for (long x = x0 < 0 ? 0 : x0; x < x1 && x < (long)s->width; x++) {
            uint8_t *p = s->rgba[(size_t)y * s->width + (size_t)x];
            p[0] = color[0], p[1] = color[1], p[2] = color[2], p[3] = 255;
        }
    }
}

static void draw_row(void *context, size_t y)
{
    sheet *s = context;
    for (uint32_t x = 0; x < s->map->width; x++) {
        uint8_t rgb[3];
        color_of(s, s->map->value[y * s->map->width + x], rgb);
        long left = (long)s->left + (long)x * s->zoom, top = (long)y * s->zoom;
        fill(s, left, top, left + s->zoom, top + s->zoom, rgb);
    }
}

static void draw_text(sheet *s, long x, long y, const char *text, size_t length)
{
    parian_font_draw(s->width, s->height, s->rgba, x, y, s->scale, INK, text, length);
}

/* Letters that fit on a line. */
static size_t line_length(const sheet *s)
{
    return (s->width - 4u * (uint32_t)s->scale) / (PARIAN_FONT_ADVANCE * (uint32_t)s->scale);
}

/* Bytes of a title that go on a line of `fits` letters: up to the last space that fits, else what
 * fits. */
static size_t line_bytes(const char *title, size_t fits)
{
    size_t bytes = 0, space = 0, before = 0;
    for (size_t letters = 0; title[bytes]; letters++) {
        if (letters == fits) {
            return space ? space : before;
        }
        space = title[bytes] == ' ' ? bytes : space;
        do {
            bytes++;
        } while ((unsigned char)title[bytes] >> 6 == 2);
        before = bytes;
    }
    return bytes;
}

/* Lines of a title, drawn from y on; y < 0: only counted. What is beyond the last line is left out.
 */
static int draw_title(sheet *s, const char *title, long y)
{
    size_t fits = line_length(s);
    int lines = 0;
    for (; title && *title && lines < TITLE_LINES_MAX; lines++) {
        size_t bytes = line_bytes(title, fits), letters = 0;
        for (size_t i = 0; i < bytes; i++) {
            letters += (unsigned char)title[i] >> 6 != 2;
        }
        if (y >= 0) {
            draw_text(s, 2 * s->scale, y + (long)lines * LINE_HEIGHT * s->scale, title, letters);
        }
        title += bytes;
        title += strspn(title, " ");
    }
    return lines;
}

/* Numbers under ticks: every n-th from zero, so that they do not run into each other. */
static void draw_numbers(sheet *s, const parian_chart_axis *axis, const parian_chart_tick *ticks,
                         size_t count, long left, long right, long y)
{
    parian_chart_text number[PARIAN_CHART_TICKS_MAX];
    long widest = 0, advance = (long)PARIAN_FONT_ADVANCE * s->scale;
    for (size_t i = 0; i < count; i++) {
        double value = fabs(ticks[i].value) < 1e-9 * s->limit ? 0 : ticks[i].value;
        number[i] = (parian_chart_text){.env = s->env};
        parian_chart_text_put_number(&number[i], value);
        widest = (long)number[i].size * advance > widest ? (long)number[i].size * advance : widest;
    }
    double step = count > 1 ? ticks[1].value - ticks[0].value : s->limit;
    double spacing = step / (axis->high - axis->low) * (double)(right - left);
    long every = (long)ceil((double)(widest + advance) / spacing);
    for (size_t i = 0; i < count; i++) {
        long x = left +
                 lround(parian_chart_axis_place(axis, ticks[i].value) * (double)(right - left - 1));
        long width = (long)number[i].size * advance - s->scale, at = x - width / 2;
        long last = (long)s->width - width - s->scale;
        if (lround(ticks[i].value / step) % every == 0) {
            draw_text(s,
                      at < s->scale ? s->scale
                      : at > last   ? last
                                    : at,
                      y, number[i].text, number[i].size);
        }
        parian_chart_text_free(&number[i]);
    }
}

/* The bar of colours with numbers at round values under it. */
static void draw_scale(sheet *s, long top)
{
    long left = 16 * s->scale, right = (long)s->width - 16 * s->scale, high = 10 * s->scale;
    parian_chart_axis axis = {false, s->map->is_signed ? -s->limit : 0, s->limit};
    parian_chart_tick ticks[PARIAN_CHART_TICKS_MAX];
    size_t count = parian_chart_axis_ticks(&axis, ticks);
    for (long x = left; x < right; x++) {
        uint8_t rgb[3];
        color_of(s, parian_chart_axis_value(&axis, (double)(x - left) / (double)(right - left - 1)),
                 rgb);
        fill(s, x, top, x + 1, top + high, rgb);
    }
    for (size_t i = 0; i < count; i++) {
        long x = left + lround(parian_chart_axis_place(&axis, ticks[i].value) *
                               (double)(right - left - 1));
        fill(s, x - s->scale / 2, top + high, x - s->scale / 2 + s->scale,
             top + high + 3 * s->scale, INK);
    }
    draw_numbers(s, &axis, ticks, count, left, right, top + high + 5 * s->scale);
}

static void put_range(const sheet *s, char line[LINE_MAX_BYTES])
{
    bool any = s->smallest <= s->largest;
    if (!any) {
        snprintf(line, LINE_MAX_BYTES, "no values");
        return;
    }
    snprintf(line, LINE_MAX_BYTES, "values %.3g to %.3g%s", s->smallest, s->largest,
             s->none ? "; grey: no value" : "");
}

static parian_result draw_sheet(sheet *s)
{
    char range[LINE_MAX_BYTES];
    const parian_error_map *m = s->map;
    s->zoom = m->width < WIDTH_MIN ? (WIDTH_MIN + m->width - 1) / m->width : 1;
    s->zoom = s->zoom > 64 ? 64 : s->zoom;
    while (s->zoom > 1 && m->height * s->zoom > 2 * WIDTH_MIN) {
        s->zoom--;
    }
    s->map_height = m->height * s->zoom;
    s->width = m->width * s->zoom < WIDTH_MIN ? WIDTH_MIN : m->width * s->zoom;
    s->left = (s->width - m->width * s->zoom) / 2;
    s->scale = s->width < 2 * TEXT_WIDTH ? 2 : (int)(s->width / TEXT_WIDTH);
    put_range(s, range);
    long step = (long)LINE_HEIGHT * s->scale, top = (long)s->map_height + 4 * s->scale;
    int lines = draw_title(s, m->title, -1);
    s->height = (uint32_t)(top + (lines + 1) * step + 2 * s->scale + 26 * s->scale);
    if (!PARIAN_NEW(s->env, s->rgba, (size_t)s->width * s->height)) {
        return parian_fail(s->env, PARIAN_E_NOMEM, "no memory for an error map of %u x %u pixels",
                           s->width, s->height);
    }
    fill(s, 0, 0, s->width, s->height, PAPER);
    parian_par(s->env, m->height, draw_row, s);
    draw_title(s, m->title, top);
    draw_text(s, 2 * s->scale, top + lines * step, range, line_length(s));
    draw_scale(s, top + (lines + 1) * step + 2 * s->scale);
    return PARIAN_OK;
}

/* ---- files -------------------------------------------------------------------------------------
 */
static parian_result write_values(const parian_env *env, const char *path,
                                  const parian_error_map *map)
{
    size_t count = (size_t)map->width * map->height;
    float(*rgba)[4];
    if (!PARIAN_NEW(env, rgba, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for '%s'", path);
    }
    for (size_t i = 0; i < count; i++) {
        rgba[i][0] = rgba[i][1] = rgba[i][2] = map->value[i];
        rgba[i][3] = isnan(map->value[i]) ? 0 : 1;
    }
    parian_result result =
        parian_exr_write(env, path, map->width, map->height, (const float(*)[4])rgba);
    parian_free(env, rgba);
    return result;
}

static char *join(const parian_env *env, const char *folder, const char *name, const char *suffix)
{
    char file[NAME_MAX_BYTES + 8];
    snprintf(file, sizeof file, "%s%s", name, suffix);
    return parian_path_join(env, folder, file);
}

static parian_result check(const parian_env *env, const char *name, const parian_error_map *map)
{
    if (map->width == 0 || map->height == 0 || map->width > PARIAN_PICTURE_SIDE_MAX ||
        map->height > PARIAN_PICTURE_SIDE_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "an error map of %u x %u pixels; expected 1 to %d a side", map->width,
                           map->height, PARIAN_PICTURE_SIDE_MAX);
    }
    if (!*name || strlen(name) > NAME_MAX_BYTES || strchr(name, '/')) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "an error map cannot have the name '%.40s'",
                           name);
    }
    return PARIAN_OK;
}

parian_result parian_error_map_write(const parian_env *env, const char *folder, const char *name,
                                     const parian_error_map *map)
{
    sheet s = {.env = env, .map = map};
    char *png = NULL, *exr = NULL;
    parian_result result = check(env, name, map);
    if (result != PARIAN_OK) {
        return result;
    }
    png = join(env, folder, name, ".png");
    exr = join(env, folder, name, ".exr");
    result = png && exr ? survey(&s)
                        : parian_fail(env, PARIAN_E_NOMEM, "no memory for the names of '%s'", name);
    result = result == PARIAN_OK ? draw_sheet(&s) : result;
    result = result == PARIAN_OK ? parian_folder_create(env, folder) : result;
    result = result == PARIAN_OK ? write_values(env, exr, map) : result;
    if (result == PARIAN_OK) {
        result = parian_png_write(env, png, s.width, s.height, (const uint8_t(*)[4])s.rgba);
    }
    parian_free(env, s.rgba);
    parian_free(env, png);
    parian_free(env, exr);
    return result;
}
