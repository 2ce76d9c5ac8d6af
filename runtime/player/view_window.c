/* view_window.c - the window of the player: opening, loading, drawing, reloading.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_window.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "core/memory.h"
#include "tool/picture.h"
#include "tool/session.h"
#include "view_glfw.h"
#include "view_loader.h"
#include "view_surface.h"
#ifdef PARIAN_WITH_IMGUI
#include "view_panel.h"
#endif

enum { TITLE_MAX = 200, SETTLE_FRAMES = 3 };
enum { COARSEST = 4, QUICK_PIXELS = 200000, SETS_AT_REST = 64 };
static const double REFINE_MS = 300;              /* beyond this a window would not answer */
static const double SMOOTH_MS = 60, REST_S = 0.2; /* of a picture while things move */
static const double WAIT_S = 0.1, LOOK_S = 0.5, PROGRESS_WAIT_S = 0.03;

typedef struct view_window {
    parian_view_app *app;
    parian_view_relay relay;
    parian_view_state state;
    parian_view_glfw glfw;
    parian_view_surface *surface;
    parian_view_loader loader;
    parian_view_watch watch;
    bool watching;
    char asset[PARIAN_VIEW_PATH_MAX]; /* shown now */
    bool reopening;                   /* the same file again, or another one */
    unsigned line_count;              /* of the relay, as of the last line shown */
    double next_look;
    bool moving, coarse; /* within REST_S of a change; the picture is not in full */
    double last_change;  /* seconds */
    double shade_ms;     /* of a picture in full */
    double relight_ms;   /* of the last relight or refinement, with its picture */
    double start;        /* of the program's window, seconds */
    unsigned saved;
#ifdef PARIAN_WITH_IMGUI
    parian_panel *panel;
#endif
} view_window;

/* ---- over the picture --------------------------------------------------------------------------
 */
#ifdef PARIAN_WITH_IMGUI
static parian_result draw_over(view_window *view)
{
    return view->panel ? parian_view_panel_draw(view->panel, &view->state) : PARIAN_OK;
}

static parian_result draw_progress(view_window *view, const char *stage, double fraction)
{
    return view->panel ? parian_view_panel_draw_progress(view->panel, &view->state, stage, fraction)
                       : PARIAN_OK;
}

static parian_result make_panel(view_window *view)
{
    parian_result result =
        parian_panel_create(&view->relay.env, view->glfw.window, view->glfw.es, &view->panel);
    view->glfw.panel = view->panel;
    return result;
}

static void free_panel(view_window *view)
{
    parian_panel_destroy(view->panel);
}
#else
static parian_result draw_over(view_window *view)
{
    if (view->state.line[0]) {
        glfwSetWindowTitle(view->glfw.window, view->state.line);
    }
    return PARIAN_OK;
}

static parian_result draw_progress(view_window *view, const char *stage, double fraction)
{
    char title[TITLE_MAX];
    snprintf(title, sizeof title, "parian-view - %s %.0f %%", stage, 100 * fraction);
    glfwSetWindowTitle(view->glfw.window, title);
    return PARIAN_OK;
}

static parian_result make_panel(view_window *view)
{
    (void)view;
    return PARIAN_OK;
}

static void free_panel(view_window *view)
{
    (void)view;
}
#endif

/* Pixels of the picture: the column where it begins, and its width. */
static uint32_t picture_left(const view_window *view)
{
    const int window = view->state.window_width > 0 ? view->state.window_width : 1;
    return (uint32_t)((int64_t)view->state.area_x * view->glfw.width / window);
}

static uint32_t picture_width(const view_window *view)
{
    return (uint32_t)view->glfw.width - picture_left(view);
}

static double aspect(const view_window *view)
{
    return view->glfw.height > 0 ? (double)picture_width(view) / view->glfw.height : 1;
}

/* ---- drawing -----------------------------------------------------------------------------------
 */
