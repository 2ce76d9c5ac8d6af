/* view_panel_groups.c - the groups of the panel that are not about lights: asset, view, surface,
 * timings.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_panel_groups.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float MILLIMETRE = 1e3f; /* of a metre */

/* ---- asset -------------------------------------------------------------------------------------
 */
/* Mean free path of the channel in which it is longest, metres. */
static double mean_free_path(const parian_scene_body *body)
{
    double longest = 0;
    for (int c = 0; c < 3; c++) {
        const double extinction = body->sigma_s_prime[c] + body->sigma_a[c];
        longest = extinction > 0 ? fmax(longest, 1 / extinction) : longest;
    }
    return longest;
}

static void describe_body(parian_panel *panel, const parian_view_state *state, uint32_t index)
{
    const parian_scene_body body = parian_scene_get_body(state->app->scene, index);
    const double path = mean_free_path(&body), extent = 2 * state->app->extent.body_radius;
    parian_panel_text(panel, "%.40s: %.40s, eta %.2f", body.name[0] ? body.name : "body",
                      body.medium_name[0] ? body.medium_name : "own medium", body.eta);
    parian_panel_text(panel, "  %u texels of %u x %u, %u charts", body.texel_count, body.atlas_size,
                      body.atlas_size, body.chart_count);
    parian_panel_text(panel, "  %u vertices, %.2f million factors", body.vertex_count,
                      1e-6 * (double)body.factor_count);
    parian_panel_text(panel, "  mean free path %.3g mm: 1/%.0f", 1e3 * path,
                      path > 0 ? extent / path : 0);
    if (!body.has_local || !body.has_global) {
        parian_panel_text(panel, "  %s part alone", body.has_local ? "local" : "global");
    }
}

void parian_view_group_asset(parian_panel *panel, parian_view_state *state)
{
    const parian_view_app *app = state->app;
    if (!parian_panel_group(panel, "Asset", true)) {
        return;
    }
    const char *slash = strrchr(app->options->asset, '/');
    parian_panel_text(panel, "%.60s, %.2f MB", slash ? slash + 1 : app->options->asset,
                      1e-6 * (double)state->file_size);
    parian_panel_text(panel, "%.2f MB of GPU memory, method transfer",
                      1e-6 * (double)parian_renderer_memory(app->renderer));
    parian_panel_text(panel, "scene %.4g mm", (double)MILLIMETRE * 2 * app->extent.body_radius);
    for (uint32_t b = 0; b < app->info.body_count && b < 8; b++) {
        describe_body(panel, state, b);
    }
    if (app->info.surrounding_count) {
        parian_panel_text(panel, "%u mesh%s around", app->info.surrounding_count,
                          app->info.surrounding_count > 1 ? "es" : "");
    }
}

/* ---- view --------------------------------------------------------------------------------------
 */
static void choose_display(parian_panel *panel, parian_view_state *state)
{
    parian_view_app *app = state->app;
    int chosen = (int)app->display;
    if (!parian_panel_choice(panel, "shows", parian_view_display_names, PARIAN_DISPLAY_COUNT,
                             &chosen)) {
        return;
    }
    if (chosen == PARIAN_DISPLAY_ERROR && !app->options->reference) {
        strcpy(state->line, "the error view needs a --reference");
        return;
    }
    app->display = (parian_view_display)chosen;
    state->picture_stale = true;
}

static void choose_error_scale(parian_panel *panel, parian_view_state *state)
{
    parian_view_app *app = state->app;
    float scale = (float)app->error_scale;
    if (app->error >= 0) {
        parian_panel_text(panel, "relative error (L2) %.4f", app->error);
    }
    if (parian_panel_slider(panel, "full colour at", &scale, 0.001f, 10, "%.3f", true)) {
        app->error_scale = (double)scale;
        app->error_stale = state->picture_stale = true;
    }
}

void parian_view_group_view(parian_panel *panel, parian_view_state *state)
{
    parian_view_app *app = state->app;
    if (!parian_panel_group(panel, "View", true)) {
        return;
    }
    choose_display(panel, state);
    if (app->display == PARIAN_DISPLAY_ERROR) {
        choose_error_scale(panel, state);
    }
    state->picture_stale |=
        parian_panel_slider(panel, "exposure", &app->exposure_ev, -12, 12, "%+.2f EV", false);
    state->picture_stale |= parian_panel_check(panel, "automatic", &app->exposure_auto);
    parian_panel_same_line(panel);
    if (parian_panel_button(panel, "frame")) {
        state->requests.frame_bodies = true;
    }
    parian_panel_same_line(panel);
    if (parian_panel_button(panel, "save picture")) {
        state->requests.save_picture = true;
    }
    parian_panel_same_line(panel);
    if (parian_panel_button(panel, "keys")) {
        state->show_help = !state->show_help;
    }
}

/* ---- surface -----------------------------------------------------------------------------------
 */
/* A check for a setting that switches something off. */
static void choose_unless(parian_panel *panel, parian_view_state *state, const char *label,
                          bool *left_out)
{
    bool on = !*left_out;
    if (parian_panel_check(panel, label, &on)) {
        *left_out = !on;
        state->picture_stale = true;
    }
}

void parian_view_group_surface(parian_panel *panel, parian_view_state *state)
{
    parian_settings *settings = &state->app->settings;
    if (!parian_panel_group(panel, "Surface", false)) {
        return;
    }
    float roughness = settings->roughness > 0 ? settings->roughness : 0.35f;
    if (parian_panel_slider(panel, "roughness", &roughness, 0.05f, 1, "%.2f", false)) {
        settings->roughness = roughness;
        state->picture_stale = true;
    }
    choose_unless(panel, state, "reflection", &settings->no_specular);
    choose_unless(panel, state, "surface texture", &settings->no_albedo);
    choose_unless(panel, state, "normal map", &settings->no_normal_map);
}

/* ---- timings -----------------------------------------------------------------------------------
 */
static float highest(const float value[PARIAN_VIEW_HISTORY])
{
    float most = 0.1f;
    for (int i = 0; i < PARIAN_VIEW_HISTORY; i++) {
        most = fmaxf(most, value[i]);
    }
    return most;
}

static void graph(parian_panel *panel, const parian_view_state *state, const char *name,
                  const float value[PARIAN_VIEW_HISTORY], float height)
{
    char label[80];
    const int last = (state->history_at + PARIAN_VIEW_HISTORY - 1) % PARIAN_VIEW_HISTORY;
    snprintf(label, sizeof label, "%s %.2f ms", name, (double)value[last]);
    parian_panel_graph(panel, label, value, PARIAN_VIEW_HISTORY, state->history_at,
                       1.1f * highest(value), height);
}

void parian_view_group_timings(parian_panel *panel, parian_view_state *state)
{
    if (!parian_panel_group(panel, "Timings", true)) {
        return;
    }
    graph(panel, state, "picture", state->frame_ms, 44);
    if (parian_panel_check(panel, "each pass (waits for each: slower)", &state->time_passes)) {
        parian_renderer_set_timing(state->app->renderer, state->time_passes);
        memset(state->pass_ms, 0, sizeof state->pass_ms);
    }
    for (size_t p = 0; p < state->pass_count; p++) {
        parian_panel_push(panel, (int)p);
        if (state->time_passes) {
            graph(panel, state, state->pass[p].name, state->pass_ms[p], 22);
        }
        parian_panel_pop(panel);
    }
    parian_panel_text(panel, "%llu pictures, relit %llu times", (unsigned long long)state->pictures,
                      (unsigned long long)(state->pass_count ? state->pass[1].runs : 0));
    parian_panel_note(panel, state->renderer_name);
}
