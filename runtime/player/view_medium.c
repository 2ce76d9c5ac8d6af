/* view_medium.c - the medium, size and tint that the bodies are shown with.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_medium.h"

#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/media_file.h"

static parian_result find_medium(const parian_env *env, const char *name, parian_medium *medium)
{
    if (parian_view_path_ends(name, ".json")) {
        return parian_media_read_file(env, name, medium);
    }
    const parian_medium *preset = parian_media_find(name);
    if (!preset) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "no medium named '%s'; parian-bake --list-materials shows the presets, "
                           "a file ends in .json",
                           name);
    }
    *medium = *preset;
    return PARIAN_OK;
}

parian_result parian_view_medium_choose(const parian_env *env, const char *name,
                                        parian_view_medium *medium)
{
    parian_medium found = {.eta = 0};
    bool as_baked = !name || !name[0];
    parian_result result = as_baked ? PARIAN_OK : find_medium(env, name, &found);
    if (result != PARIAN_OK) {
        return result;
    }
    medium->edit.change_medium = !as_baked;
    medium->edit.eta = found.eta;
    memcpy(medium->edit.sigma_s_prime, found.sigma_s_prime, sizeof found.sigma_s_prime);
    memcpy(medium->edit.sigma_a, found.sigma_a, sizeof found.sigma_a);
    snprintf(medium->name, sizeof medium->name, "%s", found.name);
    return PARIAN_OK;
}

parian_result parian_view_medium_read(const parian_env *env, const parian_view_options *options,
                                      parian_view_medium *medium)
{
    *medium = (parian_view_medium){.edit = {.size_factor = options->size_factor}};
    for (int c = 0; c < 3; c++) {
        medium->edit.tint[c] = (float)options->tint[c];
    }
    return parian_view_medium_choose(env, options->medium, medium);
}

static bool is_worse(const parian_medium_report *a, const parian_medium_report *b)
{
    return (a->missing != 0) != (b->missing != 0) ? a->missing != 0 : a->error_hard > b->error_hard;
}

parian_result parian_view_medium_send(parian_renderer *renderer, uint32_t body_count,
                                      parian_view_medium *medium)
{
    parian_result result = PARIAN_OK;
    for (uint32_t b = 0; b < body_count && result == PARIAN_OK; b++) {
        parian_medium_report report;
        result = parian_renderer_set_medium(renderer, b, &medium->edit, &report);
        if (result == PARIAN_OK && (b == 0 || is_worse(&report, &medium->report))) {
            medium->report = report;
        }
    }
    return result;
}
