/* view_panel_media.c - the panel's group of media: tint, presets, coefficients, size, and what an
 * edit costs.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "tool/media_file.h"
#include "view_panel_groups.h"

enum { PRESETS_MAX = 128 };
static const double PER_MILLIMETRE = 1e3; /* m^-1 */

/* The numbers of the body as baked, or of the edit that was computed last. */
static void begin_draft(parian_view_state *state)
{
    const parian_view_app *app = state->app;
    const parian_scene_body body = parian_scene_get_body(app->scene, state->body);
    parian_medium_edit *draft = &state->draft;
    *draft = app->edit[state->body];
    for (int c = 0; c < 3; c++) {
        draft->tint[c] = draft->tint[c] > 0 ? draft->tint[c] : 1;
        if (!app->edit[state->body].change_medium) {
            draft->sigma_s_prime[c] = body.sigma_s_prime[c];
            draft->sigma_a[c] = body.sigma_a[c];
        }
    }
    draft->eta = draft->eta > 0 ? draft->eta : body.eta;
    draft->size_factor = draft->size_factor > 0 ? draft->size_factor : 1;
    state->draft_stale = false;
    state->draft_changed = false;
}

static void choose_body(parian_panel *panel, parian_view_state *state)
{
    const uint32_t count = state->app->info.body_count;
    if (count < 2) {
        return;
    }
    const parian_scene_body body = parian_scene_get_body(state->app->scene, state->body);
    if (parian_panel_button(panel, "next body")) {
        state->body = (state->body + 1) % (count < PARIAN_VIEW_EDITS ? count : PARIAN_VIEW_EDITS);
        state->draft_stale = true;
    }
    parian_panel_same_line(panel);
    parian_panel_text(panel, "%u: %.30s", state->body + 1, body.name);
}

static void choose_tint(parian_panel *panel, parian_view_state *state)
{
    if (parian_panel_color(panel, "tint (apart from transport)", state->draft.tint)) {
        state->requests.tint = true;
    }
}

static void choose_preset(parian_panel *panel, parian_view_state *state)
{
    static const char *const none = "preset ...";
    const char *names[PRESETS_MAX] = {none};
    const uint32_t presets = parian_media_preset_count();
    const int count = presets < PRESETS_MAX - 1 ? (int)presets + 1 : PRESETS_MAX;
    int chosen = 0;
    for (int i = 1; i < count; i++) {
        names[i] = parian_media_preset((uint32_t)(i - 1))->name;
    }
    if (!parian_panel_choice(panel, "##preset", names, count, &chosen) || chosen == 0) {
        return;
    }
    const parian_medium *medium = parian_media_preset((uint32_t)(chosen - 1));
    memcpy(state->draft.sigma_s_prime, medium->sigma_s_prime, sizeof state->draft.sigma_s_prime);
    memcpy(state->draft.sigma_a, medium->sigma_a, sizeof state->draft.sigma_a);
    state->draft.eta = medium->eta;
    state->requests.edit_medium = true;
}

/* Three coefficients in mm^-1. */
static void drag_coefficients(parian_panel *panel, parian_view_state *state, const char *label,
                              double value[3], float pace)
{
    float shown[3];
    for (int c = 0; c < 3; c++) {
        shown[c] = (float)(value[c] / PER_MILLIMETRE);
    }
    if (parian_panel_drag3(panel, label, shown, pace, "%.4g")) {
        for (int c = 0; c < 3; c++) {
            value[c] = PER_MILLIMETRE * fmax((double)shown[c], 0);
        }
        state->draft_changed = true;
    }
}

static void choose_numbers(parian_panel *panel, parian_view_state *state)
{
    parian_medium_edit *draft = &state->draft;
    float eta = (float)draft->eta, size = (float)draft->size_factor;
    drag_coefficients(panel, state, "sigma_s', 1/mm", draft->sigma_s_prime, 0.01f);
    drag_coefficients(panel, state, "sigma_a, 1/mm", draft->sigma_a, 0.0005f);
    if (parian_panel_slider(panel, "eta", &eta, 1, 2.5f, "%.3f", false)) {
        draft->eta = (double)eta;
        state->draft_changed = true;
    }
    if (parian_panel_slider(panel, "size", &size, 0.1f, 10, "x %.2f", true)) {
        draft->size_factor = (double)size;
        state->draft_changed = true;
    }
}

void parian_view_group_media(parian_panel *panel, parian_view_state *state)
{
    if (!parian_panel_group(panel, "Medium", false)) {
        return;
    }
    if (state->draft_stale) {
        begin_draft(state);
    }
    choose_body(panel, state);
    choose_tint(panel, state);
    choose_preset(panel, state);
    choose_numbers(panel, state);
    if (parian_panel_button(panel, state->draft_changed ? "compute *" : "compute")) {
        state->requests.edit_medium = true;
    }
    parian_panel_same_line(panel);
    if (parian_panel_button(panel, "as baked")) {
        state->requests.undo_medium = true;
    }
    if (state->app->report.text[0]) {
        parian_panel_note(panel, state->app->report.text);
    }
}
