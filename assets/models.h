/* models.h - the example models, and what a generator of one does.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_MODELS_H
#define PARIAN_ASSETS_MODELS_H

#include "glb_write.h"
#include "implicit.h"

/* Fill a zeroed scene, in metres, y up, front towards +z. On failure what was made stays for
 * glb_scene_free. triangle_count is that of the body. */
typedef parian_result (*model_function)(const parian_env *env, uint32_t triangle_count,
                                        glb_scene *scene);

parian_result model_figurine(const parian_env *env, uint32_t triangle_count, glb_scene *scene);
parian_result model_candle(const parian_env *env, uint32_t triangle_count, glb_scene *scene);
parian_result model_cup(const parian_env *env, uint32_t triangle_count, glb_scene *scene);
parian_result model_leaf(const parian_env *env, uint32_t triangle_count, glb_scene *scene);
parian_result model_sphere(const parian_env *env, uint32_t triangle_count, glb_scene *scene);
parian_result model_slab(const parian_env *env, uint32_t triangle_count, glb_scene *scene);

typedef struct model_entry {
    const char *name;
    model_function make;
    uint32_t triangle_count; /* by default */
    const char *summary;
} model_entry;

extern const model_entry model_table[];
extern const uint32_t model_count;

/* Make one model, check that every mesh of it is closed and manifold, write FOLDER/NAME.glb. */
parian_result model_write(const parian_env *env, const model_entry *entry, uint32_t triangle_count,
                          const char *folder);

/* Polygonise a field whose unit is the millimetre and append it to the scene. */
parian_result model_add_solid(const parian_env *env, glb_scene *scene, const glb_part *part,
                              field_function field, vec3 lower_mm, vec3 upper_mm,
                              uint32_t triangle_count);
/* Append an opaque solid of revolution, its profile in millimetres, moved by `at`. */
parian_result model_add_lathe(const parian_env *env, glb_scene *scene, const glb_part *part,
                              const double (*profile_mm)[2], uint32_t count, vec3 at_mm);
void model_add_light(glb_scene *scene, const glb_light *light);

/* Write small damaged files for tests into a folder. */
parian_result nasty_write(const parian_env *env, const char *folder);

#endif
