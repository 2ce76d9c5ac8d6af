/* view_panel_groups.h - the groups of the panel, and the rings of the lights.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_PANEL_GROUPS_H
#define PARIAN_VIEW_PANEL_GROUPS_H

#include "adapters/panel_imgui.h"
#include "view_input.h"
#include "view_state.h"

/* view_panel_groups.c */
void parian_view_group_asset(parian_panel *panel, parian_view_state *state);
void parian_view_group_view(parian_panel *panel, parian_view_state *state);
void parian_view_group_surface(parian_panel *panel, parian_view_state *state);
void parian_view_group_timings(parian_panel *panel, parian_view_state *state);

/* view_panel_media.c */
void parian_view_group_media(parian_panel *panel, parian_view_state *state);

/* view_panel_lights.c */
void parian_view_group_lights(parian_panel *panel, parian_view_state *state);
void parian_view_draw_gizmos(parian_panel *panel, parian_view_state *state);

#endif
