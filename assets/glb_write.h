/* glb_write.h - a small glTF 2.0 scene as a .glb file: meshes, scattering media, punctual lights.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_GLB_WRITE_H
#define PARIAN_ASSETS_GLB_WRITE_H

#include <stdbool.h>

#include "model_mesh.h"

enum { GLB_PARTS_MAX = 4, GLB_LIGHTS_MAX = 4 };

/* What a body is made of, as the literature gives it. */
typedef struct model_medium {
    double sigma_s_prime_per_mm[3]; /* reduced scattering */
    double sigma_a_per_mm[3];       /* absorption */
    double g;                       /* mean cosine of the scattering angle */
    double eta;                     /* index of refraction */
} model_medium;

/* The same medium in the terms of KHR_materials_volume and KHR_materials_scatter. */
typedef struct gltf_medium {
    double attenuation_color[3];
    double attenuation_distance_m;
    double multiscatter_color[3];
} gltf_medium;

typedef struct glb_part {
    const char *name;
    const char *material_name;
    model_mesh mesh;            /* metres */
    const model_medium *medium; /* NULL: an opaque, diffuse part of the surroundings */
    double base_color[3];       /* linear */
    double roughness;
} glb_part;

typedef struct glb_light {
    const char *name;
    bool directional; /* else a point light */
    vec3 at; /* point: position, metres; directional: the direction in which the light travels */
    double color[3]; /* point: W/sr; directional: W/m^2 (glTF's candela and lux, taken as
                        radiometric) */
} glb_light;

typedef struct glb_scene {
    uint32_t part_count, light_count;
    glb_part part[GLB_PARTS_MAX];
    glb_light light[GLB_LIGHTS_MAX];
} glb_scene;

void glb_scene_free(const parian_env *env, glb_scene *scene);

/* Invert the glTF extensions' formulas. Source: KHR_materials_volume, KHR_materials_scatter.
 */
gltf_medium gltf_medium_from(const model_medium *medium);

/* Write PATH, atomically. The same scene gives the same bytes. Errors: PARIAN_E_IO, PARIAN_E_NOMEM.
 */
parian_result glb_write(const parian_env *env, const char *path, const glb_scene *scene);

#endif
