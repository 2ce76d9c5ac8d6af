/* view_app.h - what the window and the headless run share: asset, lights, camera, renderer,
 * outputs.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_APP_H
#define PARIAN_VIEW_APP_H

#include "parian/runtime.h"
#include "view_camera.h"
#include "view_lights.h"
#include "view_options.h"

typedef struct parian_view_app {
    const parian_env *env;
    const parian_view_options *options;
    parian_scene *scene;
    parian_scene_info info;
    parian_view_extent extent;
    parian_light_set lights;
    parian_view_camera camera;
    parian_renderer *renderer;
    parian_settings settings;
    bool exposure_auto;
    float exposure_ev;
} parian_view_app;

/* Read lights, asset and camera. app->env and app->options are set; close in every case. */
parian_result parian_view_app_open(parian_view_app *app);
/* Make the renderer in the current context (NULL: the C evaluation), with lights and settings, and
 * frame the bodies unless --camera says from how far to look. */
parian_result parian_view_app_start(parian_view_app *app,
                                    void *(*get_proc_address)(const char *name));
/* Free the renderer, while its context is current. */
void parian_view_app_stop(parian_view_app *app);
void parian_view_app_close(parian_view_app *app);

/* Draw to a framebuffer ((uint32_t)-1: none) of width x height pixels. */
parian_result parian_view_app_draw(parian_view_app *app, uint32_t width, uint32_t height,
                                   uint32_t framebuffer);
/* Fit the camera to the bodies' surface, from the direction it looks in now. */
parian_result parian_view_app_frame(parian_view_app *app, double aspect);
/* Force a full relight, and do it. */
parian_result parian_view_app_relight(parian_view_app *app);

/* Write the picture of the last draw; the ending of the path says how. */
parian_result parian_view_write_image(parian_view_app *app, const char *path, uint32_t width,
                                      uint32_t height);
/* Write the per-texel arrays of --dump to a folder. */
parian_result parian_view_write_dump(parian_view_app *app, const char *folder);

#endif
