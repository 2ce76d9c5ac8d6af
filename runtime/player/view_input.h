/* view_input.h - what mouse and keys do; knows no window system.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_INPUT_H
#define PARIAN_VIEW_INPUT_H

#include "view_state.h"

/* What is held while the mouse moves. */
typedef struct parian_view_held {
    bool left, middle, right, shift, light_key;
} parian_view_held;

/* The left button goes down at a place, in window coordinates: takes hold of the light that is
 * shown there, if one is. It comes up: lets go. */
void parian_view_press(parian_view_state *state, double x, double y);
void parian_view_release(parian_view_state *state);
/* The mouse moves to a place. */
void parian_view_move(parian_view_state *state, double x, double y, const parian_view_held *held);
/* The wheel turns by notches, away from the user above 0. */
void parian_view_scroll(parian_view_state *state, double notches);

/* Keys by their character, 'A' to 'Z', '0' to '9', '+', '-'; others by name. */
enum { PARIAN_KEY_ESCAPE = 256, PARIAN_KEY_TAB, PARIAN_KEY_F1 };
void parian_view_key(parian_view_state *state, int key, bool shift);

/* Lists of what keys and mouse do, pairs of input and effect; ends with NULL, NULL. */
extern const char *const parian_view_help[][2];

/* Files dropped on the window: an asset, or a lights file. */
typedef enum parian_view_drop {
    PARIAN_DROP_ASSET,
    PARIAN_DROP_LIGHTS,
    PARIAN_DROP_UNKNOWN
} parian_view_drop;
parian_view_drop parian_view_drop_kind(const char *path);

/* Lights by hand; selects the new one, or the one before. Errors: PARIAN_E_LIMIT, PARIAN_E_NOMEM.
 */
parian_result parian_view_add_light(parian_view_state *state, parian_light_type type);
void parian_view_remove_light(parian_view_state *state, size_t index);

#endif
