/* media_file.c - reads a medium from a JSON material file.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "core/memory.h"
#include "tool/files.h"
#include "tool/media_file.h"

enum { FILE_SIZE_MAX = 1 << 20 };

static const char *const known_keys[] = {"name", "sigma_s_prime", "sigma_s", "sigma_a",
                                         "g",    "eta",           "unit",    "source"};

typedef struct medium_file {
    const parian_env *env;
    const char *path;
    const cJSON *root;
} medium_file;

static const cJSON *member(const medium_file *file, const char *key)
{
    return cJSON_GetObjectItemCaseSensitive(file->root, key);
}

/* Three numbers, or one for all channels; absent is PARIAN_OK with found false. */
static parian_result read_channels(const medium_file *file, const char *key,
                                   double value[PARIAN_CHANNELS], bool *found)
{
    const cJSON *item = member(file, key);
    *found = item != NULL;
    if (!item) {
        return PARIAN_OK;
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        bool three = cJSON_IsArray(item) && cJSON_GetArraySize(item) == PARIAN_CHANNELS;
        const cJSON *number = three ? cJSON_GetArrayItem(item, c) : item;
        if (!cJSON_IsNumber(number) || !isfinite(number->valuedouble)) {
            return parian_fail(file->env, PARIAN_E_FORMAT,
                               "%s: \"%s\" is not a number or three of them", file->path, key);
        }
        value[c] = number->valuedouble;
    }
    return PARIAN_OK;
}

static parian_result read_text(const medium_file *file, const char *key, char *text, size_t size)
{
    const cJSON *item = member(file, key);
    if (item && !cJSON_IsString(item)) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: \"%s\" is not a string", file->path,
                           key);
    }
    if (item) {
        snprintf(text, size, "%s", item->valuestring);
    }
    return PARIAN_OK;
}

/* The factor to m^-1. */
static parian_result read_unit(const medium_file *file, double *per_m)
{
    char unit[16] = "";
    parian_result result = read_text(file, "unit", unit, sizeof unit);
    if (result != PARIAN_OK) {
        return result;
    }
    *per_m = strcmp(unit, "1/mm") == 0 ? 1e3 : strcmp(unit, "1/cm") == 0 ? 1e2 : 1;
    if (*per_m == 1 && strcmp(unit, "1/m") != 0) {
        return parian_fail(file->env, PARIAN_E_FORMAT,
                           "%s: \"unit\" is '%s', expected \"1/mm\", \"1/cm\" or \"1/m\"",
                           file->path, unit);
    }
    return PARIAN_OK;
}

/* Exactly one of sigma_s_prime and sigma_s; the latter takes g (0 where absent). */
static parian_result read_scattering(const medium_file *file, parian_medium *medium)
{
    double reduced[PARIAN_CHANNELS], full[PARIAN_CHANNELS];
    bool has_reduced, has_full, has_g;
    parian_result result = read_channels(file, "sigma_s_prime", reduced, &has_reduced);
    if (result == PARIAN_OK) {
        result = read_channels(file, "sigma_s", full, &has_full);
    }
    if (result == PARIAN_OK) {
        result = read_channels(file, "g", medium->g, &has_g);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    if (has_reduced == has_full) {
        return parian_fail(file->env, PARIAN_E_FORMAT,
                           "%s: %s \"sigma_s_prime\" and \"sigma_s\", expected one", file->path,
                           has_full ? "both" : "neither");
    }
    medium->reduced_only = has_reduced && !has_g;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        if (!(fabs(medium->g[c]) < 1)) {
            return parian_fail(file->env, PARIAN_E_FORMAT,
                               "%s: \"g\" is %g, expected -1 to 1, both excluded", file->path,
                               medium->g[c]);
        }
        medium->sigma_s_prime[c] = has_reduced ? reduced[c] : (1 - medium->g[c]) * full[c];
    }
    return PARIAN_OK;
}

static parian_result read_eta(const medium_file *file, double *eta)
{
    const cJSON *item = member(file, "eta");
    if (item && !cJSON_IsNumber(item)) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: \"eta\" is not a number", file->path);
    }
    if (!item) {
        parian_log(file->env, PARIAN_LOG_WARNING, "%s: \"eta\" is missing, taken as 1.3",
                   file->path);
    }
    *eta = item ? item->valuedouble : 1.3;
    return PARIAN_OK;
}

static void warn_unknown(const medium_file *file)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, file->root)
    {
        bool known = false;
        for (size_t i = 0; i < sizeof known_keys / sizeof known_keys[0]; i++) {
            known = known || strcmp(item->string, known_keys[i]) == 0;
        }
        if (!known) {
            parian_log(file->env, PARIAN_LOG_WARNING, "%s: unknown key \"%s\" is ignored",
                       file->path, item->string);
        }
    }
}

static parian_result read_medium(const medium_file *file, parian_medium *medium)
{
    double per_m = 1;
    bool has_absorption = false;
    if (!cJSON_IsObject(file->root)) {
        return parian_fail(file->env, PARIAN_E_FORMAT, "%s: not a JSON object with a medium",
                           file->path);
    }
    warn_unknown(file);
    snprintf(medium->name, sizeof medium->name, "%s", "medium");
    parian_result result = read_text(file, "name", medium->name, sizeof medium->name);
    if (result == PARIAN_OK) {
        result = read_text(file, "source", medium->source, sizeof medium->source);
    }
    if (result == PARIAN_OK) {
        result = read_unit(file, &per_m);
    }
    if (result == PARIAN_OK) {
        result = read_scattering(file, medium);
    }
    if (result == PARIAN_OK) {
        result = read_channels(file, "sigma_a", medium->sigma_a, &has_absorption);
    }
    if (result == PARIAN_OK && !has_absorption) {
        result = parian_fail(file->env, PARIAN_E_FORMAT, "%s: \"sigma_a\" is missing", file->path);
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        medium->sigma_s_prime[c] *= per_m;
        medium->sigma_a[c] *= per_m;
    }
    return result == PARIAN_OK ? read_eta(file, &medium->eta) : result;
}

parian_result parian_media_read_file(const parian_env *env, const char *path, parian_medium *medium)
{
    parian_medium made = {.eta = 0};
    uint8_t *data = NULL;
    size_t size = 0;
    parian_result result = parian_file_read(env, path, FILE_SIZE_MAX, &data, &size);
    if (result != PARIAN_OK) {
        return result;
    }
    cJSON *root = cJSON_ParseWithLength((const char *)data, size);
    if (!root) {
        result = parian_fail(env, PARIAN_E_FORMAT, "%s: not JSON", path);
    } else {
        medium_file file = {env, path, root};
        result = read_medium(&file, &made);
    }
    if (result == PARIAN_OK && parian_medium_check(env, &made) != PARIAN_OK) {
        result = PARIAN_E_FORMAT;
    }
    if (result == PARIAN_OK) {
        *medium = made;
    }
    cJSON_Delete(root);
    parian_free(env, data);
    return result;
}
