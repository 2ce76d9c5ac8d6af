/* body_file_read.c - reads a scene from a container; what does not fit the schema is refused.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/body_file.h"

#include <stdio.h>
#include <string.h>

#include "core/body_schema.h"
#include "core/memory.h"

enum {
    WHERE_MAX = 512,
    CHUNKS_PER_BODY_MIN = 20,
    CHUNKS_PER_SURROUNDING_MIN = 5,
    TEXT_MAX = 1 << 24
};

/* One object of the file on its way into memory. */
typedef struct object_reader {
    const parian_env *env;
    const parian_reader *reader;
    uint8_t *used; /* [chunk count] chunks that were read */
    uint32_t object, level;
    char where[WHERE_MAX]; /* begins messages: file and object */
} object_reader;

static void name_place(object_reader *in, const char *kind, uint32_t object)
{
    in->object = object;
    in->level = 0;
    snprintf(in->where, sizeof in->where, "%.400s: %s %u", parian_reader_name(in->reader), kind,
             object);
}

/* Find a chunk and check element and shape against what is expected. NULL with PARIAN_OK: not
 * there. */
static parian_result find_chunk(object_reader *in, const char *name, parian_element element,
                                uint32_t rank, const uint64_t *shape, int64_t *index)
{
    *index = parian_reader_find(in->reader, name, in->object, in->level);
    if (*index < 0) {
        return PARIAN_OK;
    }
    const parian_chunk_info *info = parian_reader_chunk(in->reader, (uint32_t)*index);
    bool same = info->element == element && info->rank == rank;
    for (uint32_t i = 0; same && i < rank; i++) {
        same = info->shape[i] == shape[i];
    }
    in->used[*index] = 1;
    if (same) {
        return PARIAN_OK;
    }
    return parian_fail(in->env, PARIAN_E_FORMAT,
                       "%s: rule %d: chunk %s is %s [%llu][%llu][%llu][%llu], expected %s "
                       "[%llu][%llu][%llu][%llu]",
                       in->where, RULE_CHUNK_SHAPE, name, parian_element_name(info->element),
                       (unsigned long long)info->shape[0], (unsigned long long)info->shape[1],
                       (unsigned long long)info->shape[2], (unsigned long long)info->shape[3],
                       parian_element_name(element), (unsigned long long)shape[0],
                       (unsigned long long)(rank > 1 ? shape[1] : 0),
                       (unsigned long long)(rank > 2 ? shape[2] : 0),
                       (unsigned long long)(rank > 3 ? shape[3] : 0));
}

static parian_result fail_missing(const object_reader *in, const char *name)
{
    return parian_fail(in->env, PARIAN_E_FORMAT, "%s: rule %d: chunk %s is missing", in->where,
                       RULE_CHUNK_MISSING, name);
}

static parian_result read_vector(object_reader *in, const char *name, parian_element element,
                                 uint64_t count, void *values)
{
    int64_t index;
    parian_result result = find_chunk(in, name, element, 1, &count, &index);
    if (result == PARIAN_OK && index < 0) {
        result = fail_missing(in, name);
    }
    return result == PARIAN_OK ? parian_reader_read(in->reader, (uint32_t)index, values) : result;
}

/* ---- arrays by table ----------------------------------------------------------------------------
 */

static parian_result read_pointer(const object_reader *in, int64_t index, unsigned char *field)
{
    const parian_chunk_info *info = parian_reader_chunk(in->reader, (uint32_t)index);
    void *data = parian_alloc(in->env, info->size, 1);
    if (!data) {
        return parian_fail(in->env, PARIAN_E_NOMEM, "%s: no memory for the %llu bytes of %s",
                           in->where, (unsigned long long)info->size, info->name);
    }
    memcpy(field, &data, sizeof data); /* the body owns it from here on, whatever happens */
    return parian_reader_read(in->reader, (uint32_t)index, data);
}

