/* lights_file.h - lights from a lights file, from --light specifications, and back to JSON.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_LIGHTS_FILE_H
#define PARIAN_TOOL_LIGHTS_FILE_H

#include <stddef.h>

#include "parian/env.h"
#include "parian/light.h"
#include "parian/result.h"

/* Lights with the pictures they refer to. */
typedef struct parian_light_set {
    parian_light *light;
    size_t count;
} parian_light_set;

void parian_light_set_free(const parian_env *env, parian_light_set *set);

/* Append the lights of a lights file; relative pictures are relative to the file.
 * Errors: PARIAN_E_IO, PARIAN_E_FORMAT with light index and key. */
parian_result parian_lights_read_file(const parian_env *env, const char *path,
                                      parian_light_set *set);
/* The same from JSON text; folder (may be NULL) is where relative pictures are. */
parian_result parian_lights_parse(const parian_env *env, const char *json, const char *folder,
                                  parian_light_set *set);
/* Append one light from "point:0,0.1,0.2:intensity=1", "directional:0,0,-1:irradiance=1,0.9,0.8",
 * "spot:X,Y,Z:direction=0,0,-1:outer=30:inner=20:image=slide.png:intensity=1",
 * "environment:radiance=1", "environment:sky.exr". Errors: PARIAN_E_ARGUMENT. */
parian_result parian_lights_parse_spec(const parian_env *env, const char *spec,
                                       parian_light_set *set);
/* JSON text of lights without pictures (for an asset's default lights); free with parian_free. */
parian_result parian_lights_to_json(const parian_env *env, const parian_light *light, size_t count,
                                    char **json);

#endif
