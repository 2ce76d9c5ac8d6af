/* scene_internal.h - what a scene holds, for the renderer and the tests.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_SCENE_INTERNAL_H
#define PARIAN_SCENE_INTERNAL_H

#include "core/body.h"
#include "parian/runtime.h"

struct parian_scene {
    parian_env env;
    parian_scene_data data;
    parian_scene_info info;
};

/* A scene from derived data, which it takes over (and frees, also on failure). */
parian_result parian_scene_adopt(const parian_env *env, parian_scene_data *data,
                                 parian_scene **scene);

#endif
