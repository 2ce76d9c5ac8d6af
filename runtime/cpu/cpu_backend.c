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
#include "cpu/cpu_irradiance.h"
#include "cpu/cpu_shade.h"
#include "cpu/cpu_tone.h"
#include "cpu/cpu_transfer.h"
#include "method/atlas_fill.h"
#include "renderer_internal.h"

enum { REGISTER_MAX = 2 * PARIAN_MAX_OPERATORS };

/* What all instances of a body share. */
typedef struct cpu_body {
    parian_kernels kernels;
    parian_restriction restriction;
    parian_edited_body edited; /* empty unless another medium than the baked one is in force */
    float (*normal)[4], (*albedo)[4], (*values)[4]; /* atlases, or NULL */
} cpu_body;

/* What a body of one instance has of its own: the light on it and in it. */
typedef struct cpu_lit {
    uint32_t register_count;
    float (*registers[REGISTER_MAX])[3];
    float (*irradiance)[3], (*local)[3], (*global)[3]; /* [texel_count] */
} cpu_lit;

typedef struct cpu_state {
    cpu_body *body; /* [body_count] */
    cpu_lit *lit;   /* [lit_count * body_count] bodies of an instance one after the other */
    parian_shade_atlas *atlas; /* the same count; normal, albedo and values belong to the body */
    uint32_t lit_count;        /* instances that there is room for */
    parian_cpu_lights lights;
    float (*picture)[4];
    uint8_t (*srgb)[4];
} cpu_state;

static void destroy_body(const parian_env *env, cpu_body *made)
{
    parian_kernels_free(env, &made->kernels);
    parian_restriction_free(env, &made->restriction);
    parian_edited_body_free(env, &made->edited);
    parian_free(env, made->normal);
    parian_free(env, made->albedo);
    parian_free(env, made->values);
}

static void destroy_lit(const parian_env *env, cpu_lit *lit, parian_shade_atlas *atlas)
{
    for (uint32_t r = 0; r < REGISTER_MAX; r++) {
        parian_free(env, lit->registers[r]);
    }
    parian_free(env, lit->irradiance);
    parian_free(env, lit->local);
    parian_free(env, lit->global);
    parian_free(env, atlas->irradiance);
    parian_free(env, atlas->local);
    parian_free(env, atlas->global);
    *lit = (cpu_lit){0};
    *atlas = (parian_shade_atlas){0};
}

static void cpu_destroy(parian_renderer *renderer)
{
    const parian_env *env = &renderer->env;
    cpu_state *state = renderer->state;
    if (!state) {
        return;
    }
    for (uint32_t i = 0; i < state->lit_count * renderer->scene->data.body_count; i++) {
        destroy_lit(env, &state->lit[i], &state->atlas[i]);
    }
    for (uint32_t b = 0; state->body && b < renderer->scene->data.body_count; b++) {
        destroy_body(env, &state->body[b]);
    }
    parian_free(env, state->body);
    parian_free(env, state->lit);
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
    parian_atlas_fill(body, value, 0, (uint64_t)body->atlas_size * body->atlas_size, *atlas);
    return true;
}

static parian_result create_body(const parian_env *env, const parian_body *body, cpu_body *made)
{
    parian_result result = parian_kernels_build(env, body, &made->kernels);
    if (result == PARIAN_OK) {
        result = parian_restriction_build(env, body, &made->restriction);
    }
    if (result == PARIAN_OK &&
        (!fill_static(env, body, (const float(*)[3])body->texel_normal_map, &made->normal) ||
         !fill_static(env, body, (const float(*)[3])body->texel_albedo, &made->albedo))) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for an atlas of %u texels a side",
                             body->atlas_size);
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
    if (!PARIAN_NEW0(env, state->body, data->body_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u bodies", data->body_count);
    }
    parian_result result = PARIAN_OK;
    for (uint32_t b = 0; result == PARIAN_OK && b < data->body_count; b++) {
        result = create_body(env, &data->bodies[b], &state->body[b]);
    }
    return result;
}

/* ---- instances ---- */

