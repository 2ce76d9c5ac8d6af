/* import_stl.c - checks an STL file, text or binary, and leaves a binary one.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>
#include <strings.h>

#include "bake/stages/import_check.h"
#include "core/memory.h"

enum { STL_HEADER = 84, STL_RECORD = 50 };

static uint32_t read_count(const char *at)
{
    const uint8_t *byte = (const uint8_t *)at;
    return byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

/* Append a record: a zero normal, nine coordinates, no attributes. */
static parian_result append_record(parian_plain_file *plain, const float corner[9])
{
    char record[STL_RECORD] = {0};
    memcpy(record + 12, corner, 36);
    return parian_plain_append(plain, record, sizeof record);
}

static parian_result write_header(parian_plain_file *plain, uint32_t count)
{
    char header[STL_HEADER] = "binary STL";
    for (int k = 0; k < 4; k++) {
        header[80 + k] = (char)(count >> (8 * k));
    }
    return parian_plain_append(plain, header, sizeof header);
}

static parian_result check_binary(const parian_model_bytes *file, uint32_t count,
                                  parian_plain_file *plain)
{
    parian_result result = write_header(plain, count);
    for (uint32_t i = 0; i < count && result == PARIAN_OK; i++) {
        float corner[9];
        memcpy(corner, file->data + STL_HEADER + (size_t)i * STL_RECORD + 12, sizeof corner);
        for (int k = 0; k < 9; k++) {
            if (!isfinite(corner[k])) {
                return parian_fail(plain->env, PARIAN_E_FORMAT,
                                   "%s: triangle %u has a coordinate that is not finite",
                                   file->path, i);
            }
        }
        result = append_record(plain, corner);
    }
    return result;
}

/* The three coordinates behind the word vertex. */
static parian_result read_vertex(const parian_model_bytes *file, const parian_env *env,
                                 uint32_t number, parian_span line, float corner[3])
{
    for (int k = 0; k < 3; k++) {
        parian_span word = {line.end, line.end};
        double value;
        char shown[24];
        if (!parian_scan_word(&line, &word) || !parian_span_finite(word, &value) ||
            !isfinite((float)value)) {
            return parian_fail(env, PARIAN_E_FORMAT,
                               "%s:%u: vertex coordinate '%s', expected a finite number",
                               file->path, number, parian_span_show(word, shown));
        }
        corner[k] = (float)value;
    }
    return PARIAN_OK;
}

static bool is_word(parian_span word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word.end - word.begin) == length && strncasecmp(word.begin, text, length) == 0;
}

static parian_result check_text(const parian_model_bytes *file, parian_plain_file *plain)
{
    parian_scan scan = {file->data, file->data + file->size, 0};
    parian_result result = write_header(plain, 0);
    parian_span line, word;
    float corner[9];
    uint32_t corner_count = 0, count = 0;
    bool ended = false;
    while (result == PARIAN_OK && parian_scan_line(&scan, &line)) {
        parian_scan_word(&line, &word);
        ended = is_word(word, "endsolid");
        if (is_word(word, "vertex")) {
            if (corner_count == 3) {
                return parian_fail(plain->env, PARIAN_E_FORMAT,
                                   "%s:%u: a facet with more than 3 vertices", file->path,
                                   scan.line);
            }
            result = read_vertex(file, plain->env, scan.line, line, &corner[3 * corner_count++]);
        } else if (is_word(word, "endfacet")) {
            if (corner_count != 3) {
                return parian_fail(plain->env, PARIAN_E_FORMAT,
                                   "%s:%u: a facet with %u vertices, expected 3", file->path,
                                   scan.line, corner_count);
            }
            result = append_record(plain, corner);
            corner_count = 0;
            count++;
        }
    }
    if (result == PARIAN_OK && !ended) {
        return parian_fail(plain->env, PARIAN_E_FORMAT,
                           "%s:%u: the file ends without endsolid: it is cut short", file->path,
                           scan.line);
    }
    if (result == PARIAN_OK && count == 0) {
        return parian_fail(plain->env, PARIAN_E_FORMAT, "%s: no facets, expected some", file->path);
    }
    for (int k = 0; k < 4 && result == PARIAN_OK; k++) {
        plain->data[80 + k] = (char)(count >> (8 * k));
    }
    return result;
}

parian_result parian_check_stl(const parian_model_bytes *file, parian_plain_file *plain)
{
    uint32_t count = file->size >= STL_HEADER ? read_count(file->data + 80) : 0;
    uint64_t needed = STL_HEADER + (uint64_t)count * STL_RECORD;
    bool named_solid = file->size >= 5 && strncasecmp(file->data, "solid", 5) == 0;
    bool fits = file->size >= STL_HEADER && needed <= file->size;
    plain->binary = true;
    if (named_solid && !(fits && needed == file->size)) {
        return check_text(file, plain);
    }
    if (!fits) {
        return parian_fail(plain->env, PARIAN_E_FORMAT,
                           "%s: a binary STL of %zu bytes, expected %llu for its %u triangles",
                           file->path, file->size, (unsigned long long)needed, count);
    }
    if (count == 0) {
        return parian_fail(plain->env, PARIAN_E_FORMAT, "%s: no triangles, expected some",
                           file->path);
    }
    return check_binary(file, count, plain);
}
