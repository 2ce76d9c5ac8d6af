/* view_panel_lights.c - the panel's list of lights, and their rings in the scene.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "view_gizmo.h"
#include "view_panel_groups.h"
#include "view_vector.h"

static const char *const type_names[] = {"point", "directional", "spot", "rect", "environment"};
enum { TYPE_COUNT = sizeof type_names / sizeof type_names[0] };

/* What the numbers of a light's colour are called. */
static const char *strength_format(parian_light_type type)
{
    return type == PARIAN_LIGHT_POINT || type == PARIAN_LIGHT_SPOT ? "%.3g W/sr"
           : type == PARIAN_LIGHT_DIRECTIONAL                      ? "%.3g W/m^2"
                                                                   : "%.3g W/(m^2 sr)";
}

/* ---- list --------------------------------------------------------------------------------------
 */
/* Colour and strength apart: the largest channel is the strength. */
static bool edit_color(parian_panel *panel, parian_light *light)
{
    float strength = fmaxf(fmaxf(light->color[0], light->color[1]), light->color[2]);
    float hue[3] = {1, 1, 1};
    for (int c = 0; c < 3 && strength > 0; c++) {
        hue[c] = light->color[c] / strength;
    }
    bool changed = parian_panel_color(panel, "colour", hue);
    changed |= parian_panel_slider(panel, "strength", &strength, 1e-5f, 1e3f,
                                   strength_format(light->type), true);
    for (int c = 0; c < 3 && changed; c++) {
        light->color[c] = hue[c] * strength;
    }
    return changed;
}

static bool edit_direction(parian_panel *panel, parian_light *light)
{
    double direction[3] = {light->direction[0], light->direction[1], light->direction[2]};
    float shown[3];
    vector_normalize(direction);
    for (int c = 0; c < 3; c++) {
        shown[c] = (float)direction[c];
    }
    if (!parian_panel_drag3(panel, "direction", shown, 0.01f, "%.2f")) {
        return false;
    }
    if (shown[0] == 0 && shown[1] == 0 && shown[2] == 0) {
        return false;
    }
    memcpy(light->direction, shown, sizeof shown);
    return true;
}

static bool edit_position(parian_panel *panel, parian_light *light, double radius)
{
    float millimetres[3];
    for (int c = 0; c < 3; c++) {
        millimetres[c] = 1e3f * light->position[c];
    }
    if (!parian_panel_drag3(panel, "place, mm", millimetres, (float)(10 * radius), "%.1f")) {
        return false;
    }
    for (int c = 0; c < 3; c++) {
        light->position[c] = 1e-3f * millimetres[c];
    }
    return true;
}

static bool aim(parian_panel *panel, parian_light *light, const double at[3])
{
    if (!parian_panel_button(panel, "aim at the bodies")) {
        return false;
    }
    for (int c = 0; c < 3; c++) {
        light->direction[c] = (float)(at[c] - (double)light->position[c]);
    }
    return light->direction[0] != 0 || light->direction[1] != 0 || light->direction[2] != 0;
}

static bool edit_spot(parian_panel *panel, parian_light *light, const double at[3])
{
    bool changed = parian_panel_slider(panel, "outer", &light->outer_deg, 1, 85, "%.1f deg", false);
    changed |= parian_panel_slider(panel, "inner", &light->inner_deg, 0.5f, 85, "%.1f deg", false);
    light->inner_deg = fminf(light->inner_deg, light->outer_deg);
    return aim(panel, light, at) || changed;
}

static bool edit_light(parian_panel *panel, parian_light *light, const parian_view_extent *extent)
{
    const parian_light_type type = light->type;
    bool changed = edit_color(panel, light);
    if (type == PARIAN_LIGHT_POINT || type == PARIAN_LIGHT_SPOT || type == PARIAN_LIGHT_RECT) {
        changed |= edit_position(panel, light, extent->body_radius);
    }
    if (type == PARIAN_LIGHT_DIRECTIONAL || type == PARIAN_LIGHT_SPOT) {
        changed |= edit_direction(panel, light);
    }
    if (type == PARIAN_LIGHT_SPOT) {
        changed |= edit_spot(panel, light, extent->body_centre);
    }
    if (type == PARIAN_LIGHT_ENVIRONMENT) {
        changed |= parian_panel_slider(panel, "rotation", &light->rotation_deg, -180, 180,
                                       "%.0f deg", false);
    }
    return changed;
}

/* Another type keeps place, direction and strength at the bodies, as far as there is such a thing.
 */
static void change_type(parian_view_app *app, parian_light *light, parian_light_type type)
{
    parian_light made = parian_view_light_make(&app->extent, type);
    double place[3];
    if (parian_view_light_place(light, &app->extent, place) &&
        light->type != PARIAN_LIGHT_DIRECTIONAL && type != PARIAN_LIGHT_ENVIRONMENT) {
        parian_view_light_move(&made, &app->extent, place);
    }
    for (int c = 0; c < 3 && type == PARIAN_LIGHT_SPOT; c++) {
        made.direction[c] = (float)app->extent.body_centre[c] - made.position[c];
    }
    made.image = light->image; /* stays in the set, and is used where the type has one */
    *light = made;
}

