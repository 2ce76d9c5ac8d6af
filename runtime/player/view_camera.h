/* view_camera.h - where the player looks from: framing, --camera, and the motions of the mouse.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_CAMERA_H
#define PARIAN_VIEW_CAMERA_H

#include "parian/env.h"
#include "parian/result.h"
#include "parian/runtime.h"

/* World space, metres. */
typedef struct parian_view_camera {
    double eye[3], target[3], up[3];
    double fov_deg; /* vertical */
} parian_view_camera;

/* A sphere about the bodies and one about everything; a scene without extent gets a radius of 1. */
typedef struct parian_view_extent {
    double body_centre[3], body_radius, body_lower[3], body_upper[3];
    double centre[3], radius;
} parian_view_extent;
parian_view_extent parian_view_extent_of(const parian_scene_info *info);

/* The camera that --camera asks for; NULL frames the box of all bodies from the front, a little
 * from above. aspect: width over height, for the framing. Errors: PARIAN_E_ARGUMENT, PARIAN_E_IO,
 * PARIAN_E_FORMAT. */
parian_result parian_view_camera_make(const parian_env *env, const char *text,
                                      const parian_view_extent *extent, double aspect,
                                      parian_view_camera *camera);
/* True when --camera leaves the distance open: the camera is then to be fitted to what the bodies
 * hold. */
bool parian_view_camera_is_open(const char *text);
/* Keep the direction of the view, and place eye and target so that all points are in the picture,
 * centred and as large as they can be; nothing without points. depth_centre: the target is at its
 * depth. */
void parian_view_camera_fit(parian_view_camera *camera, const float (*point)[3], size_t count,
                            const double depth_centre[3], double aspect);
/* eye (required), target, up and fov_deg of a JSON object (a cJSON *); `where` begins the message.
 * What is left out stays. Errors: PARIAN_E_FORMAT. */
struct cJSON;
parian_result parian_view_camera_read_members(const parian_env *env, const char *where,
                                              const struct cJSON *object,
                                              parian_view_camera *camera);
/* What can be said about --camera before the asset is read: PARIAN_E_ARGUMENT for a bad orbit. */
parian_result parian_view_camera_check(const parian_env *env, const char *text);

/* Matrices as the renderer takes them; near and far enclose the extent. */
parian_camera parian_view_camera_matrices(const parian_view_camera *camera,
                                          const parian_view_extent *extent, double aspect);

/* Turn about the target by angles in radians; stops short of the poles. */
void parian_view_camera_orbit(parian_view_camera *camera, double yaw, double pitch);
/* Move eye and target across the view by shares of the picture's height. */
void parian_view_camera_pan(parian_view_camera *camera, double right, double up);
/* Scale the distance to the target. */
void parian_view_camera_zoom(parian_view_camera *camera, double factor);
/* Unit axes of the view in the world: right, up, and towards the viewer. */
void parian_view_camera_axes(const parian_view_camera *camera, double right[3], double up[3],
                             double back[3]);

#endif