static parian_result read_array(object_reader *in, const parian_schema_array *array,
                                unsigned char *field, int presence,
                                const parian_schema_counts *counts)
{
    uint64_t shape[PARIAN_CHUNK_RANK_MAX];
    int64_t index;
    parian_schema_shape(array, counts, shape);
    parian_result result = find_chunk(in, array->name, array->element, array->rank, shape, &index);
    if (result != PARIAN_OK) {
        return result;
    }
    if (index < 0) {
        return presence > 0 ? fail_missing(in, array->name) : PARIAN_OK;
    }
    return array->in_place ? parian_reader_read(in->reader, (uint32_t)index, field)
                           : read_pointer(in, index, field);
}

static parian_result read_arrays(object_reader *in, const parian_schema_array *array, void *base,
                                 const parian_body *body, const parian_schema_counts *counts)
{
    parian_result result = PARIAN_OK;
    for (; array->name && result == PARIAN_OK; array++) {
        int presence = body ? parian_schema_presence(array, body) : 1;
        if (presence >= 0) {
            result = read_array(in, array, (unsigned char *)base + array->field, presence, counts);
        }
    }
    return result;
}

/* ---- texts --------------------------------------------------------------------------------------
 */

/* Names are shown on terminals: no control characters. JSON may be laid out. */
static bool is_clean(const char *text, size_t size, bool json)
{
    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)text[i];
        bool layout = c == '\n' || c == '\t' || c == '\r';
        if (c == 0x7f || (c < 0x20 && !(json && layout))) {
            return false;
        }
    }
    return true;
}

/* Find a text of at most size_max bytes; *size 0 and index -1 where there is none. */
static parian_result find_text(object_reader *in, const char *name, size_t size_max, int64_t *index,
                               size_t *size)
{
    *size = 0;
    *index = parian_reader_find(in->reader, name, in->object, in->level);
    if (*index < 0) {
        return PARIAN_OK;
    }
    const parian_chunk_info *info = parian_reader_chunk(in->reader, (uint32_t)*index);
    in->used[*index] = 1;
    if (info->element != PARIAN_ELEMENT_U8 || info->rank != 1 || info->size > size_max) {
        return parian_fail(in->env, PARIAN_E_FORMAT,
                           "%s: rule %d: %s is a text of at most %zu bytes, found %llu", in->where,
                           RULE_TEXT, name, size_max, (unsigned long long)info->size);
    }
    *size = (size_t)info->size;
    return PARIAN_OK;
}

static parian_result read_text(object_reader *in, const char *name, int64_t index, char *text,
                               size_t size, bool json)
{
    parian_result result = parian_reader_read(in->reader, (uint32_t)index, text);
    text[size] = 0;
    if (result == PARIAN_OK && !is_clean(text, size, json)) {
        return parian_fail(in->env, PARIAN_E_FORMAT, "%s: rule %d: %s holds control characters",
                           in->where, RULE_TEXT, name);
    }
    return result;
}

/* Into a zeroed array of size_max bytes; absent is empty. */
static parian_result read_name(object_reader *in, const char *name, char *text, size_t size_max)
{
    int64_t index;
    size_t size;
    parian_result result = find_text(in, name, size_max - 1, &index, &size);
    return result != PARIAN_OK || index < 0 ? result
                                            : read_text(in, name, index, text, size, false);
}

static parian_result read_json(object_reader *in, const char *name, char **json)
{
    int64_t index;
    size_t size;
    parian_result result = find_text(in, name, TEXT_MAX, &index, &size);
    if (result != PARIAN_OK || index < 0) {
        return result;
    }
    *json = parian_alloc(in->env, size + 1, 1);
    if (!*json) {
        return parian_fail(in->env, PARIAN_E_NOMEM, "%s: no memory for %s", in->where, name);
    }
    return read_text(in, name, index, *json, size, true);
}

/* ---- a body -------------------------------------------------------------------------------------
 */

