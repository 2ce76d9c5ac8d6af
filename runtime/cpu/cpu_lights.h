/* cpu_lights.h - light that arrives at a point, and shadows: the C evaluation of
 * shaders/lights.glsl.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_LIGHTS_H
#define PARIAN_CPU_LIGHTS_H

#include <stdbool.h>

#include "core/body.h"
#include "lights/light_list.h"
#include "placement.h"

typedef struct parian_cpu_lights {
    const parian_light_list *list;
    float *depth; /* [layer_count][shadow_size^2] nearest depth, 1 where nothing is */
    float lift;   /* metres along the normal before a look-up, at scale 1 */
} parian_cpu_lights;

/* Draw all shadow maps of the list; casters are the bodies of all instances and the surroundings.
 * Replaces lights->depth. Errors: PARIAN_E_NOMEM. */
parian_result parian_cpu_shadow(const parian_env *env, const parian_scene_data *scene,
                                const parian_placement *instances, uint32_t instance_count,
                                parian_cpu_lights *lights);

/* Light of a sample at a point: direction towards the light and irradiance on a plane perpendicular
 * to it, unshadowed. extent: side of the patch of surface that the point stands for, metres
 * (pictures are filtered over it, and it bounds 1/d^2). */
void parian_cpu_light_at(const parian_light_list *list, const parian_light_sample *sample,
                         const float p[3], float extent, float to_light[3], float irradiance[3]);

/* Share of a sample's light that reaches a point with a unit normal, in [0, 1]. scale: of the
 * point's instance, 1 for surroundings; it scales the lift. */
float parian_cpu_visibility(const parian_cpu_lights *lights, const parian_light_sample *sample,
                            const float p[3], const float n[3], float scale);

/* Irradiance of the environment's smooth part on a diffuse surface, with the zonal coefficients of
 * a cosine lobe, and shadows of its probes by shadow maps. */
void parian_cpu_environment(const parian_cpu_lights *lights, const float p[3], const float n[3],
                            const float zonal[3], float scale, float irradiance[3]);

/* The same for a known share of the probes' light: open is what of whole is not blocked. */
void parian_cpu_environment_open(const parian_light_list *list, const float n[3],
                                 const float zonal[3], const float open[3], const float whole[3],
                                 float irradiance[3]);

/* Radiance of the environment from a direction, from its nine coefficients. */
void parian_cpu_environment_radiance(const parian_light_list *list, const float direction[3],
                                     float radiance[3]);

#endif
