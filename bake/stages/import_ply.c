/* import_ply.c - checks a PLY file (text, binary of either byte order) and leaves positions and
 * faces.
 *
 * What is left is a binary little-endian PLY with float positions and int lists, whatever else the
 * file held.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/import_check.h"
#include "core/memory.h"

enum { PROPERTY_MAX = 256, ELEMENT_MAX = 64 };

typedef enum ply_type {
    PLY_NONE,
    PLY_I8,
    PLY_U8,
    PLY_I16,
    PLY_U16,
    PLY_I32,
    PLY_U32,
    PLY_F32,
    PLY_F64
} ply_type;

typedef struct ply_property {
    ply_type type;
    ply_type count_type; /* of a list, else PLY_NONE */
    int axis;            /* 0 1 2: coordinate of a vertex; 3: corners of a face; -1: passed over */
} ply_property;

typedef struct ply_element {
    char name[16];
    int64_t count;
    uint32_t property_first, property_count;
} ply_element;

typedef struct ply_check {
    const parian_model_bytes *file;
    parian_plain_file *plain;
    parian_scan scan;
    enum { PLY_TEXT, PLY_LITTLE, PLY_BIG } form;
    ply_element element[ELEMENT_MAX];
    ply_property property[PROPERTY_MAX];
    uint32_t element_count, property_count;
    int64_t vertex_count, face_count;
} ply_check;

static parian_result refuse(const ply_check *check, const char *what)
{
    return parian_fail(check->plain->env, PARIAN_E_FORMAT, "%s:%u: %s", check->file->path,
                       check->scan.line, what);
}

static size_t type_size(ply_type type)
{
    static const size_t size[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return size[type];
}

static ply_type find_type(parian_span word)
{
    static const struct {
        const char *name;
        ply_type type;
    } table[] = {
        {"char", PLY_I8},   {"int8", PLY_I8},     {"uchar", PLY_U8},   {"uint8", PLY_U8},
        {"short", PLY_I16}, {"int16", PLY_I16},   {"ushort", PLY_U16}, {"uint16", PLY_U16},
        {"int", PLY_I32},   {"int32", PLY_I32},   {"uint", PLY_U32},   {"uint32", PLY_U32},
        {"float", PLY_F32}, {"float32", PLY_F32}, {"double", PLY_F64}, {"float64", PLY_F64}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (parian_span_is(word, table[i].name)) {
            return table[i].type;
        }
    }
    return PLY_NONE;
}

static parian_result read_format(ply_check *check, parian_span line)
{
    parian_span word = {line.end, line.end};
    parian_scan_word(&line, &word);
    if (parian_span_is(word, "ascii")) {
        check->form = PLY_TEXT;
    } else if (parian_span_is(word, "binary_little_endian")) {
        check->form = PLY_LITTLE;
    } else if (parian_span_is(word, "binary_big_endian")) {
        check->form = PLY_BIG;
    } else {
        return refuse(check, "an unknown PLY format, expected ascii, binary_little_endian or "
                             "binary_big_endian");
    }
    return PARIAN_OK;
}

static parian_result read_element(ply_check *check, parian_span line)
{
    parian_span word;
    if (check->element_count == ELEMENT_MAX || !parian_scan_word(&line, &word)) {
        return refuse(check, "an element line without a name, or too many elements");
    }
    ply_element *element = &check->element[check->element_count++];
    size_t length = (size_t)(word.end - word.begin);
    length = length < sizeof element->name - 1 ? length : sizeof element->name - 1;
    memcpy(element->name, word.begin, length);
    element->name[length] = '\0';
    element->property_first = check->property_count;
    if (!parian_scan_word(&line, &word) ||
        !parian_span_integer(word, 0, (int64_t)check->file->size, &element->count)) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s:%u: element %s has a count that a file of %zu bytes cannot hold",
                           check->file->path, check->scan.line, element->name, check->file->size);
    }
    return PARIAN_OK;
}

static int find_axis(const ply_element *element, parian_span name, bool list)
{
    static const char *const axes[] = {"x", "y", "z"};
    if (strcmp(element->name, "vertex") == 0 && !list) {
        for (int k = 0; k < 3; k++) {
            if (parian_span_is(name, axes[k])) {
                return k;
            }
        }
    }
    bool corners = parian_span_is(name, "vertex_indices") || parian_span_is(name, "vertex_index");
    return strcmp(element->name, "face") == 0 && list && corners ? 3 : -1;
}