static parian_result fail_settings(const object_reader *in, const char *name)
{
    return parian_fail(in->env, PARIAN_E_FORMAT, "%s: rule %d: a value of %s is out of its range",
                       in->where, RULE_SETTING, name);
}

static parian_result read_settings(object_reader *in, parian_body *body, uint32_t *border_entries)
{
    uint32_t s[SETTING_TOTAL];
    parian_result result = read_vector(in, "body.settings", PARIAN_ELEMENT_U32, SETTING_TOTAL, s);
    if (result != PARIAN_OK) {
        return result;
    }
    if (s[SETTING_FIT_FDR] > 1 || s[SETTING_PAPER_FORM] > 1 || s[SETTING_REDUCED_ONLY] > 1 ||
        s[SETTING_BSSRDF] > PARIAN_BSSRDF_DIPOLE_FLUX ||
        s[SETTING_LOCAL_FORM] > PARIAN_LOCAL_ONLY ||
        s[SETTING_OPERATOR_COUNT] > PARIAN_MAX_OPERATORS || s[SETTING_RESERVED] != 0) {
        return fail_settings(in, "body.settings");
    }
    body->bssrdf = (parian_bssrdf)s[SETTING_BSSRDF];
    body->fit_fdr = s[SETTING_FIT_FDR] != 0;
    body->paper_form = s[SETTING_PAPER_FORM] != 0;
    body->medium.reduced_only = s[SETTING_REDUCED_ONLY] != 0;
    body->atlas_size = s[SETTING_ATLAS_SIZE];
    body->chart_count = s[SETTING_CHART_COUNT];
    body->local_form = (parian_local_form)s[SETTING_LOCAL_FORM];
    body->kernel_width = s[SETTING_KERNEL_WIDTH];
    body->operator_count = s[SETTING_OPERATOR_COUNT];
    body->has_global = body->operator_count > 0;
    body->vertex_count = s[SETTING_VERTEX_COUNT];
    body->triangle_count = s[SETTING_TRIANGLE_COUNT];
    body->texel_count = s[SETTING_TEXEL_COUNT];
    body->gutter_count = s[SETTING_GUTTER_COUNT];
    body->border_count = s[SETTING_BORDER_COUNT];
    *border_entries = s[SETTING_BORDER_ENTRY_COUNT];
    return PARIAN_OK;
}

static parian_result read_operator(object_reader *in, parian_operator *op)
{
    uint64_t s[OPERATOR_TOTAL];
    parian_schema_counts counts;
    parian_result result =
        read_vector(in, "operator.settings", PARIAN_ELEMENT_U64, OPERATOR_TOTAL, s);
    if (result != PARIAN_OK) {
        return result;
    }
    for (int i = 0; i < OPERATOR_FACTOR_TOTAL; i++) {
        if (s[i] >= UINT32_MAX) {
            return fail_settings(in, "operator.settings");
        }
    }
    op->source_register = (uint32_t)s[OPERATOR_SOURCE];
    op->target_register = (uint32_t)s[OPERATOR_TARGET];
    op->row_count = (uint32_t)s[OPERATOR_ROW_COUNT];
    op->column_count = (uint32_t)s[OPERATOR_COLUMN_COUNT];
    op->run_total = (uint32_t)s[OPERATOR_RUN_TOTAL];
    op->factor_total = s[OPERATOR_FACTOR_TOTAL];
    parian_schema_operator_counts(op, &counts);
    return read_arrays(in, parian_operator_arrays, op, NULL, &counts);
}

static parian_result read_body_texts(object_reader *in, parian_body *body)
{
    parian_result result = read_name(in, "body.name", body->name, sizeof body->name);
    if (result == PARIAN_OK) {
        result = read_name(in, "medium.name", body->medium.name, sizeof body->medium.name);
    }
    if (result == PARIAN_OK) {
        result = read_name(in, "medium.source", body->medium.source, sizeof body->medium.source);
    }
    return result == PARIAN_OK ? read_json(in, "body.plan", &body->plan_json) : result;
}

