/* lights_spec.c - a light from the text of --light, by way of the object that a lights file would
 * hold.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"
#include "tool/lights_internal.h"

enum { WORD_MAX = 1024, WHERE_MAX = 256 };

/* Short names that are handy on a command line. */
static const struct {
    const char *spoken, *key;
} short_names[] = {{"inner", "inner_deg"}, {"outer", "outer_deg"}, {"rotation", "rotation_deg"},
                   {"u", "axis_u"},        {"v", "axis_v"},        {"file", "image"}};

static const char *full_key(const char *word)
{
    for (size_t i = 0; i < sizeof short_names / sizeof short_names[0]; i++) {
        if (strcmp(word, short_names[i].spoken) == 0) {
            return short_names[i].key;
        }
    }
    return word;
}

/* What the word right after the type is, when it has no "key=". */
static const char *first_key(const char *type)
{
    static const char *const table[][2] = {{"point", "position"},
                                           {"spot", "position"},
                                           {"directional", "direction"},
                                           {"rect", "center"},
                                           {"environment", "image"}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (strcmp(type, table[i][0]) == 0) {
            return table[i][1];
        }
    }
    return "position";
}

/* "1" -> 1, "1,2,3" -> [1,2,3]; NULL when it is no such list. */
static cJSON *numbers_from(const char *value)
{
    cJSON *array = cJSON_CreateArray();
    const char *at = value;
    while (array) {
        char *end;
        double number = strtod(at, &end);
        if (end == at || (*end != ',' && *end != '\0')) {
            cJSON_Delete(array);
            return NULL;
        }
        cJSON_AddItemToArray(array, cJSON_CreateNumber(number));
        if (*end == '\0') {
            break;
        }
        at = end + 1;
    }
    if (array && cJSON_GetArraySize(array) == 1) {
        cJSON *single = cJSON_DetachItemFromArray(array, 0);
        cJSON_Delete(array);
        return single;
    }
    return array;
}

static parian_result add_member(const parian_light_source_text *text, cJSON *object,
                                const char *key, const char *value)
{
    bool is_text = strcmp(key, "image") == 0;
    if (cJSON_GetObjectItemCaseSensitive(object, key)) {
        return parian_fail(text->env, PARIAN_E_ARGUMENT, "%s: '%s' twice", text->where, key);
    }
    cJSON *item = is_text ? cJSON_CreateString(value) : numbers_from(value);
    if (!item || !cJSON_AddItemToObject(object, key, item)) {
        cJSON_Delete(item);
        return parian_fail(text->env, PARIAN_E_ARGUMENT,
                           "%s: '%.60s' is not a number or numbers with commas", text->where,
                           value);
    }
    return PARIAN_OK;
}

/* One word between colons: "0,0.1,0.2" or "key=value". */
static parian_result add_word(const parian_light_source_text *text, cJSON *object, const char *type,
                              bool first, char *word)
{
    char *equals = strchr(word, '=');
    if (equals) {
        *equals = '\0';
        return add_member(text, object, full_key(word), equals + 1);
    }
    if (!first) {
        return parian_fail(text->env, PARIAN_E_ARGUMENT, "%s: '%.60s' is not KEY=VALUE",
                           text->where, word);
    }
    return add_member(text, object, first_key(type), word);
}

static parian_result build_object(const parian_light_source_text *text, char *words, cJSON *object)
{
    char *rest = strchr(words, ':');
    bool first = true;
    if (rest) {
        *rest++ = '\0';
    }
    if (!cJSON_AddStringToObject(object, "type", words)) {
        return parian_fail(text->env, PARIAN_E_NOMEM, "%s: no memory", text->where);
    }
    while (rest) {
        char *next = strchr(rest, ':');
        if (next) {
            *next++ = '\0';
        }
        parian_result result = add_word(text, object, words, first, rest);
        if (result != PARIAN_OK) {
            return result;
        }
        first = false;
        rest = next;
    }
    return PARIAN_OK;
}

parian_result parian_lights_parse_spec(const parian_env *env, const char *spec,
                                       parian_light_set *set)
{
    char where[WHERE_MAX], words[WORD_MAX];
    parian_light light = {0};
    snprintf(where, sizeof where, "--light %.200s", spec);
    parian_light_source_text text = {.env = env, .where = where, .mistake = PARIAN_E_ARGUMENT};
    if (snprintf(words, sizeof words, "%s", spec) >= WORD_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "%.80s...: longer than %d characters", where,
                           WORD_MAX);
    }
    cJSON *object = cJSON_CreateObject();
    parian_result result = object ? build_object(&text, words, object) : PARIAN_E_NOMEM;
    if (result == PARIAN_OK) {
        result = parian_light_from_object(&text, object, &light);
    }
    if (result == PARIAN_OK) {
        result = parian_light_set_append(env, set, &light);
    }
    cJSON_Delete(object);
    return result;
}
