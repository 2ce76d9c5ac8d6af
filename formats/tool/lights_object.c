/* lights_object.c - one light from the JSON object that describes it, with every check.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/lights_internal.h"
#include "tool/picture.h"

static const double DEFAULT_OUTER_DEG = 30, DEFAULT_INNER_SHARE = 2.0 / 3.0;
static const float PIXEL_MAX = 65504; /* the largest half: what an infinity in a picture becomes */

typedef parian_light_source_text source_text;

/* ---- members -----------------------------------------------------------------------------------
 */
static parian_result read_number(const source_text *text, const char *key, const cJSON *item,
                                 double *number)
{
    if (!cJSON_IsNumber(item)) {
        return parian_fail(text->env, text->mistake, "%s: '%s' is not a number", text->where, key);
    }
    if (!isfinite(item->valuedouble) || fabs(item->valuedouble) > (double)FLT_MAX) {
        return parian_fail(text->env, text->mistake, "%s: '%s' is not a finite number", text->where,
                           key);
    }
    *number = item->valuedouble;
    return PARIAN_OK;
}

/* Three numbers in an array; with `spread`, one number may stand for all. Missing is an error. */
static parian_result read_three(const source_text *text, const cJSON *object, const char *key,
                                bool spread, double out[3])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    bool single = cJSON_IsNumber(item) || (cJSON_IsArray(item) && cJSON_GetArraySize(item) == 1);
    if (!item) {
        return parian_fail(text->env, text->mistake, "%s: '%s' is missing", text->where, key);
    }
    if (spread && single) {
        parian_result result =
            read_number(text, key, cJSON_IsNumber(item) ? item : item->child, &out[0]);
        out[1] = out[2] = out[0];
        return result;
    }
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 3) {
        return parian_fail(text->env, text->mistake, "%s: '%s' is not three numbers%s", text->where,
                           key, spread ? " or one for all channels" : "");
    }
    const cJSON *element = item->child;
    for (int c = 0; c < 3; c++, element = element->next) {
        parian_result result = read_number(text, key, element, &out[c]);
        if (result != PARIAN_OK) {
            return result;
        }
    }
    return PARIAN_OK;
}

static parian_result read_vector(const source_text *text, const cJSON *object, const char *key,
                                 float out[3])
{
    double v[3];
    parian_result result = read_three(text, object, key, false, v);
    for (int c = 0; c < 3 && result == PARIAN_OK; c++) {
        out[c] = (float)v[c];
    }
    return result;
}

/* A vector of any length but zero, made a unit vector. */
static parian_result read_direction(const source_text *text, const cJSON *object, const char *key,
                                    float out[3])
{
    double v[3];
    parian_result result = read_three(text, object, key, false, v);
    if (result != PARIAN_OK) {
        return result;
    }
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0)) {
        return parian_fail(text->env, text->mistake, "%s: '%s' has no length", text->where, key);
    }
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        v[c] /= largest; /* so that squares neither overflow nor vanish */
        sum += v[c] * v[c];
    }
    for (int c = 0; c < 3; c++) {
        out[c] = (float)(v[c] / sqrt(sum));
    }
    return PARIAN_OK;
}

static parian_result read_power(const source_text *text, const cJSON *object, const char *key,
                                float out[3])
{
    double v[3];
    parian_result result = read_three(text, object, key, true, v);
    for (int c = 0; c < 3 && result == PARIAN_OK; c++) {
        if (v[c] < 0) {
            return parian_fail(text->env, text->mistake, "%s: '%s' is negative", text->where, key);
        }
        out[c] = (float)v[c];
    }
    return result;
}

/* A number that may be missing. */
static parian_result read_optional(const source_text *text, const cJSON *object, const char *key,
                                   double missing, float *out)
{
    double number = missing;
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    parian_result result = item ? read_number(text, key, item, &number) : PARIAN_OK;
    *out = (float)number;
    return result;
}

/* ---- pictures ----------------------------------------------------------------------------------
 */
