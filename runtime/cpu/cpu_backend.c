/* cpu_backend.c - the C evaluation of a renderer: lights to E to B to pictures without a GPU.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/kernel.h"
#include "core/memory.h"
#include "core/operator.h"
#include "cpu/cpu_lights.h"
#include "cpu/cpu_shade.h"
#include "cpu/cpu_tone.h"
#include "cpu/cpu_transfer.h"
#include "method/atlas_fill.h"
#include "renderer_internal.h"

enum { REGISTER_MAX = 2 * PARIAN_MAX_OPERATORS };

typedef struct cpu_body {
    parian_kernels kernels;
    parian_restriction restriction;
    uint32_t register_count;
    float (*registers[REGISTER_MAX])[3];
    float (*irradiance)[3], (*local)[3], (*global)[3]; /* [texel_count] */
    parian_shade_atlas atlas;
} cpu_body;

typedef struct cpu_state {
    cpu_body *body;            /* [body_count] */
    parian_shade_atlas *atlas; /* [body_count] the same pointers, as shading takes them */
    parian_cpu_lights lights;
    float (*picture)[4];
    uint8_t (*srgb)[4];
} cpu_state;

static void destroy_body(const parian_env *env, cpu_body *made)
{
    parian_kernels_free(env, &made->kernels);
    parian_restriction_free(env, &made->restriction);
    for (uint32_t r = 0; r < REGISTER_MAX; r++) {
        parian_free(env, made->registers[r]);
    }
    parian_free(env, made->irradiance);
    parian_free(env, made->local);
    parian_free(env, made->global);
    parian_free(env, made->atlas.irradiance);
    parian_free(env, made->atlas.local);
    parian_free(env, made->atlas.global);
    parian_free(env, made->atlas.normal);
    parian_free(env, made->atlas.albedo);
    parian_free(env, made->atlas.values);
}

static void cpu_destroy(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    cpu_state *state = renderer->state;
    if (!state) {
        return;
    }
    for (uint32_t b = 0; state->body && b < renderer->scene->data.body_count; b++) {
        destroy_body(env, &state->body[b]);
    }
    parian_free(env, state->body);
    parian_free(env, state->atlas);
    parian_free(env, state->lights.depth);
    parian_free(env, state->picture);
    parian_free(env, state->srgb);
    parian_free(env, state);
    renderer->state = NULL;
}

/* An atlas that does not change: filled once where the body has the values. */
static bool fill_static(const parian_env *env, const parian_body *body, const float (*value)[3],
                        float (**atlas)[4])
{
    if (!value) {
        return true;
    }
    if (!PARIAN_NEW(env, *atlas, (size_t)body->atlas_size * body->atlas_size)) {
        return false;
    }
    parian_atlas_fill(body, value, *atlas);
    return true;
}

static bool allocate_body(const parian_env *env, const parian_body *body, cpu_body *made)
{
    size_t atlas = (size_t)body->atlas_size * body->atlas_size;
    made->register_count = parian_body_register_count(body);
    for (uint32_t r = 0; r < made->register_count; r++) {
        if (!PARIAN_NEW0(env, made->registers[r], parian_body_register_size(body, r))) {
            return false;
        }
    }
    return PARIAN_NEW0(env, made->irradiance, body->texel_count) &&
           PARIAN_NEW0(env, made->local, body->texel_count) &&
           PARIAN_NEW0(env, made->global, body->texel_count) &&
           PARIAN_NEW0(env, made->atlas.irradiance, atlas) &&
           PARIAN_NEW0(env, made->atlas.local, atlas) &&
           PARIAN_NEW0(env, made->atlas.global, atlas) &&
           fill_static(env, body, (const float(*)[3])body->texel_normal_map, &made->atlas.normal) &&
           fill_static(env, body, (const float(*)[3])body->texel_albedo, &made->atlas.albedo);
}

static parian_result create_body(const parian_env *env, const parian_body *body, cpu_body *made)
{
    parian_result result = parian_kernels_build(env, body, &made->kernels);
    if (result == PARIAN_OK) {
        result = parian_restriction_build(env, body, &made->restriction);
    }
    if (result == PARIAN_OK && !allocate_body(env, body, made)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory to light a body of %u texels",
                             body->texel_count);
    }
    return result;
}

