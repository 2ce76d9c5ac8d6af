/* gl_body.c - plans the upload of a body: atlases, restriction lists, kernels, operators.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_body.h"

#include <string.h>

#include "core/memory.h"
#include "lights/relief.h"
#include "method/atlas_fill.h"
#include "method/ray_origins.h"

/* ---- atlases, element by element ---- */

static void copy_positions(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    float(*atlas)[4] = to;
    memset(atlas, 0, count * sizeof *atlas);
    for (uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
         t < body->texel_count && body->texel_index[t] < first + count; t++) {
        float *at = atlas[body->texel_index[t] - first];
        memcpy(at, body->texel_position[t], sizeof body->texel_position[0]);
        at[3] = body->texel_area[t];
    }
}

static void copy_normals(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    float(*atlas)[4] = to;
    memset(atlas, 0, count * sizeof *atlas);
    for (uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
         t < body->texel_count && body->texel_index[t] < first + count; t++) {
        float *at = atlas[body->texel_index[t] - first];
        memcpy(at, parian_body_lit_normal(body, t), 3 * sizeof(float));
        at[3] = parian_relief_of_texel(body, t);
    }
}

static void copy_barycentrics(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    float(*atlas)[2] = to;
    memset(atlas, 0, count * sizeof *atlas);
    for (uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
         t < body->texel_count && body->texel_index[t] < first + count; t++) {
        memcpy(atlas[body->texel_index[t] - first], body->texel_barycentric[t], sizeof atlas[0]);
    }
}

/* Three vertices and the ordinal among interior or border texels; the ordinal of a gutter texel. */
static void copy_info(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    uint32_t(*info)[4] = to;
    uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
    uint32_t interior = t - parian_find_first(body->border_texel, body->border_count, t);
    memset(info, 0xFF, count * sizeof *info);
    for (; t < body->texel_count && body->texel_index[t] < first + count; t++) {
        uint32_t *at = info[body->texel_index[t] - first];
        memcpy(at, body->triangle[body->texel_triangle[t]], sizeof body->triangle[0]);
        bool border = body->texel_border[t] != PARIAN_NO_BORDER;
        at[3] = border ? 0x80000000u | body->texel_border[t] : interior++;
    }
    for (uint32_t g = parian_find_first(body->gutter_index, body->gutter_count, first);
         g < body->gutter_count && body->gutter_index[g] < first + count; g++) {
        info[body->gutter_index[g] - first][1] = g;
    }
}

static void copy_normal_map(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    parian_atlas_fill(body, (const float(*)[3])body->texel_normal_map, first, count, to);
}

static void copy_albedo(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    parian_atlas_fill(body, (const float(*)[3])body->texel_albedo, first, count, to);
}

static void plan_atlas(gl_upload_list *list, const parian_body *body, gl_format format,
                       gl_array_source source, gl_texture *texture)
{
    uint64_t area = (uint64_t)body->atlas_size * body->atlas_size;
    *texture = gl_texture_describe(format, body->atlas_size, body->atlas_size);
    gl_upload_texture(list, PARIAN_MEMORY_ATLAS, texture, area, source, body);
}

static void plan_atlases(gl_upload_list *list, const parian_body *body, gl_body *made)
{
    plan_atlas(list, body, GL_FORMAT_RGBA32F, copy_positions, &made->position);
    plan_atlas(list, body, GL_FORMAT_RGBA32F, copy_normals, &made->normal);
    plan_atlas(list, body, GL_FORMAT_RG32F, copy_barycentrics, &made->barycentric);
    plan_atlas(list, body, GL_FORMAT_RGBA32UI, copy_info, &made->info);
    if (body->texel_normal_map) {
        plan_atlas(list, body, GL_FORMAT_RGBA32F, copy_normal_map, &made->normal_map);
    }
    if (body->texel_albedo) {
        plan_atlas(list, body, GL_FORMAT_RGBA32F, copy_albedo, &made->albedo);
    }
}

/* ---- starts of rays ---- */

