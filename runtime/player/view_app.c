/* view_app.c - what the window and the headless run share: asset, lights, camera, renderer.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_app.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "view_picture.h"

/* Radiance of the default background for each W/m^2 of light; a white surface has 0.32. */
static const double BACKGROUND_SHARE = 0.005, BACKGROUND_MAX = 1e6;
enum { UPLOAD_SLICE = 16 << 20 }; /* bytes */
static const double WHITE = 2.2, EXPOSURE_MAX = 60;

/* ---- first choices -----------------------------------------------------------------------------
 */
/* Unless told: as much as makes a white surface in full light come out as WHITE before the tone
 * curve. It depends on the lights alone, so pictures of the same lights compare and nothing pumps
 * while the camera moves. */
static void choose_exposure(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    const double brightness = parian_view_lights_brightness(&app->lights, app->extent.body_centre);
    app->exposure_auto = o->exposure_auto;
    app->exposure_ev = (float)o->exposure_ev;
    if (!o->exposure_text && brightness > 0) {
        const double ev = log2(WHITE * 3.14159265358979323846 / brightness);
        app->exposure_ev = (float)fmax(fmin(ev, EXPOSURE_MAX), -EXPOSURE_MAX);
    }
}

static void choose_background(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    const bool linear = (o->image && parian_view_path_ends(o->image, ".exr")) ||
                        (app->reference.pixel && !app->reference.encoded);
    const double grey = linear ? 0
                               : BACKGROUND_SHARE * parian_view_lights_brightness(
                                                        &app->lights, app->extent.body_centre);
    for (int c = 0; c < 3; c++) {
        const double value = o->background[c] >= 0 ? o->background[c] : grey;
        app->settings.background[c] = (float)fmin(value, BACKGROUND_MAX);
    }
}

static parian_result choose_lights(parian_view_app *app)
{
    if (app->lights_given) {
        return PARIAN_OK;
    }
    parian_light_set_free(app->env, &app->lights);
    memset(app->light_off, 0, sizeof app->light_off);
    return parian_view_lights_default(app->env, &app->info, &app->extent, &app->lights);
}

parian_result parian_view_app_prepare(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    parian_result result = parian_view_camera_check(app->env, o->camera);
    if (result == PARIAN_OK) {
        result = parian_view_lights_read(app->env, o, &app->lights);
    }
    app->lights_given = app->lights.count > 0;
    if (result == PARIAN_OK) {
        result = parian_view_medium_read(app->env, o, &app->medium);
    }
    app->tone = (parian_tone)o->tone;
    if (result == PARIAN_OK && o->reference) {
        result = parian_view_reference_read(app->env, o->reference, &app->reference);
    }
    app->display = o->displays[0];
    app->aspect = (double)o->width / o->height;
    app->error_scale = o->error_scale;
    app->error = -1;
    app->settings =
        (parian_settings){.no_specular = o->no_specular, .roughness = (float)o->roughness};
    return result;
}

/* ---- adopting a scene --------------------------------------------------------------------------
 */
static void use_scene(parian_view_app *app, parian_scene *scene)
{
    app->scene = scene;
    app->info = parian_scene_get_info(scene);
    app->extent = parian_view_extent_of(&app->info);
    app->error_stale = true;
    memset(app->edit, 0, sizeof app->edit);
    memset(&app->report, 0, sizeof app->report);
    parian_view_reference_forget(app->env, &app->reference);
}

static parian_result make_view(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    parian_result result = choose_lights(app);
    if (result == PARIAN_OK) {
        result =
            parian_view_camera_make(app->env, o->camera, &app->extent, app->aspect, &app->camera);
    }
    choose_exposure(app);
    choose_background(app);
    if (result == PARIAN_OK) {
        result = parian_view_app_send_lights(app);
    }
    if (result == PARIAN_OK && parian_view_camera_is_open(o->camera)) {
        result = parian_view_app_frame(app, app->aspect);
    }
    return result;
}

/* In slices of some milliseconds, so that the window can tell how far it is. */
static parian_result upload(const parian_view_app *app, parian_renderer *renderer)
{
    uint64_t left = 0, all = 0;
    parian_result result;
    do {
        result = parian_cancelled(app->env) ? PARIAN_E_INTERRUPTED
                                            : parian_renderer_upload(renderer, UPLOAD_SLICE, &left);
        all = all > left ? all : left + UPLOAD_SLICE;
        if (app->on_upload && result == PARIAN_OK && left > 0) {
            app->on_upload(app->on_upload_user, 1 - (double)left / (double)all);
        }
    } while (result == PARIAN_OK && left > 0);
    return result;
}

parian_result parian_view_app_adopt(parian_view_app *app, parian_scene *scene, bool keep)
{
    const parian_renderer_desc desc = {.backend = app->get_proc_address ? PARIAN_BACKEND_GL
                                                                        : PARIAN_BACKEND_CPU,
                                       .get_proc_address = app->get_proc_address,
                                       .deferred_upload = true};
    parian_scene *before = app->scene;
    parian_renderer *made = NULL, *old = app->renderer;
    parian_result result = parian_renderer_create(app->env, scene, &desc, &made);
    if (result == PARIAN_OK) {
        result = upload(app, made);
    }
    if (result != PARIAN_OK) {
        parian_renderer_destroy(made);
        parian_scene_close(scene);
        return result;
    }
    use_scene(app, scene);
    app->renderer = made;
    result = keep && before ? parian_view_app_send_lights(app) : make_view(app);
    if (result == PARIAN_OK) {
        result = parian_view_app_send_medium(app);
    }
    if (result != PARIAN_OK && before) {
        parian_renderer_destroy(made);
        parian_scene_close(scene);
        use_scene(app, before);
        app->renderer = old;
        return result;
    }
    parian_renderer_destroy(old);
    parian_scene_close(before);
    return result;
}

