/* relight.c - loads an asset into a renderer, reads B, and times relights.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/relight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "scene_internal.h"
#include "tool/session.h"

enum { REPEATS_MIN = 5, REPEATS_MAX = 100 };

/* ---- the device
 * --------------------------------------------------------------------------------------------- */
const char *parian_measure_backend_name(parian_measure_backend backend)
{
    static const char *const names[] = {"core", "es", "cpu"};
    return (unsigned)backend <= PARIAN_MEASURE_CPU ? names[backend] : "unknown";
}

void parian_measure_device_open(const parian_env *env, parian_measure_backend wanted,
                                parian_measure_device *device)
{
    *device = (parian_measure_device){.backend = wanted};
    if (wanted == PARIAN_MEASURE_CPU) {
        return;
    }
    parian_env quiet = *env;
    quiet.log = NULL; /* the warning says it */
    parian_result r = parian_headless_create(
        &quiet, wanted == PARIAN_MEASURE_ES ? PARIAN_VIEW_GL_ES : PARIAN_VIEW_GL_CORE,
        &device->headless);
    if (r != PARIAN_OK) {
        parian_log(env, PARIAN_LOG_WARNING,
                   "EGL gives no %s context: the C evaluation relights instead",
                   wanted == PARIAN_MEASURE_ES ? "OpenGL ES 3.0" : "OpenGL 3.3 core");
        device->backend = PARIAN_MEASURE_CPU;
        return;
    }
    void *finish = parian_headless_proc_address("glFinish");
    memcpy(&device->finish, &finish, sizeof finish);
}

void parian_measure_device_close(const parian_env *env, parian_measure_device *device)
{
    parian_headless_destroy(env, device->headless);
    *device = (parian_measure_device){0};
}

/* ---- an asset on it
 * ------------------------------------------------------------------------------------------ */
static parian_result make_renderer(const parian_env *env, parian_relit *relit)
{
    parian_renderer_desc desc = {.backend = PARIAN_BACKEND_CPU,
                                 .shadow_size = relit->device->shadow_size};
    if (relit->device->headless) {
        desc.backend = PARIAN_BACKEND_GL;
        desc.get_proc_address = parian_headless_proc_address;
    }
    return parian_renderer_create(env, relit->scene, &desc, &relit->renderer);
}

static parian_result make_arrays(const parian_env *env, parian_relit *relit)
{
    size_t n = relit->info.texel_count;
    if (!PARIAN_NEW(env, relit->position, n) || !PARIAN_NEW(env, relit->normal, n) ||
        !PARIAN_NEW(env, relit->area, n) || !PARIAN_NEW(env, relit->irradiance, n) ||
        !PARIAN_NEW(env, relit->radiosity, n)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu texels", n);
    }
    const parian_texel_arrays arrays = {
        .position = relit->position, .normal = relit->normal, .area = relit->area};
    return parian_renderer_read_texels(relit->renderer, &arrays);
}

const parian_body *parian_relit_bodies(const parian_relit *relit)
{
    return relit->scene->data.bodies;
}

parian_result parian_relit_open(const parian_env *env, const char *path,
                                const parian_measure_device *device, parian_relit *relit)
{
    *relit = (parian_relit){.device = device};
    parian_result r = parian_scene_open(env, path, &relit->scene);
    if (r == PARIAN_OK) {
        relit->info = parian_scene_get_info(relit->scene);
        r = make_renderer(env, relit);
    }
    if (r == PARIAN_OK) {
        r = make_arrays(env, relit);
    }
    for (uint32_t b = 0; r == PARIAN_OK && b < relit->info.body_count; b++) {
        const parian_body *body = &parian_relit_bodies(relit)[b];
        for (uint32_t o = 0; o < body->operator_count; o++) {
            relit->factors += body->operators[o].factor_total;
        }
    }
    return r;
}

void parian_relit_close(const parian_env *env, parian_relit *relit)
{
    parian_free(env, relit->position);
    parian_free(env, relit->normal);
    parian_free(env, relit->area);
    parian_free(env, relit->irradiance);
    parian_free(env, relit->radiosity);
    parian_renderer_destroy(relit->renderer);
    parian_scene_close(relit->scene);
    *relit = (parian_relit){0};
}

parian_result parian_relit_light(parian_relit *relit, const parian_light *lights, size_t count)
{
    const parian_texel_arrays arrays = {.irradiance = relit->irradiance,
                                        .radiosity = relit->radiosity};
    parian_result r = parian_renderer_set_lights(relit->renderer, lights, count);
    return r == PARIAN_OK ? parian_renderer_read_texels(relit->renderer, &arrays) : r;
}

/* ---- times
 * ---------------------------------------------------------------------------------------------------
 */
static int by_size(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *value, size_t count)
{
    qsort(value, count, sizeof *value, by_size);
    return count % 2 ? value[count / 2] : 0.5 * (value[count / 2 - 1] + value[count / 2]);
}

