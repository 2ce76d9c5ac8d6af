/* cpu_tone.h - exposure and tone curve: the C evaluation of the tone passes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_TONE_H
#define PARIAN_CPU_TONE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/runtime.h"

/* Mean of `side` x `side` samples for each pixel: samples [height * side][width * side]. */
void parian_cpu_resolve(const float (*samples)[4], uint32_t width, uint32_t height, uint32_t side,
                        float (*picture)[4]);

/* Factor that brings the log-average luminance of covered pixels to 0.18; 1 where nothing shines.
 * Darker pixels than a thousandth of the mean count as that. */
float parian_cpu_exposure(const float (*picture)[4], size_t count);

/* 8-bit sRGB after exposure and tone curve; plain: neither, the values are clamped.
 * Source  [KhronosPbrNeutral] */
void parian_cpu_tone(const float (*picture)[4], size_t count, float exposure, parian_tone tone,
                     bool plain, uint8_t (*srgb)[4]);

#endif
