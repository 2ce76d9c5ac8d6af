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

enum { DRAW_SIDE_MAX = 16384, SHADOW_SIZE_DEFAULT = 2048, SHADOW_SIZE_MAX = 8192 };

/* Memory that all shadow maps of a renderer may take: 16 maps of 2048 x 2048. */
static const uint64_t shadow_memory_max = 256u << 20;

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

float parian_renderer_shadow_lift(const parian_renderer *renderer)
{
    float diagonal[3];
    vec3_sub(diagonal, renderer->scene->info.body_upper, renderer->scene->info.body_lower);
    return 2e-3f * vec3_length(diagonal);
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
    const parian_scene_data *data = &renderer->scene->data;
    if (!PARIAN_NEW(&renderer->env, renderer->optics, data->body_count)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for %u bodies",
                           data->body_count);
    }
    for (uint32_t b = 0; b < data->body_count; b++) {
        renderer->optics[b] =
            parian_body_optics_make(&data->bodies[b].medium, data->bodies[b].fit_fdr);
    }
    for (int p = 0; p < PARIAN_PASS_COUNT; p++) {
        renderer->pass[p].name = pass_names[p];
    }
    renderer->lights_changed = true;
    return renderer->backend->create(renderer);
}

parian_result parian_renderer_create(const parian_env *env, const parian_scene *scene,
                                     const parian_renderer_desc *desc, parian_renderer **renderer)
{
    parian_renderer *made;
    if (!scene || !desc || !renderer || (unsigned)desc->backend > PARIAN_BACKEND_CPU ||
        desc->shadow_size > SHADOW_SIZE_MAX) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "a renderer needs a scene, a known backend and shadow maps of at most %d texels",
            SHADOW_SIZE_MAX);
    }
    parian_result result = check_scene(env, scene);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW0(env, made, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a renderer");
    }
    if (env) {
        made->env = *env;
    }
    made->scene = scene;
    made->desc = *desc;
    if (!made->desc.shadow_size) {
        made->desc.shadow_size = SHADOW_SIZE_DEFAULT;
    }
    made->backend = desc->backend == PARIAN_BACKEND_CPU ? &parian_cpu_backend : &parian_gl_backend;
    result = prepare(made);
    if (result != PARIAN_OK) {
        parian_renderer_destroy(made);
        return result;
    }
    *renderer = made;
    return PARIAN_OK;
}

void parian_renderer_destroy(parian_renderer *renderer)
{
    if (renderer) {
        parian_env env = renderer->env;
        renderer->backend->destroy(renderer);
        parian_light_list_free(&env, &renderer->lights);
        parian_free(&env, renderer->optics);
        parian_free(&env, renderer);
    }
}

const char *parian_renderer_name(const parian_renderer *renderer)
{
    return renderer->name;
}

uint64_t parian_renderer_memory(const parian_renderer *renderer)
{
    return renderer->backend->memory(renderer);
}

/* The ball around the middle of the bodies' box that holds all their vertices, or around
 * everything. */
static parian_ball find_ball(const parian_scene *scene, bool everything)
{
    const parian_scene_info *info = &scene->info;
    parian_ball ball;
    float reach = 0.0f;
    for (int c = 0; c < 3; c++) {
        ball.center[c] = 0.5f * (everything ? info->lower[c] + info->upper[c]
                                            : info->body_lower[c] + info->body_upper[c]);
    }
    if (everything) {
        float half[3];
        vec3_sub(half, info->upper, ball.center);
        reach = vec3_length(half);
    }
    for (uint32_t b = 0; !everything && b < scene->data.body_count; b++) {
        const parian_body *body = &scene->data.bodies[b];
        for (uint32_t v = 0; v < body->vertex_count; v++) {
            float away[3];
            vec3_sub(away, body->vertex_position[v], ball.center);
            reach = fmaxf(reach, vec3_length(away));
        }
    }
    ball.radius = fmaxf(reach, 1e-9f);
    return ball;
}

static parian_result fit_shadows(parian_renderer *renderer, parian_light_list *list)
{
    const parian_scene *scene = renderer->scene;
    parian_ball bodies = find_ball(scene, false), everything = find_ball(scene, true);
    bool surrounded =
        scene->data.surrounding_count > 0 && everything.radius > 1.05f * bodies.radius;
    return parian_shadow_fit(&renderer->env, list, renderer->desc.shadow_size, shadow_memory_max,
                             &bodies, &everything, surrounded, scene->info.lower,
                             scene->info.upper);
}

