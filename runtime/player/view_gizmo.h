/* view_gizmo.h - where lights are shown in the window, which one is under the mouse, and where one
 * goes that is dragged.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_GIZMO_H
#define PARIAN_VIEW_GIZMO_H

#include "view_state.h"

/* A point of the world in window coordinates; false when it is behind the eye. */
bool parian_view_project(const parian_view_state *state, const double point[3], float window[2]);

/* Where the ring of a light is shown: at its place, or at the edge of the window towards it when
 * that is not in sight (inside is then false). False for a light that has no ring. */
bool parian_view_ring(const parian_view_state *state, size_t light, float at[2], bool *inside);

/* The light shown nearest to a place of the window and within reach of the mouse, or
 * PARIAN_VIEW_NO_LIGHT. */
int parian_view_pick_light(const parian_view_state *state, double x, double y);

/* Drag a light by a way across the window: one with a place moves in the plane through it that
 * faces the viewer; a directional one, or one at the edge, turns about the bodies. Window
 * coordinates. */
void parian_view_drag_light(parian_view_state *state, int light, double dx, double dy);

/* Turn a light about the bodies, by shares of the window's height. */
void parian_view_turn_light(parian_view_state *state, int light, double right, double down);

#endif