static parian_result create_lit(const parian_env *env, const parian_body *body,
                                const cpu_body *shared, cpu_lit *lit, parian_shade_atlas *atlas)
{
    const size_t area = (size_t)body->atlas_size * body->atlas_size;
    bool room = PARIAN_NEW0(env, lit->irradiance, body->texel_count) &&
                PARIAN_NEW0(env, lit->local, body->texel_count) &&
                PARIAN_NEW0(env, lit->global, body->texel_count) &&
                PARIAN_NEW0(env, atlas->irradiance, area) && PARIAN_NEW0(env, atlas->local, area) &&
                PARIAN_NEW0(env, atlas->global, area);
    atlas->normal = shared->normal;
    atlas->albedo = shared->albedo;
    atlas->values = shared->values;
    lit->register_count = parian_body_register_count(body);
    for (uint32_t r = 0; room && r < lit->register_count; r++) {
        room = PARIAN_NEW0(env, lit->registers[r], parian_body_register_size(body, r));
    }
    return room ? PARIAN_OK
                : parian_fail(env, PARIAN_E_NOMEM, "no memory to light a body of %u texels",
                              body->texel_count);
}

static void shrink(const parian_env *env, cpu_state *state, uint32_t instance_count,
                   uint32_t body_count)
{
    for (uint32_t i = instance_count * body_count; i < state->lit_count * body_count; i++) {
        destroy_lit(env, &state->lit[i], &state->atlas[i]);
    }
    state->lit_count = instance_count;
}

/* Longer arrays: what is there moves over. */
static parian_result lengthen(const parian_env *env, cpu_state *state, uint32_t instance_count,
                              uint32_t body_count)
{
    cpu_lit *lit = NULL;
    parian_shade_atlas *atlas = NULL;
    if (!PARIAN_NEW0(env, lit, (size_t)instance_count * body_count) ||
        !PARIAN_NEW0(env, atlas, (size_t)instance_count * body_count)) {
        parian_free(env, lit);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u instances", instance_count);
    }
    for (uint32_t i = 0; i < state->lit_count * body_count; i++) {
        lit[i] = state->lit[i];
        atlas[i] = state->atlas[i];
    }
    parian_free(env, state->lit);
    parian_free(env, state->atlas);
    state->lit = lit;
    state->atlas = atlas;
    return PARIAN_OK;
}

static parian_result cpu_resize(parian_renderer *renderer, uint32_t instance_count)
{
    const parian_env *env = &renderer->env;
    const parian_scene_data *data = &renderer->scene->data;
    cpu_state *state = renderer->state;
    const uint32_t bodies = data->body_count, before = state->lit_count;
    if (instance_count <= before) {
        shrink(env, state, instance_count, bodies);
        return PARIAN_OK;
    }
    parian_result result = lengthen(env, state, instance_count, bodies);
    if (result != PARIAN_OK) {
        return result;
    }
    state->lit_count = instance_count;
    for (uint32_t i = before * bodies; result == PARIAN_OK && i < instance_count * bodies; i++) {
        result = create_lit(env, &data->bodies[i % bodies], &state->body[i % bodies],
                            &state->lit[i], &state->atlas[i]);
    }
    if (result != PARIAN_OK) {
        shrink(env, state, before, bodies);
    }
    return result;
}

/* ---- relighting, a pass at a time over all bodies of all instances ---- */

/* One body of one instance, on which a pass works. */
typedef struct pass_body {
    const parian_body *data;
    const cpu_body *shared;
    cpu_lit *lit;
    parian_shade_atlas *atlas;
} pass_body;

static void run_restrict(parian_renderer *renderer, const pass_body *one)
{
    parian_cpu_restrict(&renderer->env, &one->shared->restriction,
                        (const float(*)[3])one->lit->irradiance, one->lit->registers[0],
                        one->lit->registers[1]);
}

static void run_product(parian_renderer *renderer, const pass_body *one)
{
    cpu_lit *lit = one->lit;
    for (uint32_t r = 2; r < lit->register_count; r++) {
        memset(lit->registers[r], 0,
               parian_body_register_size(one->data, r) * sizeof *lit->registers[r]);
    }
    for (uint32_t o = 0; o < one->data->operator_count; o++) {
        const parian_operator *op = &one->data->operators[o];
        parian_operator_apply(&renderer->env, op,
                              (const float(*)[3])lit->registers[op->source_register],
                              lit->registers[op->target_register], true);
    }
}

static void run_filter(parian_renderer *renderer, const pass_body *one)
{
    parian_cpu_filter(&renderer->env, one->data, &one->shared->kernels,
                      (const float(*)[3])one->lit->irradiance,
                      (const float(*)[3])one->lit->registers[1], one->lit->local, one->lit->global);
}

