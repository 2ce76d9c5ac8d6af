/* gltf_medium.c - from scattering coefficients to the colours of glTF's volume extensions.
 *
 * The extensions give, for each channel,
 *     sigma_t = -ln(attenuationColor) / attenuationDistance,
 *     s       = 4.09712 + 4.20863 r - sqrt(9.59217 + 41.6808 r + 17.7126 r^2)   (r =
 * multiscatterColorFactor), albedo  = sigma_s / sigma_t = (1 - s^2) / (1 - g s^2). Wanted are the colours
 * for given sigma_s' and sigma_a. With sigma_s = sigma_s' / (1 - g) the last line gives s^2 = (1 -
 * albedo) / (1 - g albedo), and the second falls from s = 1 at r = 0 to s = 0 at r = 1, so that
 * bisection finds r. The distance is the mean free path averaged over the channels: it makes the
 * colours about 1/e, where a rounding costs least.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "glb_write.h"

static double similarity(double r)
{
    return 4.09712 + 4.20863 * r - sqrt(9.59217 + 41.6808 * r + 17.7126 * r * r);
}

static double multiscatter_of(double s)
{
    double low = 0, high = 1;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (similarity(middle) > s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

gltf_medium gltf_medium_from(const model_medium *medium)
{
    gltf_medium gltf = {.attenuation_distance_m = 0};
    double sigma_t[3];
    for (int c = 0; c < 3; c++) {
        double sigma_s = medium->sigma_s_prime_per_mm[c] / (1 - medium->g);
        sigma_t[c] = 1e3 * (sigma_s + medium->sigma_a_per_mm[c]);
        double albedo = 1e3 * sigma_s / sigma_t[c];
        gltf.multiscatter_color[c] = multiscatter_of(sqrt((1 - albedo) / (1 - medium->g * albedo)));
        gltf.attenuation_distance_m += 1 / (3 * sigma_t[c]);
    }
    for (int c = 0; c < 3; c++) {
        gltf.attenuation_color[c] = exp(-sigma_t[c] * gltf.attenuation_distance_m);
    }
    return gltf;
}
