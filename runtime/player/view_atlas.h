/* view_atlas.h - the atlases of all bodies laid flat, as a picture.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_ATLAS_H
#define PARIAN_VIEW_ATLAS_H

#include "parian/runtime.h"
#include "view_display.h"

/* Where the square of a body lies in a picture: bodies in rows, as large as fits. Pixels. */
typedef struct parian_view_cell {
    double x, y, side;
} parian_view_cell;
parian_view_cell parian_view_atlas_cell(uint32_t body_count, uint32_t body, uint32_t width,
                                        uint32_t height);

/* Linear values of an atlas display, [height * width] with coverage in alpha, rows from top to
 * bottom: E / pi, B / pi, or a colour for each chart. Relights if needed. Errors: PARIAN_E_NOMEM,
 * those of reading texels. */
parian_result parian_view_atlas_draw(const parian_env *env, const parian_scene *scene,
                                     parian_renderer *renderer, parian_view_display display,
                                     uint32_t width, uint32_t height, float (*radiance)[4]);

#endif
