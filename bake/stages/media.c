/* media.c - turns glTF volume materials into media.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/media.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"

static const char channel_name[PARIAN_CHANNELS] = {'r', 'g', 'b'};
/* An attenuation colour is 8 bits at best: what it calls 0 or 1 is nearer than this. */
static const double color_margin = 1.0 / 512;

/* Extinction of a channel from its colour after the attenuation distance. */
static parian_result find_extinction(const parian_env *env, const parian_source_material *material,
                                     int c, double *sigma_t)
{
    double color = material->attenuation_color[c];
    if (!(color >= 0 && color <= 1)) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "material '%s': attenuationColor %c is %g, expected 0 to 1",
                           material->name, channel_name[c], color);
    }
    if (color < color_margin || color > 1 - color_margin) {
        double clamped = color < color_margin ? color_margin : 1 - color_margin;
        parian_log(env, PARIAN_LOG_WARNING,
                   "material '%s': attenuationColor %c of %g means %s extinction; taken as %g",
                   material->name, channel_name[c], color, color > 0.5 ? "no" : "infinite",
                   clamped);
        color = clamped;
    }
    *sigma_t = -log(color) / material->attenuation_distance;
    return PARIAN_OK;
}

/* Single-scattering albedo of the multiple-scattering albedo r. Source: [KullaConty17]; the older
 * draft leaves the anisotropy out. */
static double single_albedo(double r, double g, bool with_anisotropy)
{
    double s = 4.09712 + 4.20863 * r - sqrt(9.59217 + 41.6808 * r + 17.7126 * r * r);
    s = s < 0 ? 0 : s > 1 || r == 0 ? 1 : s; /* the fit misses 1 by 3e-6 at r = 0 */
    return (1 - s * s) / (with_anisotropy ? 1 - g * s * s : 1);
}

static parian_result check_volume(const parian_env *env, const parian_source_material *material)
{
    double distance = material->attenuation_distance, g = material->scatter_anisotropy;
    bool clear = true;
    if (!material->has_volume || !isfinite(distance) || !(distance > 0)) {
        return parian_fail(
            env, PARIAN_E_FORMAT,
            "material '%s' scatters but has attenuationDistance %g, expected a finite "
            "distance in KHR_materials_volume",
            material->name, distance);
    }
    if (!(g > -1 && g < 1)) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "material '%s': scatterAnisotropy %g, expected -1 to 1, both excluded",
                           material->name, g);
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        double r = material->multiscatter_color[c];
        clear = clear && material->attenuation_color[c] == 1;
        if (!(r >= 0 && r <= 1)) {
            return parian_fail(env, PARIAN_E_FORMAT,
                               "material '%s': multiscatterColor %c is %g, expected 0 to 1",
                               material->name, channel_name[c], r);
        }
    }
    if (clear) {
        return parian_fail(env, PARIAN_E_FORMAT,
                           "material '%s': attenuationColor is white, so that the medium is clear; "
                           "expected a colour below 1",
                           material->name);
    }
    return PARIAN_OK;
}

parian_result parian_media_from_material(const parian_env *env,
                                         const parian_source_material *material,
                                         parian_medium *medium)
{
    parian_medium made = {.eta = material->ior};
    double g = material->scatter_anisotropy;
    parian_result result = check_volume(env, material);
    snprintf(made.name, sizeof made.name, "%s", material->name);
    snprintf(made.source, sizeof made.source, "glTF KHR_materials_volume and %s",
             material->new_draft ? "KHR_materials_scatter" : "KHR_materials_volume_scatter");
    for (int c = 0; c < PARIAN_CHANNELS && result == PARIAN_OK; c++) {
        double sigma_t = 0;
        result = find_extinction(env, material, c, &sigma_t);
        double albedo = single_albedo(material->multiscatter_color[c], g, material->new_draft);
        made.sigma_s_prime[c] = (1 - g) * albedo * sigma_t;
        made.sigma_a[c] = (1 - albedo) * sigma_t;
        made.g[c] = g;
    }
    if (result == PARIAN_OK && parian_medium_check(env, &made) != PARIAN_OK) {
        result = PARIAN_E_FORMAT;
    }
    if (result == PARIAN_OK) {
        *medium = made;
    }
    return result;
}
