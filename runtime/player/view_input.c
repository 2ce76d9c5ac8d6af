/* view_input.c - what mouse and keys do; knows no window system.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_input.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "view_gizmo.h"

static const double TURN_PER_HEIGHT =
    3.14159265358979323846; /* radians for a drag over the window's height */
static const double ZOOM_PER_NOTCH = 0.88, EXPOSURE_STEP = 0.25, EXPOSURE_LIMIT = 60;

const char *const parian_view_help[][2] = {
    {"left mouse", "orbit; on the ring of a light: drag the light"},
    {"middle, Shift + left", "pan"},
    {"wheel", "zoom"},
    {"right mouse, L + left", "turn the chosen light about the bodies"},
    {"Tab", "choose the next light"},
    {"O", "chosen light on, off"},
    {"G", "rings of the lights on, off"},
    {"1 to 9", "combined, local, global, irradiance, opaque, normals, charts, radiosity, error"},
    {"0", "atlas: irradiance, radiosity, charts"},
    {"S", "opaque for comparison, and back"},
    {"R, T", "surface reflection, surface texture on, off"},
    {"+ -, E", "exposure by a quarter stop; by hand, automatic"},
    {"F", "frame the bodies"},
    {"P, Shift + P", "save the picture, the window"},
    {"F1", "panel on, off"},
    {"H", "this help"},
    {"Esc", "quit"},
    {NULL, NULL}};

void parian_view_state_lay_out(parian_view_state *state)
{
    const bool beside = state->show_panel && state->window_width >= 2 * PARIAN_VIEW_PANEL_WIDTH;
    const int x = beside ? PARIAN_VIEW_PANEL_WIDTH : 0;
    state->picture_stale |= x != state->area_x || state->window_width - x != state->area_width;
    state->area_x = x;
    state->area_width = state->window_width - x;
}

/* ---- mouse -------------------------------------------------------------------------------------
 */
void parian_view_press(parian_view_state *state, double x, double y)
{
    state->mouse_x = x;
    state->mouse_y = y;
    state->dragged = parian_view_pick_light(state, x, y);
    if (state->dragged != PARIAN_VIEW_NO_LIGHT) {
        state->selected = state->dragged;
    }
}

void parian_view_release(parian_view_state *state)
{
    state->dragged = PARIAN_VIEW_NO_LIGHT;
}

void parian_view_move(parian_view_state *state, double x, double y, const parian_view_held *held)
{
    const double height = state->window_height > 0 ? state->window_height : 1;
    const double dx = x - state->mouse_x, dy = y - state->mouse_y;
    parian_view_camera *camera = &state->app->camera;
    state->mouse_x = x;
    state->mouse_y = y;
    if (!state->app->renderer) {
        return;
    }
    if (held->right || (held->left && held->light_key)) {
        parian_view_turn_light(state, state->selected, dx / height, dy / height);
    } else if (held->middle || (held->left && held->shift)) {
        parian_view_camera_pan(camera, -dx / height, dy / height);
        state->picture_stale = true;
    } else if (held->left && state->dragged != PARIAN_VIEW_NO_LIGHT) {
        parian_view_drag_light(state, state->dragged, dx, dy);
    } else if (held->left) {
        parian_view_camera_orbit(camera, -dx / height * TURN_PER_HEIGHT,
                                 dy / height * TURN_PER_HEIGHT);
        state->picture_stale = true;
    }
}

void parian_view_scroll(parian_view_state *state, double notches)
{
    if (state->app->renderer) {
        parian_view_camera_zoom(&state->app->camera, pow(ZOOM_PER_NOTCH, notches));
        state->picture_stale = true;
    }
}

/* ---- keys --------------------------------------------------------------------------------------
 */
static void show(parian_view_state *state, parian_view_display display)
{
    parian_view_app *app = state->app;
    if (display == PARIAN_DISPLAY_ERROR && !app->options->reference) {
        strcpy(state->line, "the error view needs a --reference");
        return;
    }
    app->display = display;
}

static void toggle_opaque(parian_view_state *state)
{
    if (state->app->display == PARIAN_DISPLAY_OPAQUE) {
        show(state, state->before_opaque);
    } else {
        state->before_opaque = state->app->display;
        show(state, PARIAN_DISPLAY_OPAQUE);
    }
}