static parian_result make_origins(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    if (!PARIAN_NEW(env, source->origin, source->body->texel_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the rays of %u texels",
                           source->body->texel_count);
    }
    parian_ray_origins(env, source->body, NULL, 0, source->origin);
    return PARIAN_OK;
}

static void drop_origins(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    parian_free(env, source->origin);
    source->origin = NULL;
}

static void copy_origins(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    const parian_body *body = source->body;
    float(*atlas)[4] = to;
    memset(atlas, 0, count * sizeof *atlas);
    for (uint32_t t = parian_find_first(body->texel_index, body->texel_count, first);
         t < body->texel_count && body->texel_index[t] < first + count; t++) {
        memcpy(atlas[body->texel_index[t] - first], source->origin[t], sizeof source->origin[0]);
    }
}

static void plan_origins(gl_upload_list *list, gl_body_source *source, gl_body *made)
{
    const gl_preparation origins = {make_origins, drop_origins, source};
    uint32_t side = source->body->atlas_size;
    made->origin = gl_texture_describe(GL_FORMAT_RGBA32F, side, side);
    gl_upload_prepare_begin(list, origins);
    gl_upload_texture(list, PARIAN_MEMORY_ATLAS, &made->origin, (uint64_t)side * side, copy_origins,
                      source);
    gl_upload_prepare_end(list);
}

/* ---- gutter ---- */

static void copy_gutter_sources(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    uint32_t(*source)[4] = to;
    for (uint64_t i = 0; i < count; i++) {
        for (int s = 0; s < PARIAN_GUTTER_SOURCES; s++) {
            bool used = body->gutter_weight[first + i][s] != 0.0f;
            source[i][s] = used ? body->texel_index[body->gutter_source[first + i][s]] : 0;
        }
    }
}

static void plan_gutter(gl_upload_list *list, const parian_body *body, gl_body *made)
{
    made->gutter_source = gl_array_describe(GL_FORMAT_RGBA32UI, body->gutter_count);
    made->gutter_weight = gl_array_describe(GL_FORMAT_RGBA32F, body->gutter_count);
    gl_upload_texture(list, PARIAN_MEMORY_ATLAS, &made->gutter_source, body->gutter_count,
                      copy_gutter_sources, body);
    gl_upload_texture(list, PARIAN_MEMORY_ATLAS, &made->gutter_weight, body->gutter_count, NULL,
                      body->gutter_weight);
}

/* ---- restriction ---- */

static parian_result make_restriction(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    return parian_restriction_build(env, source->body, &source->restriction);
}

static void drop_restriction(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    parian_restriction_free(env, &source->restriction);
}

static void copy_feed_offsets(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    memcpy(to, source->restriction.offset + first, count * sizeof *source->restriction.offset);
}

static void copy_feeds(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    uint32_t(*pair)[2] = to;
    for (uint64_t i = 0; i < count; i++) {
        const parian_feed *feed = &source->restriction.feed[first + i];
        pair[i][0] = source->body->texel_index[feed->texel];
        memcpy(&pair[i][1], &feed->flux, sizeof pair[i][1]);
    }
}

static void copy_feed_weights(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    memcpy(to, source->restriction.weight + first, count * sizeof *source->restriction.weight);
}

static void plan_restriction(gl_upload_list *list, gl_body_source *source, gl_body *made)
{
    const parian_memory_part part = PARIAN_MEMORY_FACTORS;
    const gl_preparation restriction = {make_restriction, drop_restriction, source};
    uint64_t offsets = (uint64_t)source->body->vertex_count + 1;
    uint64_t feeds = 3 * (uint64_t)source->body->texel_count;
    made->feed_offset = gl_array_describe(GL_FORMAT_R32UI, offsets);
    made->feed = gl_array_describe(GL_FORMAT_RG32UI, feeds);
    gl_upload_prepare_begin(list, restriction);
    gl_upload_texture(list, part, &made->feed_offset, offsets, copy_feed_offsets, source);
    gl_upload_texture(list, part, &made->feed, feeds, copy_feeds, source);
    if (source->body->blend_weight) {
        made->feed_weight = gl_array_describe(GL_FORMAT_RGB16F, feeds);
        gl_upload_texture(list, part, &made->feed_weight, feeds, copy_feed_weights, source);
    }
    gl_upload_prepare_end(list);
}

