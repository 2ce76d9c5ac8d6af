/* montage_main.c - parian-montage: puts pictures side by side in one PNG.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tool/picture.h"
#include "tool/session.h"

enum { GAP = 8, PICTURES_MAX = 64, SIDE_MAX = 32768 };

typedef struct picture {
    uint32_t width, height;
    float (*rgb)[3];
} picture;

typedef struct montage {
    picture picture[PICTURES_MAX];
    size_t count;
    uint32_t columns, cell_width, cell_height;
} montage;

static parian_result read_pictures(const parian_env *env, const parian_string_list *paths,
                                   montage *m)
{
    if (paths->count > PICTURES_MAX) {
        return parian_fail(env, PARIAN_E_LIMIT, "%zu pictures were given, at most %d are possible",
                           paths->count, PICTURES_MAX);
    }
    for (size_t i = 0; i < paths->count; i++) {
        picture *p = &m->picture[i];
        parian_result result =
            parian_png_read_linear(env, paths->item[i], &p->width, &p->height, &p->rgb);
        if (result != PARIAN_OK) {
            return result;
        }
        m->count++;
        m->cell_width = p->width > m->cell_width ? p->width : m->cell_width;
        m->cell_height = p->height > m->cell_height ? p->height : m->cell_height;
    }
    return PARIAN_OK;
}

static void place(const montage *m, size_t index, uint32_t width, uint8_t (*pixel)[4])
{
    const picture *p = &m->picture[index];
    const uint32_t left = (uint32_t)(index % m->columns) * (m->cell_width + GAP);
    const uint32_t top = (uint32_t)(index / m->columns) * (m->cell_height + GAP);
    for (uint32_t y = 0; y < p->height; y++) {
        for (uint32_t x = 0; x < p->width; x++) {
            uint8_t *to = pixel[(size_t)(top + y) * width + left + x];
            for (int c = 0; c < 3; c++) {
                to[c] = parian_srgb_encode(p->rgb[(size_t)y * p->width + x][c]);
            }
        }
    }
}

static parian_result write_montage(const parian_env *env, const montage *m, const char *path)
{
    const uint32_t rows = (uint32_t)((m->count + m->columns - 1) / m->columns);
    const uint64_t width = (uint64_t)m->columns * (m->cell_width + GAP) - GAP;
    const uint64_t height = (uint64_t)rows * (m->cell_height + GAP) - GAP;
    uint8_t(*pixel)[4];
    if (width > SIDE_MAX || height > SIDE_MAX) {
        return parian_fail(
            env, PARIAN_E_LIMIT,
            "the montage would have %llu x %llu pixels, at most %d a side are possible",
            (unsigned long long)width, (unsigned long long)height, SIDE_MAX);
    }
    if (!PARIAN_NEW(env, pixel, (size_t)(width * height))) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %llu pixels",
                           (unsigned long long)(width * height));
    }
    memset(pixel, 255, (size_t)(width * height) * sizeof *pixel);
    for (size_t i = 0; i < m->count; i++) {
        place(m, i, (uint32_t)width, pixel);
    }
    parian_result result =
        parian_png_write(env, path, (uint32_t)width, (uint32_t)height, (const uint8_t(*)[4])pixel);
    parian_free(env, pixel);
    return result;
}

int main(int argc, char **argv)
{
    static montage m;
    const char *output = NULL;
    parian_common_options common = {0};
    static parian_string_list paths;
    const parian_option table[] = {
        {.name = "-o",
         .kind = PARIAN_OPTION_STRING,
         .value = &output,
         .argument = "OUT.png",
         .help = "The picture to write."},
        {.name = "--columns",
         .kind = PARIAN_OPTION_COUNT,
         .value = &m.columns,
         .argument = "N",
         .help = "Pictures in a row (all of them).",
         .minimum = 1,
         .maximum = PICTURES_MAX},
    };
    const parian_command command = {.tool = "parian-montage",
                                    .usage = "-o OUT.png PICTURE.png...",
                                    .summary = "Puts PNG pictures side by side.",
                                    .options = table,
                                    .option_count = sizeof table / sizeof table[0]};
    parian_result result = parian_options_parse(&command, &common, &paths, argc, argv, 1);
    if (result != PARIAN_OK || common.help || common.version) {
        return parian_result_exit_status(result);
    }
    if (!output || paths.count == 0) {
        fprintf(stderr,
                "parian-montage: an output and a picture are needed; see parian-montage --help\n");
        return parian_result_exit_status(PARIAN_E_ARGUMENT);
    }
    parian_session *session = NULL;
    result = parian_session_create("parian-montage", &common, &session);
    if (result == PARIAN_OK) {
        const parian_env *env = parian_session_env(session);
        m.columns = m.columns ? m.columns : (uint32_t)paths.count;
        result = read_pictures(env, &paths, &m);
        result = result == PARIAN_OK ? write_montage(env, &m, output) : result;
        for (size_t i = 0; i < m.count; i++) {
            parian_free(env, m.picture[i].rgb);
        }
    }
    int status = session ? parian_session_exit(session, result) : parian_result_exit_status(result);
    parian_session_destroy(session);
    return status;
}
