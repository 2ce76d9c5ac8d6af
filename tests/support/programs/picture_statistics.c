/* picture_statistics.c - numbers about part of a PNG, and how far another one differs, for scripts
 * that test.
 *
 * picture_statistics A.png X Y WIDTH HEIGHT [B.png]: mean red, green and blue and their standard
 * deviation over the rectangle (8-bit codes), and with B the share of its pixels that differ by
 * more than 6 codes in a channel.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/memory.h"
#include "tool/picture.h"

typedef struct picture {
    uint32_t width, height;
    float (*rgb)[3];
} picture;

typedef struct rectangle {
    uint32_t x, y, width, height;
} rectangle;

static int code(const picture *p, uint32_t x, uint32_t y, int c)
{
    return parian_srgb_encode(p->rgb[(size_t)y * p->width + x][c]);
}

static bool holds(const picture *p, const rectangle *r)
{
    return r->width > 0 && r->height > 0 && r->x + r->width <= p->width &&
           r->y + r->height <= p->height;
}

static void print_means(const picture *p, const rectangle *r)
{
    double sum[3] = {0, 0, 0}, squares = 0, grey = 0;
    const double count = (double)r->width * r->height;
    for (uint32_t y = r->y; y < r->y + r->height; y++) {
        for (uint32_t x = r->x; x < r->x + r->width; x++) {
            const int red = code(p, x, y, 0), green = code(p, x, y, 1), blue = code(p, x, y, 2);
            const double mean = (red + green + blue) / 3.0;
            sum[0] += red / count;
            sum[1] += green / count;
            sum[2] += blue / count;
            grey += mean / count;
            squares += mean * mean / count;
        }
    }
    printf("%.2f %.2f %.2f %.2f", sum[0], sum[1], sum[2], sqrt(fmax(squares - grey * grey, 0)));
}

static double share_that_differs(const picture *a, const picture *b, const rectangle *r)
{
    size_t count = 0;
    for (uint32_t y = r->y; y < r->y + r->height; y++) {
        for (uint32_t x = r->x; x < r->x + r->width; x++) {
            bool differs = false;
            for (int c = 0; c < 3; c++) {
                differs |= abs(code(a, x, y, c) - code(b, x, y, c)) > 6;
            }
            count += differs;
        }
    }
    return (double)count / ((double)r->width * r->height);
}

int main(int argc, char **argv)
{
    picture a = {0, 0, NULL}, b = {0, 0, NULL};
    if (argc < 6 || argc > 7) {
        fprintf(stderr, "usage: picture_statistics A.png X Y WIDTH HEIGHT [B.png]\n");
        return 1;
    }
    const rectangle r = {(uint32_t)atoi(argv[2]), (uint32_t)atoi(argv[3]), (uint32_t)atoi(argv[4]),
                         (uint32_t)atoi(argv[5])};
    if (parian_png_read_linear(NULL, argv[1], &a.width, &a.height, &a.rgb) != PARIAN_OK ||
        !holds(&a, &r) ||
        (argc > 6 &&
         (parian_png_read_linear(NULL, argv[6], &b.width, &b.height, &b.rgb) != PARIAN_OK ||
          !holds(&b, &r)))) {
        fprintf(stderr,
                "picture_statistics: a picture cannot be read, or is smaller than the rectangle\n");
        return 3;
    }
    print_means(&a, &r);
    if (argc > 6) {
        printf(" %.4f", share_that_differs(&a, &b, &r));
    }
    printf("\n");
    parian_free(NULL, a.rgb);
    parian_free(NULL, b.rgb);
    return 0;
}
