/* baked_asset.c - bakes models in this process and keeps assets by content.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/baked_asset.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "core/memory.h"
#include "tests/measure/content_hash.h"
#include "tool/files.h"

enum { WORDS_MAX = 512, FILE_MAX = 1 << 26 };
static const char SPACE[] = " \t\n";

bool parian_path_is_asset(const char *path)
{
    size_t n = strlen(path);
    return n > 7 && strcasecmp(path + n - 7, ".parian") == 0;
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* The arguments of the parian-bake that this bake is. */
typedef struct word_list {
    char *item[WORDS_MAX];
    int count;
} word_list;

static void add_word(word_list *words, const char *word)
{
    if (words->count < WORDS_MAX - 1) {
        words->item[words->count++] = (char *)word;
    }
}

static void add_option(word_list *words, const char *option, const char *value)
{
    add_word(words, option);
    add_word(words, value);
}

static void list_words(const parian_measure_options *options, const char *input, char *bake,
                       word_list *words)
{
    static const char *const units[] = {"mm", "cm", "m"};
    add_word(words, "parian-bake");
    add_option(words, "-o", "cached.parian");
    for (size_t i = 0; i < options->materials.count; i++) {
        add_option(words, "--material", options->materials.item[i]);
    }
    if (options->scale) {
        add_option(words, "--scale", options->scale);
    }
    if (options->unit_given) {
        add_option(words, "--unit", units[options->unit]);
    }
    if (options->keep_origin) {
        add_word(words, "--keep-origin");
    }
    for (char *word = strtok_r(bake, SPACE, &bake); word; word = strtok_r(NULL, SPACE, &bake)) {
        add_word(words, word);
    }
    add_option(words, "--", input); /* what begins with '-' behind this is a name */
}

static parian_result parse_bake(const parian_env *env, const parian_measure_options *options,
                                const char *input, parian_baked_asset *asset)
{
    word_list words = {.count = 0};
    if (!PARIAN_NEW0(env, asset->bake_options, 1) ||
        !PARIAN_NEW(env, asset->words, strlen(asset->bake) + 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the settings of a bake");
    }
    memcpy(asset->words, asset->bake, strlen(asset->bake) + 1);
    list_words(options, input, asset->words, &words);
    return parian_bake_options_parse(words.count, words.item, asset->bake_options);
}

parian_result parian_baked_asset_plan(const parian_env *env, const parian_measure_options *options,
                                      const char *input, const char *bake,
                                      parian_baked_asset *asset)
{
    *asset = (parian_baked_asset){.bake = bake, .bake_s = NAN};
    asset->from_model = !parian_path_is_asset(input);
    const char *name = file_name(input);
    snprintf(asset->model, sizeof asset->model, "%.200s", name);
    snprintf(asset->label, sizeof asset->label, "%.200s%s%.280s", name, *bake ? " " : "", bake);
    if (access(input, R_OK) != 0) {
        return parian_fail(env, PARIAN_E_IO, "%s: cannot be read", input);
    }
    if (asset->from_model) {
        return parse_bake(env, options, input, asset);
    }
    if (!PARIAN_NEW0(env, asset->bake_options, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the settings of a bake");
    }
    asset->bake_options->desc.input = input;
    snprintf(asset->path, sizeof asset->path, "%s", input);
    return PARIAN_OK;
}

void parian_baked_asset_free(const parian_env *env, parian_baked_asset *asset)
{
    if (asset) {
        parian_free(env, asset->bake_options);
        parian_free(env, asset->words);
        asset->bake_options = NULL;
        asset->words = NULL;
    }
}

/* Add the bytes of every file that a dependency file names; reads it in place. */
static parian_result hash_dependencies(const parian_env *env, parian_content_hash *hash, char *text)
{
    char *to = text, *begin = text;
    for (const char *from = strchr(text, ':') + 1; *from; from++) {
        bool escaped = (*from == '\\' && from[1]) || (*from == '$' && from[1] == '$');
        if (escaped && from[1] != '\n') {
            *to++ = *++from;
        } else if (*from != ' ' && *from != '\n' && *from != '\\') {
            *to++ = *from;
        } else if (to > begin) {
            *to = 0;
            parian_result r = parian_content_hash_file(env, hash, begin);
            if (r != PARIAN_OK) {
                return r;
            }
            to = begin;
        }
    }
    return PARIAN_OK;
}

/* The input and what it refers to: material files, buffers, pictures. */
static parian_result hash_inputs(const parian_env *env, parian_content_hash *hash,
                                 const char *folder, const parian_bake_desc *desc)
{
    parian_bake_desc names = *desc;
    uint8_t *text = NULL;
    size_t size = 0;
    char *path = parian_path_join(env, folder, "inputs.d");
    if (!path) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a path");
    }
    names.output = "o";
    names.depfile_path = path;
    parian_result r = parian_write_depfile(env, &names);
    if (r == PARIAN_OK) {
        r = parian_file_read(env, path, FILE_MAX, &text, &size);
        unlink(path);
    }
    if (r == PARIAN_OK) {
        r = hash_dependencies(env, hash, (char *)text);
    }
    parian_free(env, text);
    parian_free(env, path);
    return r;
}

/* The program's own bytes count, for what is measured is what it does now. */
static parian_result name_bake(const parian_env *env, const char *folder,
                               const parian_bake_desc *desc, char name[PARIAN_HASH_TEXT_MAX])
{
    parian_content_hash *hash = NULL;
    char *settings = parian_settings_json(desc);
    parian_result r =
        settings ? parian_content_hash_begin(env, &hash)
                 : parian_fail(env, PARIAN_E_NOMEM, "no memory for the settings of a bake");
    if (r == PARIAN_OK) {
        parian_content_hash_text(hash, PARIAN_VERSION);
        parian_content_hash_text(hash, settings);
        r = parian_content_hash_file(env, hash, "/proc/self/exe");
    }
    if (r == PARIAN_OK) {
        r = hash_inputs(env, hash, folder, desc);
    }
    parian_content_hash_end(hash, name);
    cJSON_free(settings);
    return r;
}

/* Seconds of the bake from its report; false where there is no sound report. */
static bool read_report(const parian_env *env, const char *path, double *seconds)
{
    uint8_t *text = NULL;
    size_t size = 0;
    if (access(path, R_OK) != 0 ||
        parian_file_read(env, path, FILE_MAX, &text, &size) != PARIAN_OK) {
        return false;
    }
    cJSON *root = cJSON_Parse((const char *)text);
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "total_seconds");
    bool sound = cJSON_IsNumber(item);
    *seconds = sound ? item->valuedouble : NAN;
    cJSON_Delete(root);
    parian_free(env, text);
    return sound;
}