static void next_atlas(parian_view_state *state)
{
    const parian_view_display now = state->app->display;
    const bool last = now < PARIAN_DISPLAY_ATLAS_IRRADIANCE || now == PARIAN_DISPLAY_COUNT - 1;
    show(state, last ? PARIAN_DISPLAY_ATLAS_IRRADIANCE : (parian_view_display)(now + 1));
}

static void step_exposure(parian_view_app *app, double step)
{
    const double ev = (double)app->exposure_ev + step;
    app->exposure_ev = (float)fmax(fmin(ev, EXPOSURE_LIMIT), -EXPOSURE_LIMIT);
}

static void toggle_light(parian_view_state *state)
{
    if (state->selected >= 0 && (size_t)state->selected < state->app->lights.count) {
        state->app->light_off[state->selected] = !state->app->light_off[state->selected];
        state->lights_stale = true;
    }
}

static void select_next_light(parian_view_state *state)
{
    const int count = (int)state->app->lights.count;
    state->selected = count ? (state->selected + 1) % count : PARIAN_VIEW_NO_LIGHT;
}

/* Keys that change the picture; false for others. */
static bool change_picture(parian_view_state *state, int key)
{
    parian_view_app *app = state->app;
    switch (key) {
    case '0':
        next_atlas(state);
        return true;
    case 'S':
        toggle_opaque(state);
        return true;
    case 'R':
        app->settings.no_specular = !app->settings.no_specular;
        return true;
    case 'T':
        app->settings.no_albedo = !app->settings.no_albedo;
        return true;
    case 'E':
        app->exposure_auto = !app->exposure_auto;
        return true;
    case '+':
    case '-':
        step_exposure(app, key == '+' ? EXPOSURE_STEP : -EXPOSURE_STEP);
        return true;
    case 'O':
        toggle_light(state);
        return true;
    default:
        return false;
    }
}

void parian_view_key(parian_view_state *state, int key, bool shift)
{
    if (key != 0 && key != 'P') {
        state->line[0] = '\0';
    }
    if (key >= '1' && key <= '9') {
        show(state, (parian_view_display)(key - '1'));
        state->picture_stale = true;
        return;
    }
    if (change_picture(state, key)) {
        state->picture_stale = true;
        return;
    }
    switch (key) {
    case PARIAN_KEY_ESCAPE:
        state->requests.quit = true;
        break;
    case 'F':
        state->requests.frame_bodies = true;
        break;
    case PARIAN_KEY_TAB:
        select_next_light(state);
        break;
    case 'G':
        state->show_gizmos = !state->show_gizmos;
        break;
    case 'P':
        *(shift ? &state->requests.save_window : &state->requests.save_picture) = true;
        break;
    case 'H':
        state->show_help = !state->show_help;
        state->requests.list_keys = state->show_help;
        break;
    case PARIAN_KEY_F1:
        state->show_panel = !state->show_panel;
        break;
    default:
        break;
    }
}

/* ---- files and lights --------------------------------------------------------------------------
 */
parian_view_drop parian_view_drop_kind(const char *path)
{
    return parian_view_path_ends(path, ".parian") ? PARIAN_DROP_ASSET
           : parian_view_path_ends(path, ".json") ? PARIAN_DROP_LIGHTS
                                                  : PARIAN_DROP_UNKNOWN;
}

parian_result parian_view_add_light(parian_view_state *state, parian_light_type type)
{
    parian_view_app *app = state->app;
    const parian_light light = parian_view_light_make(&app->extent, type);
    parian_result result = parian_light_set_append(app->env, &app->lights, &light);
    if (result == PARIAN_OK) {
        app->lights_given = true;
        app->light_off[app->lights.count - 1] = false;
        state->selected = (int)app->lights.count - 1;
        state->lights_stale = state->picture_stale = true;
    }
    return result;
}

void parian_view_remove_light(parian_view_state *state, size_t index)
{
    parian_view_app *app = state->app;
    if (index >= app->lights.count) {
        return;
    }
    parian_view_light_remove(app->env, &app->lights, index);
    memmove(app->light_off + index, app->light_off + index + 1,
            (PARIAN_LIGHTS_MAX - index - 1) * sizeof *app->light_off);
    app->lights_given = true;
    state->selected =
        state->selected >= (int)app->lights.count ? (int)app->lights.count - 1 : state->selected;
    state->dragged = PARIAN_VIEW_NO_LIGHT;
    state->lights_stale = state->picture_stale = true;
}
