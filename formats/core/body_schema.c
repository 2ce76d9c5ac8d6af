/* body_schema.c - the tables that say which chunk carries which array.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/body_schema.h"

#include <string.h>

#define U16                  PARIAN_ELEMENT_U16
#define U32                  PARIAN_ELEMENT_U32
#define S8                   PARIAN_ELEMENT_S8
#define F16                  PARIAN_ELEMENT_F16
#define F32                  PARIAN_ELEMENT_F32
#define F64                  PARIAN_ELEMENT_F64
#define RAW                  PARIAN_CODEC_RAW
#define ZSTD                 PARIAN_CODEC_ZSTD
#define SHUFFLE              PARIAN_CODEC_SHUFFLE_ZSTD
#define DELTA                PARIAN_CODEC_DELTA_ZSTD
#define BODY(field)          false, offsetof(parian_body, field)
#define BODY_IN_PLACE(field) true, offsetof(parian_body, field)
#define OPERATOR(field)      false, offsetof(parian_operator, field)
#define SURROUNDING(field)   false, offsetof(parian_surrounding, field)

/* clang-format off */
const parian_schema_array parian_body_arrays[] = {
    {"medium.sigma_s_prime", F64, RAW, WHEN_ALWAYS, BODY_IN_PLACE(medium.sigma_s_prime), 1, {3}},
    {"medium.sigma_a", F64, RAW, WHEN_ALWAYS, BODY_IN_PLACE(medium.sigma_a), 1, {3}},
    {"medium.g", F64, RAW, WHEN_ALWAYS, BODY_IN_PLACE(medium.g), 1, {3}},
    {"medium.eta", F64, RAW, WHEN_ALWAYS, BODY_IN_PLACE(medium.eta), 1, {1}},
    {"vertex.position", F32, SHUFFLE, WHEN_ALWAYS, BODY(vertex_position), 2, {COUNT_VERTEX, 3}},
    {"triangle.vertex", U32, DELTA, WHEN_ALWAYS, BODY(triangle), 2, {COUNT_TRIANGLE, 3}},
    {"triangle.chart", U32, DELTA, WHEN_ALWAYS, BODY(triangle_chart), 1, {COUNT_TRIANGLE}},
    {"corner.normal", F32, ZSTD, WHEN_ALWAYS, BODY(corner_normal), 3, {COUNT_TRIANGLE, 3, 3}},
    {"corner.uv", F32, ZSTD, WHEN_ALWAYS, BODY(corner_uv), 3, {COUNT_TRIANGLE, 3, 2}},
    {"texel.index", U32, DELTA, WHEN_ALWAYS, BODY(texel_index), 1, {COUNT_TEXEL}},
    {"texel.triangle", U32, ZSTD, WHEN_ALWAYS, BODY(texel_triangle), 1, {COUNT_TEXEL}},
    {"texel.barycentric", F32, SHUFFLE, WHEN_ALWAYS, BODY(texel_barycentric), 2, {COUNT_TEXEL, 2}},
    {"texel.area", F32, SHUFFLE, WHEN_ALWAYS, BODY(texel_area), 1, {COUNT_TEXEL}},
    {"texel.normal_map", F32, SHUFFLE, WHEN_PRESENT, BODY(texel_normal_map), 2, {COUNT_TEXEL, 3}},
    {"texel.albedo", F32, SHUFFLE, WHEN_PRESENT, BODY(texel_albedo), 2, {COUNT_TEXEL, 3}},
    {"gutter.index", U32, DELTA, WHEN_ALWAYS, BODY(gutter_index), 1, {COUNT_GUTTER}},
    {"gutter.source", U32, DELTA, WHEN_ALWAYS, BODY(gutter_source), 2, {COUNT_GUTTER, PARIAN_GUTTER_SOURCES}},
    {"gutter.weight", F32, SHUFFLE, WHEN_ALWAYS, BODY(gutter_weight), 2, {COUNT_GUTTER, PARIAN_GUTTER_SOURCES}},
    {"border.texel", U32, DELTA, WHEN_ALWAYS, BODY(border_texel), 1, {COUNT_BORDER}},
    {"border.offset", U32, DELTA, WHEN_ALWAYS, BODY(border_offset), 1, {COUNT_BORDER_OFFSET}},
    {"border.neighbour", U32, DELTA, WHEN_ALWAYS, BODY(border_neighbour), 1, {COUNT_BORDER_ENTRY}},
    {"blend.weight", F16, SHUFFLE, WHEN_BLEND, BODY(blend_weight), 3, {COUNT_TEXEL, 3, 3}},
    {"local.split_radius", F32, RAW, WHEN_SPLIT, BODY_IN_PLACE(split_radius_m), 1, {1}},
    {"local.channel_scale", F32, RAW, WHEN_F16, BODY_IN_PLACE(kernel_channel_scale), 1, {3}},
    {"local.kernel_f16", F16, SHUFFLE, WHEN_F16, BODY(kernel_f16), 4, {COUNT_INTERIOR, COUNT_WIDTH, COUNT_WIDTH, 3}},
    {"local.border_f16", F16, SHUFFLE, WHEN_F16, BODY(border_f16), 2, {COUNT_BORDER_ENTRY, 3}},
    {"local.kernel_s8", S8, ZSTD, WHEN_U8, BODY(kernel_s8), 4, {COUNT_INTERIOR, COUNT_WIDTH, COUNT_WIDTH, 3}},
    {"local.border_s8", S8, ZSTD, WHEN_U8, BODY(border_s8), 2, {COUNT_BORDER_ENTRY, 3}},
    {"local.kernel_scale", F32, SHUFFLE, WHEN_U8, BODY(kernel_scale), 2, {COUNT_TEXEL, 3}},
    {NULL, U16, RAW, WHEN_ALWAYS, false, 0, 0, {0}}};

