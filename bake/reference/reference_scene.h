/* reference_scene.h - loads what a reference is computed on: a model with media, or the transfer
 * surface of an asset.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_SCENE_H
#define PARIAN_BAKE_REFERENCE_SCENE_H

#include "bake/pipeline/bake.h"
#include "bake/reference/light_sampler.h"
#include "bake/reference/reference.h"

/* Build the scene of desc->input (material, scale, unit, keep_origin as in a bake; a .parian brings
 * its own media and surface) under the given lights (copied; NULL and 0 take the scene's own).
 * Errors: as parian_import, parian_select_bodies, parian_reader_open. */
parian_result parian_reference_scene_load(const parian_env *env, const parian_bake_desc *desc,
                                          const parian_light *lights, uint32_t light_count,
                                          parian_reference_scene *scene);
/* The same from surfaces at hand: bodies [body_count] and surroundings are taken over (freed on
 * failure too). */
parian_result parian_reference_scene_make(const parian_env *env, parian_reference_body *bodies,
                                          uint32_t body_count, parian_mesh *surroundings,
                                          uint32_t surrounding_count, const parian_light *lights,
                                          uint32_t light_count, parian_reference_scene *scene);

/* count places (met exactly where the surface allows, else within 2 %) spread evenly by area over
 * all bodies: systematic along the triangles in an order that follows the surface, one random place
 * in each share. */
parian_result parian_receivers_spread(const parian_env *env, const parian_reference_scene *scene,
                                      size_t count, uint64_t seed, parian_receivers *receivers);
/* Places nearest to points [count][3] (metres); area is 1 for each. */
parian_result parian_receivers_nearest(const parian_env *env, const parian_reference_scene *scene,
                                       const double (*point)[3], size_t count,
                                       parian_receivers *receivers);
void parian_receiver_place(const parian_receivers *receivers, size_t index, parian_place *place);

#endif
