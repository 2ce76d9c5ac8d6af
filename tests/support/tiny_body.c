/* tiny_body.c - a small body made by hand, with every array that an asset can hold.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/tiny_body.h"

#include <stdio.h>
#include <string.h>

#include "core/body_schema.h"
#include "core/half.h"
#include "core/memory.h"

#define SQUARE_M 0.02f

enum { MARGIN = 4, WIDTH = 3, HALF_WIDTH = 1, VERTICES = 4, TRIANGLES = 2 };

static char *copy_text(const parian_env *env, const char *text)
{
    char *copy = parian_alloc(env, strlen(text) + 1, 1);
    if (copy) {
        memcpy(copy, text, strlen(text) + 1);
    }
    return copy;
}

static parian_half half_of(double value)
{
    return parian_half_from_float((float)value);
}

static void fill_medium(parian_medium *medium)
{
    snprintf(medium->name, sizeof medium->name, "Tiny Marble");
    snprintf(medium->source, sizeof medium->source, "made up for tests");
    for (int c = 0; c < 3; c++) {
        medium->sigma_s_prime[c] = 2000.0 + 200.0 * c;
        medium->sigma_a[c] = 2.0 + 2.0 * c;
    }
    medium->eta = 1.5;
    medium->reduced_only = true;
}

static bool fill_surface(const parian_env *env, parian_body *body, uint32_t side)
{
    static const float place[VERTICES][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const uint32_t corner[TRIANGLES][3] = {{0, 1, 2}, {0, 2, 3}};
    body->vertex_count = VERTICES;
    body->triangle_count = TRIANGLES;
    if (!PARIAN_NEW(env, body->vertex_position, VERTICES) ||
        !PARIAN_NEW(env, body->triangle, TRIANGLES) ||
        !PARIAN_NEW(env, body->corner_normal, TRIANGLES) ||
        !PARIAN_NEW(env, body->corner_uv, TRIANGLES) ||
        !PARIAN_NEW0(env, body->triangle_chart, TRIANGLES)) {
        return false;
    }
    memcpy(body->triangle, corner, sizeof corner);
    for (int v = 0; v < VERTICES; v++) {
        body->vertex_position[v][0] = place[v][0] * SQUARE_M;
        body->vertex_position[v][1] = place[v][1] * SQUARE_M;
        body->vertex_position[v][2] = 0;
    }
    for (int t = 0; t < TRIANGLES; t++) {
        for (int c = 0; c < 3; c++) {
            const float *p = place[corner[t][c]];
            memcpy(body->corner_normal[t][c], (float[3]){0, 0, 1}, sizeof(float[3]));
            body->corner_uv[t][c][0] = MARGIN + p[0] * (float)side;
            body->corner_uv[t][c][1] = MARGIN + p[1] * (float)side;
        }
    }
    return true;
}

static bool fill_texels(const parian_env *env, parian_body *body, uint32_t side)
{
    uint32_t count = side * side;
    body->atlas_size = side + 2 * MARGIN;
    body->chart_count = 1;
    body->texel_count = count;
    if (!PARIAN_NEW(env, body->texel_index, count) ||
        !PARIAN_NEW(env, body->texel_triangle, count) ||
        !PARIAN_NEW(env, body->texel_barycentric, count) ||
        !PARIAN_NEW(env, body->texel_area, count) ||
        !PARIAN_NEW(env, body->texel_normal_map, count) ||
        !PARIAN_NEW(env, body->texel_albedo, count)) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t u = i % side, v = i / side;
        float s = ((float)u + 0.5f) / (float)side, t = ((float)v + 0.5f) / (float)side;
        body->texel_index[i] = (v + MARGIN) * body->atlas_size + u + MARGIN;
        body->texel_triangle[i] = t > s;
        body->texel_barycentric[i][0] = t > s ? 1 - t : 1 - s;
        body->texel_barycentric[i][1] = t > s ? s : s - t;
        body->texel_area[i] = SQUARE_M * SQUARE_M / (float)count;
        float tilt =
            0.3f * (s - t); /* of the normal about the diagonal: tangent of half its angle */
        body->texel_normal_map[i][0] = 2 * tilt / (1 + tilt * tilt);
        body->texel_normal_map[i][1] = 0;
        body->texel_normal_map[i][2] = (1 - tilt * tilt) / (1 + tilt * tilt);
        for (int c = 0; c < 3; c++) {
            body->texel_albedo[i][c] =
                0.5f + 0.125f * (float)((u + 2 * v + (uint32_t)c) % 5) - 0.25f;
        }
    }
    return true;
}

static uint32_t clamp(int value, uint32_t side)
{
    return value < 0 ? 0 : value >= (int)side ? side - 1 : (uint32_t)value;
}