const parian_schema_array parian_operator_arrays[] = {
    {"operator.run_offset", U32, DELTA, WHEN_ALWAYS, OPERATOR(run_offset), 1, {COUNT_ROW_OFFSET}},
    {"operator.run_column", U32, DELTA, WHEN_ALWAYS, OPERATOR(run_column), 1, {COUNT_RUN}},
    {"operator.run_count", U16, SHUFFLE, WHEN_ALWAYS, OPERATOR(run_count), 1, {COUNT_RUN}},
    {"operator.factor", F16, SHUFFLE, WHEN_ALWAYS, OPERATOR(factor), 2, {COUNT_FACTOR, 3}},
    {"operator.scale", F32, SHUFFLE, WHEN_ALWAYS, OPERATOR(scale), 2, {COUNT_ROW, 3}},
    {NULL, U16, RAW, WHEN_ALWAYS, false, 0, 0, {0}}};

const parian_schema_array parian_surrounding_arrays[] = {
    {"surrounding.position", F32, SHUFFLE, WHEN_ALWAYS, SURROUNDING(vertex_position), 2, {COUNT_VERTEX, 3}},
    {"surrounding.triangle", U32, DELTA, WHEN_ALWAYS, SURROUNDING(triangle), 2, {COUNT_TRIANGLE, 3}},
    {"surrounding.corner_normal", F32, ZSTD, WHEN_ALWAYS, SURROUNDING(corner_normal), 3, {COUNT_TRIANGLE, 3, 3}},
    {"surrounding.reflectance", F32, RAW, WHEN_ALWAYS, true, offsetof(parian_surrounding, reflectance), 1, {3}},
    {NULL, U16, RAW, WHEN_ALWAYS, false, 0, 0, {0}}};
/* clang-format on */

static bool form_blends(parian_local_form form)
{
    return form == PARIAN_LOCAL_REBUILT || form == PARIAN_LOCAL_F16 || form == PARIAN_LOCAL_U8;
}

int parian_schema_presence(const parian_schema_array *array, const parian_body *body)
{
    switch (array->when) {
    case WHEN_ALWAYS:
        return 1;
    case WHEN_PRESENT:
        return 0;
    case WHEN_BLEND:
        return !form_blends(body->local_form) ? -1 : body->has_global ? 1 : 0;
    case WHEN_F16:
        return body->local_form == PARIAN_LOCAL_F16 ? 1 : -1;
    case WHEN_U8:
        return body->local_form == PARIAN_LOCAL_U8 ? 1 : -1;
    case WHEN_SPLIT:
        return body->local_form == PARIAN_LOCAL_SPLIT ? 1 : -1;
    }
    return -1;
}

void parian_schema_shape(const parian_schema_array *array, const parian_schema_counts *counts,
                         uint64_t shape[PARIAN_CHUNK_RANK_MAX])
{
    memset(shape, 0, PARIAN_CHUNK_RANK_MAX * sizeof *shape);
    for (uint32_t i = 0; i < array->rank; i++) {
        uint16_t extent = array->shape[i];
        shape[i] = extent < SCHEMA_COUNT ? extent : counts->value[extent - SCHEMA_COUNT];
    }
}

static void set(parian_schema_counts *counts, schema_count which, uint64_t value)
{
    counts->value[which - SCHEMA_COUNT] = value;
}

void parian_schema_body_counts(const parian_body *body, uint64_t border_entries,
                               parian_schema_counts *counts)
{
    memset(counts, 0, sizeof *counts);
    set(counts, COUNT_VERTEX, body->vertex_count);
    set(counts, COUNT_TRIANGLE, body->triangle_count);
    set(counts, COUNT_TEXEL, body->texel_count);
    set(counts, COUNT_GUTTER, body->gutter_count);
    set(counts, COUNT_BORDER, body->border_count);
    set(counts, COUNT_BORDER_OFFSET, (uint64_t)body->border_count + 1);
    set(counts, COUNT_BORDER_ENTRY, border_entries);
    set(counts, COUNT_INTERIOR, body->texel_count - body->border_count);
    set(counts, COUNT_WIDTH, body->kernel_width);
}

void parian_schema_operator_counts(const parian_operator *op, parian_schema_counts *counts)
{
    memset(counts, 0, sizeof *counts);
    set(counts, COUNT_ROW, op->row_count);
    set(counts, COUNT_ROW_OFFSET, (uint64_t)op->row_count + 1);
    set(counts, COUNT_RUN, op->run_total);
    set(counts, COUNT_FACTOR, op->factor_total);
}

void parian_schema_surrounding_counts(const parian_surrounding *surrounding,
                                      parian_schema_counts *counts)
{
    memset(counts, 0, sizeof *counts);
    set(counts, COUNT_VERTEX, surrounding->vertex_count);
    set(counts, COUNT_TRIANGLE, surrounding->triangle_count);
}
