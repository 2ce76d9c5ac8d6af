/* method_spec.c - parses the names and settings of methods.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/method_spec.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "core/memory.h"

/* Every method that the command line names; keys are separated by spaces. */
static const struct method_entry {
    const char *name;
    bool built;
    const char *keys;
} METHODS[] = {
    {"transfer", true, ""},
    {"texture", false, ""},
    {"volume", false, ""},
    {"maps", false, ""},
};
enum { METHOD_COUNT = sizeof METHODS / sizeof METHODS[0] };

static const char WORD[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_+";
static const char SPACE[] = " \t\n";

/* Copy the word at *at and move behind it; false when there is none or it is too long. */
static bool take_word(const char **at, char word[PARIAN_METHOD_WORD_MAX])
{
    size_t n = strspn(*at, WORD);
    if (n == 0 || n >= PARIAN_METHOD_WORD_MAX) {
        return false;
    }
    memcpy(word, *at, n);
    word[n] = 0;
    *at += n;
    return true;
}

static bool take_pair(const char **at, parian_method_spec *spec)
{
    if (spec->pair_count == PARIAN_METHOD_PAIRS_MAX) {
        return false;
    }
    parian_method_pair *pair = &spec->pair[spec->pair_count++];
    if (!take_word(at, pair->key) || *(*at)++ != '=') {
        return false;
    }
    return take_word(at, pair->value);
}

/* NAME[:KEY=VALUE,...] and nothing behind it. */
static bool parse_form(const char *at, parian_method_spec *spec)
{
    if (!take_word(&at, spec->name)) {
        return false;
    }
    bool more = *at == ':';
    while (more) {
        at++;
        if (!take_pair(&at, spec)) {
            return false;
        }
        more = *at == ',';
    }
    return *at == '\0';
}

static bool has_word(const char *list, const char *word)
{
    size_t n = strlen(word);
    for (const char *at = list; (at = strstr(at, word)) != NULL; at += n) {
        if ((at == list || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0')) {
            return true;
        }
    }
    return false;
}

static parian_result check_keys(const parian_env *env, const struct method_entry *method,
                                const parian_method_spec *spec)
{
    for (size_t i = 0; i < spec->pair_count; i++) {
        const char *key = spec->pair[i].key;
        if (!has_word(method->keys, key)) {
            return parian_fail(env, PARIAN_E_ARGUMENT, "method '%s': '%s' has no setting '%s'%s%s",
                               spec->text, method->name, key, *method->keys ? "; it has: " : "",
                               method->keys);
        }
        for (size_t k = 0; k < i; k++) {
            if (strcmp(key, spec->pair[k].key) == 0) {
                return parian_fail(env, PARIAN_E_ARGUMENT, "method '%s': '%s' is given twice",
                                   spec->text, key);
            }
        }
    }
    return PARIAN_OK;
}

static parian_result check_method(const parian_env *env, const parian_method_spec *spec)
{
    for (int m = 0; m < METHOD_COUNT; m++) {
        if (strcmp(spec->name, METHODS[m].name) == 0) {
            return METHODS[m].built ? check_keys(env, &METHODS[m], spec)
                                    : parian_fail(env, PARIAN_E_UNSUPPORTED,
                                                  "method '%s' is not built yet", spec->name);
        }
    }
    return parian_fail(
        env, PARIAN_E_ARGUMENT,
        "no method is named '%s'; expected transfer (texture, volume and maps are not built yet)",
        spec->name);
}

parian_result parian_method_parse(const parian_env *env, const char *text, parian_method_spec *spec)
{
    *spec = (parian_method_spec){.pair_count = 0};
    if (strlen(text) >= PARIAN_METHOD_TEXT_MAX || !parse_form(text, spec)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "method '%.200s' is not of the form NAME[:KEY=VALUE,...]", text);
    }
    memcpy(spec->text, text, strlen(text) + 1);
    return check_method(env, spec);
}

static parian_result append_method(const parian_env *env, const char *text,
                                   parian_method_spec *spec, size_t *count)
{
    if (*count == PARIAN_METHODS_MAX) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "more than %d methods", PARIAN_METHODS_MAX);
    }
    parian_result r = parian_method_parse(env, text, &spec[*count]);
    for (size_t i = 0; r == PARIAN_OK && i < *count; i++) {
        if (strcmp(spec[i].text, text) == 0) {
            r = parian_fail(env, PARIAN_E_ARGUMENT, "method '%s' is given twice", text);
        }
    }
    *count += r == PARIAN_OK;
    return r;
}

parian_result parian_method_list_parse(const parian_env *env, const char *text,
                                       parian_method_spec spec[PARIAN_METHODS_MAX], size_t *count)
{
    parian_result r = PARIAN_OK;
    *count = 0;
    for (text += strspn(text, SPACE); r == PARIAN_OK && *text; text += strspn(text, SPACE)) {
        char one[PARIAN_METHOD_TEXT_MAX + 1];
        size_t n = strcspn(text, SPACE);
        snprintf(one, sizeof one, "%.*s", (int)(n < sizeof one ? n : sizeof one), text);
        r = append_method(env, one, spec, count);
        text += n;
    }
    return r == PARIAN_OK && *count == 0 ? parian_fail(env, PARIAN_E_ARGUMENT, "no method is given")
                                         : r;
}