static parian_result read_body_arrays(object_reader *in, parian_body *body, uint32_t border_entries)
{
    parian_schema_counts counts;
    parian_schema_body_counts(body, border_entries, &counts);
    parian_result result = read_arrays(in, parian_body_arrays, body, body, &counts);
    if (result == PARIAN_OK && body->border_offset[body->border_count] != border_entries) {
        return parian_fail(in->env, PARIAN_E_FORMAT,
                           "%s: rule %d: border.offset ends at %u, there are %u entries", in->where,
                           RULE_OFFSETS, body->border_offset[body->border_count], border_entries);
    }
    for (uint32_t i = 0; i < body->operator_count && result == PARIAN_OK; i++) {
        in->level = i;
        result = read_operator(in, &body->operators[i]);
    }
    in->level = 0;
    return result;
}

static parian_result read_body(object_reader *in, parian_body *body)
{
    uint32_t border_entries = 0;
    parian_result result = read_settings(in, body, &border_entries);
    if (result == PARIAN_OK) {
        result = parian_body_check_settings(in->env, body, in->where);
    }
    if (result == PARIAN_OK) {
        result = read_body_texts(in, body);
    }
    if (result == PARIAN_OK) {
        result = read_body_arrays(in, body, border_entries);
    }
    if (result == PARIAN_OK) {
        result = parian_body_check(in->env, body, in->where);
    }
    return result == PARIAN_OK ? parian_body_derive(in->env, body) : result;
}

/* ---- surroundings -------------------------------------------------------------------------------
 */

static parian_result read_surrounding(object_reader *in, parian_surrounding *surrounding)
{
    uint32_t count[2];
    parian_schema_counts counts;
    parian_result result = read_vector(in, "surrounding.counts", PARIAN_ELEMENT_U32, 2, count);
    if (result != PARIAN_OK) {
        return result;
    }
    surrounding->vertex_count = count[0];
    surrounding->triangle_count = count[1];
    parian_schema_surrounding_counts(surrounding, &counts);
    result = read_name(in, "surrounding.name", surrounding->name, sizeof surrounding->name);
    if (result == PARIAN_OK) {
        result = read_arrays(in, parian_surrounding_arrays, surrounding, NULL, &counts);
    }
    return result == PARIAN_OK ? parian_surrounding_check(in->env, surrounding, in->where) : result;
}

/* ---- the scene ----------------------------------------------------------------------------------
 */

static bool in_table(const parian_schema_array *array, const char *name, parian_codec *codec)
{
    for (; array->name; array++) {
        if (strcmp(array->name, name) == 0) {
            *codec = array->codec;
            return true;
        }
    }
    return false;
}

static bool in_list(const char *const *list, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(list[i], name) == 0) {
            return true;
        }
    }
    return false;
}

bool parian_scene_knows_chunk(const char *name, parian_codec *codec)
{
    static const char *const counts[] = {"scene.counts", "body.settings", "operator.settings",
                                         "surrounding.counts"};
    static const char *const texts[] = {"scene.lights",    "scene.provenance", "body.name",
                                        "body.plan",       "medium.name",      "medium.source",
                                        "surrounding.name"};
    bool count = in_list(counts, sizeof counts / sizeof *counts, name);
    if (count || in_list(texts, sizeof texts / sizeof *texts, name)) {
        *codec = count ? PARIAN_CODEC_RAW : PARIAN_CODEC_ZSTD;
        return true;
    }
    return in_table(parian_body_arrays, name, codec) ||
           in_table(parian_operator_arrays, name, codec) ||
           in_table(parian_surrounding_arrays, name, codec);
}