static void show_title(view_window *view)
{
    char title[TITLE_MAX];
    const parian_view_app *app = view->app;
    const char *slash = strrchr(view->asset, '/');
    const int last = (view->state.history_at + PARIAN_VIEW_HISTORY - 1) % PARIAN_VIEW_HISTORY;
    snprintf(title, sizeof title,
             "%.80s - %s - %.1f ms - %u sets - %s EV %+.2f - light %d of %zu - H: help",
             slash ? slash + 1 : view->asset, parian_view_display_names[app->display],
             (double)view->state.frame_ms[last], parian_renderer_set_count(app->renderer),
             app->exposure_auto ? "auto" : "manual", (double)app->exposure_ev,
             view->state.selected + 1, app->lights.count);
    glfwSetWindowTitle(view->glfw.window, title);
}

static void note_times(view_window *view, double ms)
{
    parian_view_state *state = &view->state;
    const int at = state->history_at;
    state->frame_ms[at] = (float)ms;
    state->pass_count = parian_renderer_get_times(view->app->renderer, state->pass);
    for (size_t p = 0; p < state->pass_count; p++) {
        state->pass_ms[p][at] = (float)state->pass[p].ms;
    }
    state->history_at = (at + 1) % PARIAN_VIEW_HISTORY;
    state->pictures++;
}

/* Pixels of the window along a side of one of the picture's: 1, or more for the very first picture,
 * and while things move and a full picture would take longer than the eye allows. Asked for again
 * at rest. */
static uint32_t choose_coarseness(const view_window *view)
{
    const bool whole = view->app->options->frames ||
                       parian_view_display_is_atlas(view->app->display) ||
                       view->app->display == PARIAN_DISPLAY_ERROR;
    if (!whole && view->state.pictures == 0) {
        return (uint64_t)picture_width(view) * (uint64_t)view->glfw.height > QUICK_PIXELS ? 2 : 1;
    }
    const double side = whole || !view->moving ? 1 : ceil(sqrt(view->shade_ms / SMOOTH_MS));
    return (uint32_t)fmin(fmax(side, 1), COARSEST);
}

/* The picture alone, to stay in the surface. */
static parian_result draw_picture(view_window *view)
{
    parian_view_app *app = view->app;
    parian_view_state *state = &view->state;
    const uint32_t side = choose_coarseness(view);
    const uint32_t width = (picture_width(view) + side - 1) / side;
    const uint32_t height = ((uint32_t)view->glfw.height + side - 1) / side;
    const double start = parian_seconds();
    const bool relit = state->lights_stale;
    parian_result result = state->lights_stale ? parian_view_app_send_lights(app) : PARIAN_OK;
    state->lights_stale = state->picture_stale = false;
    parian_view_surface_resize(view->surface, width, height);
    if (result == PARIAN_OK) {
        result = parian_view_app_draw(app, width, height,
                                      parian_view_surface_framebuffer(view->surface));
    }
    if (result == PARIAN_OK && app->picture.width) {
        result = parian_view_surface_upload(view->surface, (const uint8_t(*)[4])app->picture.srgb);
    }
    if (result == PARIAN_OK) {
        const double ms = 1e3 * (parian_seconds() - start);
        view->coarse = side > 1;
        if (side == 1 && !relit && state->pictures > 0) {
            view->shade_ms = ms; /* the first picture also builds the shaders */
        }
        view->relight_ms = relit ? ms : view->relight_ms;
        note_times(view, ms);
        show_title(view);
    }
    return result;
}

/* The window as it is seen, panel included. */
static void save_window(view_window *view)
{
    char path[64];
    const uint32_t width = (uint32_t)view->glfw.width, height = (uint32_t)view->glfw.height;
    uint8_t(*srgb)[4];
    view->state.requests.save_window = false;
    if (!PARIAN_NEW(view->app->env, srgb, (size_t)width * height)) {
        return;
    }
    snprintf(path, sizeof path, "parian-view-%03u.png", ++view->saved);
    if (parian_view_surface_read_window(view->surface, width, height, srgb) == PARIAN_OK) {
        for (size_t i = 0; i < (size_t)width * height; i++) {
            srgb[i][3] = 255;
        }
        if (parian_png_write(view->app->env, path, width, height, (const uint8_t(*)[4])srgb) ==
            PARIAN_OK) {
            parian_log(view->app->env, PARIAN_LOG_INFO, "wrote %s", path);
        }
    }
    parian_free(view->app->env, srgb);
}

