/* cpu_irradiance.h - E of texels: the C evaluation of shaders/irradiance.glsl.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_IRRADIANCE_H
#define PARIAN_CPU_IRRADIANCE_H

#include "cpu/cpu_lights.h"
#include "cpu/cpu_occlusion.h"

typedef struct parian_irradiance_desc {
    const parian_light_list *list;
    const parian_light_sample *sample; /* [list->sample_count] of the set */
    parian_casters casters;
    uint32_t own_first, own_count; /* casters of the body's instance */
    const parian_body *body;
    const parian_placement *at;
    const float (*origin)[3]; /* [texel_count] where rays start, in the body's coordinates */
    float eta;
    float relief_reach; /* parian_relief_reach of the body */
    float share;        /* of this set in the mean; 1: the first one */
} parian_irradiance_desc;

/* E of every texel, [texel_count]; with a share below 1 the mean with what is there. Threads: uses
 * env->par. */
void parian_cpu_irradiance(const parian_env *env, const parian_irradiance_desc *desc,
                           float (*irradiance)[3]);

#endif