static parian_result cpu_create(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    const parian_scene_data *data = &renderer->scene->data;
    cpu_state *state;
    snprintf(renderer->name, sizeof renderer->name, "C evaluation");
    if (!PARIAN_NEW0(env, state, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a renderer");
    }
    renderer->state = state;
    if (!PARIAN_NEW0(env, state->body, data->body_count) ||
        !PARIAN_NEW0(env, state->atlas, data->body_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", data->body_count);
    }
    for (uint32_t b = 0; b < data->body_count; b++) {
        parian_result result = create_body(env, &data->bodies[b], &state->body[b]);
        if (result != PARIAN_OK) {
            return result;
        }
        state->atlas[b] = state->body[b].atlas;
    }
    return PARIAN_OK;
}

/* ---- relighting, a pass at a time over all bodies ---- */

static void run_irradiance(parian_renderer *renderer, cpu_state *state)
{
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        const parian_body_optics *optics = &renderer->optics[b];
        parian_cpu_irradiance(&renderer->env, &state->lights, &renderer->scene->data.bodies[b],
                              optics->eta, optics->zonal_transmit, state->body[b].irradiance);
    }
}

static void run_restrict(parian_renderer *renderer, cpu_state *state)
{
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        cpu_body *body = &state->body[b];
        parian_cpu_restrict(&renderer->env, &body->restriction, (const float(*)[3])body->irradiance,
                            body->registers[0], body->registers[1]);
    }
}

static void run_product(parian_renderer *renderer, cpu_state *state)
{
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        const parian_body *data = &renderer->scene->data.bodies[b];
        cpu_body *body = &state->body[b];
        for (uint32_t r = 2; r < body->register_count; r++) {
            memset(body->registers[r], 0,
                   parian_body_register_size(data, r) * sizeof *body->registers[r]);
        }
        for (uint32_t o = 0; o < data->operator_count; o++) {
            const parian_operator *op = &data->operators[o];
            parian_operator_apply(&renderer->env, op,
                                  (const float(*)[3])body->registers[op->source_register],
                                  body->registers[op->target_register], true);
        }
    }
}

static void run_filter(parian_renderer *renderer, cpu_state *state)
{
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        cpu_body *body = &state->body[b];
        parian_cpu_filter(&renderer->env, &renderer->scene->data.bodies[b], &body->kernels,
                          (const float(*)[3])body->irradiance,
                          (const float(*)[3])body->registers[1], body->local, body->global);
    }
}

static void run_gutter(parian_renderer *renderer, cpu_state *state)
{
    for (uint32_t b = 0; b < renderer->scene->data.body_count; b++) {
        const parian_body *data = &renderer->scene->data.bodies[b];
        cpu_body *body = &state->body[b];
        parian_atlas_fill(data, (const float(*)[3])body->irradiance, body->atlas.irradiance);
        parian_atlas_fill(data, (const float(*)[3])body->local, body->atlas.local);
        parian_atlas_fill(data, (const float(*)[3])body->global, body->atlas.global);
    }
}

static parian_result cpu_relight(parian_renderer *renderer)
{
    static void (*const passes[])(parian_renderer *, cpu_state *) = {
        run_irradiance, run_restrict, run_product, run_filter, run_gutter};
    cpu_state *state = renderer->state;
    state->lights.list = &renderer->lights;
    state->lights.lift = parian_renderer_shadow_lift(renderer);
    parian_renderer_begin_pass(renderer);
    parian_result result =
        parian_cpu_shadow(&renderer->env, &renderer->scene->data, &state->lights);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_renderer_end_pass(renderer, PARIAN_PASS_SHADOW);
    for (int p = 0; p < 5; p++) {
        parian_renderer_begin_pass(renderer);
        passes[p](renderer, state);
        parian_renderer_end_pass(renderer, (parian_pass)(PARIAN_PASS_IRRADIANCE + p));
    }
    return PARIAN_OK;
}

/* ---- pictures ---- */

