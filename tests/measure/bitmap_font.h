/* bitmap_font.h - text into a picture, without a font on the machine: 5 x 7 pixels a letter, ASCII.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_BITMAP_FONT_H
#define PARIAN_MEASURE_BITMAP_FONT_H

#include <stddef.h>
#include <stdint.h>

enum {
    PARIAN_FONT_ADVANCE = 6,
    PARIAN_FONT_HEIGHT = 8
}; /* pixels at scale 1; tails reach into the eighth row */

/* Letters that a text takes: what is not ASCII counts, and is drawn, as one '?', what cannot be
 * seen as a space. */
size_t parian_font_length(const char *text);
/* Draw the first `length` letters from (x, y), the upper left corner; scale: pixels a dot. What
 * leaves the picture is left out. rgba: [height * width][4]. */
void parian_font_draw(uint32_t width, uint32_t height, uint8_t (*rgba)[4], long x, long y,
                      int scale, const uint8_t color[3], const char *text, size_t length);

#endif