static void list_light(parian_panel *panel, parian_view_state *state, size_t index)
{
    parian_view_app *app = state->app;
    parian_light *light = &app->lights.light[index];
    bool on = !app->light_off[index];
    char label[48];
    parian_panel_push(panel, (int)index);
    snprintf(label, sizeof label, "%zu: %s%s", index + 1, type_names[light->type],
             light->image.pixel ? " (picture)" : "");
    if (parian_panel_check(panel, "##on", &on)) {
        app->light_off[index] = !on;
        state->lights_stale = state->picture_stale = true;
    }
    parian_panel_same_line(panel);
    if (parian_panel_radio(panel, label, state->selected == (int)index)) {
        state->selected = (int)index;
    }
    parian_panel_pop(panel);
}

static void edit_selected(parian_panel *panel, parian_view_state *state)
{
    parian_view_app *app = state->app;
    if (state->selected < 0 || (size_t)state->selected >= app->lights.count) {
        return;
    }
    parian_light *light = &app->lights.light[state->selected];
    int type = (int)light->type;
    if (parian_panel_choice(panel, "type", type_names, TYPE_COUNT, &type)) {
        change_type(app, light, (parian_light_type)type);
        state->lights_stale = state->picture_stale = true;
    }
    if (edit_light(panel, light, &app->extent)) {
        state->lights_stale = state->picture_stale = true;
    }
}

void parian_view_group_lights(parian_panel *panel, parian_view_state *state)
{
    parian_view_app *app = state->app;
    if (!parian_panel_group(panel, "Lights", true)) {
        return;
    }
    for (size_t i = 0; i < app->lights.count; i++) {
        list_light(panel, state, i);
    }
    if (parian_panel_button(panel, "add") &&
        parian_view_add_light(state, PARIAN_LIGHT_POINT) != PARIAN_OK) {
        snprintf(state->line, sizeof state->line, "no more than %d lights", PARIAN_LIGHTS_MAX);
    }
    parian_panel_same_line(panel);
    if (parian_panel_button(panel, "remove") && state->selected >= 0) {
        parian_view_remove_light(state, (size_t)state->selected);
    }
    parian_panel_same_line(panel);
    parian_panel_check(panel, "rings", &state->show_gizmos);
    edit_selected(panel, state);
}

/* ---- rings -------------------------------------------------------------------------------------
 */
static uint32_t channel(float value, float most)
{
    return most > 0 ? (uint32_t)lrintf(110 + 145 * fminf(fmaxf(value / most, 0), 1)) : 160;
}

static uint32_t ring_color(const parian_light *light, bool off)
{
    const float *c = light->color, most = fmaxf(fmaxf(c[0], c[1]), c[2]);
    return (off ? 0x60000000u : 0xFF000000u) | channel(c[2], most) << 16 |
           channel(c[1], most) << 8 | channel(c[0], most);
}

static void draw_segment(parian_panel *panel, const parian_view_state *state, const double a[3],
                         const double b[3], uint32_t color)
{
    float from[2], to[2];
    if (parian_view_project(state, a, from) && parian_view_project(state, b, to)) {
        parian_panel_draw_line(panel, from, to, color, 1.5f);
    }
}

static void draw_rectangle(parian_panel *panel, const parian_view_state *state,
                           const parian_light *light, uint32_t color)
{
    static const int sign[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
    double corner[5][3];
    for (int k = 0; k < 5; k++) {
        for (int c = 0; c < 3; c++) {
            corner[k][c] = (double)light->position[c] + sign[k][0] * (double)light->axis_u[c] +
                           sign[k][1] * (double)light->axis_v[c];
        }
    }
    for (int k = 0; k < 4; k++) {
        draw_segment(panel, state, corner[k], corner[k + 1], color);
    }
}

static void draw_arrow(parian_panel *panel, const parian_view_state *state,
                       const parian_light *light, const double place[3], uint32_t color)
{
    double direction[3] = {light->direction[0], light->direction[1], light->direction[2]}, end[3];
    vector_normalize(direction);
    vector_add_scaled(place, 0.35 * state->app->extent.body_radius, direction, end);
    draw_segment(panel, state, place, end, color);
}

static void draw_gizmo(parian_panel *panel, const parian_view_state *state, size_t index)
{
    const parian_view_app *app = state->app;
    const parian_light *light = &app->lights.light[index];
    const uint32_t color = ring_color(light, app->light_off[index]);
    const bool chosen = state->selected == (int)index;
    double place[3];
    float at[2];
    char number[16];
    bool inside;
    if (!parian_view_ring(state, index, at, &inside)) {
        return;
    }
    parian_view_light_place(light, &app->extent, place);
    if (light->type == PARIAN_LIGHT_RECT) {
        draw_rectangle(panel, state, light, color);
    }
    if (light->type == PARIAN_LIGHT_SPOT || light->type == PARIAN_LIGHT_DIRECTIONAL) {
        draw_arrow(panel, state, light, place, color);
    }
    parian_panel_draw_circle(panel, at, 9, 0xA0000000u, 4);
    parian_panel_draw_circle(panel, at, 9, color, chosen ? 3.0f : 1.5f);
    if (inside) {
        parian_panel_draw_circle(panel, at, 3, color, 0);
    }
    snprintf(number, sizeof number, "%zu", index + 1);
    parian_panel_draw_text(panel, (const float[2]){at[0] - 4, at[1] + 11}, color, number);
}

void parian_view_draw_gizmos(parian_panel *panel, parian_view_state *state)
{
    for (size_t i = 0; i < state->app->lights.count; i++) {
        draw_gizmo(panel, state, i);
    }
}
