/* view_window.c - the window of the player, with its mouse and keys.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/session.h"
#include "view_vector.h"

enum { TITLE_MAX = 200 };
static const double TURN_PER_HEIGHT =
    3.14159265358979323846; /* radians for a drag over the window's height */
static const double ZOOM_PER_NOTCH = 0.88, EXPOSURE_STEP = 0.25, WAIT_S = 0.1;
static const double SMOOTHING =
    0.1; /* share of the newest frame in the time that the title shows */

static const char help_text[] =
    "left mouse     orbit                    1..7  combined, local, global, irradiance,\n"
    "middle, Shift  pan                            opaque, normals, charts\n"
    "wheel          zoom                     S     opaque for comparison, and back\n"
    "right mouse    move the light           R     surface reflection on, off\n"
    "L + mouse      move the light           + -   exposure\n"
    "Tab            next light               E     exposure by hand, automatic\n"
    "F              frame the bodies         P     save a picture\n"
    "H              this help                Esc   quit\n";

typedef struct view_window {
    parian_view_app *app;
    GLFWwindow *window;
    bool dirty, lights_dirty, settings_dirty;
    parian_result result; /* of what a callback did */
    double mouse_x, mouse_y;
    size_t selected; /* light */
    parian_view_mode before_opaque;
    double frame_ms; /* smoothed */
    uint32_t frames, pictures;
    int width, height; /* of the framebuffer */
} view_window;

static void *proc_address(const char *name)
{
    return (void *)glfwGetProcAddress(name);
}

/* ---- mouse -------------------------------------------------------------------------------------
 */
static void move_light(view_window *view, double right_share, double down_share)
{
    double right[3], up[3], back[3];
    parian_view_app *app = view->app;
    if (view->selected >= app->lights.count) {
        return;
    }
    parian_view_camera_axes(&app->camera, right, up, back);
    parian_light *light = &app->lights.light[view->selected];
    parian_view_light_turn(light, app->extent.body_centre, up, right_share * TURN_PER_HEIGHT);
    parian_view_light_turn(light, app->extent.body_centre, right, down_share * TURN_PER_HEIGHT);
    view->lights_dirty = true;
}

static bool held(const view_window *view, int button)
{
    return glfwGetMouseButton(view->window, button) == GLFW_PRESS;
}

static bool key_held(const view_window *view, int key)
{
    return glfwGetKey(view->window, key) == GLFW_PRESS;
}

static void on_cursor(GLFWwindow *window, double x, double y)
{
    view_window *view = glfwGetWindowUserPointer(window);
    int width, height;
    glfwGetWindowSize(window, &width, &height);
    const double dx = (x - view->mouse_x) / (height > 0 ? height : 1),
                 dy = (y - view->mouse_y) / (height > 0 ? height : 1);
    const bool left = held(view, GLFW_MOUSE_BUTTON_LEFT),
               shift = key_held(view, GLFW_KEY_LEFT_SHIFT) || key_held(view, GLFW_KEY_RIGHT_SHIFT);
    view->mouse_x = x;
    view->mouse_y = y;
    if (held(view, GLFW_MOUSE_BUTTON_RIGHT) || (left && key_held(view, GLFW_KEY_L))) {
        move_light(view, dx, dy);
    } else if (held(view, GLFW_MOUSE_BUTTON_MIDDLE) || (left && shift)) {
        parian_view_camera_pan(&view->app->camera, -dx, dy);
    } else if (left) {
        parian_view_camera_orbit(&view->app->camera, -dx * TURN_PER_HEIGHT, dy * TURN_PER_HEIGHT);
    } else {
        return;
    }
    view->dirty = true;
}

static void on_scroll(GLFWwindow *window, double x, double y)
{
    view_window *view = glfwGetWindowUserPointer(window);
    (void)x;
    parian_view_camera_zoom(&view->app->camera, pow(ZOOM_PER_NOTCH, y));
    view->dirty = true;
}

static void on_resize(GLFWwindow *window, int width, int height)
{
    view_window *view = glfwGetWindowUserPointer(window);
    view->width = width;
    view->height = height;
    view->dirty = true;
}

