/* view_window.h - the window of the player, with its mouse and keys.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_WINDOW_H
#define PARIAN_VIEW_WINDOW_H

#include "view_app.h"

/* With an open app; returns when the window is closed, or after --frames frames. Then --image and
 * --dump are written. Errors: PARIAN_E_DEVICE (no display, no OpenGL), those of the renderer,
 * PARIAN_E_INTERRUPTED. */
parian_result parian_view_run_window(parian_view_app *app);

#endif