static void run_gutter(parian_renderer *renderer, const pass_body *one)
{
    const uint64_t area = (uint64_t)one->data->atlas_size * one->data->atlas_size;
    (void)renderer;
    parian_atlas_fill(one->data, (const float(*)[3])one->lit->irradiance, 0, area,
                      one->atlas->irradiance);
    parian_atlas_fill(one->data, (const float(*)[3])one->lit->local, 0, area, one->atlas->local);
    parian_atlas_fill(one->data, (const float(*)[3])one->lit->global, 0, area, one->atlas->global);
}

/* A body with the factors that are in force. */
static const parian_body *body_now(const parian_renderer *renderer, uint32_t b)
{
    const cpu_body *made = &((const cpu_state *)renderer->state)->body[b];
    return made->edited.owned ? &made->edited.body : &renderer->scene->data.bodies[b];
}

static void run_all(parian_renderer *renderer, void (*run)(parian_renderer *, const pass_body *))
{
    cpu_state *state = renderer->state;
    const uint32_t count = renderer->scene->data.body_count;
    for (uint32_t i = 0; i < renderer->instance_count * count; i++) {
        const uint32_t b = i % count;
        const pass_body one = {body_now(renderer, b), &state->body[b], &state->lit[i],
                               &state->atlas[i]};
        run(renderer, &one);
    }
}

static parian_result run_shadow(parian_renderer *renderer)
{
    cpu_state *state = renderer->state;
    state->lights.list = &renderer->lights;
    state->lights.lift = parian_renderer_shadow_lift(renderer, 1.0f);
    parian_renderer_begin_pass(renderer);
    parian_result result =
        parian_cpu_shadow(&renderer->env, &renderer->scene->data, renderer->instances,
                          renderer->instance_count, &state->lights);
    if (result == PARIAN_OK) {
        parian_renderer_end_pass(renderer, PARIAN_PASS_SHADOW);
    }
    return result;
}

/* E under the samples of a set, into the mean of the sets before. */
static void run_irradiance(parian_renderer *renderer, const parian_light_sample *sample,
                           uint32_t set)
{
    cpu_state *state = renderer->state;
    const parian_scene_data *data = &renderer->scene->data;
    parian_irradiance_desc desc = {
        .list = &renderer->lights,
        .sample = sample,
        .casters = {&renderer->tree, renderer->caster, renderer->caster_count},
        .own_count = data->body_count,
        .share = 1.0f / (float)(set + 1)};
    parian_renderer_begin_pass(renderer);
    for (uint32_t b = 0; b < data->body_count; b++) {
        desc.body = &data->bodies[b];
        desc.origin = parian_renderer_origins(renderer, b, set);
        desc.eta = renderer->optics[b].eta;
        desc.relief_reach = renderer->relief_reach[b];
        for (uint32_t i = 0; i < renderer->instance_count; i++) {
            desc.at = &renderer->instances[i];
            desc.own_first = i * data->body_count;
            parian_cpu_irradiance(&renderer->env, &desc,
                                  state->lit[i * data->body_count + b].irradiance);
        }
    }
    parian_renderer_end_pass(renderer, PARIAN_PASS_IRRADIANCE);
}

/* What follows from E, from a pass on. */
static void run_transfer(parian_renderer *renderer, parian_pass from)
{
    static void (*const passes[])(parian_renderer *, const pass_body *) = {
        run_restrict, run_product, run_filter, run_gutter};
    for (parian_pass p = from > PARIAN_PASS_RESTRICT ? from : PARIAN_PASS_RESTRICT;
         p <= PARIAN_PASS_GUTTER; p++) {
        parian_renderer_begin_pass(renderer);
        run_all(renderer, passes[p - PARIAN_PASS_RESTRICT]);
        parian_renderer_end_pass(renderer, p);
    }
}

static parian_result cpu_relight(parian_renderer *renderer, parian_pass from)
{
    parian_result result = from == PARIAN_PASS_SHADOW ? run_shadow(renderer) : PARIAN_OK;
    if (result != PARIAN_OK) {
        return result;
    }
    if (from <= PARIAN_PASS_IRRADIANCE) {
        run_irradiance(renderer, renderer->lights.sample, 0);
    }
    run_transfer(renderer, from);
    return PARIAN_OK;
}

