/* import_obj.c - checks a Wavefront OBJ file and leaves its positions and faces.
 *
 * Lines other than v and f are passed over: a body has one medium, so material libraries are not
 * read.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/import_check.h"
#include "core/memory.h"

typedef struct obj_check {
    const parian_model_bytes *file;
    parian_plain_file *plain;
    uint64_t vertex_count; /* seen so far */
    uint64_t face_count;
    int64_t index_highest; /* the highest vertex that a face names, and where */
    uint32_t index_line;
} obj_check;

static parian_result check_vertex(obj_check *check, parian_span line, uint32_t number)
{
    parian_result result = parian_plain_append(check->plain, "v", 1);
    for (int k = 0; k < 3 && result == PARIAN_OK; k++) {
        parian_span word;
        double value;
        char shown[24];
        if (!parian_scan_word(&line, &word)) {
            return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                               "%s:%u: a vertex with %d coordinates, expected 3", check->file->path,
                               number, k);
        }
        if (!parian_span_finite(word, &value)) {
            return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                               "%s:%u: vertex coordinate '%s', expected a finite number",
                               check->file->path, number, parian_span_show(word, shown));
        }
        result = parian_plain_append(check->plain, " ", 1);
        if (result == PARIAN_OK) {
            result = parian_plain_append(check->plain, word.begin, (size_t)(word.end - word.begin));
        }
    }
    check->vertex_count++;
    return result == PARIAN_OK ? parian_plain_append(check->plain, "\n", 1) : result;
}

/* Cut the position index off a corner such as 3/1/2 and count its parts. */
static parian_span split_corner(parian_span word, int *parts)
{
    const char *slash = memchr(word.begin, '/', (size_t)(word.end - word.begin));
    *parts = 1;
    for (const char *at = word.begin; at < word.end; at++) {
        *parts += *at == '/';
    }
    return (parian_span){word.begin, slash ? slash : word.end};
}

static parian_result check_corner(obj_check *check, parian_span word, uint32_t number)
{
    int64_t index, seen = (int64_t)check->vertex_count;
    char shown[24];
    bool valid = parian_span_integer(word, -seen, UINT32_MAX - 1, &index) && index != 0;
    if (!valid) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s:%u: face corner '%s', expected the number of a vertex",
                           check->file->path, number, parian_span_show(word, shown));
    }
    index = index < 0 ? seen + index + 1 : index;
    if (index > check->index_highest) {
        check->index_highest = index;
        check->index_line = number;
    }
    parian_result result = parian_plain_append(check->plain, " ", 1);
    return result == PARIAN_OK ? parian_plain_number(check->plain, (uint64_t)index) : result;
}

/* `last`: the file ends in this line without a newline, so its last corner may be cut. */
static parian_result check_face(obj_check *check, parian_span line, uint32_t number, bool last)
{
    parian_result result = parian_plain_append(check->plain, "f", 1);
    parian_span word;
    int count = 0, first_parts = 0, parts = 0;
    while (result == PARIAN_OK && parian_scan_word(&line, &word)) {
        parian_span index = split_corner(word, &parts);
        first_parts = count == 0 ? parts : first_parts;
        result = check_corner(check, index, number);
        count++;
    }
    if (result != PARIAN_OK) {
        return result;
    }
    if (last && (count < 3 || parts != first_parts || word.end[-1] == '/')) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s:%u: the file ends inside a face (%d corners, the last with %d of %d "
                           "indices): it is cut short",
                           check->file->path, number, count, parts, first_parts);
    }
    if (count < 3) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s:%u: a face with %d corners, expected at least 3", check->file->path,
                           number, count);
    }
    check->face_count++;
    return parian_plain_append(check->plain, "\n", 1);
}

static parian_result check_whole(const obj_check *check)
{
    const parian_env *env = check->plain->env;
    const char *path = check->file->path;
    if (check->face_count == 0) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: %llu vertices and no faces, expected faces",
                           path, (unsigned long long)check->vertex_count);
    }
    if ((uint64_t)check->index_highest > check->vertex_count) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s:%u: a face names vertex %lld of %llu", path,
                           check->index_line, (long long)check->index_highest,
                           (unsigned long long)check->vertex_count);
    }
    return PARIAN_OK;
}

parian_result parian_check_obj(const parian_model_bytes *file, parian_plain_file *plain)
{
    parian_scan scan = {file->data, file->data + file->size, 0};
    obj_check check = {.file = file, .plain = plain};
    parian_result result = PARIAN_OK;
    parian_span line, word;
    bool open_end = file->size > 0 && file->data[file->size - 1] != '\n';
    while (result == PARIAN_OK && parian_scan_line(&scan, &line)) {
        parian_scan_word(&line, &word);
        if (parian_span_is(word, "v")) {
            result = check_vertex(&check, line, scan.line);
        } else if (parian_span_is(word, "f") || parian_span_is(word, "fo")) {
            result = check_face(&check, line, scan.line, open_end && line.end == scan.end);
        }
    }
    return result == PARIAN_OK ? check_whole(&check) : result;
}
