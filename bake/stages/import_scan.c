/* import_scan.c - lines, words and numbers of mesh files in text form, and the growing plain file.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/import_check.h"
#include "core/memory.h"

parian_result parian_plain_append(parian_plain_file *plain, const void *bytes, size_t size)
{
    if (size > plain->capacity - plain->size) {
        size_t capacity = (plain->size + size) + (plain->size + size) / 2 + 4096;
        char *data;
        if (capacity < plain->size || !PARIAN_NEW(plain->env, data, capacity)) {
            return parian_fail(plain->env, PARIAN_E_NOMEM, "out of memory reading a mesh");
        }
        if (plain->size > 0) {
            memcpy(data, plain->data, plain->size);
        }
        parian_free(plain->env, plain->data);
        plain->data = data;
        plain->capacity = capacity;
    }
    memcpy(plain->data + plain->size, bytes, size);
    plain->size += size;
    return PARIAN_OK;
}

parian_result parian_plain_number(parian_plain_file *plain, uint64_t number)
{
    char digits[24];
    size_t at = sizeof digits;
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    return parian_plain_append(plain, digits + at, sizeof digits - at);
}

static bool is_blank(char letter)
{
    return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\v' || letter == '\f' ||
           letter == '\0' || letter == '\\' || letter == '\n';
}

/* One past the last character of the line at `at`; joins lines that end in a backslash. */
static const char *find_line_end(parian_scan *scan)
{
    const char *at = scan->at;
    for (;;) {
        const char *end = memchr(at, '\n', (size_t)(scan->end - at));
        if (!end) {
            return scan->end;
        }
        const char *last = end;
        while (last > scan->at && last[-1] == '\r') {
            last--;
        }
        if (last == scan->at || last[-1] != '\\') {
            return end;
        }
        scan->line++;
        at = end + 1;
    }
}

bool parian_scan_line(parian_scan *scan, parian_span *line)
{
    while (scan->at < scan->end) {
        line->begin = scan->at;
        line->end = find_line_end(scan);
        scan->line++;
        scan->at = line->end < scan->end ? line->end + 1 : scan->end;
        const char *comment = memchr(line->begin, '#', (size_t)(line->end - line->begin));
        line->end = comment ? comment : line->end;
        while (line->begin < line->end && is_blank(*line->begin)) {
            line->begin++;
        }
        if (line->begin < line->end) {
            return true;
        }
    }
    return false;
}

bool parian_scan_word(parian_span *line, parian_span *word)
{
    while (line->begin < line->end && is_blank(*line->begin)) {
        line->begin++;
    }
    word->begin = line->begin;
    while (line->begin < line->end && !is_blank(*line->begin)) {
        line->begin++;
    }
    word->end = line->begin;
    return word->end > word->begin;
}

bool parian_span_is(parian_span word, const char *text)
{
    size_t length = strlen(text);
    return (size_t)(word.end - word.begin) == length && memcmp(word.begin, text, length) == 0;
}

bool parian_span_finite(parian_span word, double *value)
{
    char *rest = NULL;
    *value = strtod(word.begin, &rest);
    return rest == word.end && isfinite(*value);
}

bool parian_span_integer(parian_span word, int64_t lowest, int64_t highest, int64_t *value)
{
    const char *at = word.begin;
    bool negative = at < word.end && *at == '-';
    int64_t sum = 0;
    at += at < word.end && (*at == '-' || *at == '+') ? 1 : 0;
    if (at == word.end || word.end - at > 18) {
        return false;
    }
    for (; at < word.end; at++) {
        if (*at < '0' || *at > '9') {
            return false;
        }
        sum = sum * 10 + (*at - '0');
    }
    *value = negative ? -sum : sum;
    return *value >= lowest && *value <= highest;
}

const char *parian_span_show(parian_span word, char buffer[24])
{
    size_t count = 0;
    for (const char *at = word.begin; at < word.end && count < 20; at++) {
        buffer[count++] = *at >= ' ' && *at <= '~' ? *at : '?';
    }
    if (word.end - word.begin > 20) {
        memcpy(buffer + 17, "...", 3);
    }
    buffer[count] = '\0';
    return buffer;
}