parian_result parian_renderer_set_lights(parian_renderer *renderer, const parian_light *lights,
                                         size_t count)
{
    parian_light_list list;
    if (!renderer || (count > 0 && !lights)) {
        return PARIAN_E_ARGUMENT;
    }
    parian_result result = parian_light_list_build(&renderer->env, lights, count, &list);
    if (result != PARIAN_OK) {
        return result;
    }
    result = fit_shadows(renderer, &list);
    if (result != PARIAN_OK) {
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
    renderer->settings = *settings;
    return PARIAN_OK;
}

parian_result parian_renderer_set_values(parian_renderer *renderer, const float (*value)[3])
{
    if (!renderer || !value) {
        return PARIAN_E_ARGUMENT;
    }
    parian_result result = PARIAN_OK;
    renderer->has_values = false;
    for (uint32_t b = 0; b < renderer->scene->data.body_count && result == PARIAN_OK; b++) {
        result = renderer->backend->set_values(renderer, b, value);
        value += renderer->scene->data.bodies[b].texel_count;
    }
    renderer->has_values = result == PARIAN_OK;
    return result;
}

parian_result parian_renderer_relight(parian_renderer *renderer)
{
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    if (!renderer->lights_changed) {
        return PARIAN_OK;
    }
    parian_result result = renderer->backend->relight(renderer);
    if (result == PARIAN_OK) {
        renderer->lights_changed = false;
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
        !isfinite(desc->exposure_ev) || fabsf(desc->exposure_ev) > 100.0f) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "camera matrices must be finite and the exposure within 100 stops");
    }
    if (renderer->settings.view == PARIAN_VIEW_VALUES && !renderer->has_values) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT, "there are no values to paint");
    }
    parian_result result = parian_renderer_relight(renderer);
    if (result == PARIAN_OK) {
        result = renderer->backend->draw(renderer, desc);
    }
    if (result == PARIAN_OK) {
        renderer->picture_width = desc->width;
        renderer->picture_height = desc->height;
    }
    return result;
}

parian_result parian_renderer_read_picture(parian_renderer *renderer, float (*radiance)[4],
                                           uint8_t (*srgb)[4])
{
    if (!renderer) {
        return PARIAN_E_ARGUMENT;
    }
    if (!renderer->picture_width) {
        return parian_fail(&renderer->env, PARIAN_E_ARGUMENT,
                           "there is no picture before the first draw");
    }
    return renderer->backend->read_picture(renderer, radiance, srgb);
}

static void copy_surface(const parian_body *body, const parian_texel_arrays *arrays, size_t first)
{
    size_t count = body->texel_count;
    if (arrays->position) {
        memcpy(arrays->position + first, body->texel_position, count * sizeof *arrays->position);
    }
    if (arrays->normal) {
        memcpy(arrays->normal + first, body->texel_normal, count * sizeof *arrays->normal);
    }
    if (arrays->area) {
        memcpy(arrays->area + first, body->texel_area, count * sizeof *arrays->area);
    }
    for (size_t t = 0; arrays->place && t < count; t++) {
        arrays->place[first + t][0] = body->texel_index[t] % body->atlas_size;
        arrays->place[first + t][1] = body->texel_index[t] / body->atlas_size;
    }
}

/* local, global and their sum, each where asked for. */
static parian_result read_radiosity(parian_renderer *renderer, uint32_t b,
                                    const parian_texel_arrays *arrays, size_t first)
{
    const parian_backend_table *backend = renderer->backend;
    size_t count = renderer->scene->data.bodies[b].texel_count;
    float(*local)[3] = NULL, (*global)[3] = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (!PARIAN_NEW(&renderer->env, local, count) || !PARIAN_NEW(&renderer->env, global, count)) {
        parian_fail(&renderer->env, result, "no memory for the radiosity of %zu texels", count);
        goto done;
    }
    result = backend->read_texels(renderer, b, PARIAN_RESULT_LOCAL, local);
    if (result == PARIAN_OK) {
        result = backend->read_texels(renderer, b, PARIAN_RESULT_GLOBAL, global);
    }
    for (size_t t = 0; result == PARIAN_OK && t < count; t++) {
        for (int c = 0; c < 3; c++) {
            if (arrays->radiosity) {
                arrays->radiosity[first + t][c] = local[t][c] + global[t][c];
            }
            if (arrays->radiosity_local) {
                arrays->radiosity_local[first + t][c] = local[t][c];
            }
            if (arrays->radiosity_global) {
                arrays->radiosity_global[first + t][c] = global[t][c];
            }
        }
    }
done:
    parian_free(&renderer->env, local);
    parian_free(&renderer->env, global);
    return result;
}

parian_result parian_renderer_read_texels(parian_renderer *renderer,
                                          const parian_texel_arrays *arrays)
{
    if (!renderer || !arrays) {
        return PARIAN_E_ARGUMENT;
    }
    size_t first = 0;
    const bool lit = arrays->irradiance || arrays->radiosity || arrays->radiosity_local ||
                     arrays->radiosity_global;
    parian_result result = lit ? parian_renderer_relight(renderer) : PARIAN_OK;
    for (uint32_t b = 0; result == PARIAN_OK && b < renderer->scene->data.body_count; b++) {
        const parian_body *body = &renderer->scene->data.bodies[b];
        copy_surface(body, arrays, first);
        if (arrays->irradiance) {
            result = renderer->backend->read_texels(renderer, b, PARIAN_RESULT_IRRADIANCE,
                                                    arrays->irradiance + first);
        }
        if (result == PARIAN_OK &&
            (arrays->radiosity || arrays->radiosity_local || arrays->radiosity_global)) {
            result = read_radiosity(renderer, b, arrays, first);
        }
        first += body->texel_count;
    }
    return result;
}

parian_result parian_renderer_read_register(parian_renderer *renderer, uint32_t body,
                                            uint32_t index, float (*value)[3])
{
    parian_result result = parian_renderer_relight(renderer);
    return result == PARIAN_OK ? renderer->backend->read_register(renderer, body, index, value)
                               : result;
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
