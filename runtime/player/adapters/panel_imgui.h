/* panel_imgui.h - widgets of the player's panel, and lines drawn over the picture, by Dear ImGui.
 *
 * Plain data and functions; what the panel shows is decided by its caller. One panel for a window,
 * used in the thread of its GL context. A frame is begin, widgets, end; end draws to the
 * framebuffer that is bound, and puts GL state back. Nothing is remembered on disk. After a failure
 * widgets do nothing and return false, and end tells.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_PANEL_IMGUI_H
#define PARIAN_PANEL_IMGUI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif

struct GLFWwindow;
typedef struct parian_panel parian_panel;

/* The window's context is current, OpenGL 3.3 core or (es) OpenGL ES 3.0. Callbacks that the window
 * has are called by those of the panel, so set them before. Errors: PARIAN_E_NOMEM,
 * PARIAN_E_DEVICE. */
parian_result parian_panel_create(const parian_env *env, struct GLFWwindow *window, bool es,
                                  parian_panel **panel);
/* While the context is current; NULL is fine. */
void parian_panel_destroy(parian_panel *panel);

/* Whether mouse or keys belong to a widget, as of the last frame. */
bool parian_panel_has_mouse(const parian_panel *panel);
bool parian_panel_has_keys(const parian_panel *panel);

void parian_panel_begin(parian_panel *panel);
/* Errors: PARIAN_E_DEVICE, with the library's words. */
parian_result parian_panel_end(parian_panel *panel);

/* ---- boxes: each that is begun is ended, whatever begin returned ---- */

/* A box at a place in window coordinates; size 0 fits the contents. Without a title it is bare: no
 * frame to grab, and the mouse passes through. Returns false when folded up. */
typedef struct parian_panel_box {
    const char *title;
    float x, y, width, height;
    bool bare, centred; /* centred: x and y are those of the centre */
    float alpha;        /* of the background; 0 takes 0.85 */
} parian_panel_box;
bool parian_panel_begin_box(parian_panel *panel, const parian_panel_box *box);
void parian_panel_end_box(parian_panel *panel);
/* A heading that folds; true when what follows is to be shown. */
bool parian_panel_group(parian_panel *panel, const char *label, bool open_at_first);
/* Widgets between the two belong to item `id`, so that their labels may repeat. */
void parian_panel_push(parian_panel *panel, int id);
void parian_panel_pop(parian_panel *panel);

/* ---- widgets: true when changed or pressed ---- */
void parian_panel_text(parian_panel *panel, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 2, 3)))
#endif
    ;
/* The same, wrapped and dim. */
void parian_panel_note(parian_panel *panel, const char *text);
/* Wrapped after `width`, window coordinates. */
void parian_panel_wrapped(parian_panel *panel, const char *text, float width);
void parian_panel_same_line(parian_panel *panel);
bool parian_panel_button(parian_panel *panel, const char *label);
bool parian_panel_check(parian_panel *panel, const char *label, bool *value);
bool parian_panel_radio(parian_panel *panel, const char *label, bool chosen);
/* Over [low, high]; logarithmic needs low > 0. */
bool parian_panel_slider(parian_panel *panel, const char *label, float *value, float low,
                         float high, const char *format, bool logarithmic);
/* Numbers that change by dragging, `step` for a pixel. */
bool parian_panel_drag3(parian_panel *panel, const char *label, float value[3], float step,
                        const char *format);
/* A colour with components of 0 to 1. */
bool parian_panel_color(parian_panel *panel, const char *label, float rgb[3]);
/* names: [count] */
bool parian_panel_choice(parian_panel *panel, const char *label, const char *const *names,
                         int count, int *chosen);
/* A curve of the last values, from 0 to `high`; first is the oldest in the ring. */
void parian_panel_graph(parian_panel *panel, const char *label, const float *value, int count,
                        int first, float high, float height);
void parian_panel_progress(parian_panel *panel, float fraction, const char *text);

/* ---- over the picture, below the boxes: window coordinates, colour 0xAABBGGRR ---- */
void parian_panel_draw_line(parian_panel *panel, const float from[2], const float to[2],
                            uint32_t color, float width);
void parian_panel_draw_circle(parian_panel *panel, const float centre[2], float radius,
                              uint32_t color, float width); /* width 0 fills */
void parian_panel_draw_text(parian_panel *panel, const float at[2], uint32_t color,
                            const char *text);

#ifdef __cplusplus
}
#endif
#endif
