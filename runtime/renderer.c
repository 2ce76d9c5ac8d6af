/* renderer.c - one scene with lights and settings; decides what must be recomputed and asks its
 * backend.
 *
 * SPDX-License-Identifier: MIT
 */
#include "renderer_internal.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "core/memory.h"
#include "vec3.h"

enum { DRAW_SIDE_MAX = 16384, SHADOW_SIZE_MAX = 8192 };

static const char *const pass_names[PARIAN_PASS_COUNT] = {
    "shadow", "irradiance", "restrict", "product", "filter", "gutter", "shade", "tone"};

uint32_t parian_body_register_count(const parian_body *body)
{
    uint32_t count = 2;
    for (uint32_t o = 0; o < body->operator_count; o++) {
        const parian_operator *op = &body->operators[o];
        count = op->source_register >= count ? op->source_register + 1 : count;
        count = op->target_register >= count ? op->target_register + 1 : count;
    }
    return count;
}

uint32_t parian_body_register_size(const parian_body *body, uint32_t index)
{
    uint32_t size = index < 2 ? body->vertex_count : 0;
    for (uint32_t o = 0; o < body->operator_count; o++) {
        const parian_operator *op = &body->operators[o];
        if (op->source_register == index && op->column_count > size) {
            size = op->column_count;
        }
        if (op->target_register == index && op->row_count > size) {
            size = op->row_count;
        }
    }
    return size;
}

float parian_renderer_shadow_lift(const parian_renderer *renderer, float scale)
{
    float diagonal[3];
    vec3_sub(diagonal, renderer->scene->info.body_upper, renderer->scene->info.body_lower);
    return 2e-3f * scale * vec3_length(diagonal);
}

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void parian_renderer_begin_pass(parian_renderer *renderer)
{
    renderer->pass_start = renderer->timing ? seconds_now() : 0.0;
}

void parian_renderer_end_pass(parian_renderer *renderer, parian_pass pass)
{
    renderer->pass[pass].runs++;
    if (renderer->timing) {
        renderer->pass[pass].ms = 1e3 * (seconds_now() - renderer->pass_start);
    }
}

static parian_result check_scene(const parian_env *env, const parian_scene *scene)
{
    for (uint32_t b = 0; b < scene->data.body_count; b++) {
        const parian_body *body = &scene->data.bodies[b];
        if (!body->texel_at || !body->texel_position || !body->texel_border) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "body %u: its derived arrays are missing",
                               b);
        }
        if (parian_body_register_count(body) > 2 * PARIAN_MAX_OPERATORS) {
            return parian_fail(env, PARIAN_E_UNSUPPORTED,
                               "body %u: operators use more than %d registers", b,
                               2 * PARIAN_MAX_OPERATORS);
        }
    }
    return PARIAN_OK;
}

static parian_result prepare(parian_renderer *renderer)
{
    for (int p = 0; p < PARIAN_PASS_COUNT; p++) {
        renderer->pass[p].name = pass_names[p];
    }
    renderer->lights_changed = true;
    renderer->edited_from = PARIAN_PASS_SHADE;
    parian_result result = parian_renderer_start_media(renderer);
    if (result == PARIAN_OK) {
        result = parian_renderer_start_instances(renderer);
    }
    if (result == PARIAN_OK) {
        result = parian_renderer_prepare_sets(renderer);
    }
    if (result == PARIAN_OK) {
        result = renderer->backend->create(renderer);
    }
    return result == PARIAN_OK ? renderer->backend->resize(renderer, 1) : result;
}

