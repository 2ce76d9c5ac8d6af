/* npy_read.c - reads arrays of numbers in the .npy format, versions 1 to 3.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/half.h"
#include "core/memory.h"
#include "tool/files.h"

enum { PREFIX_V1 = 10, PREFIX_V2 = 12, HEADER_TEXT_MAX = 4096 };
static const uint64_t FILE_MAX = UINT64_C(1) << 33;

/* A file being read: its bytes, the header's text, and where the elements begin. */
typedef struct npy_file {
    const parian_env *env;
    const char *path;
    const uint8_t *data;
    size_t size, start;
    char text[HEADER_TEXT_MAX + 1];
    char kind; /* of NumPy: f, i, u, b */
    unsigned width;
} npy_file;

static parian_result find_header(npy_file *file)
{
    const uint8_t *d = file->data;
    if (file->size < PREFIX_V1 || memcmp(d, "\x93NUMPY", 6) != 0) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: does not begin as a .npy file does",
                           file->path);
    }
    bool long_form = d[6] >= 2;
    if (d[6] < 1 || d[6] > 3 || (long_form && file->size < PREFIX_V2)) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: npy version %d, expected 1 to 3",
                           file->path, d[6]);
    }
    size_t length = d[8] | (size_t)d[9] << 8;
    if (long_form) {
        length |= (size_t)d[10] << 16 | (size_t)d[11] << 24;
    }
    size_t prefix = long_form ? PREFIX_V2 : PREFIX_V1;
    if (length > HEADER_TEXT_MAX || length > file->size - prefix) {
        return parian_fail(file->env, PARIAN_E_FORMAT,
                           "%s: a header of %zu bytes, the file has %zu", file->path, length,
                           file->size - prefix);
    }
    memcpy(file->text, d + prefix, length);
    file->text[length] = '\0';
    file->start = prefix + length;
    return PARIAN_OK;
}

/* The text behind "'key':", or NULL. */
static const char *find_value(const npy_file *file, const char *key)
{
    size_t length = strlen(key);
    for (const char *at = file->text; (at = strstr(at, key)) != NULL; at += length) {
        const char *end = at + length;
        bool quoted = at > file->text && (at[-1] == '\'' || at[-1] == '"') && *end == at[-1];
        for (end += quoted; quoted && *end == ' '; end++) {
        }
        if (quoted && *end == ':') {
            for (end++; *end == ' '; end++) {
            }
            return end;
        }
    }
    return NULL;
}

static parian_result read_element(npy_file *file)
{
    static const char *const known[] = {"f2", "f4", "f8", "i1", "i2", "i4",
                                        "i8", "u1", "u2", "u4", "u8", "b1"};
    const char *value = find_value(file, "descr");
    if (value && (*value == '\'' || *value == '"')) {
        const char *code = value + 1;
        bool little = *code == '<' || *code == '|' || *code == '=';
        for (size_t i = 0; little && i < sizeof known / sizeof *known; i++) {
            if (strncmp(code + 1, known[i], 2) == 0 && code[3] == *value) {
                file->kind = known[i][0];
                file->width = (unsigned)(known[i][1] - '0');
                return PARIAN_OK;
            }
        }
    }
    if (!value || (*value != '\'' && *value != '"')) {
        return parian_fail(file->env, PARIAN_E_FORMAT,
                           "%s: elements %s, expected little-endian numbers", file->path,
                           value ? "are records" : "are not described");
    }
    return parian_fail(file->env, PARIAN_E_FORMAT,
                       "%s: elements are '%.*s', expected little-endian numbers", file->path,
                       (int)strcspn(value + 1, "'\""), value + 1);
}

static parian_result read_shape(const npy_file *file, parian_npy *array)
{
    const char *at = find_value(file, "shape"), *order = find_value(file, "fortran_order");
    if (!at || *at != '(' || !order) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: its header names no shape", file->path);
    }
    for (at += 1 + strspn(at + 1, " "); *at != ')'; at += strspn(at, ", ")) {
        char *end;
        unsigned long long n = strtoull(at, &end, 10);
        if (!isdigit((unsigned char)*at) || array->rank == PARIAN_CHUNK_RANK_MAX) {
            return parian_fail(file->env, PARIAN_E_FORMAT,
                               "%s: its shape is not one of up to %d numbers", file->path,
                               PARIAN_CHUNK_RANK_MAX);
        }
        array->shape[array->rank++] = n;
        at = end;
    }
    if (strncmp(order, "False", 5) != 0 && array->rank > 1) {
        return parian_fail(file->env, PARIAN_E_FORMAT,
                           "%s: columns first (Fortran order), expected rows first", file->path);
    }
    return PARIAN_OK;
}

/* The number of elements, which must be there. */
static parian_result count_elements(const npy_file *file, parian_npy *array)
{
    uint64_t room = (file->size - file->start) / file->width, count = 1;
    for (uint32_t i = 0; i < array->rank; i++) {
        if (array->shape[i] > 0 && count > room / array->shape[i]) {
            return parian_fail(file->env, PARIAN_E_FORMAT,
                               "%s: ends after %" PRIu64 " elements, its shape promises more",
                               file->path, room);
        }
        count *= array->shape[i];
    }
    if (count > room) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: ends before its one element",
                           file->path);
    }
    array->count = (size_t)count;
    return PARIAN_OK;
}

static double read_float(const uint8_t *bytes, unsigned width)
{
    uint16_t half;
    float single;
    double number;
    switch (width) {
    case 2:
        memcpy(&half, bytes, 2);
        return parian_half_to_float(half);
    case 4:
        memcpy(&single, bytes, 4);
        return single;
    default:
        memcpy(&number, bytes, 8);
        return number;
    }
}

static double read_number(const npy_file *file, size_t index)
{
    const uint8_t *bytes = file->data + file->start + index * file->width;
    uint64_t bits = 0;
    if (file->kind == 'f') {
        return read_float(bytes, file->width);
    }
    for (unsigned i = 0; i < file->width; i++) {
        bits |= (uint64_t)bytes[i] << (8 * i);
    }
    unsigned unused = 64 - 8 * file->width;
    return file->kind == 'i' ? (double)((int64_t)(bits << unused) >> unused) : (double)bits;
}

static parian_result read_array(npy_file *file, parian_npy *array)
{
    parian_result r = find_header(file);
    if (r == PARIAN_OK) {
        r = read_element(file);
    }
    if (r == PARIAN_OK) {
        r = read_shape(file, array);
    }
    if (r == PARIAN_OK) {
        r = count_elements(file, array);
    }
    if (r == PARIAN_OK && !PARIAN_NEW(file->env, array->value, array->count)) {
        r = parian_fail(file->env, PARIAN_E_NOMEM, "%s: no memory for %zu numbers", file->path,
                        array->count);
    }
    for (size_t i = 0; r == PARIAN_OK && i < array->count; i++) {
        array->value[i] = read_number(file, i);
    }
    return r;
}

parian_result parian_npy_read(const parian_env *env, const char *path, parian_npy *array)
{
    npy_file file = {.env = env, .path = path};
    uint8_t *data = NULL;
    *array = (parian_npy){0};
    parian_result r = parian_file_read(env, path, FILE_MAX, &data, &file.size);
    if (r == PARIAN_OK) {
        file.data = data;
        r = read_array(&file, array);
    }
    parian_free(env, data);
    return r;
}

void parian_npy_free(const parian_env *env, parian_npy *array)
{
    parian_free(env, array->value);
    *array = (parian_npy){0};
}