void parian_view_app_stop(parian_view_app *app)
{
    parian_renderer_destroy(app->renderer);
    app->renderer = NULL;
}

void parian_view_app_close(parian_view_app *app)
{
    parian_view_picture_free(app);
    parian_view_reference_free(app->env, &app->reference);
    parian_light_set_free(app->env, &app->lights);
    parian_scene_close(app->scene);
    app->scene = NULL;
}

/* ---- lights and camera -------------------------------------------------------------------------
 */
parian_result parian_view_app_frame(parian_view_app *app, double aspect)
{
    parian_texel_arrays arrays = {.position = NULL};
    if (!PARIAN_NEW(app->env, arrays.position, app->info.texel_count)) {
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for the positions of texels");
    }
    parian_result result = parian_renderer_read_texels(app->renderer, &arrays);
    if (result == PARIAN_OK) {
        parian_view_camera_fit(&app->camera, (const float(*)[3])arrays.position,
                               app->info.texel_count, app->extent.body_centre, aspect);
    }
    parian_free(app->env, arrays.position);
    return result;
}

parian_result parian_view_app_send_lights(parian_view_app *app)
{
    parian_light *on;
    size_t count = 0;
    if (!PARIAN_NEW(app->env, on, app->lights.count)) {
        return parian_fail(app->env, PARIAN_E_NOMEM, "no memory for %zu lights", app->lights.count);
    }
    for (size_t i = 0; i < app->lights.count; i++) {
        if (!app->light_off[i]) {
            on[count++] = app->lights.light[i];
        }
    }
    parian_result result = parian_renderer_set_lights(app->renderer, on, count);
    parian_free(app->env, on);
    app->error_stale = true;
    return result;
}

parian_result parian_view_app_relight(parian_view_app *app)
{
    parian_result result = parian_view_app_send_lights(app);
    parian_renderer_invalidate(app->renderer); /* the same lights are timed again and again */
    return result == PARIAN_OK ? parian_renderer_relight(app->renderer) : result;
}

parian_result parian_view_app_refine(parian_view_app *app, uint32_t sets)
{
    parian_result result = PARIAN_OK;
    while (result == PARIAN_OK && parian_renderer_set_count(app->renderer) < sets) {
        result = parian_cancelled(app->env) ? PARIAN_E_INTERRUPTED
                                            : parian_renderer_refine(app->renderer);
        app->error_stale = true;
    }
    return result;
}

parian_result parian_view_app_edit(parian_view_app *app, uint32_t body,
                                   const parian_medium_edit *edit)
{
    parian_medium_report report;
    if (body >= PARIAN_VIEW_EDITS) {
        return parian_fail(app->env, PARIAN_E_LIMIT, "only the first %d bodies can be edited",
                           PARIAN_VIEW_EDITS);
    }
    parian_result result = parian_renderer_set_medium(app->renderer, body, edit, &report);
    if (result == PARIAN_OK) {
        app->edit[body] = *edit;
        app->report = report;
        app->error_stale = true;
    }
    return result;
}

parian_result parian_view_app_read_lights(parian_view_app *app, const char *path)
{
    parian_light_set set = {NULL, 0};
    parian_result result = parian_lights_read_file(app->env, path, &set);
    if (result != PARIAN_OK) {
        parian_light_set_free(app->env, &set);
        return result;
    }
    parian_light_set_free(app->env, &app->lights);
    memset(app->light_off, 0, sizeof app->light_off);
    app->lights = set;
    app->lights_given = true;
    return PARIAN_OK;
}

parian_result parian_view_app_send_medium(parian_view_app *app)
{
    app->error_stale = true;
    return parian_view_medium_send(app->renderer, app->info.body_count, &app->medium);
}

/* ---- drawing -----------------------------------------------------------------------------------
 */
parian_result parian_view_app_draw(parian_view_app *app, uint32_t width, uint32_t height,
                                   uint32_t framebuffer)
{
    const double aspect = (double)width / height;
    const parian_draw_desc desc = {
        .camera = parian_view_camera_matrices(&app->camera, &app->extent, aspect),
        .width = width,
        .height = height,
        .exposure_auto = app->exposure_auto,
        .exposure_ev = app->exposure_ev,
        .tone = app->tone,
        .framebuffer = framebuffer};
    const bool picture_error = app->display == PARIAN_DISPLAY_ERROR && app->reference.pixel != NULL;
    app->settings.view =
        picture_error ? PARIAN_VIEW_COMBINED : parian_view_display_mode(app->display);
    app->picture.width = app->picture.height = 0;
    parian_result result = PARIAN_OK;
    if (parian_view_display_is_atlas(app->display)) {
        return parian_view_picture_atlas(app, width, height);
    }
    if (app->display == PARIAN_DISPLAY_ERROR && !picture_error) {
        result = parian_view_picture_paint_error(app);
    }
    if (result == PARIAN_OK) {
        result = parian_renderer_set_settings(app->renderer, &app->settings);
    }
    if (result == PARIAN_OK) {
        result = parian_renderer_draw(app->renderer, &desc);
    }
    return result == PARIAN_OK && picture_error ? parian_view_picture_compare(app, width, height)
                                                : result;
}
