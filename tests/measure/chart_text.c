/* chart_text.c - text that grows, and texts of others made safe for gnuplot.
 *
 * gnuplot knows no escapes within single quotes but '' for a quote, and runs nothing there: within
 * double quotes it would run what stands between backquotes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/chart_text.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

static const char ELLIPSIS[] = "\xe2\x80\xa6";

void parian_chart_text_free(parian_chart_text *out)
{
    parian_free(out->env, out->text);
    *out = (parian_chart_text){.env = out->env};
}

static bool reserve(parian_chart_text *out, size_t more)
{
    if (out->failed || out->size + more < out->capacity) {
        return !out->failed;
    }
    size_t capacity = 2 * (out->size + more) + 256;
    char *larger = parian_alloc(out->env, capacity, 1);
    if (!larger) {
        out->failed = true;
        return false;
    }
    if (out->text) {
        memcpy(larger, out->text, out->size + 1);
    }
    parian_free(out->env, out->text);
    out->text = larger;
    out->capacity = capacity;
    return true;
}

static void put_bytes(parian_chart_text *out, const char *bytes, size_t size)
{
    if (reserve(out, size)) {
        memcpy(out->text + out->size, bytes, size);
        out->size += size;
        out->text[out->size] = 0;
    }
}

void parian_chart_text_put(parian_chart_text *out, const char *format, ...)
{
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int size = vsnprintf(NULL, 0, format, args);
    if (size >= 0 && reserve(out, (size_t)size)) {
        vsnprintf(out->text + out->size, (size_t)size + 1, format, again);
        out->size += (size_t)size;
    }
    va_end(again);
    va_end(args);
}

/* ---- texts of others ---------------------------------------------------------------------------
 */
typedef struct character {
    char bytes[4];
    size_t size, columns;
} character;

/* Bytes of a well-formed UTF-8 sequence at s and its code point, or 0. */
static size_t decode(const unsigned char *s, uint32_t *code)
{
    static const uint32_t smallest[5] = {0, 0, 0x80, 0x800, 0x10000};
    size_t size = s[0] < 0x80       ? 1
                  : s[0] >> 5 == 6  ? 2
                  : s[0] >> 4 == 14 ? 3
                  : s[0] >> 3 == 30 ? 4
                                    : 0;
    *code = size == 1 ? s[0] : s[0] & (0x7fu >> size);
    for (size_t i = 1; i < size; i++) {
        if (s[i] >> 6 != 2) {
            return 0;
        }
        *code = *code << 6 | (s[i] & 0x3fu);
    }
    return size && *code >= smallest[size] && *code <= 0x10ffff && *code >> 11 != 0x1b ? size : 0;
}

static bool is_wide(uint32_t code)
{
    return (code >= 0x1100 && code <= 0x115f) || (code >= 0x2e80 && code <= 0xa4cf) ||
           (code >= 0xac00 && code <= 0xd7a3) || (code >= 0xf900 && code <= 0xfaff) ||
           (code >= 0xff00 && code <= 0xff60) || code >= 0x1f300;
}

/* The next character of a text, made harmless; false at its end. */
static bool next(const char **text, character *c)
{
    uint32_t code;
    if (!*text || !**text) {
        return false;
    }
    size_t size = decode((const unsigned char *)*text, &code);
    bool control = code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x2028 || code == 0x2029;
    bool bad = size == 0 || (code & 0xfffe) == 0xfffe || (code >= 0xfdd0 && code <= 0xfdef);
    *c = (character){.size = 1, .columns = 1};
    if (bad || control) {
        c->bytes[0] = bad ? '?' : ' ';
    } else {
        memcpy(c->bytes, *text, size);
        c->size = size;
        c->columns = is_wide(code) ? 2 : 1;
    }
    *text += size ? size : 1;
    return true;
}

size_t parian_chart_text_columns(const char *text, size_t columns)
{
    character c;
    size_t sum = 0;
    while (next(&text, &c)) {
        sum += c.columns;
        if (sum > columns) {
            return columns;
        }
    }
    return sum;
}

/* Append characters of a text up to `end` (NULL: all), cut to columns; quoted: ' becomes ''. */
static void put_cut(parian_chart_text *out, const char *text, const char *end, size_t columns,
                    bool quoted)
{
    character c;
    const char *at = text;
    size_t total = 0, used = 0;
    while ((!end || at < end) && next(&at, &c)) {
        total += c.columns;
    }
    at = text;
    while ((!end || at < end) && next(&at, &c)) {
        used += c.columns;
        if (total > columns && used > columns - 1) {
            put_bytes(out, ELLIPSIS, strlen(ELLIPSIS));
            return;
        }
        put_bytes(out, c.bytes, c.size);
        if (quoted && c.bytes[0] == '\'') {
            put_bytes(out, "'", 1);
        }
    }
}

void parian_chart_text_put_plain(parian_chart_text *out, const char *text, size_t columns)
{
    put_cut(out, text, NULL, columns, false);
}

void parian_chart_text_put_quoted(parian_chart_text *out, const char *text, size_t columns)
{
    parian_chart_text_put(out, "'");
    put_cut(out, text, NULL, columns, true);
    parian_chart_text_put(out, "'");
}

/* Where the first line ends: behind the last space that fits, or where no space does, behind what
 * fits. */
static const char *first_line_end(const char *text, size_t columns)
{
    character c;
    const char *at = text, *space = NULL, *fits = text;
    size_t used = 0;
    while (next(&at, &c)) {
        used += c.columns;
        if (used > columns) {
            return space ? space : fits;
        }
        fits = at;
        space = c.bytes[0] == ' ' ? at : space;
    }
    return at;
}

int parian_chart_text_put_lines(parian_chart_text *out, const char *text, size_t columns)
{
    if (!text || !*text) {
        parian_chart_text_put(out, "''");
        return 0;
    }
    const char *end = first_line_end(text, columns);
    parian_chart_text_put(out, "'");
    put_cut(out, text, end, columns + 1, true);
    parian_chart_text_put(out, "'");
    if (!*end) {
        return 1;
    }
    parian_chart_text_put(out, ".\"\\n\".");
    parian_chart_text_put_quoted(out, end, columns);
    return 2;
}

void parian_chart_text_put_number(parian_chart_text *out, double value)
{
    char number[32];
    double size = fabs(value);
    if (size != 0 && (size < 0.99e-4 || size >= 0.999e6)) {
        snprintf(number, sizeof number, "%.3e", value);
        char *exponent = strchr(number, 'e'), *end = exponent;
        int power = exponent ? atoi(exponent + 1) : 0;
        while (end && end > number && (end[-1] == '0' || end[-1] == '.')) {
            if (*--end == '.') {
                break;
            }
        }
        if (end) {
            *end = 0;
        }
        parian_chart_text_put(out, "%se%d", number, power);
        return;
    }
    snprintf(number, sizeof number, "%.6g", value);
    parian_chart_text_put(out, "%s", number);
}
