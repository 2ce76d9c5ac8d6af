/* view_display.h - what the player can show: views of the renderer, atlases, errors; the text of
 * --view.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_DISPLAY_H
#define PARIAN_VIEW_DISPLAY_H

#include <stddef.h>

#include "parian/runtime.h"

typedef enum parian_view_display {
    PARIAN_DISPLAY_COMBINED,
    PARIAN_DISPLAY_LOCAL,
    PARIAN_DISPLAY_GLOBAL,
    PARIAN_DISPLAY_IRRADIANCE,
    PARIAN_DISPLAY_OPAQUE,
    PARIAN_DISPLAY_NORMALS,
    PARIAN_DISPLAY_CHARTS,
    PARIAN_DISPLAY_RADIOSITY,
    PARIAN_DISPLAY_ERROR,            /* against the reference */
    PARIAN_DISPLAY_ATLAS_IRRADIANCE, /* the atlases laid flat */
    PARIAN_DISPLAY_ATLAS_RADIOSITY,
    PARIAN_DISPLAY_ATLAS_CHARTS,
    PARIAN_DISPLAY_COUNT
} parian_view_display;

/* Names as in --view. */
extern const char *const parian_view_display_names[PARIAN_DISPLAY_COUNT];

/* The view of the renderer that a display draws with. */
parian_view_mode parian_view_display_mode(parian_view_display display);
bool parian_view_display_is_atlas(parian_view_display display);

/* Displays of "combined,opaque": how many, or 0 with the place of the unknown name. */
size_t parian_view_display_parse(const char *text, parian_view_display out[PARIAN_DISPLAY_COUNT],
                                 const char **unknown);

#endif