/* The picture, what is over it, and the swap; the window as it is seen is saved before the swap. */
static parian_result present(view_window *view)
{
    parian_view_surface_show(view->surface, picture_left(view), (uint32_t)view->glfw.width,
                             (uint32_t)view->glfw.height);
    parian_result result = draw_over(view);
    if (result == PARIAN_OK && view->state.requests.save_window && !view->coarse) {
        save_window(view);
    }
    glfwSwapBuffers(view->glfw.window);
    return result;
}

/* What the renderer refuses (a light with absurd numbers, a reference of another size) does not end
 * the program: the picture before stays. A failing device or no memory does. */
static bool is_fatal(parian_result result)
{
    return result == PARIAN_E_DEVICE || result == PARIAN_E_NOMEM;
}

static void show_new_line(view_window *view)
{
    char line[PARIAN_VIEW_LINE_MAX];
    const unsigned count = parian_view_relay_line(&view->relay, line);
    if (count != view->line_count) {
        memcpy(view->state.line, line, sizeof line);
        view->line_count = count;
        view->glfw.settle = SETTLE_FRAMES;
    }
}

static parian_result draw_frame(view_window *view)
{
    parian_result result = view->state.picture_stale ? draw_picture(view) : PARIAN_OK;
    show_new_line(view);
    if (is_fatal(result)) {
        return result;
    }
    return present(view);
}

/* ---- requests ----------------------------------------------------------------------------------
 */
static void list_keys(void)
{
    for (size_t i = 0; parian_view_help[i][0]; i++) {
        printf("%-22s %s\n", parian_view_help[i][0], parian_view_help[i][1]);
    }
    fflush(stdout);
}

static void save_picture(view_window *view)
{
    char path[64];
    snprintf(path, sizeof path, "parian-view-%03u.png", ++view->saved);
    if (parian_view_write_image(view->app, path, picture_width(view),
                                (uint32_t)view->glfw.height) == PARIAN_OK) {
        parian_log(view->app->env, PARIAN_LOG_INFO, "wrote %s", path);
        snprintf(view->state.line, sizeof view->state.line, "wrote %s", path);
    }
}

/* A new tint, a new medium, or the one of the bake. A medium takes seconds: that is said first.
 * What is refused is one line, and the medium stays. */
static parian_result edit_medium(view_window *view, const parian_view_requests *asked)
{
    parian_view_state *state = &view->state;
    parian_medium_edit edit = view->app->edit[state->body];
    if (asked->edit_medium) {
        edit = state->draft;
        edit.change_medium = true;
        snprintf(state->line, sizeof state->line, "computing the medium ...");
        parian_result result = present(view);
        if (result != PARIAN_OK) {
            return result;
        }
    } else if (asked->undo_medium) {
        edit = (parian_medium_edit){.change_medium = false};
    }
    memcpy(edit.tint, state->draft.tint, asked->undo_medium ? 0 : sizeof edit.tint);
    state->line[0] = '\0';
    parian_result result = parian_view_app_edit(view->app, state->body, &edit);
    state->draft_stale = result == PARIAN_OK;
    state->picture_stale = true;
    view->glfw.settle = SETTLE_FRAMES;
    return is_fatal(result) ? result : PARIAN_OK;
}

static parian_result answer_requests(view_window *view)
{
    parian_view_requests *requests = &view->state.requests;
    parian_result result = PARIAN_OK;
    if (requests->quit) {
        glfwSetWindowShouldClose(view->glfw.window, GLFW_TRUE);
    }
    if (requests->list_keys) {
        list_keys();
    }
    if (requests->tint || requests->edit_medium || requests->undo_medium) {
        result = edit_medium(view, requests);
    }
    if (result == PARIAN_OK && requests->frame_bodies && view->glfw.height > 0) {
        result = parian_view_app_frame(view->app, aspect(view));
        view->state.picture_stale = true;
    }
    const bool ready = view->state.pictures && !view->state.picture_stale && !view->coarse;
    if (requests->save_picture && ready) {
        save_picture(view);
    }
    *requests = (parian_view_requests){.save_window = requests->save_window,
                                       .save_picture = requests->save_picture && !ready};
    return result;
}