/* Light is finite and not negative, whatever resampling and half floats left in the file. */
static void mend_pixels(const source_text *text, const char *path, float (*rgb)[3], size_t count)
{
    size_t mended = 0;
    for (size_t i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++) {
            float value = rgb[i][c];
            if (!(value >= 0)) {
                mended += isnan(value) ? 1 : 0;
                rgb[i][c] = 0;
            } else if (isinf(value)) {
                mended++;
                rgb[i][c] = PIXEL_MAX;
            }
        }
    }
    if (mended) {
        parian_log(text->env, PARIAN_LOG_WARNING,
                   "%s: %zu values are not finite numbers; infinities become %g, the others 0",
                   path, mended, (double)PIXEL_MAX);
    }
}

static parian_result read_image(const source_text *text, const cJSON *object,
                                parian_light_image *image)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "image");
    float(*rgb)[3];
    if (!item) {
        return PARIAN_OK;
    }
    if (!cJSON_IsString(item) || !item->valuestring[0]) {
        return parian_fail(text->env, text->mistake, "%s: 'image' is not the name of a picture",
                           text->where);
    }
    bool absolute = item->valuestring[0] == '/' || !text->folder;
    char *path = parian_path_join(text->env, absolute ? "" : text->folder, item->valuestring);
    if (!path) {
        return parian_fail(text->env, PARIAN_E_NOMEM, "%s: no memory for a path", text->where);
    }
    parian_result result =
        parian_picture_read_linear(text->env, path, &image->width, &image->height, &rgb);
    if (result == PARIAN_OK) {
        mend_pixels(text, path, rgb, (size_t)image->width * image->height);
        image->pixel = (const float(*)[3])rgb;
    }
    parian_free(text->env, path);
    return result;
}

/* ---- types -------------------------------------------------------------------------------------
 */
static parian_result read_point(const source_text *text, const cJSON *object, parian_light *light)
{
    parian_result result = read_vector(text, object, "position", light->position);
    return result == PARIAN_OK ? read_power(text, object, "intensity", light->color) : result;
}

static parian_result read_directional(const source_text *text, const cJSON *object,
                                      parian_light *light)
{
    parian_result result = read_direction(text, object, "direction", light->direction);
    return result == PARIAN_OK ? read_power(text, object, "irradiance", light->color) : result;
}

static parian_result read_cone(const source_text *text, const cJSON *object, parian_light *light)
{
    parian_result result =
        read_optional(text, object, "outer_deg", DEFAULT_OUTER_DEG, &light->outer_deg);
    if (result == PARIAN_OK) {
        result = read_optional(text, object, "inner_deg",
                               (double)light->outer_deg * DEFAULT_INNER_SHARE, &light->inner_deg);
    }
    if (result == PARIAN_OK &&
        !(light->inner_deg > 0 && light->inner_deg <= light->outer_deg && light->outer_deg < 90)) {
        result = parian_fail(
            text->env, text->mistake,
            "%s: a cone of inner_deg %g and outer_deg %g; 0 < inner <= outer < 90 was expected",
            text->where, (double)light->inner_deg, (double)light->outer_deg);
    }
    return result;
}

static parian_result read_spot(const source_text *text, const cJSON *object, parian_light *light)
{
    parian_result result = read_point(text, object, light);
    if (result == PARIAN_OK) {
        result = read_direction(text, object, "direction", light->direction);
    }
    if (result == PARIAN_OK) {
        result = read_cone(text, object, light);
    }
    if (result == PARIAN_OK && cJSON_GetObjectItemCaseSensitive(object, "up")) {
        result = read_direction(text, object, "up", light->up);
    }
    return result == PARIAN_OK ? read_image(text, object, &light->image) : result;
}

static parian_result check_axes(const source_text *text, const parian_light *light)
{
    const float *u = light->axis_u, *v = light->axis_v;
    double uu = 0, vv = 0, cross = 0;
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3;
        double part = (double)u[c] * v[d] - (double)u[d] * v[c];
        uu += (double)u[c] * u[c];
        vv += (double)v[c] * v[c];
        cross += part * part;
    }
    if (!(cross > 1e-12 * uu * vv) || !isfinite(uu * vv)) {
        return parian_fail(text->env, text->mistake,
                           "%s: 'axis_u' and 'axis_v' do not span a rectangle", text->where);
    }
    return PARIAN_OK;
}