static parian_result read_property(ply_check *check, parian_span line)
{
    ply_property *property = &check->property[check->property_count];
    parian_span word = {line.end, line.end};
    if (check->element_count == 0 || check->property_count == PROPERTY_MAX) {
        return refuse(check, "a property outside an element, or too many properties");
    }
    *property = (ply_property){.axis = -1};
    parian_scan_word(&line, &word);
    bool list = parian_span_is(word, "list");
    if (list) {
        parian_scan_word(&line, &word);
        property->count_type = find_type(word);
        parian_scan_word(&line, &word);
    }
    property->type = find_type(word);
    bool counted = !list || (property->count_type >= PLY_I8 && property->count_type <= PLY_U32);
    if (property->type == PLY_NONE || !counted || !parian_scan_word(&line, &word)) {
        return refuse(check, "a property without a known type and a name");
    }
    ply_element *element = &check->element[check->element_count - 1];
    property->axis = find_axis(element, word, list);
    if (property->axis == 3 && property->type >= PLY_F32) {
        return refuse(check, "vertex indices of a floating-point type");
    }
    check->property_count++;
    element->property_count++;
    return PARIAN_OK;
}

/* Every element of a kind that matters has what it needs, once, and the elements come once. */
static parian_result check_layout(ply_check *check)
{
    int seen[4] = {0};
    for (uint32_t e = 0; e < check->element_count; e++) {
        const ply_element *element = &check->element[e];
        for (uint32_t p = 0; p < element->property_count; p++) {
            int axis = check->property[element->property_first + p].axis;
            seen[axis < 0 ? 0 : axis] += axis >= 0;
        }
        if (strcmp(element->name, "vertex") == 0) {
            check->vertex_count = element->count;
        } else if (strcmp(element->name, "face") == 0) {
            check->face_count = element->count;
        }
        if (element->count > 0 && element->property_count == 0) {
            return refuse(check, "an element without properties");
        }
    }
    if (seen[0] != 1 || seen[1] != 1 || seen[2] != 1) {
        return refuse(check, "no vertex element with properties x, y and z, once each");
    }
    if (seen[3] != 1 || check->face_count == 0) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s: %lld vertices and no faces, expected faces with vertex_indices",
                           check->file->path, (long long)check->vertex_count);
    }
    return check->vertex_count < INT32_MAX ? PARIAN_OK : refuse(check, "too many vertices");
}

/* A header line ends at a newline; comments are whole lines. False at the end of the file. */
static bool next_header_line(ply_check *check, parian_span *line)
{
    const char *end = memchr(check->scan.at, '\n', (size_t)(check->scan.end - check->scan.at));
    if (!end) {
        return false;
    }
    *line = (parian_span){check->scan.at, end};
    check->scan.at = end + 1;
    check->scan.line++;
    return true;
}

static parian_result read_header(ply_check *check)
{
    parian_span line, word = {NULL, NULL};
    parian_result result = PARIAN_OK;
    bool formatted = false;
    if (!next_header_line(check, &line) || !parian_scan_word(&line, &word) ||
        !parian_span_is(word, "ply")) {
        return refuse(check, "the file does not begin with the line 'ply'");
    }
    while (result == PARIAN_OK) {
        if (!next_header_line(check, &line)) {
            return refuse(check, "the file ends inside its PLY header");
        }
        if (!parian_scan_word(&line, &word)) {
            continue;
        }
        if (parian_span_is(word, "end_header")) {
            break;
        }
        if (parian_span_is(word, "format")) {
            formatted = true;
            result = read_format(check, line);
        } else if (parian_span_is(word, "element")) {
            result = read_element(check, line);
        } else if (parian_span_is(word, "property")) {
            result = read_property(check, line);
        } else if (!parian_span_is(word, "comment") && !parian_span_is(word, "obj_info")) {
            result = refuse(check, "an unknown line in the PLY header");
        }
    }
    if (result == PARIAN_OK && !formatted) {
        result = refuse(check, "a PLY header without a format line");
    }
    return result == PARIAN_OK ? check_layout(check) : result;
}

static double decode(ply_type type, bool big, const char *at)
{
    uint64_t bits = 0;
    size_t size = type_size(type);
    for (size_t i = 0; i < size; i++) {
        bits |= (uint64_t)(uint8_t)at[big ? size - 1 - i : i] << (8 * i);
    }
    uint32_t low = (uint32_t)bits;
    float f32;
    double f64;
    switch (type) {
    case PLY_I8:
        return (int8_t)low;
    case PLY_I16:
        return (int16_t)low;
    case PLY_I32:
        return (int32_t)low;
    case PLY_F32:
        memcpy(&f32, &low, sizeof f32);
        return f32;
    case PLY_F64:
        memcpy(&f64, &bits, sizeof f64);
        return f64;
    default:
        return low;
    }
}

/* The next value of the body. False where the file ends or a word is no number. */
static bool next_value(ply_check *check, ply_type type, double *value)
{
    if (check->form != PLY_TEXT) {
        size_t size = type_size(type);
        if ((size_t)(check->scan.end - check->scan.at) < size) {
            return false;
        }
        *value = decode(type, check->form == PLY_BIG, check->scan.at);
        check->scan.at += size;
        return true;
    }
    parian_span word, rest = {check->scan.at, check->scan.end};
    char *end = NULL;
    if (!parian_scan_word(&rest, &word)) {
        check->scan.at = check->scan.end;
        return false;
    }
    bool finite = parian_span_finite(word, value);
    if (!finite) {
        *value = NAN; /* a property that is passed over may be nan */
        end = (char *)word.begin;
    }
    check->scan.at = rest.begin;
    return finite ||
           (end && (*end == 'n' || *end == 'N' || *end == '-' || *end == 'i' || *end == 'I'));
}

