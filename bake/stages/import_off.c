/* import_off.c - checks a text OFF file and leaves its positions and faces.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/import_check.h"
#include "core/memory.h"

typedef struct off_check {
    const parian_model_bytes *file;
    parian_plain_file *plain;
    parian_scan scan;
    int64_t vertex_count, face_count;
} off_check;

static parian_result cut_short(const off_check *check, const char *what, int64_t found,
                               int64_t expected)
{
    return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                       "%s:%u: the file ends after %lld of %lld %s that its header announces",
                       check->file->path, check->scan.line, (long long)found, (long long)expected,
                       what);
}

/* The keyword: OFF with the prefixes that put more numbers behind the position. */
static bool is_keyword(parian_span word)
{
    static const char *const known[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                        "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (parian_span_is(word, known[i])) {
            return true;
        }
    }
    return false;
}

static parian_result check_header(off_check *check)
{
    const parian_env *env = check->plain->env;
    const char *path = check->file->path;
    parian_span line, word;
    char shown[24];
    if (!parian_scan_line(&check->scan, &line) || !parian_scan_word(&line, &word) ||
        !is_keyword(word)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: no OFF keyword in the first line", path);
    }
    bool more = parian_scan_word(&line, &word);
    if (more && parian_span_is(word, "BINARY")) {
        return parian_fail(env, PARIAN_E_UNSUPPORTED, "%s: binary OFF is not supported, only text",
                           path);
    }
    if (!more && (!parian_scan_line(&check->scan, &line) || !parian_scan_word(&line, &word))) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: the file ends before its counts", path);
    }
    int64_t *const counts[2] = {&check->vertex_count, &check->face_count};
    for (int k = 0; k < 2; k++) {
        if (k == 1 && !parian_scan_word(&line, &word)) {
            return parian_fail(env, PARIAN_E_FORMAT, "%s:%u: no count of faces", path,
                               check->scan.line);
        }
        /* A vertex takes at least 6 characters ("0 0 0\n"), a face 8 ("3 0 1 2\n"). */
        int64_t room = (int64_t)check->file->size / (k == 0 ? 6 : 4) + 1;
        if (!parian_span_integer(word, 0, room, counts[k])) {
            return parian_fail(
                env, PARIAN_E_FORMAT,
                "%s:%u: a count of '%s', expected at most %lld in a file of %zu bytes", path,
                check->scan.line, parian_span_show(word, shown), (long long)room,
                check->file->size);
        }
    }
    return PARIAN_OK;
}

static parian_result check_vertex(off_check *check, parian_span line)
{
    parian_result result = PARIAN_OK;
    for (int k = 0; k < 3 && result == PARIAN_OK; k++) {
        parian_span word = {line.end, line.end};
        double value;
        char shown[24];
        if (!parian_scan_word(&line, &word) || !parian_span_finite(word, &value)) {
            return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                               "%s:%u: vertex coordinate '%s', expected a finite number",
                               check->file->path, check->scan.line, parian_span_show(word, shown));
        }
        result = parian_plain_append(check->plain, word.begin, (size_t)(word.end - word.begin));
        if (result == PARIAN_OK) {
            result = parian_plain_append(check->plain, k < 2 ? " " : "\n", 1);
        }
    }
    return result;
}

static parian_result check_face(off_check *check, parian_span line)
{
    parian_span word = {line.end, line.end};
    int64_t corner_count = 0, index;
    char shown[24];
    if (!parian_scan_word(&line, &word) ||
        !parian_span_integer(word, 0, INT32_MAX, &corner_count)) {
        return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                           "%s:%u: '%s', expected a face's number of corners", check->file->path,
                           check->scan.line, parian_span_show(word, shown));
    }
    if (corner_count < 3) {
        return PARIAN_OK; /* points and edges are no faces */
    }
    parian_result result = parian_plain_number(check->plain, (uint64_t)corner_count);
    for (int64_t k = 0; k < corner_count && result == PARIAN_OK; k++) {
        word = (parian_span){line.end, line.end};
        if (!parian_scan_word(&line, &word) ||
            !parian_span_integer(word, 0, check->vertex_count - 1, &index)) {
            return parian_fail(check->plain->env, PARIAN_E_FORMAT,
                               "%s:%u: face corner '%s', expected a vertex number below %lld",
                               check->file->path, check->scan.line, parian_span_show(word, shown),
                               (long long)check->vertex_count);
        }
        result = parian_plain_append(check->plain, " ", 1);
        if (result == PARIAN_OK) {
            result = parian_plain_number(check->plain, (uint64_t)index);
        }
    }
    return result == PARIAN_OK ? parian_plain_append(check->plain, "\n", 1) : result;
}

/* Faces of fewer than three corners fall away, so the faces are gathered before the header is
 * written. */
static parian_result write_plain(off_check *check, const parian_plain_file *vertices,
                                 const parian_plain_file *faces, uint64_t face_count)
{
    parian_plain_file *out = check->plain;
    parian_result result = parian_plain_append(out, "OFF\n", 4);
    if (result == PARIAN_OK) {
        result = parian_plain_number(out, (uint64_t)check->vertex_count);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_append(out, " ", 1);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_number(out, face_count);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_append(out, " 0\n", 3);
    }
    if (result == PARIAN_OK) {
        result = parian_plain_append(out, vertices->data, vertices->size);
    }
    return result == PARIAN_OK ? parian_plain_append(out, faces->data, faces->size) : result;
}

static parian_result check_body(off_check *check, parian_plain_file *vertices,
                                parian_plain_file *faces, uint64_t *face_count)
{
    parian_plain_file *const target = check->plain;
    parian_result result = PARIAN_OK;
    parian_span line;
    check->plain = vertices;
    for (int64_t i = 0; i < check->vertex_count && result == PARIAN_OK; i++) {
        result = parian_scan_line(&check->scan, &line)
                     ? check_vertex(check, line)
                     : cut_short(check, "vertices", i, check->vertex_count);
    }
    check->plain = faces;
    for (int64_t i = 0; i < check->face_count && result == PARIAN_OK; i++) {
        size_t before = faces->size;
        result = parian_scan_line(&check->scan, &line)
                     ? check_face(check, line)
                     : cut_short(check, "faces", i, check->face_count);
        *face_count += faces->size > before;
    }
    check->plain = target;
    return result;
}

parian_result parian_check_off(const parian_model_bytes *file, parian_plain_file *plain)
{
    off_check check = {
        .file = file, .plain = plain, .scan = {file->data, file->data + file->size, 0}};
    parian_plain_file vertices = {.env = plain->env}, faces = {.env = plain->env};
    uint64_t face_count = 0;
    parian_result result = check_header(&check);
    if (result == PARIAN_OK) {
        result = check_body(&check, &vertices, &faces, &face_count);
    }
    if (result == PARIAN_OK && face_count == 0) {
        result = parian_fail(plain->env, PARIAN_E_FORMAT,
                             "%s: %lld vertices and no faces, expected faces", file->path,
                             (long long)check.vertex_count);
    }
    if (result == PARIAN_OK) {
        result = write_plain(&check, &vertices, &faces, face_count);
    }
    parian_free(plain->env, vertices.data);
    parian_free(plain->env, faces.data);
    return result;
}
