/* cpu_shade.h - radiance of the picture: the C evaluation of the shading passes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_SHADE_H
#define PARIAN_CPU_SHADE_H

#include "cpu/cpu_lights.h"
#include "shade/body_optics.h"
#include "shade/view.h"

/* What shading reads of one body: atlases with their gutters, [atlas_size^2], or NULL where absent.
 */
typedef struct parian_shade_atlas {
    float (*irradiance)[4], (*local)[4], (*global)[4];
    float (*normal)[4], (*albedo)[4], (*values)[4];
} parian_shade_atlas;

typedef struct parian_shade_desc {
    const parian_scene_data *scene;
    const parian_body_optics *optics;  /* [body_count] */
    const parian_placement *instances; /* [instance_count] */
    uint32_t instance_count;
    const parian_shade_atlas
        *atlas; /* [instance_count * body_count] bodies of an instance together */
    const parian_cpu_lights *lights;
    const parian_settings *settings;
    const parian_view *view;
    uint32_t width, height; /* samples */
} parian_shade_desc;

/* Draw bodies and surroundings: [width * height] radiance and coverage, row 0 on top.
 * Errors: PARIAN_E_NOMEM. */
parian_result parian_cpu_shade(const parian_env *env, const parian_shade_desc *desc,
                               float (*radiance)[4]);

#endif
