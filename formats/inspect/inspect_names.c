/* inspect_names.c - names of chunks, numbers people can read, and JSON on stdout.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "inspect/inspect.h"

void inspect_chunk_name(const parian_chunk_info *info, char name[INSPECT_NAME_MAX])
{
    char place[24] = "", level[16] = "";
    bool scene = strncmp(info->name, "scene.", 6) == 0;
    bool surrounding = strncmp(info->name, "surrounding.", 12) == 0;
    if (!scene || info->object != 0) {
        snprintf(place, sizeof place, "%s%" PRIu32 "/",
                 scene         ? "object"
                 : surrounding ? "surrounding"
                               : "body",
                 info->object);
    }
    if (info->level != 0) {
        snprintf(level, sizeof level, "@%" PRIu32, info->level);
    }
    snprintf(name, INSPECT_NAME_MAX, "%s%s%s", place, info->name, level);
}

int64_t inspect_find_chunk(const parian_reader *reader, const char *name)
{
    int64_t by_name = -1;
    uint32_t same_name = 0;
    for (uint32_t i = 0; i < parian_reader_chunk_count(reader); i++) {
        const parian_chunk_info *info = parian_reader_chunk(reader, i);
        char full[INSPECT_NAME_MAX];
        inspect_chunk_name(info, full);
        if (strcmp(full, name) == 0) {
            return i;
        }
        if (strcmp(info->name, name) == 0) {
            by_name = i;
            same_name++;
        }
    }
    return same_name == 1 ? by_name : -1;
}

parian_result inspect_print_json(const parian_env *env, cJSON *json)
{
    char *text = json ? cJSON_Print(json) : NULL;
    cJSON_Delete(json);
    if (!text) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the JSON text");
    }
    puts(text);
    cJSON_free(text);
    return PARIAN_OK;
}

enum { BUFFER_COUNT = 8, BUFFER_SIZE = 40 };

static char *next_buffer(void)
{
    static char buffer[BUFFER_COUNT][BUFFER_SIZE];
    static unsigned next;
    return buffer[next++ % BUFFER_COUNT];
}

const char *inspect_bytes(uint64_t bytes)
{
    static const char *const unit[] = {"B", "kB", "MB", "GB", "TB"};
    char *text = next_buffer();
    double value = (double)bytes;
    size_t step = 0;
    while (value >= 999.5 && step + 1 < sizeof unit / sizeof *unit) {
        value /= 1000;
        step++;
    }
    snprintf(text, BUFFER_SIZE, step == 0 || value >= 99.95 ? "%.0f %s" : "%.1f %s", value,
             unit[step]);
    return text;
}

const char *inspect_count(uint64_t count)
{
    char digits[24], *text = next_buffer(), *out = text;
    size_t length = (size_t)snprintf(digits, sizeof digits, "%" PRIu64, count);
    for (size_t i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0) {
            *out++ = ',';
        }
        *out++ = digits[i];
    }
    *out = 0;
    return text;
}