/* ---- files -------------------------------------------------------------------------------------
 */
static void note_size(view_window *view)
{
    struct stat found;
    view->state.file_size = stat(view->asset, &found) == 0 ? (uint64_t)found.st_size : 0;
}

static void open_dropped(view_window *view)
{
    const char *path = view->glfw.dropped;
    parian_result result = PARIAN_OK;
    view->state.line[0] = '\0';
    switch (parian_view_drop_kind(path)) {
    case PARIAN_DROP_ASSET:
        view->reopening = strcmp(path, view->asset) == 0;
        result = parian_view_loader_begin(&view->loader, &view->relay.env, path);
        break;
    case PARIAN_DROP_LIGHTS:
        result = parian_view_app_read_lights(view->app, path);
        view->state.lights_stale = view->state.picture_stale = result == PARIAN_OK;
        view->state.selected = view->app->lights.count ? 0 : PARIAN_VIEW_NO_LIGHT;
        break;
    case PARIAN_DROP_UNKNOWN:
        snprintf(view->state.line, sizeof view->state.line,
                 "%.300s ends in neither .parian nor .json", path);
        break;
    }
    view->glfw.dropped[0] = '\0';
    view->glfw.settle = SETTLE_FRAMES;
}

/* The file changed on disk and whoever wrote it is done: open it again, in the background. */
static void look_for_changes(view_window *view)
{
    const double now = parian_seconds();
    if (now < view->next_look || view->loader.busy) {
        return;
    }
    view->next_look = now + LOOK_S;
    if (view->watching && parian_view_watch_changed(&view->watch, view->asset)) {
        view->state.line[0] = '\0';
        view->reopening = true;
        parian_view_loader_begin(&view->loader, &view->relay.env, view->asset);
    }
}

/* An asset that was opened beside the one that is shown takes its place. What is wrong with it is
 * one line, and the old one stays. */
static parian_result take_loaded(view_window *view)
{
    parian_scene *scene;
    parian_result result;
    if (!parian_view_loader_take(&view->loader, &result, &scene)) {
        return PARIAN_OK;
    }
    view->glfw.settle = SETTLE_FRAMES;
    if (result == PARIAN_OK) {
        view->app->aspect = aspect(view);
        result = parian_view_app_adopt(view->app, scene, view->reopening);
    }
    if (result != PARIAN_OK) {
        return PARIAN_OK;
    }
    if (!view->reopening) {
        memcpy(view->asset, view->loader.path, sizeof view->asset);
        parian_view_watch_begin(&view->watch, view->asset);
        view->state.selected = view->app->lights.count ? 0 : PARIAN_VIEW_NO_LIGHT;
    }
    parian_log(view->app->env, PARIAN_LOG_INFO, "opened %s%s", view->asset,
               view->reopening ? " again" : "");
    snprintf(view->state.line, sizeof view->state.line, "%s %.300s",
             view->reopening ? "read again:" : "opened", view->asset);
    note_size(view);
    parian_renderer_set_timing(view->app->renderer, view->state.time_passes);
    view->state.renderer_name = parian_renderer_name(view->app->renderer);
    view->state.picture_stale = view->state.draft_stale = true;
    view->state.body = 0;
    return PARIAN_OK;
}

/* ---- the first asset ---------------------------------------------------------------------------
 */
static parian_result show_progress(view_window *view, const char *stage, double fraction)
{
    parian_view_surface_show(view->surface, picture_left(view), (uint32_t)view->glfw.width,
                             (uint32_t)view->glfw.height);
    parian_result result = draw_progress(view, stage, fraction);
    glfwSwapBuffers(view->glfw.window);
    return result;
}

static void on_upload(void *user, double fraction)
{
    glfwPollEvents();
    show_progress(user, "upload", fraction);
}

