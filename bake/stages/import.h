/* import.h - the scene that a bake starts from: bodies with media, surroundings, lights. First
 * stage.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_IMPORT_H
#define PARIAN_BAKE_IMPORT_H

#include "core/medium.h"
#include "core/mesh.h"
#include "parian/light.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An 8-bit RGBA picture, rows from top to bottom, sRGB-coded. */
typedef struct parian_picture {
    uint32_t width, height;
    uint8_t (*pixel)[4]; /* [height * width] */
} parian_picture;

/* The surface and volume description of a source material (glTF: with its extensions' defaults). */
typedef struct parian_source_material {
    char name[PARIAN_NAME_MAX];
    float base_color[4];        /* linear factor */
    int32_t base_color_picture; /* index into the scene's pictures, or -1 */
    bool has_volume;            /* KHR_materials_volume present */
    bool has_scatter;           /* KHR_materials_scatter or KHR_materials_volume_scatter present */
    bool new_draft; /* KHR_materials_scatter, which replaces KHR_materials_volume_scatter:
                     * albedo (1-s^2)/(1-g s^2); else 1-s^2 */
    double
        attenuation_distance; /* metres in world space, unscaled by nodes; infinity where absent */
    double attenuation_color[3];
    double multiscatter_color[3]; /* times the scatter strength, if any */
    double scatter_anisotropy;
    double ior; /* 1.5 where absent */
} parian_source_material;

/* One mesh of one material, transforms applied. */
typedef struct parian_source_part {
    char name[PARIAN_NAME_MAX];      /* node name, else mesh name, else "body" */
    char mesh_name[PARIAN_NAME_MAX]; /* glTF mesh name */
    uint32_t material;               /* index into materials; 0xFFFFFFFF for none */
    parian_mesh mesh;                /* corner_uv and corner_normal where the source has them */
} parian_source_part;

typedef struct parian_source_scene {
    bool is_scene; /* glTF: metres and several parts; else one part in file units */
    uint32_t part_count, material_count, picture_count, light_count;
    parian_source_part *parts;
    parian_source_material *materials;
    parian_picture *pictures;
    parian_light *lights; /* KHR_lights_punctual: intensities in candela taken as W/sr */
} parian_source_scene;

void parian_source_scene_free(const parian_env *env, parian_source_scene *scene);

/* Read a model file by its extension (.glb .gltf .obj .ply .stl .off, any case).
 * Errors: PARIAN_E_IO, PARIAN_E_FORMAT, PARIAN_E_UNSUPPORTED (extension, required glTF extension),
 * PARIAN_E_NOMEM; one log line each: what was found, expected, where. Non-finite coordinates are
 * PARIAN_E_FORMAT. */
parian_result parian_import(const parian_env *env, const char *path, parian_source_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
