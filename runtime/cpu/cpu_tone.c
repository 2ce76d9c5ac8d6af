/* cpu_tone.c - exposure and tone curve: the C evaluation of the tone passes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "cpu/cpu_tone.h"

#include <math.h>

#include "vec3.h"

void parian_cpu_resolve(const float (*samples)[4], uint32_t width, uint32_t height, uint32_t side,
                        float (*picture)[4])
{
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            float *to = picture[(size_t)y * width + x];
            to[0] = to[1] = to[2] = to[3] = 0.0f;
            for (uint32_t k = 0; k < side * side; k++) {
                size_t row = (size_t)y * side + k / side, column = (size_t)x * side + k % side;
                const float *sample = samples[row * width * side + column];
                for (int c = 0; c < 4; c++) {
                    to[c] += sample[c] / (float)(side * side);
                }
            }
        }
    }
}

static float luminance(const float rgb[3])
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

float parian_cpu_exposure(const float (*picture)[4], size_t count)
{
    double sum = 0.0, covered = 0.0, logs = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += (double)(picture[i][3] * luminance(picture[i]));
        covered += (double)picture[i][3];
    }
    if (!(sum > 0.0) || !(covered > 0.0)) {
        return 1.0f;
    }
    double least = 1e-3 * sum / covered;
    for (size_t i = 0; i < count; i++) {
        if (picture[i][3] > 0.0f) {
            logs += (double)picture[i][3] * log(fmax((double)luminance(picture[i]), least));
        }
    }
    return (float)(0.18 / exp(logs / covered));
}

/* Identity up to 0.76, then a shoulder towards white that keeps hues. */
static void neutral_curve(float rgb[3])
{
    const float start = 0.8f - 0.04f, desaturation = 0.15f;
    float least = fminf(rgb[0], fminf(rgb[1], rgb[2]));
    float offset = least < 0.08f ? least - 6.25f * least * least : 0.04f;
    for (int c = 0; c < 3; c++) {
        rgb[c] -= offset;
    }
    float peak = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
    if (peak < start) {
        return;
    }
    float room = 1.0f - start;
    float new_peak = 1.0f - room * room / (peak + room - start);
    vec3_scale(rgb, new_peak / peak);
    float white = 1.0f - 1.0f / (desaturation * (peak - new_peak) + 1.0f);
    for (int c = 0; c < 3; c++) {
        rgb[c] = rgb[c] * (1.0f - white) + new_peak * white;
    }
}

static float encode(float linear)
{
    float x = fminf(fmaxf(linear, 0.0f), 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1.0f / 2.4f) - 0.055f;
}

void parian_cpu_tone(const float (*picture)[4], size_t count, float exposure, parian_tone tone,
                     bool plain, uint8_t (*srgb)[4])
{
    for (size_t i = 0; i < count; i++) {
        float rgb[3] = {picture[i][0], picture[i][1], picture[i][2]};
        if (!plain) {
            vec3_scale(rgb, exposure);
            for (int c = 0; c < 3; c++) {
                rgb[c] = fminf(rgb[c], 1e6f);
            }
            if (tone == PARIAN_TONE_NEUTRAL) {
                neutral_curve(rgb);
            } else if (tone == PARIAN_TONE_REINHARD) {
                vec3_scale(rgb, 1.0f / (1.0f + fmaxf(luminance(rgb), 0.0f)));
            }
        }
        for (int c = 0; c < 3; c++) {
            srgb[i][c] = (uint8_t)(encode(rgb[c]) * 255.0f + 0.5f);
        }
        srgb[i][3] = (uint8_t)(fminf(fmaxf(picture[i][3], 0.0f), 1.0f) * 255.0f + 0.5f);
    }
}
