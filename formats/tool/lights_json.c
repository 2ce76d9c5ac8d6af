/* lights_json.c - lights as the JSON text of a lights file.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "core/memory.h"
#include "tool/lights_internal.h"

/* The shortest text that reads back as the same float. */
static cJSON *number_item(float value)
{
    char text[32];
    for (int digits = 6; digits <= 9; digits++) {
        float back;
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (sscanf(text, "%f", &back) == 1 && !(back < value) && !(back > value)) {
            break;
        }
    }
    return cJSON_CreateRaw(text);
}

static bool add_three(cJSON *object, const char *key, const float v[3])
{
    cJSON *array = cJSON_AddArrayToObject(object, key);
    for (int c = 0; c < 3 && array; c++) {
        cJSON *item = number_item(v[c]);
        if (!item || !cJSON_AddItemToArray(array, item)) {
            cJSON_Delete(item);
            return false;
        }
    }
    return array != NULL;
}

static bool add_number(cJSON *object, const char *key, float value)
{
    cJSON *item = number_item(value);
    if (!item || !cJSON_AddItemToObject(object, key, item)) {
        cJSON_Delete(item);
        return false;
    }
    return true;
}

static bool add_members(cJSON *object, const parian_light *light)
{
    bool turned = light->up[0] < 0 || light->up[0] > 0 || light->up[1] < 0 || light->up[1] > 0 ||
                  light->up[2] < 0 || light->up[2] > 0;
    switch (light->type) {
    case PARIAN_LIGHT_POINT:
        return cJSON_AddStringToObject(object, "type", "point") &&
               add_three(object, "position", light->position) &&
               add_three(object, "intensity", light->color);
    case PARIAN_LIGHT_DIRECTIONAL:
        return cJSON_AddStringToObject(object, "type", "directional") &&
               add_three(object, "direction", light->direction) &&
               add_three(object, "irradiance", light->color);
    case PARIAN_LIGHT_SPOT:
        return cJSON_AddStringToObject(object, "type", "spot") &&
               add_three(object, "position", light->position) &&
               add_three(object, "direction", light->direction) &&
               (!turned || add_three(object, "up", light->up)) &&
               add_three(object, "intensity", light->color) &&
               add_number(object, "inner_deg", light->inner_deg) &&
               add_number(object, "outer_deg", light->outer_deg);
    case PARIAN_LIGHT_RECT:
        return cJSON_AddStringToObject(object, "type", "rect") &&
               add_three(object, "center", light->position) &&
               add_three(object, "axis_u", light->axis_u) &&
               add_three(object, "axis_v", light->axis_v) &&
               add_three(object, "radiance", light->color);
    case PARIAN_LIGHT_ENVIRONMENT:
        return cJSON_AddStringToObject(object, "type", "environment") &&
               add_three(object, "radiance", light->color) &&
               add_number(object, "rotation_deg", light->rotation_deg);
    }
    return false;
}

static bool fill(cJSON *root, const parian_light *light, size_t count)
{
    cJSON *array = root ? cJSON_AddArrayToObject(root, "lights") : NULL;
    for (size_t i = 0; i < count && array; i++) {
        cJSON *object = cJSON_CreateObject();
        if (!object || !cJSON_AddItemToArray(array, object)) {
            cJSON_Delete(object);
            return false;
        }
        if (!add_members(object, &light[i])) {
            return false;
        }
    }
    return array != NULL;
}

parian_result parian_lights_to_json(const parian_env *env, const parian_light *light, size_t count,
                                    char **json)
{
    for (size_t i = 0; i < count; i++) {
        if (light[i].image.pixel) {
            return parian_fail(env, PARIAN_E_UNSUPPORTED,
                               "light %zu has a picture, which JSON cannot hold", i);
        }
    }
    cJSON *root = cJSON_CreateObject();
    char *text = fill(root, light, count) ? cJSON_PrintUnformatted(root) : NULL;
    char *copy = text ? parian_alloc(env, strlen(text) + 1, 1) : NULL;
    if (copy) {
        memcpy(copy, text, strlen(text) + 1);
        *json = copy;
    }
    cJSON_free(text);
    cJSON_Delete(root);
    return copy ? PARIAN_OK
                : parian_fail(env, PARIAN_E_NOMEM, "no memory for the JSON of %zu lights", count);
}
