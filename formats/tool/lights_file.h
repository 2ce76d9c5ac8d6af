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

/* Lights with the pictures they refer to. Directions are made unit vectors; pictures hold finite
 * numbers from 0. */
typedef struct parian_light_set {
    parian_light *light;
    size_t count;
} parian_light_set;

enum { PARIAN_LIGHTS_MAX = 1024 };

void parian_light_set_free(const parian_env *env, parian_light_set *set);
/* Append a copy of a light; its picture, which parian_free must be able to free, goes to the set
 * (and is freed on failure). Errors: PARIAN_E_LIMIT, PARIAN_E_NOMEM. */
parian_result parian_light_set_append(const parian_env *env, parian_light_set *set,
                                      const parian_light *light);

/* Each of these appends to the set, or leaves it as it was. One number holds for all three
 * channels; a spot's outer_deg is 30 and its inner_deg two thirds of that unless given; an
 * environment with a picture has radiance 1 unless given. Unknown keys are warned of. Errors:
 * PARIAN_E_IO, PARIAN_E_FORMAT (file, light index, key), PARIAN_E_LIMIT, PARIAN_E_NOMEM. */

/* The lights of a lights file; relative pictures are relative to the file. */
parian_result parian_lights_read_file(const parian_env *env, const char *path,
                                      parian_light_set *set);
/* The same from JSON text; folder (may be NULL) is where relative pictures are. */
parian_result parian_lights_parse(const parian_env *env, const char *json, const char *folder,
                                  parian_light_set *set);
/* One light from "point:0,0.1,0.2:intensity=1", "directional:0,0,-1:irradiance=1,0.9,0.8",
 * "spot:X,Y,Z:direction=0,0,-1:outer=30:inner=20:image=slide.png:intensity=1",
 * "rect:X,Y,Z:axis_u=0.1,0,0:axis_v=0,0.1,0:radiance=1", "environment:radiance=1",
 * "environment:sky.exr". Errors: PARIAN_E_ARGUMENT for the text; as above for the picture. */
parian_result parian_lights_parse_spec(const parian_env *env, const char *spec,
                                       parian_light_set *set);

/* JSON text of lights without pictures (for an asset's default lights); free with parian_free.
 * Errors: PARIAN_E_UNSUPPORTED (a light has a picture), PARIAN_E_NOMEM. */
parian_result parian_lights_to_json(const parian_env *env, const parian_light *light, size_t count,
                                    char **json);

#endif