static parian_result shade_picture(parian_renderer *renderer, const parian_draw_desc *desc)
{
    cpu_state *state = renderer->state;
    const parian_env *env = &renderer->env;
    uint32_t side = parian_view_supersampling(desc->width, desc->height, 16384);
    parian_view view = parian_view_make(&desc->camera);
    float(*samples)[4];
    if (!PARIAN_NEW(env, samples, (size_t)desc->width * side * desc->height * side)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u pixels",
                           desc->width, desc->height);
    }
    parian_shade_desc shade = {.scene = &renderer->scene->data,
                               .optics = renderer->optics,
                               .atlas = state->atlas,
                               .lights = &state->lights,
                               .settings = &renderer->settings,
                               .view = &view,
                               .width = desc->width * side,
                               .height = desc->height * side};
    parian_result result = parian_cpu_shade(env, &shade, samples);
    if (result == PARIAN_OK) {
        parian_cpu_resolve((const float(*)[4])samples, desc->width, desc->height, side,
                           state->picture);
    }
    parian_free(env, samples);
    return result;
}

static parian_result cpu_draw(parian_renderer *renderer, const parian_draw_desc *desc)
{
    cpu_state *state = renderer->state;
    const parian_env *env = &renderer->env;
    size_t count = (size_t)desc->width * desc->height;
    renderer->picture_width = 0;
    parian_free(env, state->picture);
    parian_free(env, state->srgb);
    state->srgb = NULL;
    if (!PARIAN_NEW(env, state->picture, count) || !PARIAN_NEW(env, state->srgb, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u pixels",
                           desc->width, desc->height);
    }
    parian_renderer_begin_pass(renderer);
    parian_result result = shade_picture(renderer, desc);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_renderer_end_pass(renderer, PARIAN_PASS_SHADE);
    parian_renderer_begin_pass(renderer);
    const float(*picture)[4] = (const float(*)[4])state->picture;
    bool plain = parian_view_is_plain(renderer->settings.view);
    float exposure = desc->exposure_auto ? parian_cpu_exposure(picture, count) : 1.0f;
    parian_cpu_tone(picture, count, exposure * exp2f(desc->exposure_ev), plain, state->srgb);
    parian_renderer_end_pass(renderer, PARIAN_PASS_TONE);
    return PARIAN_OK;
}

static parian_result cpu_read_picture(parian_renderer *renderer, float (*radiance)[4],
                                      uint8_t (*srgb)[4])
{
    const cpu_state *state = renderer->state;
    size_t count = (size_t)renderer->picture_width * renderer->picture_height;
    if (radiance) {
        memcpy(radiance, state->picture, count * sizeof *radiance);
    }
    if (srgb) {
        memcpy(srgb, state->srgb, count * sizeof *srgb);
    }
    return PARIAN_OK;
}

/* ---- arrays ---- */

static parian_result cpu_read_texels(parian_renderer *renderer, uint32_t body,
                                     parian_texel_result which, float (*value)[3])
{
    const cpu_body *made = &((const cpu_state *)renderer->state)->body[body];
    const float(*from)[3] = (const float(*)[3])(which == PARIAN_RESULT_IRRADIANCE ? made->irradiance
                                                : which == PARIAN_RESULT_LOCAL    ? made->local
                                                                                  : made->global);
    memcpy(value, from, renderer->scene->data.bodies[body].texel_count * sizeof *value);
    return PARIAN_OK;
}

static parian_result cpu_set_values(parian_renderer *renderer, uint32_t body,
                                    const float (*value)[3])
{
    cpu_state *state = renderer->state;
    cpu_body *made = &state->body[body];
    const parian_body *data = &renderer->scene->data.bodies[body];
    const size_t count = (size_t)data->atlas_size * data->atlas_size;
    if (!made->atlas.values && !PARIAN_NEW(&renderer->env, made->atlas.values, count)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for the values of %u texels",
                           data->texel_count);
    }
    parian_atlas_fill(data, value, made->atlas.values);
    state->atlas[body].values = made->atlas.values;
    return PARIAN_OK;
}

static parian_result cpu_read_register(parian_renderer *renderer, uint32_t body, uint32_t index,
                                       float (*value)[3])
{
    const cpu_body *made = &((const cpu_state *)renderer->state)->body[body];
    uint32_t size = parian_body_register_size(&renderer->scene->data.bodies[body], index);
    memcpy(value, made->registers[index], size * sizeof *value);
    return PARIAN_OK;
}

static uint64_t cpu_memory(const parian_renderer *renderer)
{
    (void)renderer;
    return 0; /* no GL memory */
}

const parian_backend_table parian_cpu_backend = {
    cpu_create,      cpu_destroy,    cpu_relight,       cpu_draw,   cpu_read_picture,
    cpu_read_texels, cpu_set_values, cpu_read_register, cpu_memory,
};