parian_result parian_renderer_create(const parian_env *env, const parian_scene *scene,
                                     const parian_renderer_desc *desc, parian_renderer **renderer)
{
    parian_renderer *made;
    if (!scene || !desc || !renderer || (unsigned)desc->backend > PARIAN_BACKEND_CPU ||
        desc->shadow_size > SHADOW_SIZE_MAX || desc->environment_lights > PARIAN_LIGHT_MAX) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "a renderer needs a scene, a known backend, shadow maps of at most %d texels and "
            "environments of at most %d lights",
            SHADOW_SIZE_MAX, PARIAN_LIGHT_MAX);
    }
    parian_result result = check_scene(env, scene);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a renderer");
    }
    parian_frame_memory_init(&made->frame_memory, env, &made->env);
    made->scene = scene;
    made->desc = *desc;
    if (!made->desc.shadow_size) {
        made->desc.shadow_size = PARIAN_SHADOW_SIZE_DEFAULT;
    }
    made->backend = desc->backend == PARIAN_BACKEND_CPU ? &parian_cpu_backend : &parian_gl_backend;
    result = prepare(made);
    if (result != PARIAN_OK) {
        parian_renderer_destroy(made);
        return result;
    }
    parian_frame_memory_trim(&made->frame_memory); /* what creation needed, frames do not */
    *renderer = made;
    return PARIAN_OK;
}

void parian_renderer_destroy(parian_renderer *renderer)
{
    if (renderer) {
        const parian_env *env = &renderer->env, parent = renderer->frame_memory.parent;
        renderer->backend->destroy(renderer);
        parian_light_list_free(env, &renderer->lights);
        parian_renderer_free_sets(renderer);
        parian_free(env, renderer->instances);
        parian_free(env, renderer->optics);
        parian_free(env, renderer->relief_reach);
        parian_free(env, renderer->medium);
        parian_frame_memory_trim(&renderer->frame_memory);
        parian_free(&parent, renderer);
    }
}

const char *parian_renderer_name(const parian_renderer *renderer)
{
    return renderer->name;
}

parian_result parian_renderer_set_lights(parian_renderer *renderer, const parian_light *lights,
                                         size_t count)
{
    parian_light_list list;
    if (!renderer || (count > 0 && !lights)) {
        return PARIAN_E_ARGUMENT;
    }
    parian_result result = parian_light_list_build(&renderer->env, lights, count,
                                                   renderer->desc.environment_lights, &list);
    if (result != PARIAN_OK) {
        return result;
    }
    bool equal = parian_light_list_equal(&list, &renderer->lights);
    if (!equal) {
        result = parian_renderer_fit_shadows(renderer, &list);
    }
    if (equal || result != PARIAN_OK) {
        parian_light_list_free(&renderer->env, &list);
        return result;
    }
    parian_light_list_free(&renderer->env, &renderer->lights);
    renderer->lights = list;
    renderer->lights_changed = true;
    return PARIAN_OK;
}

parian_result parian_renderer_set_settings(parian_renderer *renderer,
                                           const parian_settings *settings)
{
    if (!renderer || !settings || (unsigned)settings->view > PARIAN_VIEW_VALUES ||
        !(settings->roughness >= 0.0f && settings->roughness <= 1.0f)) {
        return renderer ? parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                                      "settings need a known view and a roughness of 0 to 1")
                        : PARIAN_E_ARGUMENT;
    }
    for (int c = 0; c < 3; c++) {
        if (!(settings->background[c] >= 0.0f && settings->background[c] < 1e12f)) {
            return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                               "the background is not within 0 to 1e12");
        }
    }
    if (memcmp(&renderer->settings, settings, sizeof *settings) != 0) {
        memcpy(&renderer->settings, settings, sizeof *settings);
        renderer->picture_stale = true;
    }
    return PARIAN_OK;
}

parian_result parian_renderer_set_values(parian_renderer *renderer, const float (*value)[3])
{
    if (!renderer || !value) {
        return PARIAN_E_ARGUMENT;
    }
    parian_result result = PARIAN_OK;
    renderer->has_values = false;
    renderer->picture_stale = true;
    for (uint32_t b = 0; b < renderer->scene->data.body_count && result == PARIAN_OK; b++) {
        result = renderer->backend->set_values(renderer, b, value);
        value += renderer->scene->data.bodies[b].texel_count;
    }
    renderer->has_values = result == PARIAN_OK;
    return result;
}

void parian_renderer_invalidate(parian_renderer *renderer)
{
    renderer->lights_changed = true;
}

