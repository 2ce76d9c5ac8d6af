/* view_glfw.h - the window itself, through GLFW: context, events to input, dropped files.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_GLFW_H
#define PARIAN_VIEW_GLFW_H

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "adapters/panel_imgui.h"
#include "view_input.h"
#include "view_loader.h"

typedef struct parian_view_glfw {
    GLFWwindow *window;
    parian_view_state *state;
    parian_panel *panel; /* has mouse and keys first; NULL for none */
    bool es;             /* an OpenGL ES context */
    int width, height;   /* of the framebuffer */
    int settle;          /* frames that the panel is to be drawn again for, after an event */
    char dropped[PARIAN_VIEW_PATH_MAX]; /* the last file dropped; empty for none */
} parian_view_glfw;

/* Open the window that the options ask for, and make its context current. Errors: PARIAN_E_DEVICE
 * (no display, no OpenGL). Close in every case. */
parian_result parian_view_glfw_open(parian_view_glfw *glfw, parian_view_state *state);
void parian_view_glfw_close(parian_view_glfw *glfw);

void *parian_view_glfw_proc_address(const char *name);

#endif
