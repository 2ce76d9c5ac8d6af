/* relight.h - an asset on a renderer without a window: B at texels, and what a relight takes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_RELIGHT_H
#define PARIAN_MEASURE_RELIGHT_H

#include "core/body.h"
#include "parian/runtime.h"
#include "player/headless_egl.h"
#include "player/view_camera.h"
#include "tests/measure/measure_options.h"

/* The backend of a run. */
typedef struct parian_measure_device {
    parian_measure_backend backend; /* what it became */
    parian_headless *headless;      /* NULL: the C evaluation */
    void (*finish)(void);           /* glFinish, or NULL */
    uint32_t shadow_size;           /* side of shadow maps; 0: the renderer's default */
} parian_measure_device;

/* Make a context; where there is none, warns and takes the C evaluation. */
void parian_measure_device_open(const parian_env *env, parian_measure_backend wanted,
                                parian_measure_device *device);
void parian_measure_device_close(const parian_env *env, parian_measure_device *device);
const char *parian_measure_backend_name(parian_measure_backend backend);

/* An asset that is loaded for relighting. */
typedef struct parian_relit {
    parian_scene *scene;
    parian_renderer *renderer;
    const parian_measure_device *device;
    parian_scene_info info;
    uint64_t factors; /* kept throughput factors per channel, of all bodies */
    float (*position)[3], (*normal)[3], *area; /* [info.texel_count] */
    float (*irradiance)[3], (*radiosity)[3];   /* [info.texel_count] of the last relight */
} parian_relit;

/* Errors: those of parian_scene_open and parian_renderer_create. Close it in every case. */
parian_result parian_relit_open(const parian_env *env, const char *path,
                                const parian_measure_device *device, parian_relit *relit);
void parian_relit_close(const parian_env *env, parian_relit *relit);
/* The bodies of the asset, [info.body_count]. */
const parian_body *parian_relit_bodies(const parian_relit *relit);

/* Relight, and read E and B of all texels. */
parian_result parian_relit_light(parian_relit *relit, const parian_light *lights, size_t count);

typedef struct parian_pass_median {
    const char *name;
    double ms;
} parian_pass_median;

typedef struct parian_relight_times {
    double median_ms, minimum_ms, maximum_ms;
    uint32_t repeats;
    parian_pass_median pass[PARIAN_PASS_MAX]; /* of further repeats, with a wait behind each pass */
    size_t pass_count;
} parian_relight_times;

/* Time whole relights under lights that differ a little each time: lights set until the work is
 * finished, after one that is not timed; what `seconds` allow, at least 5 and at most 100. The
 * renderer is left with the last ones. */
parian_result parian_relit_time(const parian_env *env, parian_relit *relit,
                                const parian_light *lights, size_t count, double seconds,
                                parian_relight_times *times);

/* Draw the bodies as they are lit into [size * size][4] linear radiance. */
parian_result parian_relit_draw(parian_relit *relit, const parian_camera *camera, uint32_t size,
                                float (*radiance)[4]);
/* The view that --camera asks for, NULL frames the bodies. Errors: those of view_camera.h. */
parian_result parian_relit_camera(const parian_env *env, const parian_relit *relit,
                                  const char *text, parian_view_camera *camera);

#endif
