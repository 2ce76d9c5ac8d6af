/* slide.c - a checkerboard to project: 8 squares across.
 *
 * SPDX-License-Identifier: MIT
 */
#include "slide.h"

#include "core/memory.h"
#include "tool/picture.h"

enum { SIDE = 512, SQUARES = 8 };

parian_result slide_write(const parian_env *env, const char *path)
{
    uint8_t(*pixel)[4];
    if (!PARIAN_NEW(env, pixel, (size_t)SIDE * SIDE)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the slide %s", path);
    }
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        uint32_t column = i % SIDE * SQUARES / SIDE, row = i / SIDE * SQUARES / SIDE;
        uint8_t level = (row + column) % 2 ? 0 : 255;
        pixel[i][0] = pixel[i][1] = pixel[i][2] = level;
        pixel[i][3] = 255;
    }
    parian_result result = parian_png_write(env, path, SIDE, SIDE, (const uint8_t(*)[4])pixel);
    parian_free(env, pixel);
    return result;
}
