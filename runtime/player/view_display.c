/* view_display.c - what the player can show, and the text of --view.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_display.h"

#include <string.h>

const char *const parian_view_display_names[PARIAN_DISPLAY_COUNT] = {
    "combined", "local",     "global", "irradiance",       "opaque",          "normals",
    "charts",   "radiosity", "error",  "atlas-irradiance", "atlas-radiosity", "atlas-charts"};

parian_view_mode parian_view_display_mode(parian_view_display display)
{
    static const parian_view_mode modes[PARIAN_DISPLAY_COUNT] = {
        PARIAN_VIEW_COMBINED, PARIAN_VIEW_LOCAL,      PARIAN_VIEW_GLOBAL,    PARIAN_VIEW_IRRADIANCE,
        PARIAN_VIEW_OPAQUE,   PARIAN_VIEW_NORMALS,    PARIAN_VIEW_CHARTS,    PARIAN_VIEW_RADIOSITY,
        PARIAN_VIEW_VALUES,   PARIAN_VIEW_IRRADIANCE, PARIAN_VIEW_RADIOSITY, PARIAN_VIEW_CHARTS};
    return modes[display];
}

bool parian_view_display_is_atlas(parian_view_display display)
{
    return display >= PARIAN_DISPLAY_ATLAS_IRRADIANCE;
}

static int find(const char *name, size_t length)
{
    for (int i = 0; i < PARIAN_DISPLAY_COUNT; i++) {
        if (strlen(parian_view_display_names[i]) == length &&
            strncmp(parian_view_display_names[i], name, length) == 0) {
            return i;
        }
    }
    return -1;
}

size_t parian_view_display_parse(const char *text, parian_view_display out[PARIAN_DISPLAY_COUNT],
                                 const char **unknown)
{
    size_t count = 0;
    for (const char *at = text;; at++) {
        const size_t length = strcspn(at, ",");
        const int found = find(at, length);
        if (found < 0 || count == PARIAN_DISPLAY_COUNT) {
            *unknown = at;
            return 0;
        }
        out[count++] = (parian_view_display)found;
        at += length;
        if (*at == '\0') {
            return count;
        }
    }
}
