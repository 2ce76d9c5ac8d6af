/* dump.c - every intermediate array of a bake as .npy, and the atlas as a picture.
 *
 * Arrays of texels are those of all bodies, one after the other, as parian-view writes them; the
 * other arrays carry the body's number in their names.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdio.h>
#include <string.h>

#include "bake/pipeline/bake.h"
#include "bake/stages/atlas_picture.h"
#include "core/memory.h"
#include "tool/files.h"
#include "tool/picture.h"

enum { NAME_MAX_LENGTH = 96, FILE_NAME_MAX_LENGTH = 128, PATH_MAX_LENGTH = 4096 };

typedef struct dump_array {
    const char *name;
    parian_element element;
    uint32_t rank;
    uint64_t shape[4];
    const void *data;
} dump_array;

static parian_result write_array(const parian_env *env, const char *folder, uint32_t body,
                                 const dump_array *array)
{
    char name[FILE_NAME_MAX_LENGTH];
    if (!array->data) {
        return PARIAN_OK;
    }
    snprintf(name, sizeof name, "body%u_%s", body, array->name);
    return parian_npy_write(env, folder, name, array->element, array->rank, array->shape,
                            array->data);
}

static parian_result write_arrays(const parian_env *env, const char *folder, uint32_t body,
                                  const dump_array *arrays, size_t count)
{
    parian_result r = PARIAN_OK;
    for (size_t i = 0; r == PARIAN_OK && i < count; i++) {
        r = write_array(env, folder, body, &arrays[i]);
    }
    return r;
}

static parian_result dump_surface(const parian_env *env, const char *folder, uint32_t index,
                                  const parian_body *b)
{
    uint64_t vertices = b->vertex_count, triangles = b->triangle_count;
    const dump_array arrays[] = {
        {"transfer_position", PARIAN_ELEMENT_F32, 2, {vertices, 3}, b->vertex_position},
        {"transfer_triangle", PARIAN_ELEMENT_U32, 2, {triangles, 3}, b->triangle},
        {"transfer_corner_normal", PARIAN_ELEMENT_F32, 3, {triangles, 3, 3}, b->corner_normal},
        {"atlas_corner_uv", PARIAN_ELEMENT_F32, 3, {triangles, 3, 2}, b->corner_uv},
        {"atlas_triangle_chart", PARIAN_ELEMENT_U32, 1, {triangles}, b->triangle_chart}};
    return write_arrays(env, folder, index, arrays, sizeof arrays / sizeof *arrays);
}

static parian_result dump_texels(const parian_env *env, const char *folder, uint32_t index,
                                 const parian_body *b)
{
    uint64_t texels = b->texel_count, borders = b->border_count;
    const dump_array arrays[] = {
        {"texel_index", PARIAN_ELEMENT_U32, 1, {texels}, b->texel_index},
        {"texel_triangle", PARIAN_ELEMENT_U32, 1, {texels}, b->texel_triangle},
        {"texel_barycentric", PARIAN_ELEMENT_F32, 2, {texels, 2}, b->texel_barycentric},
        {"texel_normal_map", PARIAN_ELEMENT_F32, 2, {texels, 3}, b->texel_normal_map},
        {"texel_albedo", PARIAN_ELEMENT_F32, 2, {texels, 3}, b->texel_albedo},
        {"gutter_index", PARIAN_ELEMENT_U32, 1, {b->gutter_count}, b->gutter_index},
        {"gutter_source", PARIAN_ELEMENT_U32, 2, {b->gutter_count, 4}, b->gutter_source},
        {"gutter_weight", PARIAN_ELEMENT_F32, 2, {b->gutter_count, 4}, b->gutter_weight},
        {"border_texel", PARIAN_ELEMENT_U32, 1, {borders}, b->border_texel},
        {"border_offset", PARIAN_ELEMENT_U32, 1, {borders + 1}, b->border_offset},
        {"border_neighbour",
         PARIAN_ELEMENT_U32,
         1,
         {b->border_offset ? b->border_offset[borders] : 0},
         b->border_neighbour}};
    return write_arrays(env, folder, index, arrays, sizeof arrays / sizeof *arrays);
}

static parian_result dump_transport(const parian_env *env, const char *folder, uint32_t index,
                                    const parian_body *b)
{
    uint64_t texels = b->texel_count, inner = b->texel_count - b->border_count;
    uint64_t taps = (uint64_t)b->kernel_width * b->kernel_width;
    uint64_t listed = b->border_offset ? b->border_offset[b->border_count] : 0;
    const dump_array arrays[] = {
        {"blend_weight", PARIAN_ELEMENT_F16, 3, {texels, 3, 3}, b->blend_weight},
        {"kernel_f16", PARIAN_ELEMENT_F16, 3, {inner, taps, 3}, b->kernel_f16},
        {"kernel_border_f16", PARIAN_ELEMENT_F16, 2, {listed, 3}, b->border_f16},
        {"kernel_s8", PARIAN_ELEMENT_S8, 3, {inner, taps, 3}, b->kernel_s8},
        {"kernel_border_s8", PARIAN_ELEMENT_S8, 2, {listed, 3}, b->border_s8},
        {"kernel_scale", PARIAN_ELEMENT_F32, 2, {texels, 3}, b->kernel_scale}};
    parian_result r = write_arrays(env, folder, index, arrays, sizeof arrays / sizeof *arrays);
    for (uint32_t o = 0; r == PARIAN_OK && o < b->operator_count; o++) {
        const parian_operator *op = &b->operators[o];
        const dump_array parts[] = {
            {"operator_run_offset",
             PARIAN_ELEMENT_U32,
             1,
             {(uint64_t)op->row_count + 1},
             op->run_offset},
            {"operator_run_column", PARIAN_ELEMENT_U32, 1, {op->run_total}, op->run_column},
            {"operator_run_count", PARIAN_ELEMENT_U16, 1, {op->run_total}, op->run_count},
            {"operator_factor", PARIAN_ELEMENT_F16, 2, {op->factor_total, 3}, op->factor},
            {"operator_scale", PARIAN_ELEMENT_F32, 2, {op->row_count, 3}, op->scale}};
        for (size_t i = 0; r == PARIAN_OK && i < sizeof parts / sizeof *parts; i++) {
            dump_array part = parts[i];
            char name[NAME_MAX_LENGTH];
            snprintf(name, sizeof name, "%s%u", part.name, o);
            part.name = name;
            r = write_array(env, folder, index, &part);
        }
    }
    return r;
}

/* The atlas as colours (charts, border, gutter) and as floats (normal in RGB, area in alpha). */
static parian_result dump_pictures(const parian_env *env, const char *folder, uint32_t index,
                                   const parian_body *b)
{
    uint32_t side = b->atlas_size;
    size_t count = (size_t)side * side;
    uint8_t(*colour)[4] = NULL;
    float(*values)[4] = NULL;
    char path[PATH_MAX_LENGTH];
    parian_result r = PARIAN_E_NOMEM;
    if (PARIAN_NEW0(env, colour, count) && PARIAN_NEW0(env, values, count)) {
        for (uint32_t t = 0; t < b->texel_count; t++) {
            memcpy(values[b->texel_index[t]], parian_body_lit_normal(b, t), 3 * sizeof(float));
            values[b->texel_index[t]][3] = b->texel_area[t];
        }
        r = parian_atlas_picture(env, b, colour);
    }
    if (r == PARIAN_OK) {
        snprintf(path, sizeof path, "%s/body%u_atlas.png", folder, index);
        r = parian_png_write(env, path, side, side, (const uint8_t(*)[4])colour);
    }
    if (r == PARIAN_OK) {
        snprintf(path, sizeof path, "%s/body%u_atlas.exr", folder, index);
        r = parian_exr_write(env, path, side, side, (const float(*)[4])values);
    }
    parian_free(env, colour);
    parian_free(env, values);
    return r;
}

