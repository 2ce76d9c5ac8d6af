/* lights_file.c - lights from a lights file, and sets of lights.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool/lights_file.h"

#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/lights_internal.h"

enum { FILE_SIZE_MAX = 16 << 20, WHERE_MAX = 256 };

/* ---- sets --------------------------------------------------------------------------------------
 */
static void free_picture(const parian_env *env, parian_light *light)
{
    parian_free(env, (void *)(uintptr_t)light->image.pixel);
}

void parian_light_set_cut(const parian_env *env, parian_light_set *set, size_t count)
{
    while (set->count > count) {
        free_picture(env, &set->light[--set->count]);
    }
}

void parian_light_set_free(const parian_env *env, parian_light_set *set)
{
    if (set) {
        parian_light_set_cut(env, set, 0);
        parian_free(env, set->light);
        memset(set, 0, sizeof *set);
    }
}

parian_result parian_light_set_append(const parian_env *env, parian_light_set *set,
                                      const parian_light *light)
{
    parian_light copy = *light;
    parian_light *larger = parian_alloc(env, set->count + 1, sizeof *larger);
    if (!larger || set->count >= PARIAN_LIGHTS_MAX) {
        free_picture(env, &copy);
        parian_free(env, larger);
        return larger
                   ? parian_fail(env, PARIAN_E_LIMIT, "more than %d lights", PARIAN_LIGHTS_MAX)
                   : parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu lights", set->count + 1);
    }
    if (set->count) {
        memcpy(larger, set->light, set->count * sizeof *larger);
    }
    larger[set->count] = copy;
    parian_free(env, set->light);
    set->light = larger;
    set->count++;
    return PARIAN_OK;
}

/* ---- files -------------------------------------------------------------------------------------
 */
static parian_result read_lights(const parian_env *env, const char *name, const cJSON *root,
                                 const char *folder, parian_light_set *set)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(root, "lights");
    const cJSON *item;
    size_t index = 0, before = set->count;
    if (!cJSON_IsArray(list)) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: no array 'lights'", name);
    }
    cJSON_ArrayForEach(item, list)
    {
        char where[WHERE_MAX];
        parian_light light = {0};
        snprintf(where, sizeof where, "%.200s: light %zu", name, index++);
        parian_light_source_text text = {
            .env = env, .where = where, .folder = folder, .mistake = PARIAN_E_FORMAT};
        parian_result result = parian_light_from_object(&text, item, &light);
        if (result == PARIAN_OK) {
            result = parian_light_set_append(env, set, &light);
        }
        if (result != PARIAN_OK) {
            parian_light_set_cut(env, set, before);
            return result;
        }
    }
    return PARIAN_OK;
}

static size_t line_of(const char *text, const char *at)
{
    size_t line = 1;
    for (; text < at; text++) {
        line += *text == '\n';
    }
    return line;
}

static parian_result parse(const parian_env *env, const char *name, const char *json,
                           const char *folder, parian_light_set *set)
{
    const char *end = json;
    cJSON *root = cJSON_ParseWithOpts(json, &end, 1);
    if (!root) {
        return parian_fail(env, PARIAN_E_FORMAT, "%s: not valid JSON at line %zu", name,
                           line_of(json, end));
    }
    parian_result result = read_lights(env, name, root, folder, set);
    cJSON_Delete(root);
    return result;
}

parian_result parian_lights_parse(const parian_env *env, const char *json, const char *folder,
                                  parian_light_set *set)
{
    return parse(env, "lights", json, folder, set);
}

parian_result parian_lights_read_file(const parian_env *env, const char *path,
                                      parian_light_set *set)
{
    uint8_t *data;
    size_t size;
    parian_result result = parian_file_read(env, path, FILE_SIZE_MAX, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    char *folder = parian_path_folder(env, path);
    if (!folder) {
        result = parian_fail(env, PARIAN_E_NOMEM, "%s: no memory for its folder", path);
    } else if (memchr(data, 0, size)) {
        result = parian_fail(env, PARIAN_E_FORMAT, "%s: not JSON text: it holds a zero byte", path);
    } else {
        result = parse(env, path, (const char *)data, folder, set);
    }
    parian_free(env, folder);
    parian_free(env, data);
    return result;
}