/* Keep the window alive until the asset is open. */
static parian_result wait_for_asset(view_window *view, parian_scene **scene)
{
    char stage[PARIAN_VIEW_STAGE_MAX];
    parian_result result = parian_view_loader_begin(&view->loader, &view->relay.env, view->asset);
    parian_result opened = PARIAN_OK;
    while (result == PARIAN_OK && !parian_view_loader_take(&view->loader, &opened, scene)) {
        const double fraction = parian_view_relay_progress(&view->relay, stage);
        if (parian_cancelled(view->app->env) || glfwWindowShouldClose(view->glfw.window)) {
            return PARIAN_E_INTERRUPTED;
        }
        result = show_progress(view, stage[0] ? stage : "reading", fraction);
        glfwWaitEventsTimeout(PROGRESS_WAIT_S);
    }
    return result == PARIAN_OK ? opened : result;
}

static parian_result open_first(view_window *view)
{
    parian_scene *scene = NULL;
    parian_view_watch_begin(&view->watch, view->asset);
    parian_result result = wait_for_asset(view, &scene);
    if (result == PARIAN_OK) {
        view->app->on_upload = on_upload;
        view->app->on_upload_user = view;
        show_progress(view, "upload", 0);
        parian_view_state_lay_out(&view->state);
        view->app->aspect = aspect(view);
        result = parian_view_app_adopt(view->app, scene, false);
        view->app->on_upload = NULL;
    }
    if (result == PARIAN_OK) {
        view->watching = true;
        note_size(view);
        view->state.renderer_name = parian_renderer_name(view->app->renderer);
        view->state.selected = view->app->lights.count ? 0 : PARIAN_VIEW_NO_LIGHT;
        parian_view_relay_set_soft(&view->relay, true);
    }
    return result;
}

/* A change begins or goes on; a while after the last one a coarse picture is drawn in full. */
static void refine_at_rest(view_window *view)
{
    parian_view_state *state = &view->state;
    const double now = parian_seconds();
    if (state->picture_stale) {
        view->moving = now - view->last_change < REST_S || view->shade_ms > SMOOTH_MS;
        view->last_change = now;
    } else if (view->coarse && now - view->last_change > REST_S) {
        view->moving = false;
        state->picture_stale = true;
    }
}

/* While nothing moves, E takes in another set of samples with each picture. */
static parian_result refine_light(view_window *view)
{
    const parian_view_app *app = view->app;
    const double start = parian_seconds();
    const bool due = !app->options->frames && view->state.pictures > 0 &&
                     !view->state.picture_stale && !view->coarse &&
                     start - view->last_change > REST_S && view->relight_ms < REFINE_MS &&
                     parian_renderer_set_count(app->renderer) < SETS_AT_REST;
    if (!due) {
        return PARIAN_OK;
    }
    parian_result result =
        parian_view_app_refine(view->app, parian_renderer_set_count(app->renderer) + 1);
    if (result == PARIAN_OK) {
        result = draw_picture(view);
    }
    view->relight_ms = result == PARIAN_OK ? 1e3 * (parian_seconds() - start) : 2 * REFINE_MS;
    view->glfw.settle = view->glfw.settle > 0 ? view->glfw.settle : 1;
    return is_fatal(result) ? result : PARIAN_OK;
}

/* ---- the loop ----------------------------------------------------------------------------------
 */
static parian_result step(view_window *view)
{
    const uint32_t frames_max = view->app->options->frames;
    parian_view_state *state = &view->state;
    parian_result result = PARIAN_OK;
    if (frames_max) {
        state->picture_stale = state->lights_stale = true;
    }
    if (view->glfw.dropped[0]) {
        open_dropped(view);
    }
    result = take_loaded(view);
    look_for_changes(view);
    parian_view_state_lay_out(state);
    refine_at_rest(view);
    const bool seen = view->glfw.width > 0 && view->glfw.height > 0;
    if (result == PARIAN_OK && seen) {
        result = refine_light(view);
    }
    if (result == PARIAN_OK && seen && (state->picture_stale || view->glfw.settle > 0)) {
        view->glfw.settle = view->glfw.settle > 0 ? view->glfw.settle - 1 : 0;
        result = draw_frame(view);
        if (state->pictures == 1 && view->start > 0) {
            parian_log(view->app->env, PARIAN_LOG_INFO, "first picture after %.2f s",
                       parian_seconds() - view->start);
            view->start = 0;
        }
        glfwPollEvents();
    } else {
        glfwWaitEventsTimeout(WAIT_S);
    }
    return result == PARIAN_OK ? answer_requests(view) : result;
}

