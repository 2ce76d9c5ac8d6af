/* view_gizmo.c - where lights are shown in the window, and where one goes that is dragged.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_gizmo.h"

#include <math.h>

#include "view_vector.h"

static const double PI = 3.14159265358979323846;
static const double REACH = 14, EDGE = 20; /* of the mouse; of rings: window coordinates */

/* Coordinates of a point in the view: right, up, and towards the viewer. */
static void to_view(const parian_view_state *state, const double point[3], double out[3])
{
    double axis[3][3], away[3];
    const parian_view_camera *camera = &state->app->camera;
    parian_view_camera_axes(camera, axis[0], axis[1], axis[2]);
    vector_add_scaled(point, -1, camera->eye, away);
    for (int k = 0; k < 3; k++) {
        out[k] = vector_dot(axis[k], away);
    }
}

/* Window coordinates for a metre, at a depth of one metre. */
static double focal(const parian_view_state *state)
{
    return 0.5 * state->window_height / tan(0.5 * state->app->camera.fov_deg * PI / 180);
}

bool parian_view_project(const parian_view_state *state, const double point[3], float window[2])
{
    double view[3];
    to_view(state, point, view);
    const double depth = -view[2];
    if (!(depth > 1e-6 * state->app->extent.radius)) {
        return false;
    }
    window[0] = (float)(state->area_x + 0.5 * state->area_width + focal(state) * view[0] / depth);
    window[1] = (float)(0.5 * state->window_height - focal(state) * view[1] / depth);
    return true;
}

bool parian_view_ring(const parian_view_state *state, size_t light, float at[2], bool *inside)
{
    const parian_view_app *app = state->app;
    const double half[2] = {0.5 * state->area_width - EDGE, 0.5 * state->window_height - EDGE};
    double place[3], view[3];
    if (!parian_view_light_place(&app->lights.light[light], &app->extent, place)) {
        return false;
    }
    to_view(state, place, view);
    const double depth = -view[2], near = 1e-6 * app->extent.radius;
    const double scale = depth > near ? focal(state) / depth : 1e9;
    const double x = scale * view[0], y = -scale * view[1];
    const double over = fmax(fabs(x) / fmax(half[0], 1), fabs(y) / fmax(half[1], 1));
    *inside = depth > near && over <= 1;
    const double shrink = over > 1 ? 1 / over : 1;
    at[0] = (float)(state->area_x + 0.5 * state->area_width + shrink * x);
    at[1] = (float)(0.5 * state->window_height + shrink * y);
    return true;
}

int parian_view_pick_light(const parian_view_state *state, double x, double y)
{
    const parian_view_app *app = state->app;
    int best = PARIAN_VIEW_NO_LIGHT;
    double nearest = REACH;
    for (size_t i = 0; i < app->lights.count && state->show_gizmos; i++) {
        bool inside;
        float at[2];
        if (!parian_view_ring(state, i, at, &inside)) {
            continue;
        }
        const double distance = hypot((double)at[0] - x, (double)at[1] - y);
        if (distance <= nearest) {
            nearest = distance;
            best = (int)i;
        }
    }
    return best;
}

void parian_view_turn_light(parian_view_state *state, int light, double right_share,
                            double down_share)
{
    double right[3], up[3], back[3];
    parian_view_app *app = state->app;
    if (light < 0 || (size_t)light >= app->lights.count) {
        return;
    }
    parian_view_camera_axes(&app->camera, right, up, back);
    parian_light *turned = &app->lights.light[light];
    parian_view_light_turn(turned, app->extent.body_centre, up, right_share * PI);
    parian_view_light_turn(turned, app->extent.body_centre, right, down_share * PI);
    state->lights_stale = state->picture_stale = true;
}

void parian_view_drag_light(parian_view_state *state, int light, double dx, double dy)
{
    double right[3], up[3], back[3], place[3], view[3];
    parian_view_app *app = state->app;
    bool inside;
    float at[2];
    if (light < 0 || (size_t)light >= app->lights.count || state->window_height < 1 ||
        !parian_view_ring(state, (size_t)light, at, &inside)) {
        return;
    }
    parian_light *dragged = &app->lights.light[light];
    parian_view_light_place(dragged, &app->extent, place);
    if (dragged->type == PARIAN_LIGHT_DIRECTIONAL || !inside) {
        parian_view_turn_light(state, light, dx / state->window_height, dy / state->window_height);
        return;
    }
    to_view(state, place, view);
    parian_view_camera_axes(&app->camera, right, up, back);
    const double metres = fabs(view[2]) / focal(state);
    vector_add_scaled(place, dx * metres, right, place);
    vector_add_scaled(place, -dy * metres, up, place);
    parian_view_light_move(dragged, &app->extent, place);
    state->lights_stale = state->picture_stale = true;
}
