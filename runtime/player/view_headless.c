/* view_headless.c - renders frames without a window and writes what was asked for.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_headless.h"

#include "core/memory.h"
#include "headless_egl.h"
#include "tool/session.h"
#include "view_loader.h"
#include "view_sequence.h"
#include "view_timings.h"

enum { FRAMES_DEFAULT = 1, FRAMES_TIMED_DEFAULT = 11 };
static const uint32_t NO_FRAMEBUFFER = (uint32_t)-1;
static const double TURN = 2 * 3.14159265358979323846;

/* ---- one picture, many times -------------------------------------------------------------------
 */
/* One frame: a full relight, and a draw; times are added where wanted. */
static parian_result render_frame(parian_view_app *app, parian_view_timings *timings)
{
    const double start = parian_seconds();
    parian_result result = parian_view_app_relight(app);
    if (result == PARIAN_OK) {
        result = parian_view_app_refine(app, app->options->refine);
    }
    const double relit = parian_seconds();
    if (result == PARIAN_OK) {
        result =
            parian_view_app_draw(app, app->options->width, app->options->height, NO_FRAMEBUFFER);
    }
    if (result == PARIAN_OK && timings) {
        parian_view_timings_add(timings, app->renderer, 1e3 * (relit - start),
                                1e3 * (parian_seconds() - relit));
    }
    return result;
}

/* The first frame builds what later ones keep, so it is not timed when there are others. */
static parian_result render_frames(parian_view_app *app, parian_view_timings *timings,
                                   uint32_t frames)
{
    parian_result result = PARIAN_OK;
    for (uint32_t i = 0; i < frames && result == PARIAN_OK; i++) {
        const bool warming = i == 0 && frames > 1;
        result = parian_cancelled(app->env) ? PARIAN_E_INTERRUPTED
                                            : render_frame(app, warming ? NULL : timings);
        parian_progress(app->env, "render", (i + 1.0) / frames);
    }
    return result;
}

/* ---- many pictures -----------------------------------------------------------------------------
 */
static parian_result render_view(parian_view_app *app, uint32_t number, parian_view_display display)
{
    const parian_view_options *o = app->options;
    char name[PARIAN_VIEW_PATH_MAX];
    app->display = display;
    if (parian_cancelled(app->env)) {
        return PARIAN_E_INTERRUPTED;
    }
    if (!parian_view_sequence_name(o->image, number, parian_view_display_names[display], name,
                                   sizeof name)) {
        return parian_fail(app->env, PARIAN_E_ARGUMENT, "--image: '%s' makes too long a name",
                           o->image);
    }
    parian_result result = parian_view_app_draw(app, o->width, o->height, NO_FRAMEBUFFER);
    return result == PARIAN_OK ? parian_view_write_image(app, name, o->width, o->height) : result;
}

/* path NULL: a turn. Frames of a path run from its first to its last keyframe; those of a turn end
 * one step before where they began. */
static parian_result render_sequence(parian_view_app *app, const parian_view_path *path,
                                     uint32_t frames)
{
    const parian_view_options *o = app->options;
    const double views = (double)o->display_count;
    parian_result result = PARIAN_OK;
    for (uint32_t i = 0; i < frames && result == PARIAN_OK; i++) {
        if (path) {
            app->camera = parian_view_path_at(path, frames > 1 ? i / (frames - 1.0) : 0);
        }
        for (size_t v = 0; v < o->display_count && result == PARIAN_OK; v++) {
            result = render_view(app, i, o->displays[v]);
            parian_progress(app->env, "render", (i + (double)(v + 1) / views) / frames);
        }
        if (!path) {
            parian_view_camera_orbit(&app->camera, TURN / frames, 0);
        }
    }
    if (result == PARIAN_OK) {
        parian_log(app->env, PARIAN_LOG_INFO, "%u x %u pixels, %zu pictures, on %s", o->width,
                   o->height, frames * o->display_count, parian_renderer_name(app->renderer));
    }
    return result;
}

static parian_result run_sequence(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    parian_view_path path;
    parian_result result = parian_view_app_refine(app, o->refine);
    if (result != PARIAN_OK || !o->camera_path) {
        return result != PARIAN_OK ? result
                                   : render_sequence(app, NULL, o->turntable ? o->turntable : 1);
    }
    result = parian_view_path_read(app->env, o->camera_path, &app->camera, &path);
    if (result == PARIAN_OK) {
        result = render_sequence(app, &path, o->frames ? o->frames : path.frames);
        parian_view_path_free(app->env, &path);
    }
    return result;
}

/* ---- outputs -----------------------------------------------------------------------------------
 */
static parian_result write_outputs(parian_view_app *app, const parian_view_timings *timings,
                                   const char *api)
{
    const parian_view_options *o = app->options;
    parian_result result = PARIAN_OK;
    if (o->image && !parian_view_sequence_is_wanted(o)) {
        result = parian_view_write_image(app, o->image, o->width, o->height);
    }
    if (result == PARIAN_OK && o->dump) {
        result = parian_view_write_dump(app, o->dump);
    }
    if (result == PARIAN_OK && o->timings) {
        result = parian_view_timings_write(timings, app, api, o->timings);
    }
    if (result == PARIAN_OK && app->error >= 0) {
        parian_log(app->env, PARIAN_LOG_INFO, "relative error (L2) against %s: %.4f", o->reference,
                   app->error);
    }
    if (result == PARIAN_OK && !parian_view_sequence_is_wanted(o)) {
        parian_log(app->env, PARIAN_LOG_INFO,
                   "%u x %u pixels, relit in %.2f ms and drawn in %.2f ms on %s", o->width,
                   o->height, parian_view_timings_relight_ms(timings),
                   parian_view_timings_draw_ms(timings), parian_renderer_name(app->renderer));
    }
    return result;
}

static parian_result run(parian_view_app *app, const char *api)
{
    const parian_view_options *o = app->options;
    const uint32_t frames = o->frames    ? o->frames
                            : o->timings ? FRAMES_TIMED_DEFAULT
                                         : FRAMES_DEFAULT;
    parian_view_timings *timings = parian_view_timings_create(app->env, frames);
    if (!timings) {
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for the times of %u frames",
                           frames);
    }
    parian_renderer_set_timing(app->renderer, true);
    parian_result result = PARIAN_OK;
    if (parian_view_sequence_is_wanted(o)) {
        result = run_sequence(app);
    }
    if (result == PARIAN_OK && !(o->turntable || o->camera_path)) {
        app->display = o->displays[0];
        result = render_frames(app, timings, frames);
    }
    if (result == PARIAN_OK) {
        result = write_outputs(app, timings, api);
    }
    parian_view_timings_destroy(app->env, timings);
    return result;
}

parian_result parian_view_run_headless(parian_view_app *app)
{
    parian_headless *headless = NULL;
    parian_scene *scene = NULL;
    parian_result result = parian_view_app_prepare(app);
    if (result == PARIAN_OK) {
        result = parian_scene_open(app->env, app->options->asset, &scene);
    }
    if (result == PARIAN_OK && !app->options->cpu) {
        result = parian_headless_create(app->env, (parian_view_gl)app->options->gl, &headless);
    }
    if (result == PARIAN_OK) {
        app->get_proc_address = headless ? parian_headless_proc_address : NULL;
        result = parian_view_app_adopt(app, scene, false);
    } else {
        parian_scene_close(scene);
    }
    if (result == PARIAN_OK) {
        result = run(app, headless ? parian_headless_api(headless) : "c");
    }
    parian_view_app_stop(app);
    parian_headless_destroy(app->env, headless);
    return result;
}
