/* view_panel.h - what the panel of the window shows and changes; the rings of the lights, help,
 * progress, and the last line.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_PANEL_H
#define PARIAN_VIEW_PANEL_H

#include "adapters/panel_imgui.h"
#include "view_state.h"

/* One frame of everything over the picture, between begin and end of the panel. Errors: those of
 * parian_panel_end; a change that is refused is a line of the state. */
parian_result parian_view_panel_draw(parian_panel *panel, parian_view_state *state);

/* The same while an asset opens, before there is a picture. */
parian_result parian_view_panel_draw_progress(parian_panel *panel, const parian_view_state *state,
                                              const char *stage, double fraction);

#endif
