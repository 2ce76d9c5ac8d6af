/* body_file_write.c - carries a scene into a container, after the checks that its reader will make.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/body_file.h"

#include <stdio.h>
#include <string.h>

#include "core/body_schema.h"
#include "core/memory.h"

enum { WHERE_MAX = 128 };

/* One object of the scene on its way into the file. */
typedef struct object_writer {
    const parian_env *env;
    parian_writer *writer;
    uint32_t object, level;
    const char *where; /* begins messages */
} object_writer;

static parian_result write_chunk(const object_writer *out, const char *name, parian_element element,
                                 parian_codec codec, uint32_t rank, const uint64_t *shape,
                                 const void *data)
{
    parian_chunk_info info = {
        .object = out->object, .level = out->level, .element = element, .codec = codec};
    info.flags = PARIAN_CHUNK_REQUIRED;
    info.rank = rank;
    memcpy(info.shape, shape, rank * sizeof *shape);
    snprintf(info.name, sizeof info.name, "%s", name);
    return parian_writer_chunk(out->writer, &info, data);
}

static parian_result write_vector(const object_writer *out, const char *name,
                                  parian_element element, uint64_t count, const void *data)
{
    return write_chunk(out, name, element, PARIAN_CODEC_RAW, 1, &count, data);
}

/* Texts are optional for a reader: nothing is computed from them. */
static parian_result write_text(const object_writer *out, const char *name, const char *text)
{
    parian_chunk_info info = {
        .object = out->object, .level = out->level, .element = PARIAN_ELEMENT_U8};
    info.codec = PARIAN_CODEC_ZSTD;
    info.rank = 1;
    info.shape[0] = strlen(text);
    snprintf(info.name, sizeof info.name, "%s", name);
    return parian_writer_chunk(out->writer, &info, text);
}

/* A name, which programs show on terminals: a control character becomes '_'. */
static parian_result write_name(const object_writer *out, const char *name, const char *text)
{
    char clean[PARIAN_SOURCE_MAX];
    snprintf(clean, sizeof clean, "%s", text);
    for (char *c = clean; *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f) {
            *c = '_';
        }
    }
    return write_text(out, name, clean);
}

static const void *array_data(const parian_schema_array *array, const void *base)
{
    const unsigned char *field = (const unsigned char *)base + array->field;
    const void *data;
    if (array->in_place) {
        return field;
    }
    memcpy(&data, field, sizeof data);
    return data;
}

static uint64_t shape_total(uint32_t rank, const uint64_t *shape)
{
    uint64_t total = 1;
    for (uint32_t i = 0; i < rank; i++) {
        total *= shape[i];
    }
    return total;
}

/* Refuse an array that is missing, or is there and must not be; *wanted tells whether to write it.
 */
static parian_result judge_array(const object_writer *out, const parian_schema_array *array,
                                 const void *base, const parian_body *body,
                                 const parian_schema_counts *counts, bool *wanted)
{
    uint64_t shape[PARIAN_CHUNK_RANK_MAX];
    const void *data = array_data(array, base);
    int presence = body ? parian_schema_presence(array, body) : 1;
    parian_schema_shape(array, counts, shape);
    *wanted = presence > 0 || (presence == 0 && data);
    if (presence > 0 && !data && shape_total(array->rank, shape) > 0) {
        return parian_fail(out->env, PARIAN_E_ARGUMENT, "%s: rule %d: the array for %s is missing",
                           out->where, RULE_CHUNK_MISSING, array->name);
    }
    if (presence < 0 && data && !array->in_place) {
        return parian_fail(out->env, PARIAN_E_ARGUMENT,
                           "%s: rule %d: an array for %s, which its form goes without", out->where,
                           RULE_CHUNK_UNEXPECTED, array->name);
    }
    return PARIAN_OK;
}

