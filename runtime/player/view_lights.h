/* view_lights.h - the lights that the player begins with, and how the mouse moves them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_LIGHTS_H
#define PARIAN_VIEW_LIGHTS_H

#include "tool/lights_file.h"
#include "view_camera.h"
#include "view_options.h"

/* Lights of --lights and --light. Errors: those of lights_file.h. */
parian_result parian_view_lights_read(const parian_env *env, const parian_view_options *options,
                                      parian_light_set *set);
/* Fill an empty set: with the asset's lights, else a key light in front, to the left and above,
 * with an irradiance of 3 W/m^2 at the bodies, and a weaker one behind them. */
parian_result parian_view_lights_default(const parian_env *env, const parian_scene_info *info,
                                         const parian_view_extent *extent, parian_light_set *set);

/* The irradiance that lights give a surface facing each of them at a point, summed, as one grey
 * number: a measure of how bright the scene is, W/m^2. */
double parian_view_lights_brightness(const parian_light_set *set, const double point[3]);

/* A light of a type as one is added by hand: beside the bodies, an irradiance of about 2 W/m^2. */
parian_light parian_view_light_make(const parian_view_extent *extent, parian_light_type type);
/* Take a light out of the set. */
void parian_view_light_remove(const parian_env *env, parian_light_set *set, size_t index);
/* Where a light is shown in the scene: its place, or, of one without a place, a point beside the
 * bodies that it comes from. False for an environment. */
bool parian_view_light_place(const parian_light *light, const parian_view_extent *extent,
                             double place[3]);
/* Move what is shown to another place: a light with a place goes there, a directional one comes
 * from there. */
void parian_view_light_move(parian_light *light, const parian_view_extent *extent,
                            const double place[3]);

/* Turn a light about a point by a rotation of the world: unit axis, radians. */
void parian_view_light_turn(parian_light *light, const double centre[3], const double axis[3],
                            double angle);

#endif