static parian_result read_rect(const source_text *text, const cJSON *object, parian_light *light)
{
    parian_result result = read_vector(text, object, "center", light->position);
    if (result == PARIAN_OK) {
        result = read_vector(text, object, "axis_u", light->axis_u);
    }
    if (result == PARIAN_OK) {
        result = read_vector(text, object, "axis_v", light->axis_v);
    }
    if (result == PARIAN_OK) {
        result = check_axes(text, light);
    }
    return result == PARIAN_OK ? read_power(text, object, "radiance", light->color) : result;
}

static parian_result read_environment(const source_text *text, const cJSON *object,
                                      parian_light *light)
{
    bool image = cJSON_GetObjectItemCaseSensitive(object, "image") != NULL;
    bool radiance = cJSON_GetObjectItemCaseSensitive(object, "radiance") != NULL;
    parian_result result = PARIAN_OK;
    if (!image && !radiance) {
        return parian_fail(text->env, text->mistake, "%s: neither 'radiance' nor 'image'",
                           text->where);
    }
    light->color[0] = light->color[1] = light->color[2] = 1;
    if (radiance) {
        result = read_power(text, object, "radiance", light->color);
    }
    if (result == PARIAN_OK) {
        result = read_optional(text, object, "rotation_deg", 0, &light->rotation_deg);
    }
    return result == PARIAN_OK ? read_image(text, object, &light->image) : result;
}

/* ---- the table of types ------------------------------------------------------------------------
 */
enum { KEYS_MAX = 8 };
static const struct {
    const char *name;
    parian_light_type type;
    parian_result (*read)(const source_text *text, const cJSON *object, parian_light *light);
    const char *key[KEYS_MAX];
} types[] = {
    {"point", PARIAN_LIGHT_POINT, read_point, {"position", "intensity"}},
    {"directional", PARIAN_LIGHT_DIRECTIONAL, read_directional, {"direction", "irradiance"}},
    {"spot",
     PARIAN_LIGHT_SPOT,
     read_spot,
     {"position", "direction", "up", "intensity", "inner_deg", "outer_deg", "image"}},
    {"rect", PARIAN_LIGHT_RECT, read_rect, {"center", "axis_u", "axis_v", "radiance"}},
    {"environment",
     PARIAN_LIGHT_ENVIRONMENT,
     read_environment,
     {"radiance", "image", "rotation_deg"}},
};
enum { TYPE_COUNT = sizeof types / sizeof types[0] };

static void warn_of_unknown_keys(const source_text *text, size_t type, const cJSON *object)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, object)
    {
        bool known = strcmp(item->string, "type") == 0 || strcmp(item->string, "name") == 0;
        for (int k = 0; k < KEYS_MAX && types[type].key[k]; k++) {
            known = known || strcmp(item->string, types[type].key[k]) == 0;
        }
        if (!known) {
            parian_log(text->env, PARIAN_LOG_WARNING, "%s: '%s' is no key of type '%s'; it is ignored",
                       text->where, item->string, types[type].name);
        }
    }
}

parian_result parian_light_from_object(const source_text *text, const cJSON *object,
                                       parian_light *light)
{
    const cJSON *name = cJSON_GetObjectItemCaseSensitive(object, "type");
    if (!cJSON_IsObject(object) || !cJSON_IsString(name)) {
        return parian_fail(text->env, text->mistake, "%s: no object with a 'type'", text->where);
    }
    for (size_t i = 0; i < TYPE_COUNT; i++) {
        if (strcmp(name->valuestring, types[i].name) == 0) {
            memset(light, 0, sizeof *light);
            light->type = types[i].type;
            warn_of_unknown_keys(text, i, object);
            return types[i].read(text, object, light);
        }
    }
    return parian_fail(
        text->env, text->mistake,
        "%s: type '%.40s'; point, directional, spot, rect or environment was expected", text->where,
        name->valuestring);
}