parian_result parian_renderer_relight(parian_renderer *renderer)
{
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    parian_pass from = renderer->lights_changed ? PARIAN_PASS_SHADOW : renderer->edited_from;
    if (from >= PARIAN_PASS_SHADE) {
        return PARIAN_OK;
    }
    parian_frame_memory_tick(&renderer->frame_memory);
    parian_result result = parian_renderer_check_uploaded(renderer);
    if (result == PARIAN_OK) {
        result = parian_renderer_place_casters(renderer);
    }
    if (result == PARIAN_OK) {
        result = renderer->backend->relight(renderer, from);
        renderer->picture_stale = true;
    }
    if (result == PARIAN_OK) {
        renderer->lights_changed = false;
        renderer->edited_from = PARIAN_PASS_SHADE;
        renderer->set_count = from <= PARIAN_PASS_IRRADIANCE ? 1 : renderer->set_count;
    }
    return result;
}

static bool all_finite(const float *value, int count)
{
    for (int i = 0; i < count; i++) {
        if (!isfinite(value[i])) {
            return false;
        }
    }
    return true;
}

/* Exposure and framebuffer matter to the tone pass alone. */
static bool is_shading_due(const parian_renderer *renderer, const parian_draw_desc *desc)
{
    return renderer->picture_stale || renderer->picture_width != desc->width ||
           renderer->picture_height != desc->height ||
           memcmp(&renderer->picture_camera, &desc->camera, sizeof desc->camera) != 0;
}

/* A picture of a new size may have to take memory from the shadow maps. */
static parian_result fit_picture(parian_renderer *renderer, const parian_draw_desc *desc)
{
    bool smaller = false;
    if (renderer->picture_width == desc->width && renderer->picture_height == desc->height) {
        return PARIAN_OK;
    }
    parian_result result = parian_renderer_fit_budget(renderer, &renderer->lights, desc->width,
                                                      desc->height, &smaller);
    renderer->lights_changed = renderer->lights_changed || smaller;
    return result;
}

parian_result parian_renderer_draw(parian_renderer *renderer, const parian_draw_desc *desc)
{
    if (!renderer || !desc) {
        return PARIAN_E_ARGUMENT;
    }
    if (desc->width < 1 || desc->height < 1 || desc->width > DRAW_SIDE_MAX ||
        desc->height > DRAW_SIDE_MAX) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "a picture of %u x %u pixels, expected 1 to %d", desc->width,
                           desc->height, DRAW_SIDE_MAX);
    }
    if (!all_finite(desc->camera.view, 16) || !all_finite(desc->camera.projection, 16) ||
        !isfinite(desc->exposure_ev) || fabsf(desc->exposure_ev) > 100.0f ||
        (unsigned)desc->tone > PARIAN_TONE_REINHARD) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "camera matrices must be finite, the exposure within 100 stops and the "
                           "tone curve a known one");
    }
    if (renderer->settings.view == PARIAN_VIEW_VALUES && !renderer->has_values) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT, "there are no values to paint");
    }
    parian_frame_memory_tick(&renderer->frame_memory);
    parian_result result = fit_picture(renderer, desc);
    if (result == PARIAN_OK) {
        result = parian_renderer_relight(renderer);
    }
    bool shade = result == PARIAN_OK && is_shading_due(renderer, desc);
    if (result == PARIAN_OK) {
        renderer->picture_width = 0;
        result = renderer->backend->draw(renderer, desc, shade);
    }
    if (result == PARIAN_OK) {
        renderer->picture_width = desc->width;
        renderer->picture_height = desc->height;
        renderer->picture_camera = desc->camera;
        renderer->picture_stale = false;
    }
    return result;
}

void parian_renderer_set_timing(parian_renderer *renderer, bool on)
{
    renderer->timing = on;
}

size_t parian_renderer_get_times(const parian_renderer *renderer,
                                 parian_pass_time times[PARIAN_PASS_MAX])
{
    memcpy(times, renderer->pass, sizeof renderer->pass);
    return PARIAN_PASS_COUNT;
}