/* One ring of gutter texels around the chart, each a copy of the nearest texel and its neighbour.
 */
static bool fill_gutter(const parian_env *env, parian_body *body, uint32_t side)
{
    uint32_t count = 4 * side + 4;
    if (!PARIAN_NEW(env, body->gutter_index, count) ||
        !PARIAN_NEW(env, body->gutter_source, count) ||
        !PARIAN_NEW(env, body->gutter_weight, count)) {
        return false;
    }
    for (int v = -1; v <= (int)side; v++) {
        for (int u = -1; u <= (int)side; u++) {
            if (u >= 0 && v >= 0 && u < (int)side && v < (int)side) {
                continue;
            }
            uint32_t near = clamp(v, side) * side + clamp(u, side);
            uint32_t i = body->gutter_count++;
            body->gutter_index[i] = (uint32_t)((v + MARGIN) * (int)body->atlas_size + u + MARGIN);
            for (uint32_t k = 0; k < PARIAN_GUTTER_SOURCES; k++) {
                body->gutter_source[i][k] =
                    k == 1 ? clamp(v, side) * side + clamp(u ? u - 1 : 1, side) : near;
                body->gutter_weight[i][k] = k == 0 ? 0.75f : k == 1 ? 0.25f : 0;
            }
        }
    }
    return true;
}

static bool is_border(uint32_t texel, uint32_t side)
{
    uint32_t u = texel % side, v = texel / side;
    return u < HALF_WIDTH || v < HALF_WIDTH || u + HALF_WIDTH >= side || v + HALF_WIDTH >= side;
}

static bool fill_border(const parian_env *env, parian_body *body, uint32_t side)
{
    uint32_t count = 4 * side - 4, entries = 0;
    if (!PARIAN_NEW(env, body->border_texel, count) ||
        !PARIAN_NEW(env, body->border_offset, count + 1) ||
        !PARIAN_NEW(env, body->border_neighbour, count * WIDTH * WIDTH)) {
        return false;
    }
    body->kernel_width = WIDTH;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        if (!is_border(i, side)) {
            continue;
        }
        body->border_texel[body->border_count] = i;
        body->border_offset[body->border_count++] = entries;
        for (int dv = -HALF_WIDTH; dv <= HALF_WIDTH; dv++) {
            for (int du = -HALF_WIDTH; du <= HALF_WIDTH; du++) {
                int u = (int)(i % side) + du, v = (int)(i / side) + dv;
                if (u >= 0 && v >= 0 && u < (int)side && v < (int)side) {
                    body->border_neighbour[entries++] = (uint32_t)v * side + (uint32_t)u;
                }
            }
        }
    }
    body->border_offset[body->border_count] = entries;
    return true;
}

/* Rows of all four vertices; the diagonal is zero where a local part exists. */
static bool fill_operator(const parian_env *env, parian_body *body)
{
    parian_operator *op = &body->operators[0];
    bool diagonal = body->local_form == PARIAN_LOCAL_NONE || body->local_form == PARIAN_LOCAL_SPLIT;
    body->has_global = true;
    body->operator_count = 1;
    op->source_register = 0;
    op->target_register = 1;
    op->row_count = op->column_count = VERTICES;
    if (!PARIAN_NEW(env, op->run_offset, VERTICES + 1) ||
        !PARIAN_NEW(env, op->run_column, 2 * VERTICES) ||
        !PARIAN_NEW(env, op->run_count, 2 * VERTICES) ||
        !PARIAN_NEW(env, op->factor, VERTICES * VERTICES) ||
        !PARIAN_NEW(env, op->scale, VERTICES)) {
        return false;
    }
    for (uint32_t row = 0; row < VERTICES; row++) {
        op->run_offset[row] = op->run_total;
        uint32_t column = 0;
        while (column < VERTICES) {
            uint32_t first = column;
            for (; column < VERTICES && (diagonal || column != row); column++) {
                for (int c = 0; c < 3; c++) {
                    uint32_t distance = column > row ? column - row : row - column;
                    op->factor[op->factor_total][c] = half_of(1.0 / (1 + (c + 1) * distance));
                }
                op->factor_total++;
            }
            if (column > first) {
                op->run_column[op->run_total] = first;
                op->run_count[op->run_total++] = (uint16_t)(column - first);
            }
            column += column < VERTICES;
        }
        for (int c = 0; c < 3; c++) {
            op->scale[row][c] = 512;
        }
    }
    op->run_offset[VERTICES] = op->run_total;
    return true;
}

static bool fill_blend(const parian_env *env, parian_body *body)
{
    if (!PARIAN_NEW(env, body->blend_weight, body->texel_count)) {
        return false;
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        for (int corner = 0; corner < 3; corner++) {
            for (int c = 0; c < 3; c++) {
                body->blend_weight[i][corner][c] =
                    half_of(0.1 / (1 + corner + c + i % 7) / body->texel_count);
            }
        }
    }
    return true;
}