static void on_refresh(GLFWwindow *window)
{
    view_window *view = glfwGetWindowUserPointer(window);
    view->dirty = true;
}

/* ---- keys --------------------------------------------------------------------------------------
 */
static void set_view(view_window *view, parian_view_mode mode)
{
    view->app->settings.view = mode;
    view->settings_dirty = true;
}

static void toggle_opaque(view_window *view)
{
    const parian_view_mode now = view->app->settings.view;
    if (now == PARIAN_VIEW_OPAQUE) {
        set_view(view, view->before_opaque);
    } else {
        view->before_opaque = now;
        set_view(view, PARIAN_VIEW_OPAQUE);
    }
}

static void frame_bodies(view_window *view)
{
    const double aspect = view->height > 0 ? (double)view->width / view->height : 1;
    view->result = parian_view_app_frame(view->app, aspect);
}

static void save_picture(view_window *view)
{
    char path[64];
    snprintf(path, sizeof path, "parian-view-%03u.png", ++view->pictures);
    if (view->width > 0 && view->height > 0 &&
        parian_view_write_image(view->app, path, (uint32_t)view->width, (uint32_t)view->height) ==
            PARIAN_OK) {
        parian_log(view->app->env, PARIAN_LOG_INFO, "wrote %s", path);
    }
}

static void select_next_light(view_window *view)
{
    const size_t count = view->app->lights.count;
    view->selected = count ? (view->selected + 1) % count : 0;
}

static void handle_key(view_window *view, int key)
{
    if (key >= GLFW_KEY_1 && key <= GLFW_KEY_7) {
        set_view(view, (parian_view_mode)(key - GLFW_KEY_1));
        return;
    }
    switch (key) {
    case GLFW_KEY_ESCAPE:
        glfwSetWindowShouldClose(view->window, GLFW_TRUE);
        break;
    case GLFW_KEY_F:
        frame_bodies(view);
        break;
    case GLFW_KEY_S:
        toggle_opaque(view);
        break;
    case GLFW_KEY_R:
        view->app->settings.no_specular = !view->app->settings.no_specular;
        view->settings_dirty = true;
        break;
    case GLFW_KEY_E:
        view->app->exposure_auto = !view->app->exposure_auto;
        break;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
        view->app->exposure_ev += (float)EXPOSURE_STEP;
        break;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
        view->app->exposure_ev -= (float)EXPOSURE_STEP;
        break;
    case GLFW_KEY_TAB:
        select_next_light(view);
        break;
    case GLFW_KEY_P:
        save_picture(view);
        break;
    case GLFW_KEY_H:
        fputs(help_text, stdout);
        fflush(stdout);
        break;
    default:
        break;
    }
}

static void on_key(GLFWwindow *window, int key, int scancode, int action, int mods)
{
    view_window *view = glfwGetWindowUserPointer(window);
    (void)scancode;
    (void)mods;
    if (action != GLFW_RELEASE) {
        handle_key(view, key);
        view->dirty = true;
    }
}

/* ---- frames ------------------------------------------------------------------------------------
 */
static void show_title(view_window *view)
{
    static const char *const names[] = {"combined", "local",   "global", "irradiance",
                                        "opaque",   "normals", "charts"};
    char title[TITLE_MAX];
    const parian_view_app *app = view->app;
    const char *slash = strrchr(app->options->asset, '/');
    snprintf(title, sizeof title,
             "%.80s - %s - %.1f ms, %.0f fps - %s EV %+.2f - light %zu of %zu - H: help",
             slash ? slash + 1 : app->options->asset, names[app->settings.view], view->frame_ms,
             view->frame_ms > 0 ? 1e3 / view->frame_ms : 0, app->exposure_auto ? "auto" : "manual",
             (double)app->exposure_ev, app->lights.count ? view->selected + 1 : 0,
             app->lights.count);
    glfwSetWindowTitle(view->window, title);
}

