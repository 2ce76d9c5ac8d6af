/* gl_body.c - uploads a body: atlases, restriction lists, kernels, operators.
 *
 * SPDX-License-Identifier: MIT
 */
#include "gl/gl_body.h"

#include <string.h>

#include "core/memory.h"
#include "method/atlas_fill.h"
#include "method/restriction.h"

#define TRY(call)                                                                                  \
    do {                                                                                           \
        parian_result try_result = (call);                                                         \
        if (try_result != PARIAN_OK) {                                                             \
            return try_result;                                                                     \
        }                                                                                          \
    } while (0)

/* ---- atlases ---- */

static void place_positions(const parian_body *body, float (*atlas)[4])
{
    for (uint32_t t = 0; t < body->texel_count; t++) {
        float *to = atlas[body->texel_index[t]];
        memcpy(to, body->texel_position[t], sizeof body->texel_position[0]);
        to[3] = body->texel_area[t];
    }
}

static void place_normals(const parian_body *body, float (*atlas)[4])
{
    for (uint32_t t = 0; t < body->texel_count; t++) {
        memcpy(atlas[body->texel_index[t]], body->texel_normal[t], sizeof body->texel_normal[0]);
    }
}

static void place_barycentrics(const parian_body *body, float (*atlas)[4])
{
    float(*pair)[2] = (float(*)[2])atlas; /* uses half of the room */
    for (uint32_t t = 0; t < body->texel_count; t++) {
        memcpy(pair[body->texel_index[t]], body->texel_barycentric[t], sizeof pair[0]);
    }
}

static void place_info(const parian_body *body, float (*atlas)[4])
{
    uint32_t(*info)[4] = (uint32_t(*)[4])atlas;
    uint32_t interior = 0;
    memset(info, 0xFF, (size_t)body->atlas_size * body->atlas_size * sizeof info[0]);
    for (uint32_t t = 0; t < body->texel_count; t++) {
        uint32_t *to = info[body->texel_index[t]];
        memcpy(to, body->triangle[body->texel_triangle[t]], sizeof body->triangle[0]);
        bool border = body->texel_border[t] != PARIAN_NO_BORDER;
        to[3] = border ? 0x80000000u | body->texel_border[t] : interior++;
    }
    for (uint32_t g = 0; g < body->gutter_count; g++) {
        info[body->gutter_index[g]][1] = g;
    }
}

static void place_normal_map(const parian_body *body, float (*atlas)[4])
{
    parian_atlas_fill(body, (const float(*)[3])body->texel_normal_map, atlas);
}

static void place_albedo(const parian_body *body, float (*atlas)[4])
{
    parian_atlas_fill(body, (const float(*)[3])body->texel_albedo, atlas);
}

static parian_result upload_atlas(gl_device *device, const parian_body *body, gl_format format,
                                  void (*place)(const parian_body *, float (*)[4]),
                                  float (*scratch)[4], gl_texture *texture)
{
    memset(scratch, 0, (size_t)body->atlas_size * body->atlas_size * sizeof *scratch);
    place(body, scratch);
    return gl_texture_create(device, format, body->atlas_size, body->atlas_size, scratch, texture);
}

static parian_result upload_atlases(gl_device *device, const parian_body *body, float (*scratch)[4],
                                    gl_body *made)
{
    TRY(upload_atlas(device, body, GL_FORMAT_RGBA32F, place_positions, scratch, &made->position));
    TRY(upload_atlas(device, body, GL_FORMAT_RGBA32F, place_normals, scratch, &made->normal));
    TRY(upload_atlas(device, body, GL_FORMAT_RG32F, place_barycentrics, scratch,
                     &made->barycentric));
    TRY(upload_atlas(device, body, GL_FORMAT_RGBA32UI, place_info, scratch, &made->info));
    if (body->texel_normal_map) {
        TRY(upload_atlas(device, body, GL_FORMAT_RGBA32F, place_normal_map, scratch,
                         &made->normal_map));
    }
    if (body->texel_albedo) {
        TRY(upload_atlas(device, body, GL_FORMAT_RGBA32F, place_albedo, scratch, &made->albedo));
    }
    return PARIAN_OK;
}

static parian_result create_atlases(gl_device *device, const parian_body *body, gl_body *made)
{
    float(*scratch)[4];
    if (!PARIAN_NEW(device->env, scratch, (size_t)body->atlas_size * body->atlas_size)) {
        return parian_fail(device->env, PARIAN_E_NOMEM,
                           "no memory for an atlas of %u texels a side", body->atlas_size);
    }
    parian_result result = upload_atlases(device, body, scratch, made);
    parian_free(device->env, scratch);
    return result;
}

/* ---- lists ---- */

/* Texel ordinals become places in the atlas. */
typedef struct ordinal_list {
    const parian_body *body;
    const uint32_t *ordinal;
} ordinal_list;

static void copy_places(const void *context, uint64_t first, uint64_t count, void *to)
{
    const ordinal_list *list = context;
    for (uint64_t i = 0; i < count; i++) {
        ((uint32_t *)to)[i] = list->body->texel_index[list->ordinal[first + i]];
    }
}

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

typedef struct feed_list {
    const parian_body *body;
    const parian_feed *feed;
} feed_list;

static void copy_feeds(const void *context, uint64_t first, uint64_t count, void *to)
{
    const feed_list *list = context;
    uint32_t(*pair)[2] = to;
    for (uint64_t i = 0; i < count; i++) {
        const parian_feed *feed = &list->feed[first + i];
        pair[i][0] = list->body->texel_index[feed->texel];
        memcpy(&pair[i][1], &feed->flux, sizeof pair[i][1]);
    }
}