/* ---- kernels ---- */

static parian_result make_kernels(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    parian_result result = parian_kernels_build(env, source->body, &source->kernels);
    if (result == PARIAN_OK) {
        memcpy(source->made->channel_scale, source->kernels.channel_scale,
               sizeof source->kernels.channel_scale);
    }
    return result;
}

static void drop_kernels(const parian_env *env, void *context)
{
    gl_body_source *source = context;
    parian_kernels_free(env, &source->kernels);
}

/* From one kernel after the other to one tap after the other, so that neighbours read neighbours.
 */
static void copy_planes(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    const parian_half(*kernel)[3] = (const parian_half(*)[3])source->kernels.interior;
    parian_half(*out)[3] = to;
    uint64_t interior = source->made->interior_count;
    uint64_t taps = (uint64_t)source->body->kernel_width * source->body->kernel_width;
    uint64_t tap = first / interior, texel = first % interior;
    for (uint64_t i = 0; i < count; i++) {
        memcpy(out[i], kernel[texel * taps + tap], sizeof out[i]);
        if (++texel == interior) {
            texel = 0;
            tap++;
        }
    }
}

static void copy_border_kernels(const void *context, uint64_t first, uint64_t count, void *to)
{
    const gl_body_source *source = context;
    memcpy(to, source->kernels.border + first, count * sizeof *source->kernels.border);
}

/* Texel ordinals become places in the atlas. */
static void copy_neighbours(const void *context, uint64_t first, uint64_t count, void *to)
{
    const parian_body *body = context;
    for (uint64_t i = 0; i < count; i++) {
        ((uint32_t *)to)[i] = body->texel_index[body->border_neighbour[first + i]];
    }
}

static void plan_border(gl_upload_list *list, gl_body_source *source, gl_body *made)
{
    const parian_memory_part part = PARIAN_MEMORY_KERNELS;
    const parian_body *body = source->body;
    uint64_t offsets = (uint64_t)body->border_count + 1;
    uint64_t listed = body->border_offset[body->border_count];
    made->border = gl_array_describe(GL_FORMAT_R32UI, offsets);
    made->neighbour = gl_array_describe(GL_FORMAT_R32UI, listed);
    made->border_kernel = gl_array_describe(GL_FORMAT_RGB16F, listed);
    gl_upload_texture(list, part, &made->border, offsets, NULL, body->border_offset);
    gl_upload_texture(list, part, &made->neighbour, listed, copy_neighbours, body);
    gl_upload_texture(list, part, &made->border_kernel, listed, copy_border_kernels, source);
}

static void plan_kernels(gl_upload_list *list, gl_body_source *source, gl_body *made)
{
    const parian_body *body = source->body;
    const gl_preparation kernels = {make_kernels, drop_kernels, source};
    uint64_t taps = (uint64_t)body->kernel_width * body->kernel_width;
    made->interior_count = body->texel_count - body->border_count;
    if (body->local_form == PARIAN_LOCAL_NONE) {
        return;
    }
    made->kernel = gl_array_describe(GL_FORMAT_RGB16F, made->interior_count * taps);
    gl_upload_prepare_begin(list, kernels);
    gl_upload_texture(list, PARIAN_MEMORY_KERNELS, &made->kernel, made->interior_count * taps,
                      copy_planes, source);
    if (body->border_count) {
        plan_border(list, source, made);
    }
    gl_upload_prepare_end(list);
}

/* ---- all ---- */

static void plan_registers(gl_upload_list *list, const parian_body *body, gl_body *made)
{
    made->register_count = parian_body_register_count(body);
    for (uint32_t r = 0; r < made->register_count; r++) {
        made->spare[r] = gl_vector_describe(parian_body_register_size(body, r));
        gl_upload_target(list, PARIAN_MEMORY_FACTORS, &made->spare[r]);
    }
}