static parian_result draw_frame(view_window *view)
{
    parian_view_app *app = view->app;
    parian_result result = PARIAN_OK;
    const double start = parian_seconds();
    if (view->settings_dirty) {
        result = parian_renderer_set_settings(app->renderer, &app->settings);
    }
    if (result == PARIAN_OK && view->lights_dirty) {
        result = parian_renderer_set_lights(app->renderer, app->lights.light, app->lights.count);
    }
    if (result == PARIAN_OK) {
        result = parian_view_app_draw(app, (uint32_t)view->width, (uint32_t)view->height, 0);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    glfwSwapBuffers(view->window);
    const double ms = 1e3 * (parian_seconds() - start);
    view->frame_ms += (view->frames ? SMOOTHING : 1) * (ms - view->frame_ms);
    view->frames++;
    view->dirty = view->lights_dirty = view->settings_dirty = false;
    show_title(view);
    return PARIAN_OK;
}

/* Draws when something changed, else waits; with --frames, draws that many with a relight each. */
static parian_result loop(view_window *view)
{
    const uint32_t frames_max = view->app->options->frames;
    while (!glfwWindowShouldClose(view->window)) {
        if (parian_cancelled(view->app->env)) {
            return PARIAN_E_INTERRUPTED;
        }
        if (frames_max) {
            view->dirty = view->lights_dirty = true;
        }
        if (view->dirty && view->width > 0 && view->height > 0) {
            parian_result result = draw_frame(view);
            if (result != PARIAN_OK) {
                return result;
            }
            glfwPollEvents();
        } else {
            glfwWaitEventsTimeout(WAIT_S);
        }
        if (view->result != PARIAN_OK) {
            return view->result;
        }
        if (frames_max && view->frames >= frames_max) {
            break;
        }
    }
    return PARIAN_OK;
}

static parian_result write_outputs(const view_window *view)
{
    parian_view_app *app = view->app;
    parian_result result = PARIAN_OK;
    if (app->options->image && view->frames > 0) {
        result = parian_view_write_image(app, app->options->image, (uint32_t)view->width,
                                         (uint32_t)view->height);
    }
    if (result == PARIAN_OK && app->options->dump) {
        result = parian_view_write_dump(app, app->options->dump);
    }
    return result;
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

static parian_result open_window(view_window *view)
{
    const parian_view_options *o = view->app->options;
    if (o->gl != PARIAN_VIEW_GL_ES) {
        view->window = create_window(o, true);
    }
    if (!view->window && o->gl != PARIAN_VIEW_GL_CORE) {
        view->window = create_window(o, false);
    }
    if (!view->window) {
        return parian_fail(view->app->env, PARIAN_E_DEVICE,
                           "the display gives no OpenGL 3.3 core or OpenGL ES 3.0 window; "
                           "--headless and --cpu need none");
    }
    glfwSetWindowUserPointer(view->window, view);
    glfwSetCursorPosCallback(view->window, on_cursor);
    glfwSetScrollCallback(view->window, on_scroll);
    glfwSetKeyCallback(view->window, on_key);
    glfwSetFramebufferSizeCallback(view->window, on_resize);
    glfwSetWindowRefreshCallback(view->window, on_refresh);
    glfwMakeContextCurrent(view->window);
    glfwSwapInterval(o->frames ? 0 : 1);
    glfwGetFramebufferSize(view->window, &view->width, &view->height);
    glfwGetCursorPos(view->window, &view->mouse_x, &view->mouse_y);
    return PARIAN_OK;
}

parian_result parian_view_run_window(parian_view_app *app)
{
    view_window view = {.app = app, .dirty = true};
    if (!glfwInit()) {
        return parian_fail(app->env, PARIAN_E_DEVICE,
                           "no display to open a window on; --headless renders without one");
    }
    parian_result result = open_window(&view);
    if (result == PARIAN_OK) {
        result = parian_view_app_start(app, proc_address);
    }
    if (result == PARIAN_OK) {
        result = loop(&view);
    }
    if (result == PARIAN_OK) {
        result = write_outputs(&view);
    }
    parian_view_app_stop(app);
    if (view.window) {
        glfwDestroyWindow(view.window);
    }
    glfwTerminate();
    return result;
}
