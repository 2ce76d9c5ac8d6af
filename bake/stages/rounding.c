/* rounding.c - rounds arrays of the surface to what anything computed from them needs.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/rounding.h"

#include <math.h>
#include <string.h>

static const float BARYCENTRIC_STEP = 0x1p-12f, NORMAL_STEP = 0x1p-13f, GUTTER_STEP = 0x1p-10f;
enum { AREA_BITS_LOST = 10, WEIGHT_BITS_LOST = 4 };

static void round_normals(float *component, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        component[i] = NORMAL_STEP * rintf(component[i] / NORMAL_STEP);
    }
}

/* To a float with AREA_BITS_LOST zeros at its end, the nearest. */
static float round_area(float area)
{
    uint32_t bits;
    memcpy(&bits, &area, sizeof bits);
    bits = (bits + (1u << (AREA_BITS_LOST - 1))) >> AREA_BITS_LOST << AREA_BITS_LOST;
    memcpy(&area, &bits, sizeof area);
    return area;
}

/* The largest weight takes what the others lose. */
static void round_gutter(float weight[PARIAN_GUTTER_SOURCES])
{
    int largest = 0;
    float rest = 1;
    for (int k = 1; k < PARIAN_GUTTER_SOURCES; k++) {
        largest = weight[k] > weight[largest] ? k : largest;
    }
    for (int k = 0; k < PARIAN_GUTTER_SOURCES; k++) {
        weight[k] = GUTTER_STEP * rintf(weight[k] / GUTTER_STEP);
        rest -= k == largest ? 0 : weight[k];
    }
    weight[largest] = rest;
}

parian_result parian_stage_rounding(const parian_env *env, parian_body *body)
{
    for (uint32_t i = 0; i < body->texel_count; i++) {
        for (int k = 0; k < 2; k++) {
            float *beta = &body->texel_barycentric[i][k];
            *beta = BARYCENTRIC_STEP * floorf(*beta / BARYCENTRIC_STEP);
        }
        body->texel_area[i] = round_area(body->texel_area[i]);
    }
    for (uint32_t i = 0; i < body->gutter_count; i++) {
        round_gutter(body->gutter_weight[i]);
    }
    round_normals(body->corner_normal[0][0], (size_t)body->triangle_count * 9);
    if (body->texel_normal_map) {
        round_normals(body->texel_normal_map[0], (size_t)body->texel_count * 3);
    }
    return parian_body_derive(env, body);
}

void parian_round_blend(parian_body *body)
{
    if (!body->blend_weight) {
        return;
    }
    const uint32_t lost = (1u << WEIGHT_BITS_LOST) - 1, half = lost / 2;
    parian_half *weight = body->blend_weight[0][0];
    for (size_t i = 0; i < (size_t)body->texel_count * 9; i++) {
        uint32_t magnitude = weight[i] & 0x7fffu, up = weight[i] & 0x8000u ? 0 : half;
        uint32_t rounded = (magnitude + up) & ~lost;
        if (rounded < 0x7c00u) { /* not up to infinity */
            weight[i] = (parian_half)((weight[i] & 0x8000u) | rounded);
        }
    }
}