void gl_body_plan(const parian_body *body, gl_body_source *source, gl_body *made,
                  gl_upload_list *list)
{
    *source = (gl_body_source){.body = body, .made = made};
    gl_mesh_plan_body(list, body, &made->mesh);
    plan_atlases(list, body, made);
    plan_origins(list, source, made);
    plan_restriction(list, source, made);
    plan_kernels(list, source, made);
    plan_registers(list, body, made);
    for (uint32_t o = 0; o < body->operator_count; o++) {
        gl_operator_plan(&body->operators[o], &source->operators[o], &made->operators[o], list);
    }
    if (body->gutter_count) {
        plan_gutter(list, body, made);
    }
}

/* The kernels of an edited body are its own: nothing is made or dropped. */
static void edit_kernels(gl_upload_list *list, const gl_body_source *source, gl_body *made)
{
    const parian_memory_part part = PARIAN_MEMORY_KERNELS;
    const parian_body *body = source->body;
    uint64_t taps = (uint64_t)body->kernel_width * body->kernel_width;
    memcpy(made->channel_scale, source->kernels.channel_scale, sizeof made->channel_scale);
    gl_upload_texture(list, part, &made->kernel, made->interior_count * taps, copy_planes, source);
    if (body->border_count) {
        gl_upload_texture(list, part, &made->border_kernel, body->border_offset[body->border_count],
                          copy_border_kernels, source);
    }
}

parian_result gl_body_edit(const parian_edited_body *edited, gl_body_source *source, gl_body *made,
                           gl_upload_list *list)
{
    const parian_body *body = &edited->body;
    const gl_preparation restriction = {make_restriction, drop_restriction, source};
    *source = (gl_body_source){.body = body, .made = made, .kernels = edited->kernels};
    if (body->blend_weight) {
        gl_upload_prepare_begin(list, restriction);
        gl_upload_texture(list, PARIAN_MEMORY_FACTORS, &made->feed_weight,
                          3 * (uint64_t)body->texel_count, copy_feed_weights, source);
        gl_upload_prepare_end(list);
    }
    if (body->local_form != PARIAN_LOCAL_NONE) {
        edit_kernels(list, source, made);
    }
    for (uint32_t o = 0; o < body->operator_count; o++) {
        gl_operator_edit(&body->operators[o], &made->operators[o], list);
    }
    return gl_upload_plan_end(list);
}

parian_result gl_body_set_values(gl_device *device, const parian_body *body,
                                 const float (*value)[3], gl_body *made)
{
    uint64_t area = (uint64_t)body->atlas_size * body->atlas_size;
    gl_texture wanted = gl_texture_describe(GL_FORMAT_RGBA32F, body->atlas_size, body->atlas_size);
    float(*scratch)[4];
    if (!PARIAN_NEW(device->env, scratch, area)) {
        return parian_fail(device->env, PARIAN_E_NOMEM, "no memory for the values of %u texels",
                           body->texel_count);
    }
    parian_atlas_fill(body, value, 0, area, scratch);
    device->part = PARIAN_MEMORY_ATLAS;
    parian_result result = gl_texture_update(device, &wanted, area, scratch, &made->values);
    parian_free(device->env, scratch);
    return result;
}

void gl_body_destroy(gl_device *device, gl_body *made)
{
    gl_texture *textures[] = {
        &made->position,      &made->normal,           &made->barycentric,   &made->info,
        &made->normal_map,    &made->albedo,           &made->feed_offset,   &made->feed,
        &made->feed_weight,   &made->kernel,           &made->border,        &made->neighbour,
        &made->border_kernel, &made->gutter_source,    &made->gutter_weight, &made->values,
        &made->origin,        &made->irradiance_spare, &made->set_origin};
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++) {
        gl_texture_destroy(device, textures[i]);
    }
    for (uint32_t r = 0; r < GL_REGISTER_MAX; r++) {
        gl_texture_destroy(device, &made->spare[r]);
    }
    for (uint32_t o = 0; o < PARIAN_MAX_OPERATORS; o++) {
        gl_operator_destroy(device, &made->operators[o]);
    }
    gl_mesh_destroy(device, &made->mesh);
}
