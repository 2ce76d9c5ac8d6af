/* cpu_occlusion.h - does anything stand between a point and a light: the C evaluation of
 * shaders/occlusion.glsl.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_OCCLUSION_H
#define PARIAN_CPU_OCCLUSION_H

#include "lights/occluder_tree.h"

/* What casts shadows, and where it stands. */
typedef struct parian_casters {
    const parian_occluder_tree *tree;
    const parian_caster *caster;
    uint32_t count;
} parian_casters;

/* direction of any length but 0, in the world: what counts is within `far` times that. own: the
 * origin in the coordinates of the instance that it lies on, whose bodies are the casters own_first
 * to own_first + own_count. Threads: any. */
bool parian_cpu_occluded(const parian_casters *casters, uint32_t own_first, uint32_t own_count,
                         const float own[3], const float origin[3], const float direction[3],
                         float far);

#endif