static parian_result cpu_refine(parian_renderer *renderer, uint32_t set)
{
    run_irradiance(renderer, renderer->varied, set);
    run_transfer(renderer, PARIAN_PASS_RESTRICT);
    return PARIAN_OK;
}

/* ---- medium ---- */

static parian_result cpu_edit(parian_renderer *renderer, uint32_t body, parian_edited_body *edited)
{
    const parian_env *env = &renderer->env;
    cpu_body *made = &((cpu_state *)renderer->state)->body[body];
    parian_restriction restriction;
    parian_result result = parian_restriction_build(env, &edited->body, &restriction);
    if (result != PARIAN_OK) {
        return result;
    }
    parian_restriction_free(env, &made->restriction);
    parian_kernels_free(env, &made->kernels);
    parian_edited_body_free(env, &made->edited);
    made->restriction = restriction;
    made->kernels = edited->kernels;
    made->edited = *edited;
    memset(&made->edited.kernels, 0, sizeof made->edited.kernels);
    memset(edited, 0, sizeof *edited);
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
                               .instances = renderer->instances,
                               .instance_count = renderer->instance_count,
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

static parian_result prepare_picture(const parian_env *env, cpu_state *state, uint32_t width,
                                     uint32_t height)
{
    const size_t count = (size_t)width * height;
    parian_free(env, state->picture);
    parian_free(env, state->srgb);
    state->srgb = NULL;
    if (!PARIAN_NEW(env, state->picture, count) || !PARIAN_NEW(env, state->srgb, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a picture of %u x %u pixels", width,
                           height);
    }
    return PARIAN_OK;
}

static parian_result cpu_draw(parian_renderer *renderer, const parian_draw_desc *desc, bool shade)
{
    cpu_state *state = renderer->state;
    const size_t count = (size_t)desc->width * desc->height;
    if (shade) {
        parian_result result = prepare_picture(&renderer->env, state, desc->width, desc->height);
        parian_renderer_begin_pass(renderer);
        if (result == PARIAN_OK) {
            result = shade_picture(renderer, desc);
        }
        if (result != PARIAN_OK) {
            return result;
        }
        parian_renderer_end_pass(renderer, PARIAN_PASS_SHADE);
    }
    parian_renderer_begin_pass(renderer);
    const float(*picture)[4] = (const float(*)[4])state->picture;
    bool plain = parian_view_is_plain(renderer->settings.view);
    float exposure = desc->exposure_auto ? parian_cpu_exposure(picture, count) : 1.0f;
    parian_cpu_tone(picture, count, exposure * exp2f(desc->exposure_ev), desc->tone, plain,
                    state->srgb);
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

static parian_result cpu_read_texels(parian_renderer *renderer, uint32_t instance, uint32_t body,
                                     parian_texel_result which, float (*value)[3])
{
    const uint32_t lit = instance * renderer->scene->data.body_count + body;
    const cpu_lit *made = &((const cpu_state *)renderer->state)->lit[lit];
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
    if (!made->values && !PARIAN_NEW(&renderer->env, made->values, count)) {
        return parian_fail(&renderer->env, PARIAN_E_NOMEM, "no memory for the values of %u texels",
                           data->texel_count);
    }
    parian_atlas_fill(data, value, 0, count, made->values);
    for (uint32_t i = 0; i < state->lit_count; i++) {
        state->atlas[i * renderer->scene->data.body_count + body].values = made->values;
    }
    return PARIAN_OK;
}

static parian_result cpu_read_register(parian_renderer *renderer, uint32_t body, uint32_t index,
                                       float (*value)[3])
{
    const cpu_lit *made = &((const cpu_state *)renderer->state)->lit[body];
    uint32_t size = parian_body_register_size(&renderer->scene->data.bodies[body], index);
    memcpy(value, made->registers[index], size * sizeof *value);
    return PARIAN_OK;
}

static parian_memory cpu_memory(const parian_renderer *renderer)
{
    (void)renderer;
    return (parian_memory){.total = 0}; /* no GL memory */
}

const parian_backend_table parian_cpu_backend = {
    .create = cpu_create,
    .destroy = cpu_destroy,
    .resize = cpu_resize,
    .relight = cpu_relight,
    .edit = cpu_edit,
    .refine = cpu_refine,
    .draw = cpu_draw,
    .read_picture = cpu_read_picture,
    .read_texels = cpu_read_texels,
    .set_values = cpu_set_values,
    .read_register = cpu_read_register,
    .memory = cpu_memory,
};
