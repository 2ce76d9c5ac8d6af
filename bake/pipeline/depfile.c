/* depfile.c - writes the dependency file that Make and Ninja read.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <cjson/cJSON.h>

#include "bake/pipeline/bake.h"
#include "core/memory.h"
#include "tool/files.h"

typedef struct text_buffer {
    const parian_env *env;
    char *text;
    size_t length, capacity;
    bool failed;
} text_buffer;

static void append(text_buffer *buffer, const char *text, size_t length)
{
    if (buffer->failed) {
        return;
    }
    if (buffer->length + length + 1 > buffer->capacity) {
        size_t capacity = 2 * buffer->capacity + length + 256;
        char *grown = parian_alloc(buffer->env, capacity, 1);
        if (!grown) {
            buffer->failed = true;
            return;
        }
        memcpy(grown, buffer->text ? buffer->text : "", buffer->length);
        parian_free(buffer->env, buffer->text);
        buffer->text = grown;
        buffer->capacity = capacity;
    }
    memcpy(buffer->text + buffer->length, text, length);
    buffer->length += length;
    buffer->text[buffer->length] = 0;
}

/* A path with what Make would read otherwise escaped. */
static void append_path(text_buffer *buffer, const char *path, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (path[i] == ' ' || path[i] == '#' || path[i] == '\\') {
            append(buffer, "\\", 1);
        } else if (path[i] == '$') {
            append(buffer, "$", 1);
        }
        append(buffer, path + i, 1);
    }
}

static void append_dependency(text_buffer *buffer, const char *folder, size_t folder_length,
                              const char *path)
{
    append(buffer, " \\\n  ", 5);
    append_path(buffer, folder, folder_length);
    append_path(buffer, path, strlen(path));
}

static bool has_suffix(const char *path, const char *suffix)
{
    size_t n = strlen(path), m = strlen(suffix);
    return n >= m && strcasecmp(path + n - m, suffix) == 0;
}

static int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* %20 and the like become the bytes that the file's name has; in place. */
static void decode_uri(char *uri)
{
    char *to = uri;
    for (const char *from = uri; *from; from++) {
        int high = *from == '%' ? hex_digit(from[1]) : -1;
        int low = high >= 0 ? hex_digit(from[2]) : -1;
        if (low >= 0 && 16 * high + low > 0) {
            *to++ = (char)(16 * high + low);
            from += 2;
        } else {
            *to++ = *from;
        }
    }
    *to = 0;
}

/* The files that a .gltf refers to: buffers and images with a uri that is not data. */
static void append_gltf_files(text_buffer *buffer, const char *input, const char *json)
{
    static const char *const arrays[] = {"buffers", "images"};
    const char *slash = strrchr(input, '/');
    size_t folder_length = slash ? (size_t)(slash - input) + 1 : 0;
    cJSON *root = cJSON_Parse(json);
    for (int a = 0; root && a < 2; a++) {
        const cJSON *item = NULL;
        cJSON_ArrayForEach(item, cJSON_GetObjectItemCaseSensitive(root, arrays[a]))
        {
            const cJSON *uri = cJSON_GetObjectItemCaseSensitive(item, "uri");
            if (cJSON_IsString(uri) && strncmp(uri->valuestring, "data:", 5) != 0) {
                decode_uri(uri->valuestring);
                append_dependency(buffer, input, folder_length, uri->valuestring);
            }
        }
    }
    cJSON_Delete(root);
}

static void append_inputs(text_buffer *buffer, const parian_bake_desc *desc, const char *gltf_json)
{
    append_dependency(buffer, "", 0, desc->input);
    if (gltf_json) {
        append_gltf_files(buffer, desc->input, gltf_json);
    }
    for (size_t i = 0; i < desc->material_count; i++) {
        const char *equals = strchr(desc->material[i], '=');
        const char *name = equals ? equals + 1 : desc->material[i];
        if (has_suffix(name, ".json") || strchr(name, '/')) {
            append_dependency(buffer, "", 0, name);
        }
    }
}

parian_result parian_write_depfile(const parian_env *env, const parian_bake_desc *desc)
{
    text_buffer buffer = {.env = env};
    uint8_t *json = NULL;
    size_t json_size = 0;
    parian_result r = PARIAN_OK;
    if (has_suffix(desc->input, ".gltf")) {
        r = parian_file_read(env, desc->input, UINT64_C(1) << 30, &json, &json_size);
    }
    if (r == PARIAN_OK) {
        append_path(&buffer, desc->output, strlen(desc->output));
        append(&buffer, ":", 1);
        append_inputs(&buffer, desc, (const char *)json);
        append(&buffer, "\n", 1);
        r = buffer.failed ? parian_fail(env, PARIAN_E_NOMEM, "no memory for the dependency file")
                          : parian_file_write(env, desc->depfile_path, buffer.text, buffer.length);
    }
    parian_free(env, json);
    parian_free(env, buffer.text);
    return r;
}