/* Draws when something changed, else waits; with --frames, draws that many with a relight each. */
static parian_result loop(view_window *view)
{
    const uint32_t frames_max = view->app->options->frames;
    parian_result result = PARIAN_OK;
    view->state.picture_stale = true;
    while (result == PARIAN_OK && !glfwWindowShouldClose(view->glfw.window) &&
           !(frames_max && view->state.pictures >= frames_max)) {
        result = parian_cancelled(view->app->env) ? PARIAN_E_INTERRUPTED : step(view);
    }
    return result;
}

static parian_result write_outputs(view_window *view)
{
    parian_view_app *app = view->app;
    parian_result result = PARIAN_OK;
    parian_view_relay_set_soft(&view->relay, false);
    if (app->options->image && view->state.pictures > 0) {
        result = parian_view_write_image(app, app->options->image, picture_width(view),
                                         (uint32_t)view->glfw.height);
    }
    if (result == PARIAN_OK && app->options->dump) {
        result = parian_view_write_dump(app, app->options->dump);
    }
    for (size_t p = 0; p < view->state.pass_count; p++) {
        parian_log(app->env, PARIAN_LOG_DEBUG, "pass %s ran %llu times", view->state.pass[p].name,
                   (unsigned long long)view->state.pass[p].runs);
    }
    return result;
}

/* ---- making ------------------------------------------------------------------------------------
 */
static parian_result make(view_window *view)
{
    parian_result result = parian_view_glfw_open(&view->glfw, &view->state);
    if (result == PARIAN_OK) {
        result = parian_view_surface_create(&view->relay.env, parian_view_glfw_proc_address,
                                            &view->surface);
    }
    return result == PARIAN_OK ? make_panel(view) : result;
}

static void unmake(view_window *view)
{
    parian_view_loader_stop(&view->loader);
    parian_view_app_stop(view->app);
    free_panel(view);
    parian_view_surface_destroy(view->surface);
    parian_view_glfw_close(&view->glfw);
}

static parian_result run(view_window *view)
{
    parian_result result = parian_view_app_prepare(view->app);
    if (result == PARIAN_OK) {
        result = make(view);
    }
    if (result == PARIAN_OK) {
        result = open_first(view);
    }
    if (result == PARIAN_OK) {
        result = loop(view);
    }
    return result == PARIAN_OK ? write_outputs(view) : result;
}

parian_result parian_view_run_window(parian_view_app *app)
{
    const parian_env *session = app->env;
    view_window *view;
    if (strlen(app->options->asset) >= PARIAN_VIEW_PATH_MAX) {
        return parian_fail(session, PARIAN_E_ARGUMENT, "the asset's path is too long");
    }
    if (!PARIAN_NEW0(session, view, 1)) {
        return parian_fail(session, PARIAN_E_NOMEM, "no memory for a window");
    }
    view->app = app;
    view->start = parian_seconds();
    strcpy(view->asset, app->options->asset);
    parian_view_relay_init(&view->relay, session);
    app->env = &view->relay.env;
    app->get_proc_address = parian_view_glfw_proc_address;
    view->state = (parian_view_state){.app = app,
                                      .draft_stale = true,
                                      .show_panel = !app->options->frames,
                                      .show_gizmos = !app->options->frames,
                                      .selected = PARIAN_VIEW_NO_LIGHT,
                                      .dragged = PARIAN_VIEW_NO_LIGHT,
                                      .renderer_name = ""};
    parian_result result = run(view);
    unmake(view);
    parian_view_app_close(app);
    app->env = session;
    parian_view_relay_destroy(&view->relay);
    parian_free(session, view);
    return result;
}
