/* color_map.c - colours of numbers.
 *
 * Source  "magma" of Smith and van der Walt, CC0 [Magma15]: every sixteenth entry, interpolated
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/color_map.h"

#include <math.h>
#include <stddef.h>

#include "tool/picture.h"

enum { KNOTS = 17 };

/* sRGB at 0, 16/255, 32/255, ... 240/255, 1. */
static const float MAGMA[KNOTS][3] = {
    {0.001462f, 0.000466f, 0.013866f}, {0.039608f, 0.031090f, 0.133515f},
    {0.113094f, 0.065492f, 0.276784f}, {0.211718f, 0.061992f, 0.418647f},
    {0.316654f, 0.071690f, 0.485380f}, {0.414709f, 0.110431f, 0.504662f},
    {0.512831f, 0.148179f, 0.507648f}, {0.613617f, 0.181811f, 0.498536f},
    {0.716387f, 0.214982f, 0.475290f}, {0.816914f, 0.255895f, 0.436461f},
    {0.904281f, 0.319610f, 0.388137f}, {0.960949f, 0.418323f, 0.359630f},
    {0.986700f, 0.535582f, 0.382210f}, {0.996096f, 0.653659f, 0.446213f},
    {0.996898f, 0.769591f, 0.534892f}, {0.992440f, 0.884330f, 0.640099f},
    {0.987053f, 0.991438f, 0.749504f},
};

/* CIELAB of the ends and the middle of the diverging map; equal lightness of the ends,
 * and all between is a colour of sRGB. */
static const double BLUE[3] = {34, 11, -47}, WHITE[3] = {97, 0, 0}, RED[3] = {34, 54, 31};

void parian_color_map_sequential(double t, uint8_t rgb[3])
{
    double at = fmin(fmax(t, 0), 1) * 255 / 16;
    size_t knot = (size_t)fmin(floor(at), KNOTS - 2);
    double width = knot == KNOTS - 2 ? 15.0 / 16 : 1, share = (at - (double)knot) / width;
    for (int c = 0; c < 3; c++) {
        double v = MAGMA[knot][c] + share * ((double)MAGMA[knot + 1][c] - MAGMA[knot][c]);
        rgb[c] = (uint8_t)lround(255 * v);
    }
}

static double inverse_lab_curve(double t)
{
    const double delta = 6.0 / 29;
    return t > delta ? t * t * t : 3 * delta * delta * (t - 4.0 / 29);
}

static void lab_to_srgb(const double lab[3], uint8_t rgb[3])
{
    double f = (lab[0] + 16) / 116;
    double x = 0.950428545 * inverse_lab_curve(f + lab[1] / 500), y = inverse_lab_curve(f);
    double z = 1.088900371 * inverse_lab_curve(f - lab[2] / 200);
    rgb[0] = parian_srgb_encode((float)(3.241003275 * x - 1.537398934 * y - 0.498615861 * z));
    rgb[1] = parian_srgb_encode((float)(-0.969224334 * x + 1.875930071 * y + 0.041554224 * z));
    rgb[2] = parian_srgb_encode((float)(0.055639423 * x - 0.204011202 * y + 1.057148933 * z));
}

void parian_color_map_diverging(double t, uint8_t rgb[3])
{
    const double *end = t < 0 ? BLUE : RED;
    double share = fmin(fabs(t), 1), lab[3];
    for (int c = 0; c < 3; c++) {
        lab[c] = WHITE[c] + share * (end[c] - WHITE[c]);
    }
    lab_to_srgb(lab, rgb);
}