static parian_result upload_restriction(gl_device *device, const parian_body *body,
                                        const parian_restriction *restriction, gl_body *made)
{
    feed_list feeds = {body, restriction->feed};
    TRY(gl_array_upload(device, GL_FORMAT_R32UI, (uint64_t)restriction->vertex_count + 1,
                        restriction->offset, &made->feed_offset));
    TRY(gl_array_create(device, GL_FORMAT_RG32UI, restriction->total, copy_feeds, &feeds,
                        &made->feed));
    if (restriction->weight) {
        TRY(gl_array_upload(device, GL_FORMAT_RGB16F, restriction->total, restriction->weight,
                            &made->feed_weight));
    }
    return PARIAN_OK;
}

static parian_result create_restriction(gl_device *device, const parian_body *body, gl_body *made)
{
    parian_restriction restriction = {0};
    TRY(parian_restriction_build(device->env, body, &restriction));
    parian_result result = upload_restriction(device, body, &restriction, made);
    parian_restriction_free(device->env, &restriction);
    return result;
}

/* ---- kernels ---- */

typedef struct kernel_planes {
    const parian_half (*tap)[3]; /* [interior][taps] */
    uint64_t interior, taps;
} kernel_planes;

/* From one kernel after the other to one tap after the other, so that neighbours read neighbours.
 */
static void copy_planes(const void *context, uint64_t first, uint64_t count, void *to)
{
    const kernel_planes *planes = context;
    parian_half(*out)[3] = to;
    uint64_t tap = first / planes->interior, texel = first % planes->interior;
    for (uint64_t i = 0; i < count; i++) {
        memcpy(out[i], planes->tap[texel * planes->taps + tap], sizeof out[i]);
        if (++texel == planes->interior) {
            texel = 0;
            tap++;
        }
    }
}

static parian_result upload_kernels(gl_device *device, const parian_body *body,
                                    const parian_kernels *kernels, gl_body *made)
{
    ordinal_list neighbours = {body, body->border_neighbour};
    uint64_t taps = (uint64_t)body->kernel_width * body->kernel_width;
    kernel_planes planes = {(const parian_half(*)[3])kernels->interior, made->interior_count, taps};
    uint64_t listed = body->border_count ? body->border_offset[body->border_count] : 0;
    memcpy(made->channel_scale, kernels->channel_scale, sizeof made->channel_scale);
    TRY(gl_array_create(device, GL_FORMAT_RGB16F, made->interior_count * taps, copy_planes, &planes,
                        &made->kernel));
    if (body->border_count) {
        TRY(gl_array_upload(device, GL_FORMAT_R32UI, (uint64_t)body->border_count + 1,
                            body->border_offset, &made->border));
        TRY(gl_array_create(device, GL_FORMAT_R32UI, listed, copy_places, &neighbours,
                            &made->neighbour));
        TRY(gl_array_upload(device, GL_FORMAT_RGB16F, listed, kernels->border,
                            &made->border_kernel));
    }
    return PARIAN_OK;
}

static parian_result create_kernels(gl_device *device, const parian_body *body, gl_body *made)
{
    parian_kernels kernels = {0};
    made->interior_count = body->texel_count - body->border_count;
    if (body->local_form == PARIAN_LOCAL_NONE) {
        return PARIAN_OK;
    }
    TRY(parian_kernels_build(device->env, body, &kernels));
    parian_result result = upload_kernels(device, body, &kernels, made);
    parian_kernels_free(device->env, &kernels);
    return result;
}

/* ---- all ---- */

static parian_result create_registers(gl_device *device, const parian_body *body, gl_body *made)
{
    made->register_count = parian_body_register_count(body);
    for (uint32_t r = 0; r < made->register_count; r++) {
        TRY(gl_vector_create(device, parian_body_register_size(body, r), &made->spare[r]));
    }
    for (uint32_t o = 0; o < body->operator_count; o++) {
        TRY(gl_operator_create(device, &body->operators[o], &made->operators[o]));
    }
    return PARIAN_OK;
}

parian_result gl_body_create(gl_device *device, const parian_body *body, gl_body *made)
{
    TRY(gl_mesh_create(device, body, NULL, &made->mesh));
    TRY(create_atlases(device, body, made));
    TRY(create_restriction(device, body, made));
    TRY(create_kernels(device, body, made));
    TRY(create_registers(device, body, made));
    if (body->gutter_count) {
        TRY(gl_array_create(device, GL_FORMAT_RGBA32UI, body->gutter_count, copy_gutter_sources,
                            body, &made->gutter_source));
        TRY(gl_array_upload(device, GL_FORMAT_RGBA32F, body->gutter_count, body->gutter_weight,
                            &made->gutter_weight));
    }
    return PARIAN_OK;
}

parian_result gl_body_set_values(gl_device *device, const parian_body *body,
                                 const float (*value)[3], gl_body *made)
{
    float(*scratch)[4];
    if (!PARIAN_NEW(device->env, scratch, (size_t)body->atlas_size * body->atlas_size)) {
        return parian_fail(device->env, PARIAN_E_NOMEM, "no memory for the values of %u texels",
                           body->texel_count);
    }
    parian_atlas_fill(body, value, scratch);
    gl_texture_destroy(device, &made->values);
    parian_result result = gl_texture_create(device, GL_FORMAT_RGBA32F, body->atlas_size,
                                             body->atlas_size, scratch, &made->values);
    parian_free(device->env, scratch);
    return result;
}

void gl_body_destroy(gl_device *device, gl_body *made)
{
    gl_texture *textures[] = {
        &made->position,      &made->normal,        &made->barycentric,   &made->info,
        &made->normal_map,    &made->albedo,        &made->feed_offset,   &made->feed,
        &made->feed_weight,   &made->kernel,        &made->border,        &made->neighbour,
        &made->border_kernel, &made->gutter_source, &made->gutter_weight, &made->values};
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