/* A tap's value: falls with the distance, differs by channel. */
static double tap(size_t index, int channel)
{
    static const double by_distance[9] = {0.2, 0.5, 0.2, 0.5, 1.0, 0.5, 0.2, 0.5, 0.2};
    return by_distance[index % 9] * (1.0 - 0.1 * channel);
}

static bool fill_f16(const parian_env *env, parian_body *body, size_t taps, size_t entries)
{
    if (!PARIAN_NEW(env, body->kernel_f16, taps) || !PARIAN_NEW(env, body->border_f16, entries)) {
        return false;
    }
    for (int c = 0; c < 3; c++) {
        body->kernel_channel_scale[c] = 0.125f;
        for (size_t i = 0; i < taps; i++) {
            body->kernel_f16[i][c] = half_of(tap(i, c));
        }
        for (size_t i = 0; i < entries; i++) {
            body->border_f16[i][c] = half_of(tap(i, c));
        }
    }
    return true;
}

static bool fill_u8(const parian_env *env, parian_body *body, size_t taps, size_t entries)
{
    if (!PARIAN_NEW(env, body->kernel_s8, taps) || !PARIAN_NEW(env, body->border_s8, entries) ||
        !PARIAN_NEW(env, body->kernel_scale, body->texel_count)) {
        return false;
    }
    for (int c = 0; c < 3; c++) {
        for (size_t i = 0; i < taps; i++) {
            body->kernel_s8[i][c] = (int8_t)(127 * tap(i, c));
        }
        for (size_t i = 0; i < entries; i++) {
            body->border_s8[i][c] = (int8_t)(127 * tap(i, c));
        }
        for (size_t i = 0; i < body->texel_count; i++) {
            body->kernel_scale[i][c] = 0.1f + 0.01f * (float)(i % 5);
        }
    }
    return true;
}

static bool fill_local(const parian_env *env, parian_body *body)
{
    size_t taps = (size_t)(body->texel_count - body->border_count) * WIDTH * WIDTH;
    size_t entries = body->border_offset[body->border_count];
    switch (body->local_form) {
    case PARIAN_LOCAL_REBUILT:
        return fill_blend(env, body);
    case PARIAN_LOCAL_F16:
        return fill_blend(env, body) && fill_f16(env, body, taps, entries);
    case PARIAN_LOCAL_U8:
        return fill_blend(env, body) && fill_u8(env, body, taps, entries);
    case PARIAN_LOCAL_SPLIT:
        body->split_radius_m = 0.01f;
        return true;
    default:
        return true;
    }
}

parian_result test_tiny_body(const parian_env *env, parian_local_form form, uint32_t side,
                             parian_body *body)
{
    memset(body, 0, sizeof *body);
    snprintf(body->name, sizeof body->name, "tiny");
    fill_medium(&body->medium);
    body->local_form = form;
    body->plan_json = copy_text(env, "{\"local\":true,\"reason\":\"made by hand\"}");
    bool made = body->plan_json && fill_surface(env, body, side) && fill_texels(env, body, side) &&
                fill_gutter(env, body, side) && fill_border(env, body, side) &&
                (form == PARIAN_LOCAL_ONLY || fill_operator(env, body)) && fill_local(env, body);
    parian_result result = made ? parian_body_derive(env, body) : PARIAN_E_NOMEM;
    if (result != PARIAN_OK) {
        parian_body_free(env, body);
    }
    return result;
}

static bool fill_surrounding(const parian_env *env, parian_surrounding *floor)
{
    static const float position[3][3] = {{-1, -0.1f, -1}, {1, -0.1f, -1}, {0, -0.1f, 1}};
    static const uint32_t corner[1][3] = {{0, 2, 1}};
    snprintf(floor->name, sizeof floor->name, "floor");
    floor->vertex_count = 3;
    floor->triangle_count = 1;
    if (!PARIAN_NEW(env, floor->vertex_position, 3) || !PARIAN_NEW(env, floor->triangle, 1) ||
        !PARIAN_NEW0(env, floor->corner_normal, 1)) {
        return false;
    }
    memcpy(floor->vertex_position, position, sizeof position);
    memcpy(floor->triangle, corner, sizeof corner);
    for (int c = 0; c < 3; c++) {
        floor->corner_normal[0][c][1] = 1;
        floor->reflectance[c] = 0.5f;
    }
    return true;
}