static parian_result fail_value(const ply_check *check, const ply_element *element, int64_t index)
{
    bool ended = check->scan.at >= check->scan.end || check->form != PLY_TEXT;
    return parian_fail(check->plain->env, PARIAN_E_FORMAT, "%s: %s in %s %lld of %lld",
                       check->file->path, ended ? "the file ends" : "a word that is no number",
                       element->name, (long long)index, (long long)element->count);
}

static parian_result read_list(ply_check *check, const ply_element *element,
                               const ply_property *property, int64_t index)
{
    double count, value;
    parian_result result = PARIAN_OK;
    if (!next_value(check, property->count_type, &count)) {
        return fail_value(check, element, index);
    }
    if (!(count >= 0 && count <= (double)(check->scan.end - check->scan.at))) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s: %s %lld announces a list of %.0f values, more than the file holds",
                           check->file->path, element->name, (long long)index, count);
    }
    bool wanted = property->axis == 3;
    int32_t corner = (int32_t)count;
    if (wanted) {
        result = parian_plain_append(check->plain, &corner, sizeof corner);
    }
    for (int64_t k = 0; k < (int64_t)count && result == PARIAN_OK; k++) {
        if (!next_value(check, property->type, &value)) {
            return fail_value(check, element, index);
        }
        if (wanted && !(value >= 0 && value < (double)check->vertex_count)) {
            return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                               "%s: face %lld names vertex %.0f of %lld", check->file->path,
                               (long long)index, value, (long long)check->vertex_count);
        }
        corner = wanted ? (int32_t)value : 0;
        result = wanted ? parian_plain_append(check->plain, &corner, sizeof corner) : PARIAN_OK;
    }
    return result;
}

static parian_result read_entry(ply_check *check, const ply_element *element, int64_t index)
{
    double value, position[3] = {0, 0, 0};
    for (uint32_t p = 0; p < element->property_count; p++) {
        const ply_property *property = &check->property[element->property_first + p];
        if (property->count_type != PLY_NONE) {
            parian_result result = read_list(check, element, property, index);
            if (result != PARIAN_OK) {
                return result;
            }
        } else if (!next_value(check, property->type, &value)) {
            return fail_value(check, element, index);
        } else if (property->axis >= 0) {
            position[property->axis] = value;
        }
    }
    if (strcmp(element->name, "vertex") != 0) {
        return PARIAN_OK;
    }
    float row[3] = {(float)position[0], (float)position[1], (float)position[2]};
    if (!isfinite(row[0]) || !isfinite(row[1]) || !isfinite(row[2])) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s: vertex %lld has a coordinate that is not finite", check->file->path,
                           (long long)index);
    }
    return parian_plain_append(check->plain, row, sizeof row);
}

static parian_result write_header(ply_check *check)
{
    static const char head[] = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    static const char middle[] =
        "\nproperty float x\nproperty float y\nproperty float z\nelement face ";
    static const char tail[] = "\nproperty list int int vertex_indices\nend_header\n";
    parian_result result = parian_plain_append(check->plain, head, sizeof head - 1);
    if (result == PARIAN_OK) {
        result = parian_plain_number(check->plain, (uint64_t)check->vertex_count);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_append(check->plain, middle, sizeof middle - 1);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_number(check->plain, (uint64_t)check->face_count);
    }
    return result == PARIAN_OK ? parian_plain_append(check->plain, tail, sizeof tail - 1) : result;
}

/* Faces before vertices are legal, so the two kinds are gathered apart. */
static parian_result read_body(ply_check *check, parian_plain_file *faces)
{
    parian_plain_file *const target = check->plain;
    parian_result result = PARIAN_OK;
    for (uint32_t e = 0; e < check->element_count && result == PARIAN_OK; e++) {
        const ply_element *element = &check->element[e];
        check->plain = strcmp(element->name, "face") == 0 ? faces : target;
        for (int64_t i = 0; i < element->count && result == PARIAN_OK; i++) {
            result = read_entry(check, element, i);
        }
    }
    check->plain = target;
    return result == PARIAN_OK ? parian_plain_append(target, faces->data, faces->size) : result;
}

parian_result parian_check_ply(const parian_model_bytes *file, parian_plain_file *plain)
{
    ply_check check = {
        .file = file, .plain = plain, .scan = {file->data, file->data + file->size, 0}};
    parian_plain_file faces = {.env = plain->env};
    plain->binary = true;
    parian_result result = read_header(&check);
    if (result == PARIAN_OK) {
        result = write_header(&check);
    }
    if (result == PARIAN_OK) {
        result = read_body(&check, &faces);
    }
    parian_free(plain->env, faces.data);
    return result;
}
