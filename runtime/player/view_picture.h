/* view_picture.h - pictures that the player makes itself: atlases laid flat, and errors against a
 * reference.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_PICTURE_H
#define PARIAN_VIEW_PICTURE_H

#include "view_app.h"

/* app->picture becomes the atlas display. Errors: PARIAN_E_NOMEM, those of reading texels. */
parian_result parian_view_picture_atlas(parian_view_app *app, uint32_t width, uint32_t height);
/* Give the renderer the colours of the error at each texel, where they are stale; app->error.
 * Errors: PARIAN_E_ARGUMENT (no reference), PARIAN_E_NOMEM, PARIAN_E_DEVICE. */
parian_result parian_view_picture_paint_error(parian_view_app *app);
/* app->picture becomes the error of the picture that was just drawn against the reference picture.
 * Errors: PARIAN_E_ARGUMENT (another size), PARIAN_E_NOMEM. */
parian_result parian_view_picture_compare(parian_view_app *app, uint32_t width, uint32_t height);
void parian_view_picture_free(parian_view_app *app);

#endif