typedef const float *(*texel_getter)(const parian_body *body);

static const float *get_position(const parian_body *b)
{
    return &b->texel_position[0][0];
}

static const float *get_normal(const parian_body *b)
{
    return parian_body_lit_normal(b, 0);
}

static const float *get_area(const parian_body *b)
{
    return b->texel_area;
}

/* One array over the texels of all bodies. */
static parian_result dump_joined(const parian_env *env, const char *folder,
                                 const parian_scene_data *scene, const char *name, uint32_t width,
                                 texel_getter get)
{
    uint64_t total = 0, at = 0;
    float *joined = NULL;
    for (uint32_t i = 0; i < scene->body_count; i++) {
        total += scene->bodies[i].texel_count;
    }
    if (!PARIAN_NEW(env, joined, total * width)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to dump %s", name);
    }
    for (uint32_t i = 0; i < scene->body_count; i++) {
        size_t count = (size_t)scene->bodies[i].texel_count * width;
        memcpy(joined + at, get(&scene->bodies[i]), count * sizeof *joined);
        at += count;
    }
    uint64_t shape[2] = {total, width};
    parian_result r =
        parian_npy_write(env, folder, name, PARIAN_ELEMENT_F32, width > 1 ? 2 : 1, shape, joined);
    parian_free(env, joined);
    return r;
}

parian_result parian_bake_dump(const parian_env *env, const char *folder,
                               const parian_scene_data *scene)
{
    parian_result r = parian_folder_create(env, folder);
    if (r == PARIAN_OK) {
        r = dump_joined(env, folder, scene, "texel_position", 3, get_position);
    }
    if (r == PARIAN_OK) {
        r = dump_joined(env, folder, scene, "texel_normal", 3, get_normal);
    }
    if (r == PARIAN_OK) {
        r = dump_joined(env, folder, scene, "texel_area", 1, get_area);
    }
    for (uint32_t i = 0; r == PARIAN_OK && i < scene->body_count; i++) {
        const parian_body *body = &scene->bodies[i];
        r = dump_surface(env, folder, i, body);
        r = r == PARIAN_OK ? dump_texels(env, folder, i, body) : r;
        r = r == PARIAN_OK ? dump_transport(env, folder, i, body) : r;
        r = r == PARIAN_OK ? dump_pictures(env, folder, i, body) : r;
    }
    return r;
}