static parian_result find_size(const parian_env *env, parian_baked_asset *asset)
{
    struct stat info;
    if (stat(asset->path, &info) != 0) {
        return parian_fail(env, PARIAN_E_IO, "%s: cannot be read", asset->path);
    }
    asset->bytes = (uint64_t)info.st_size;
    return PARIAN_OK;
}

parian_result parian_baked_asset_make(const parian_env *env, const char *folder,
                                      parian_baked_asset *asset)
{
    char name[PARIAN_HASH_TEXT_MAX], report[PARIAN_MEASURE_PATH_MAX];
    if (!asset->from_model) {
        return find_size(env, asset);
    }
    parian_bake_desc desc = asset->bake_options->desc;
    parian_result r = parian_folder_create(env, folder);
    if (r == PARIAN_OK) {
        r = name_bake(env, folder, &desc, name);
    }
    if (r != PARIAN_OK) {
        return r;
    }
    int length = snprintf(asset->path, sizeof asset->path, "%s/bake-%s.parian", folder, name);
    int report_length = snprintf(report, sizeof report, "%s/bake-%s.json", folder, name);
    if (length >= (int)sizeof asset->path || report_length >= (int)sizeof report) {
        return parian_fail(env, PARIAN_E_IO, "the name of the cache folder is too long");
    }
    asset->cached = access(asset->path, R_OK) == 0 && read_report(env, report, &asset->bake_s);
    if (!asset->cached) {
        desc.output = asset->path;
        desc.report_path = report; /* written last: its presence says that the asset is whole */
        unlink(report);
        r = parian_bake_run(env, &desc);
        if (r == PARIAN_OK && !read_report(env, report, &asset->bake_s)) {
            r = parian_fail(env, PARIAN_E_IO, "%s: not a report of a bake", report);
        }
    }
    return r == PARIAN_OK ? find_size(env, asset) : r;
}
