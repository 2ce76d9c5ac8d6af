/* method_spec.h - NAME[:KEY=VALUE,...]: which method to run, with which settings.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_METHOD_SPEC_H
#define PARIAN_MEASURE_METHOD_SPEC_H

#include <stddef.h>

#include "parian/env.h"
#include "parian/result.h"

enum {
    PARIAN_METHOD_TEXT_MAX = 256,
    PARIAN_METHOD_WORD_MAX = 64,
    PARIAN_METHOD_PAIRS_MAX = 16,
    PARIAN_METHODS_MAX = 64
};

typedef struct parian_method_pair {
    char key[PARIAN_METHOD_WORD_MAX], value[PARIAN_METHOD_WORD_MAX];
} parian_method_pair;

typedef struct parian_method_spec {
    char text[PARIAN_METHOD_TEXT_MAX]; /* as given: the name in tables */
    char name[PARIAN_METHOD_WORD_MAX];
    parian_method_pair pair[PARIAN_METHOD_PAIRS_MAX];
    size_t pair_count;
} parian_method_spec;

/* Parse one method and check its name and keys against the table of methods. Errors:
 * PARIAN_E_ARGUMENT (form, a name or key that no method has, a key given twice),
 * PARIAN_E_UNSUPPORTED (a method that is not built yet). */
parian_result parian_method_parse(const parian_env *env, const char *text,
                                  parian_method_spec *spec);
/* The same for methods that white space separates; the same text twice is PARIAN_E_ARGUMENT, as are
 * none. */
parian_result parian_method_list_parse(const parian_env *env, const char *text,
                                       parian_method_spec spec[PARIAN_METHODS_MAX], size_t *count);

#endif
