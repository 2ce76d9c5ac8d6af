/* view_glfw.c - the window itself, through GLFW: context, events to input, dropped files.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_glfw.h"

#include <stdio.h>
#include <string.h>

#include "core/memory.h"

enum { SETTLE_FRAMES = 3 };

void *parian_view_glfw_proc_address(const char *name)
{
    return (void *)glfwGetProcAddress(name);
}

static parian_view_glfw *woken(GLFWwindow *window)
{
    parian_view_glfw *glfw = glfwGetWindowUserPointer(window);
    glfw->settle = SETTLE_FRAMES;
    return glfw;
}

static bool panel_has_mouse(const parian_view_glfw *glfw)
{
#ifdef PARIAN_WITH_IMGUI
    return glfw->panel && parian_panel_has_mouse(glfw->panel);
#else
    (void)glfw;
    return false;
#endif
}

static bool panel_has_keys(const parian_view_glfw *glfw)
{
#ifdef PARIAN_WITH_IMGUI
    return glfw->panel && parian_panel_has_keys(glfw->panel);
#else
    (void)glfw;
    return false;
#endif
}

/* ---- events ------------------------------------------------------------------------------------
 */
static bool button(GLFWwindow *window, int which)
{
    return glfwGetMouseButton(window, which) == GLFW_PRESS;
}

static bool key(GLFWwindow *window, int which)
{
    return glfwGetKey(window, which) == GLFW_PRESS;
}

static void on_cursor(GLFWwindow *window, double x, double y)
{
    parian_view_glfw *glfw = woken(window);
    parian_view_held held = {.left = button(window, GLFW_MOUSE_BUTTON_LEFT),
                             .middle = button(window, GLFW_MOUSE_BUTTON_MIDDLE),
                             .right = button(window, GLFW_MOUSE_BUTTON_RIGHT),
                             .shift = key(window, GLFW_KEY_LEFT_SHIFT) ||
                                      key(window, GLFW_KEY_RIGHT_SHIFT),
                             .light_key = key(window, GLFW_KEY_L)};
    if (panel_has_mouse(glfw)) {
        held = (parian_view_held){.left = false};
    }
    parian_view_move(glfw->state, x, y, &held);
}

static void on_button(GLFWwindow *window, int which, int action, int mods)
{
    parian_view_glfw *glfw = woken(window);
    double x, y;
    (void)mods;
    glfwGetCursorPos(window, &x, &y);
    if (which == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_RELEASE) {
        parian_view_release(glfw->state);
    } else if (which == GLFW_MOUSE_BUTTON_LEFT && !panel_has_mouse(glfw)) {
        parian_view_press(glfw->state, x, y);
    }
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    parian_view_glfw *glfw = woken(window);
    (void)x;
    if (!panel_has_mouse(glfw)) {
        parian_view_scroll(glfw->state, y);
    }
}

static int translate(int code)
{
    if ((code >= GLFW_KEY_A && code <= GLFW_KEY_Z) || (code >= GLFW_KEY_0 && code <= GLFW_KEY_9)) {
        return code; /* GLFW counts these as characters too */
    }
    switch (code) {
    case GLFW_KEY_ESCAPE:
        return PARIAN_KEY_ESCAPE;
    case GLFW_KEY_TAB:
        return PARIAN_KEY_TAB;
    case GLFW_KEY_F1:
        return PARIAN_KEY_F1;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
        return '+';
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
        return '-';
    default:
        return 0;
    }
}

static void on_key(GLFWwindow *window, int code, int scancode, int action, int mods)
{
    parian_view_glfw *glfw = woken(window);
    (void)scancode;
    if (action == GLFW_PRESS || (action == GLFW_REPEAT && strchr("+-", translate(code)))) {
        if (!panel_has_keys(glfw)) {
            parian_view_key(glfw->state, translate(code), (mods & GLFW_MOD_SHIFT) != 0);
        }
    }
}

static void on_framebuffer(GLFWwindow *window, int width, int height)
{
    parian_view_glfw *glfw = woken(window);
    glfw->width = width;
    glfw->height = height;
    glfw->state->picture_stale = true;
}

static void on_size(GLFWwindow *window, int width, int height)
{
    parian_view_glfw *glfw = woken(window);
    glfw->state->window_width = width;
    glfw->state->window_height = height;
}

static void on_refresh(GLFWwindow *window)
{
    woken(window);
}

static void on_drop(GLFWwindow *window, int count, const char *paths[])
{
    parian_view_glfw *glfw = woken(window);
    if (count > 0 && strlen(paths[count - 1]) < sizeof glfw->dropped) {
        strcpy(glfw->dropped, paths[count - 1]);
    }
}

/* ---- making ------------------------------------------------------------------------------------
 */
static GLFWwindow *create_window(const parian_view_options *o, bool core)
{
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CLIENT_API, core ? GLFW_OPENGL_API : GLFW_OPENGL_ES_API);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, core ? 3 : 0);
    if (core) {
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
    }
    return glfwCreateWindow((int)o->width, (int)o->height, "parian-view", NULL, NULL);
}

static void listen(parian_view_glfw *glfw)
{
    GLFWwindow *window = glfw->window;
    glfwSetWindowUserPointer(window, glfw);
    glfwSetCursorPosCallback(window, on_cursor);
    glfwSetMouseButtonCallback(window, on_button);
    glfwSetScrollCallback(window, on_scroll);
    glfwSetKeyCallback(window, on_key);
    glfwSetFramebufferSizeCallback(window, on_framebuffer);
    glfwSetWindowSizeCallback(window, on_size);
    glfwSetWindowRefreshCallback(window, on_refresh);
    glfwSetDropCallback(window, on_drop);
}

parian_result parian_view_glfw_open(parian_view_glfw *glfw, parian_view_state *state)
{
    const parian_view_app *app = state->app;
    const parian_view_options *o = app->options;
    glfw->state = state;
    if (!glfwInit()) {
        return parian_fail(app->env, PARIAN_E_DEVICE,
                           "no display to open a window on; --headless renders without one");
    }
    if (o->gl != PARIAN_VIEW_GL_ES) {
        glfw->window = create_window(o, true);
    }
    if (!glfw->window && o->gl != PARIAN_VIEW_GL_CORE) {
        glfw->window = create_window(o, false);
        glfw->es = glfw->window != NULL;
    }
    if (!glfw->window) {
        return parian_fail(app->env, PARIAN_E_DEVICE,
                           "the display gives no OpenGL 3.3 core or OpenGL ES 3.0 window; "
                           "--headless and --cpu need none");
    }
    listen(glfw);
    glfwMakeContextCurrent(glfw->window);
    glfwSwapInterval(o->frames ? 0 : 1);
    glfwGetFramebufferSize(glfw->window, &glfw->width, &glfw->height);
    glfwGetWindowSize(glfw->window, &state->window_width, &state->window_height);
    glfwGetCursorPos(glfw->window, &state->mouse_x, &state->mouse_y);
    return PARIAN_OK;
}

void parian_view_glfw_close(parian_view_glfw *glfw)
{
    if (glfw->window) {
        glfwDestroyWindow(glfw->window);
    }
    glfwTerminate();
}
