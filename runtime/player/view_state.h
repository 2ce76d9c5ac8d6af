/* view_state.h - what the window's parts share: what must be drawn anew, what is chosen, what was
 * asked for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_STATE_H
#define PARIAN_VIEW_STATE_H

#include "view_app.h"
#include "view_relay.h"

enum { PARIAN_VIEW_HISTORY = 120, PARIAN_VIEW_NO_LIGHT = -1, PARIAN_VIEW_PANEL_WIDTH = 336 };

/* What input and panel ask of the window. */
typedef struct parian_view_requests {
    bool quit, frame_bodies, save_picture, save_window, list_keys;
    bool tint, edit_medium, undo_medium; /* of the chosen body, from the draft */
} parian_view_requests;

typedef struct parian_view_state {
    parian_view_app *app;
    bool picture_stale; /* the picture must be drawn anew */
    bool lights_stale;  /* and the lights given to the renderer before */
    bool show_panel, show_help, show_gizmos;
    parian_view_requests requests;
    int selected; /* light, or PARIAN_VIEW_NO_LIGHT */
    int dragged;  /* light that the mouse holds, or PARIAN_VIEW_NO_LIGHT */
    parian_view_display before_opaque;
    double mouse_x, mouse_y; /* window coordinates */
    int window_width, window_height;
    int area_x, area_width;          /* where the picture is: beside the panel */
    uint32_t body;                   /* whose medium is edited */
    parian_medium_edit draft;        /* as shown; computed on request */
    bool draft_stale, draft_changed; /* to be filled anew; not computed yet */
    char line[PARIAN_VIEW_LINE_MAX]; /* shown at the bottom; empty for none */
    /* Times of the last pictures, a ring: the whole, and of each pass. */
    bool time_passes;
    float frame_ms[PARIAN_VIEW_HISTORY], pass_ms[PARIAN_PASS_MAX][PARIAN_VIEW_HISTORY];
    parian_pass_time pass[PARIAN_PASS_MAX];
    size_t pass_count;
    int history_at; /* the next place in the ring */
    uint64_t pictures;
    uint64_t file_size; /* of the asset, bytes */
    const char *renderer_name;
} parian_view_state;

/* Lay out the window: the panel takes a column at the left where there is room for two. */
void parian_view_state_lay_out(parian_view_state *state);

#endif