parian_result test_tiny_scene(const parian_env *env, parian_local_form form, uint32_t side,
                              parian_scene_data *scene)
{
    static const char lights[] =
        "{\"lights\":[{\"type\":\"point\",\"position\":[0,0,0.1],\"intensity\":[1,1,1]}]}";
    memset(scene, 0, sizeof *scene);
    if (!PARIAN_NEW0(env, scene->bodies, 2) || !PARIAN_NEW0(env, scene->surroundings, 1)) {
        parian_scene_data_free(env, scene);
        return PARIAN_E_NOMEM;
    }
    scene->body_count = 2;
    scene->surrounding_count = 1;
    scene->lights_json = copy_text(env, lights);
    scene->provenance_json = copy_text(env, "{\"tool\":\"test\"}");
    parian_result result = test_tiny_body(env, form, side, &scene->bodies[0]);
    if (result == PARIAN_OK) {
        result = test_tiny_body(env, PARIAN_LOCAL_REBUILT, 4, &scene->bodies[1]);
    }
    if (result == PARIAN_OK && (!fill_surrounding(env, scene->surroundings) ||
                                !scene->lights_json || !scene->provenance_json)) {
        result = PARIAN_E_NOMEM;
    }
    if (result != PARIAN_OK) {
        parian_scene_data_free(env, scene);
    }
    return result;
}

/* ---- comparison ---------------------------------------------------------------------------------
 */

static bool arrays_equal(const parian_schema_array *array, const void *a, const void *b,
                         const parian_schema_counts *counts)
{
    for (; array->name; array++) {
        const unsigned char *data_a = (const unsigned char *)a + array->field;
        const unsigned char *data_b = (const unsigned char *)b + array->field;
        uint64_t shape[PARIAN_CHUNK_RANK_MAX];
        size_t size = parian_element_size(array->element);
        parian_schema_shape(array, counts, shape);
        for (uint32_t i = 0; i < array->rank; i++) {
            size *= shape[i];
        }
        if (!array->in_place) {
            memcpy(&data_a, data_a, sizeof data_a);
            memcpy(&data_b, data_b, sizeof data_b);
        }
        if (size && (!data_a != !data_b || (data_a && memcmp(data_a, data_b, size) != 0))) {
            return false;
        }
    }
    return true;
}

static bool texts_equal(const char *a, const char *b)
{
    return (!a && !b) || (a && b && strcmp(a, b) == 0);
}

static bool bodies_equal(const parian_body *a, const parian_body *b)
{
    parian_schema_counts counts, counts_b;
    parian_schema_body_counts(a, a->border_offset[a->border_count], &counts);
    parian_schema_body_counts(b, b->border_offset[b->border_count], &counts_b);
    if (memcmp(&counts, &counts_b, sizeof counts) != 0 || a->operator_count != b->operator_count ||
        a->local_form != b->local_form || a->bssrdf != b->bssrdf || a->fit_fdr != b->fit_fdr ||
        a->paper_form != b->paper_form || a->medium.reduced_only != b->medium.reduced_only ||
        a->atlas_size != b->atlas_size || a->chart_count != b->chart_count ||
        a->has_global != b->has_global || !texts_equal(a->name, b->name) ||
        !texts_equal(a->medium.name, b->medium.name) ||
        !texts_equal(a->medium.source, b->medium.source) ||
        !texts_equal(a->plan_json, b->plan_json) ||
        !arrays_equal(parian_body_arrays, a, b, &counts)) {
        return false;
    }
    for (uint32_t i = 0; i < a->operator_count; i++) {
        parian_schema_operator_counts(&a->operators[i], &counts);
        parian_schema_operator_counts(&b->operators[i], &counts_b);
        if (memcmp(&counts, &counts_b, sizeof counts) != 0 ||
            a->operators[i].column_count != b->operators[i].column_count ||
            !arrays_equal(parian_operator_arrays, &a->operators[i], &b->operators[i], &counts)) {
            return false;
        }
    }
    return true;
}

bool test_scene_equal(const parian_scene_data *a, const parian_scene_data *b)
{
    bool equal = a->body_count == b->body_count && a->surrounding_count == b->surrounding_count &&
                 texts_equal(a->lights_json, b->lights_json) &&
                 texts_equal(a->provenance_json, b->provenance_json);
    for (uint32_t i = 0; i < a->body_count && equal; i++) {
        equal = bodies_equal(&a->bodies[i], &b->bodies[i]);
    }
    for (uint32_t i = 0; i < a->surrounding_count && equal; i++) {
        const parian_surrounding *s = &a->surroundings[i], *t = &b->surroundings[i];
        parian_schema_counts counts;
        parian_schema_surrounding_counts(s, &counts);
        equal = s->vertex_count == t->vertex_count && s->triangle_count == t->triangle_count &&
                texts_equal(s->name, t->name) &&
                arrays_equal(parian_surrounding_arrays, s, t, &counts);
    }
    return equal;
}