parian_result parian_scene_check_required(const parian_env *env, const parian_reader *reader)
{
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        parian_codec codec;
        if ((info->flags & PARIAN_CHUNK_REQUIRED) &&
            !parian_scene_knows_chunk(info->name, &codec)) {
            return parian_fail(env, PARIAN_E_UNSUPPORTED,
                               "%s: rule %d: chunk %s is required and unknown to this program",
                               parian_reader_name(reader), RULE_CHUNK_UNKNOWN, info->name);
        }
    }
    return PARIAN_OK;
}

/* Judge the chunks that nothing asked for. */
static parian_result check_rest(const object_reader *in)
{
    for (uint32_t i = 0; i < parian_reader_chunk_count(in->reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(in->reader, i);
        parian_codec codec;
        if (in->used[i]) {
            continue;
        }
        if (parian_scene_knows_chunk(info->name, &codec)) {
            return parian_fail(
                in->env, PARIAN_E_FORMAT,
                "%s: rule %d: chunk %s of object %u, level %u does not go with the file's settings",
                parian_reader_name(in->reader), RULE_CHUNK_UNEXPECTED, info->name, info->object,
                info->level);
        }
        parian_result result = parian_reader_check(in->reader, i);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}

static parian_result read_counts(object_reader *in, parian_scene_data *scene)
{
    uint32_t count[2];
    uint64_t chunks = parian_reader_chunk_count(in->reader);
    parian_result result = read_vector(in, "scene.counts", PARIAN_ELEMENT_U32, 2, count);
    if (result != PARIAN_OK) {
        return result;
    }
    if ((uint64_t)count[0] * CHUNKS_PER_BODY_MIN + (uint64_t)count[1] * CHUNKS_PER_SURROUNDING_MIN >
        chunks) {
        return parian_fail(in->env, PARIAN_E_FORMAT,
                           "%s: rule %d: %u bodies and %u surroundings in %llu chunks", in->where,
                           RULE_COUNTS, count[0], count[1], (unsigned long long)chunks);
    }
    if (!PARIAN_NEW0(in->env, scene->bodies, count[0]) ||
        !PARIAN_NEW0(in->env, scene->surroundings, count[1])) {
        return parian_fail(in->env, PARIAN_E_NOMEM, "%s: no memory for %u bodies", in->where,
                           count[0]);
    }
    scene->body_count = count[0];
    scene->surrounding_count = count[1];
    return PARIAN_OK;
}

static parian_result read_objects(object_reader *in, parian_scene_data *scene)
{
    parian_result result = read_counts(in, scene);
    if (result == PARIAN_OK) {
        result = read_json(in, "scene.lights", &scene->lights_json);
    }
    if (result == PARIAN_OK) {
        result = read_json(in, "scene.provenance", &scene->provenance_json);
    }
    for (uint32_t i = 0; i < scene->body_count && result == PARIAN_OK; i++) {
        name_place(in, "body", i);
        result = read_body(in, &scene->bodies[i]);
    }
    for (uint32_t i = 0; i < scene->surrounding_count && result == PARIAN_OK; i++) {
        name_place(in, "surrounding", i);
        result = read_surrounding(in, &scene->surroundings[i]);
    }
    return result;
}

parian_result parian_scene_data_read(const parian_env *env, const parian_reader *reader,
                                     parian_scene_data *scene)
{
    object_reader in = {.env = env, .reader = reader};
    parian_scene_data made = {0};
    snprintf(in.where, sizeof in.where, "%.400s: scene", parian_reader_name(reader));
    if (!PARIAN_NEW0(env, in.used, parian_reader_chunk_count(reader))) {
        return parian_fail(env, PARIAN_E_NOMEM, "%s: no memory to read it",
                           parian_reader_name(reader));
    }
    parian_result result = parian_scene_check_required(env, reader);
    if (result == PARIAN_OK) {
        result = read_objects(&in, &made);
    }
    if (result == PARIAN_OK) {
        result = check_rest(&in);
    }
    parian_free(env, in.used);
    if (result != PARIAN_OK) {
        parian_scene_data_free(env, &made);
        return result;
    }
    *scene = made;
    return PARIAN_OK;
}
