/* lights_internal.h - what the readers of lights files and of --light specifications share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_LIGHTS_INTERNAL_H
#define PARIAN_TOOL_LIGHTS_INTERNAL_H

#include <cjson/cJSON.h>
#include <stdint.h>

#include "tool/lights_file.h"

/* Where a light is from, for its messages and its pictures. */
typedef struct parian_light_source_text {
    const parian_env *env;
    const char *where;     /* "lights.json: light 2", "--light point:0,0" */
    const char *folder;    /* of relative pictures; NULL is the current one */
    parian_result mistake; /* what an invalid light is: FORMAT or ARGUMENT */
} parian_light_source_text;

/* The light that a JSON object describes; allocates its picture. */
parian_result parian_light_from_object(const parian_light_source_text *text, const cJSON *object,
                                       parian_light *light);

/* Free the lights from `count` on. */
void parian_light_set_cut(const parian_env *env, parian_light_set *set, size_t count);

#endif
