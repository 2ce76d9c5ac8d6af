/* scene_hash.h - a number for everything in a scene that a truth depends on.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SCENE_HASH_H
#define PARIAN_BAKE_SCENE_HASH_H

#include "bake/reference/reference.h"

/* 128 bits of XXH3 over bodies (triangles, corner normals, media, fields), surroundings, lights
 * with their pictures, and the receivers' places, normals and areas. Errors: PARIAN_E_NOMEM. */
parian_result parian_reference_scene_hash(const parian_env *env,
                                          const parian_reference_scene *scene,
                                          const parian_receivers *receivers, uint64_t hash[2]);

#endif