static parian_result judge_arrays(const object_writer *out, const parian_schema_array *array,
                                  const void *base, const parian_body *body,
                                  const parian_schema_counts *counts)
{
    parian_result result = PARIAN_OK;
    bool wanted;
    for (; array->name && result == PARIAN_OK; array++) {
        result = judge_array(out, array, base, body, counts, &wanted);
    }
    return result;
}

static parian_result write_arrays(const object_writer *out, const parian_schema_array *array,
                                  const void *base, const parian_body *body,
                                  const parian_schema_counts *counts)
{
    for (; array->name; array++) {
        uint64_t shape[PARIAN_CHUNK_RANK_MAX];
        bool wanted;
        parian_result result = judge_array(out, array, base, body, counts, &wanted);
        if (result == PARIAN_OK && wanted) {
            parian_schema_shape(array, counts, shape);
            result = write_chunk(out, array->name, array->element, array->codec, array->rank, shape,
                                 array_data(array, base));
        }
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}

/* ---- a body -------------------------------------------------------------------------------------
 */

static parian_result write_operator(const object_writer *body_out, const parian_operator *op,
                                    uint32_t index)
{
    object_writer out = *body_out;
    parian_schema_counts counts;
    uint64_t settings[OPERATOR_TOTAL] = {
        [OPERATOR_SOURCE] = op->source_register, [OPERATOR_TARGET] = op->target_register,
        [OPERATOR_ROW_COUNT] = op->row_count,    [OPERATOR_COLUMN_COUNT] = op->column_count,
        [OPERATOR_RUN_TOTAL] = op->run_total,    [OPERATOR_FACTOR_TOTAL] = op->factor_total,
    };
    out.level = index;
    parian_schema_operator_counts(op, &counts);
    parian_result result =
        write_vector(&out, "operator.settings", PARIAN_ELEMENT_U64, OPERATOR_TOTAL, settings);
    return result == PARIAN_OK ? write_arrays(&out, parian_operator_arrays, op, NULL, &counts)
                               : result;
}

static parian_result write_settings(const object_writer *out, const parian_body *body,
                                    uint32_t border_entries)
{
    uint32_t settings[SETTING_TOTAL] = {
        [SETTING_BSSRDF] = (uint32_t)body->bssrdf,
        [SETTING_FIT_FDR] = body->fit_fdr,
        [SETTING_PAPER_FORM] = body->paper_form,
        [SETTING_REDUCED_ONLY] = body->medium.reduced_only,
        [SETTING_ATLAS_SIZE] = body->atlas_size,
        [SETTING_CHART_COUNT] = body->chart_count,
        [SETTING_LOCAL_FORM] = (uint32_t)body->local_form,
        [SETTING_KERNEL_WIDTH] = body->kernel_width,
        [SETTING_OPERATOR_COUNT] = body->operator_count,
        [SETTING_VERTEX_COUNT] = body->vertex_count,
        [SETTING_TRIANGLE_COUNT] = body->triangle_count,
        [SETTING_TEXEL_COUNT] = body->texel_count,
        [SETTING_GUTTER_COUNT] = body->gutter_count,
        [SETTING_BORDER_COUNT] = body->border_count,
        [SETTING_BORDER_ENTRY_COUNT] = border_entries,
    };
    return write_vector(out, "body.settings", PARIAN_ELEMENT_U32, SETTING_TOTAL, settings);
}

static parian_result write_body_texts(const object_writer *out, const parian_body *body)
{
    parian_result result = write_name(out, "body.name", body->name);
    if (result == PARIAN_OK) {
        result = write_name(out, "medium.name", body->medium.name);
    }
    if (result == PARIAN_OK) {
        result = write_name(out, "medium.source", body->medium.source);
    }
    if (result == PARIAN_OK && body->plan_json) {
        result = write_text(out, "body.plan", body->plan_json);
    }
    return result;
}

/* What the reader will ask for is asked before a byte is written. */
static parian_result check_body(const object_writer *out, const parian_body *body,
                                const parian_schema_counts *counts)
{
    parian_result result = parian_body_check_settings(out->env, body, out->where);
    if (result == PARIAN_OK) {
        result = judge_arrays(out, parian_body_arrays, body, body, counts);
    }
    for (uint32_t i = 0; i < body->operator_count && result == PARIAN_OK; i++) {
        parian_schema_counts op_counts;
        parian_schema_operator_counts(&body->operators[i], &op_counts);
        result = judge_arrays(out, parian_operator_arrays, &body->operators[i], NULL, &op_counts);
    }
    if (result == PARIAN_OK) {
        result = parian_body_check(out->env, body, out->where);
    }
    return result == PARIAN_E_FORMAT ? PARIAN_E_ARGUMENT : result;
}

static parian_result write_body(const object_writer *out, const parian_body *body)
{
    parian_schema_counts counts;
    uint32_t border_entries = body->border_offset ? body->border_offset[body->border_count] : 0;
    parian_schema_body_counts(body, border_entries, &counts);
    parian_result result = check_body(out, body, &counts);
    if (result == PARIAN_OK) {
        result = write_settings(out, body, border_entries);
    }
    if (result == PARIAN_OK) {
        result = write_body_texts(out, body);
    }
    if (result == PARIAN_OK) {
        result = write_arrays(out, parian_body_arrays, body, body, &counts);
    }
    for (uint32_t i = 0; i < body->operator_count && result == PARIAN_OK; i++) {
        result = write_operator(out, &body->operators[i], i);
    }
    return result;
}

/* ---- surroundings and scene ---------------------------------------------------------------------
 */

static parian_result write_surrounding(const object_writer *out,
                                       const parian_surrounding *surrounding)
{
    uint32_t count[2] = {surrounding->vertex_count, surrounding->triangle_count};
    parian_schema_counts counts;
    parian_schema_surrounding_counts(surrounding, &counts);
    parian_result result = judge_arrays(out, parian_surrounding_arrays, surrounding, NULL, &counts);
    if (result == PARIAN_OK) {
        result = parian_surrounding_check(out->env, surrounding, out->where);
    }
    if (result != PARIAN_OK) {
        return result == PARIAN_E_FORMAT ? PARIAN_E_ARGUMENT : result;
    }
    result = write_vector(out, "surrounding.counts", PARIAN_ELEMENT_U32, 2, count);
    if (result == PARIAN_OK) {
        result = write_name(out, "surrounding.name", surrounding->name);
    }
    return result == PARIAN_OK
               ? write_arrays(out, parian_surrounding_arrays, surrounding, NULL, &counts)
               : result;
}

static parian_result write_scene(const object_writer *out, const parian_scene_data *scene)
{
    uint32_t count[2] = {scene->body_count, scene->surrounding_count};
    parian_result result = write_vector(out, "scene.counts", PARIAN_ELEMENT_U32, 2, count);
    if (result == PARIAN_OK && scene->lights_json) {
        result = write_text(out, "scene.lights", scene->lights_json);
    }
    if (result == PARIAN_OK && scene->provenance_json) {
        result = write_text(out, "scene.provenance", scene->provenance_json);
    }
    return result;
}

parian_result parian_scene_data_write(parian_writer *writer, const parian_scene_data *scene)
{
    char where[WHERE_MAX] = "the scene";
    object_writer out = {parian_writer_env(writer), writer, 0, 0, where};
    parian_result result = write_scene(&out, scene);
    for (uint32_t i = 0; i < scene->body_count && result == PARIAN_OK; i++) {
        snprintf(where, sizeof where, "body %u (%.63s)", i, scene->bodies[i].name);
        out.object = i;
        result = write_body(&out, &scene->bodies[i]);
    }
    for (uint32_t i = 0; i < scene->surrounding_count && result == PARIAN_OK; i++) {
        snprintf(where, sizeof where, "surrounding %u (%.63s)", i, scene->surroundings[i].name);
        out.object = i;
        result = write_surrounding(&out, &scene->surroundings[i]);
    }
    return result;
}
