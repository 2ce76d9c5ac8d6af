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
#include "view_medium.h"
#include "view_options.h"
#include "view_reference.h"

enum { PARIAN_VIEW_EDITS = 64 };

/* A picture that the player made itself: atlases, errors of pictures. [height * width], rows from
 * top to bottom. */
typedef struct parian_view_picture {
    float (*radiance)[4];
    uint8_t (*srgb)[4];
    uint32_t width, height; /* 0: the last picture is the renderer's */
} parian_view_picture;

typedef struct parian_view_app {
    const parian_env *env;
    const parian_view_options *options;
    parian_scene *scene;
    parian_scene_info info;
    parian_view_extent extent;
    parian_light_set lights;
    bool lights_given;                 /* by hand: not those of the asset */
    bool light_off[PARIAN_LIGHTS_MAX]; /* switched off for the time being */
    parian_view_camera camera;
    double aspect; /* width over height of the picture, for the first framing */
    parian_renderer *renderer;
    void *(*get_proc_address)(const char *name); /* NULL: the C evaluation */
    /* Called between slices of an upload with the share that is done; may be NULL. */
    void (*on_upload)(void *user, double fraction);
    void *on_upload_user;
    parian_settings settings; /* the view comes from the display */
    parian_view_display display;
    parian_view_medium medium; /* of all bodies */
    parian_tone tone;
    bool exposure_auto;
    float exposure_ev;
    parian_view_reference reference;
    double error_scale, error; /* of the error view: colours over this; relative L2, -1 unknown */
    bool error_stale;          /* B or the scale changed since the error was painted */
    parian_view_picture picture;
    parian_medium_edit edit[PARIAN_VIEW_EDITS]; /* of the first bodies; zero: as baked */
    parian_medium_report report;                /* of the last edit; no text before one */
} parian_view_app;

/* Read lights, camera file and reference. app->env and app->options are set; close in every case.
 */
parian_result parian_view_app_prepare(parian_view_app *app);
/* Take over an opened scene (which is the app's from then on, also on failure: the one before is
 * then kept): make its renderer, and first lights, camera and exposure. keep: those stay. */
parian_result parian_view_app_adopt(parian_view_app *app, parian_scene *scene, bool keep);
/* Free what belongs to a context, while it is current. */
void parian_view_app_stop(parian_view_app *app);
void parian_view_app_close(parian_view_app *app);

/* Draw the display to a framebuffer ((uint32_t)-1: none) of width x height pixels. Afterwards
 * app->picture is the picture where its width is not 0: the framebuffer was then left alone. */
parian_result parian_view_app_draw(parian_view_app *app, uint32_t width, uint32_t height,
                                   uint32_t framebuffer);
/* Fit the camera to the bodies' surface, from the direction it looks in now. */
parian_result parian_view_app_frame(parian_view_app *app, double aspect);
/* Give the renderer the lights that are on. */
parian_result parian_view_app_send_lights(parian_view_app *app);
/* Give the renderer app->medium, after its name (parian_view_medium_choose), size factor or tint
 * changed; takes seconds where the medium did. The old one stays on failure. */
parian_result parian_view_app_send_medium(parian_view_app *app);
/* Force a full relight, and do it. */
/* Refine until E is the mean of so many sets of samples. */
parian_result parian_view_app_refine(parian_view_app *app, uint32_t sets);
parian_result parian_view_app_relight(parian_view_app *app);

/* Give a body another medium, and keep what it costs in app->report; on failure nothing changes.
 * Errors: those of parian_renderer_set_medium. */
parian_result parian_view_app_edit(parian_view_app *app, uint32_t body,
                                   const parian_medium_edit *edit);

/* Replace the lights by those of a lights file; the old ones stay on failure. */
parian_result parian_view_app_read_lights(parian_view_app *app, const char *path);

/* Write the picture of the last draw; the ending of the path says how. */
parian_result parian_view_write_image(parian_view_app *app, const char *path, uint32_t width,
                                      uint32_t height);
/* Write the per-texel arrays of --dump to a folder. */
parian_result parian_view_write_dump(parian_view_app *app, const char *folder);

#endif