/* Lights that have moved by about a thousandth: each step is another, so that nothing can be kept.
 */
static void move_lights(const parian_light *from, size_t count, uint32_t step, parian_light *to)
{
    float shift = 1e-3f * (float)(1 + step % 7);
    for (size_t i = 0; i < count; i++) {
        float size = 0;
        to[i] = from[i];
        for (int c = 0; c < 3; c++) {
            size = fmaxf(size, fabsf(from[i].position[c]));
        }
        to[i].position[0] += shift * size;
        to[i].direction[1] +=
            shift * fmaxf(fmaxf(fabsf(from[i].direction[0]), fabsf(from[i].direction[1])),
                          fabsf(from[i].direction[2]));
        to[i].rotation_deg += 100 * shift;
    }
}

static parian_result relight_once(parian_relit *relit, const parian_light *lights, size_t count,
                                  double *ms)
{
    double start = parian_seconds();
    parian_result r = parian_renderer_set_lights(relit->renderer, lights, count);
    parian_renderer_invalidate(relit->renderer);
    if (r == PARIAN_OK) {
        r = parian_renderer_relight(relit->renderer);
    }
    if (r == PARIAN_OK && relit->device->finish) {
        relit->device->finish();
    }
    *ms = 1e3 * (parian_seconds() - start);
    return r;
}

/* Fill times->... from repeats; with passes, those of every pass instead of the whole. */
static parian_result repeat(const parian_env *env, parian_relit *relit, const parian_light *lights,
                            size_t count, parian_light *moved, bool passes, double seconds,
                            parian_relight_times *times)
{
    double whole[REPEATS_MAX], part[PARIAN_PASS_MAX][REPEATS_MAX], ms;
    parian_pass_time pass[PARIAN_PASS_MAX];
    parian_result r = relight_once(relit, lights, count, &ms);
    uint32_t n = 0;
    size_t pass_count = 0;
    double begin = parian_seconds(), limit = passes ? seconds / 5 : seconds;
    while (r == PARIAN_OK && n < REPEATS_MAX &&
           (n < REPEATS_MIN || parian_seconds() - begin < limit)) {
        move_lights(lights, count, n, moved);
        r = parian_cancelled(env) ? PARIAN_E_INTERRUPTED
                                  : relight_once(relit, moved, count, &whole[n]);
        pass_count = parian_renderer_get_times(relit->renderer, pass);
        for (size_t p = 0; p < pass_count; p++) {
            part[p][n] = pass[p].ms;
        }
        n++;
    }
    if (r != PARIAN_OK) {
        return r;
    }
    for (size_t p = 0; passes && p < pass_count; p++) {
        times->pass[p] = (parian_pass_median){pass[p].name, median(part[p], n)};
    }
    if (passes) {
        times->pass_count = pass_count;
    } else {
        times->median_ms = median(whole, n);
        times->minimum_ms = whole[0];
        times->maximum_ms = whole[n - 1];
        times->repeats = n;
    }
    return PARIAN_OK;
}

parian_result parian_relit_time(const parian_env *env, parian_relit *relit,
                                const parian_light *lights, size_t count, double seconds,
                                parian_relight_times *times)
{
    parian_light *moved = NULL;
    *times = (parian_relight_times){0};
    if (!PARIAN_NEW(env, moved, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu lights", count);
    }
    parian_renderer_set_timing(relit->renderer, false);
    parian_result r = repeat(env, relit, lights, count, moved, false, seconds, times);
    if (r == PARIAN_OK) {
        parian_renderer_set_timing(relit->renderer, true);
        r = repeat(env, relit, lights, count, moved, true, seconds, times);
        parian_renderer_set_timing(relit->renderer, false);
    }
    parian_free(env, moved);
    return r;
}

/* ---- pictures
 * ------------------------------------------------------------------------------------------------
 */
parian_result parian_relit_camera(const parian_env *env, const parian_relit *relit,
                                  const char *text, parian_view_camera *camera)
{
    const parian_view_extent extent = parian_view_extent_of(&relit->info);
    parian_result r = parian_view_camera_make(env, text, &extent, 1, camera);
    if (r == PARIAN_OK && parian_view_camera_is_open(text)) {
        parian_view_camera_fit(camera, (const float(*)[3])relit->position, relit->info.texel_count,
                               extent.body_centre, 1);
    }
    return r;
}

parian_result parian_relit_draw(parian_relit *relit, const parian_camera *camera, uint32_t size,
                                float (*radiance)[4])
{
    const parian_draw_desc desc = {
        .camera = *camera, .width = size, .height = size, .framebuffer = (uint32_t)-1};
    parian_result r = parian_renderer_draw(relit->renderer, &desc);
    return r == PARIAN_OK ? parian_renderer_read_picture(relit->renderer, radiance, NULL) : r;
}
