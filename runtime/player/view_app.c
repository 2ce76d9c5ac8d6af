/* view_app.c - what the window and the headless run share: asset, lights, camera, renderer.
 *
 * SPDX-License-Identifier: MIT
 */
#include "view_app.h"

#include <math.h>

#include "core/memory.h"

/* Radiance of the default background for each W/m^2 of light; a white surface has 0.32. */
static const double BACKGROUND_SHARE = 0.005, BACKGROUND_MAX = 1e6;
static const double WHITE = 2.2, EXPOSURE_MAX = 60;

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
    const bool linear = o->image && parian_view_path_ends(o->image, ".exr");
    const double grey = linear ? 0
                               : BACKGROUND_SHARE * parian_view_lights_brightness(
                                                        &app->lights, app->extent.body_centre);
    for (int c = 0; c < 3; c++) {
        const double value = o->background[c] >= 0 ? o->background[c] : grey;
        app->settings.background[c] = (float)fmin(value, BACKGROUND_MAX);
    }
}

parian_result parian_view_app_open(parian_view_app *app)
{
    const parian_view_options *o = app->options;
    const double aspect = (double)o->width / o->height;
    parian_result result = parian_view_camera_check(app->env, o->camera);
    if (result == PARIAN_OK) {
        result = parian_view_lights_read(app->env, o, &app->lights);
    }
    if (result == PARIAN_OK) {
        result = parian_scene_open(app->env, o->asset, &app->scene);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    app->info = parian_scene_get_info(app->scene);
    app->extent = parian_view_extent_of(&app->info);
    if (app->lights.count == 0) {
        result = parian_view_lights_default(app->env, &app->info, &app->extent, &app->lights);
    }
    if (result == PARIAN_OK) {
        result = parian_view_camera_make(app->env, o->camera, &app->extent, aspect, &app->camera);
    }
    choose_exposure(app);
    app->settings = (parian_settings){.view = (parian_view_mode)o->view,
                                      .no_specular = o->no_specular,
                                      .roughness = (float)o->roughness};
    choose_background(app);
    return result;
}

parian_result parian_view_app_start(parian_view_app *app,
                                    void *(*get_proc_address)(const char *name))
{
    const parian_renderer_desc desc = {.backend = get_proc_address ? PARIAN_BACKEND_GL
                                                                   : PARIAN_BACKEND_CPU,
                                       .get_proc_address = get_proc_address};
    parian_result result = parian_renderer_create(app->env, app->scene, &desc, &app->renderer);
    if (result == PARIAN_OK) {
        result = parian_renderer_set_settings(app->renderer, &app->settings);
    }
    if (result == PARIAN_OK) {
        result = parian_renderer_set_lights(app->renderer, app->lights.light, app->lights.count);
    }
    if (result == PARIAN_OK && parian_view_camera_is_open(app->options->camera)) {
        result = parian_view_app_frame(app, (double)app->options->width / app->options->height);
    }
    return result;
}

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

void parian_view_app_stop(parian_view_app *app)
{
    parian_renderer_destroy(app->renderer);
    app->renderer = NULL;
}

void parian_view_app_close(parian_view_app *app)
{
    parian_light_set_free(app->env, &app->lights);
    parian_scene_close(app->scene);
    app->scene = NULL;
}

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
        .framebuffer = framebuffer};
    return parian_renderer_draw(app->renderer, &desc);
}

parian_result parian_view_app_relight(parian_view_app *app)
{
    parian_result result =
        parian_renderer_set_lights(app->renderer, app->lights.light, app->lights.count);
    parian_renderer_invalidate(app->renderer); /* the same lights are timed again and again */
    return result == PARIAN_OK ? parian_renderer_relight(app->renderer) : result;
}
