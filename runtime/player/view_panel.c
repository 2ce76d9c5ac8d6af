/* view_panel.c - what the panel of the window shows and changes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_panel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "view_panel_groups.h"

enum { EDGE = 6 };

static float panel_height(const parian_view_state *state)
{
    return fmaxf((float)state->window_height - 2 * EDGE, 80);
}

/* The middle of the picture, across. */
static float centre(const parian_view_state *state)
{
    return (float)state->area_x + 0.5f * (float)state->area_width;
}

static void draw_groups(parian_panel *panel, parian_view_state *state)
{
    const parian_panel_box box = {.title = "Parian  (F1 hides)",
                                  .x = EDGE,
                                  .y = EDGE,
                                  .width = PARIAN_VIEW_PANEL_WIDTH - 2 * EDGE,
                                  .height = panel_height(state),
                                  .alpha = 0.97f};
    if (parian_panel_begin_box(panel, &box)) {
        parian_view_group_asset(panel, state);
        parian_view_group_view(panel, state);
        parian_view_group_lights(panel, state);
        parian_view_group_media(panel, state);
        parian_view_group_surface(panel, state);
        parian_view_group_timings(panel, state);
    }
    parian_panel_end_box(panel);
}

static void draw_help(parian_panel *panel, const parian_view_state *state)
{
    const parian_panel_box box = {.title = "keys",
                                  .x = centre(state),
                                  .y = 0.5f * (float)state->window_height,
                                  .bare = true,
                                  .centred = true,
                                  .alpha = 0.92f};
    if (parian_panel_begin_box(panel, &box)) {
        for (size_t i = 0; parian_view_help[i][0]; i++) {
            parian_panel_text(panel, "%-22s %s", parian_view_help[i][0], parian_view_help[i][1]);
        }
    }
    parian_panel_end_box(panel);
}

static void draw_line(parian_panel *panel, const parian_view_state *state)
{
    const parian_panel_box box = {.title = "line",
                                  .x = centre(state),
                                  .y = (float)state->window_height - 24,
                                  .bare = true,
                                  .centred = true};
    if (parian_panel_begin_box(panel, &box)) {
        parian_panel_wrapped(panel, state->line, (float)state->area_width - 40);
    }
    parian_panel_end_box(panel);
}

parian_result parian_view_panel_draw(parian_panel *panel, parian_view_state *state)
{
    parian_panel_begin(panel);
    if (state->show_gizmos && !parian_view_display_is_atlas(state->app->display)) {
        parian_view_draw_gizmos(panel, state);
    }
    if (state->show_panel) {
        draw_groups(panel, state);
    }
    if (state->show_help) {
        draw_help(panel, state);
    }
    if (state->line[0]) {
        draw_line(panel, state);
    }
    return parian_panel_end(panel);
}

parian_result parian_view_panel_draw_progress(parian_panel *panel, const parian_view_state *state,
                                              const char *stage, double fraction)
{
    const parian_panel_box box = {.title = "progress",
                                  .x = 0.5f * (float)state->window_width,
                                  .y = 0.5f * (float)state->window_height,
                                  .bare = true,
                                  .centred = true};
    parian_panel_begin(panel);
    if (parian_panel_begin_box(panel, &box)) {
        const char *slash = strrchr(state->app->options->asset, '/');
        parian_panel_text(panel, "opening %s", slash ? slash + 1 : state->app->options->asset);
        parian_panel_progress(panel, (float)fraction, stage);
    }
    parian_panel_end_box(panel);
    return parian_panel_end(panel);
}
