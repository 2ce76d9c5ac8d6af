/* view_sequence.h - pictures in a row: names of their files, and the camera of each frame.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_SEQUENCE_H
#define PARIAN_VIEW_SEQUENCE_H

#include "view_camera.h"
#include "view_options.h"

/* --image, --turntable, --camera-path, --frames and --view must go together. Errors:
 * PARIAN_E_ARGUMENT. */
parian_result parian_view_sequence_check(const parian_env *env, const parian_view_options *options);
/* True when --image names several pictures. */
bool parian_view_sequence_is_wanted(const parian_view_options *options);

/* The name of one picture: %d or %0Nd in the pattern is its number, %s the name of its view, %% a
 * percent sign. False when the pattern holds anything else, or the name is too long. */
bool parian_view_sequence_name(const char *pattern, uint32_t number, const char *view, char *name,
                               size_t size);

/* Keyframes of a camera, and how many frames to make of them. */
typedef struct parian_view_path {
    size_t count; /* at least 2 */
    double *time; /* ascending */
    parian_view_camera *key;
    uint32_t frames;
} parian_view_path;

/* {"frames":N, "keyframes":[{"time":T, "eye":..., "target":..., "up":..., "fov_deg":...}, ...]};
 * time is the number of the keyframe unless given, frames 25 for each unit of time. start: what
 * keyframes leave out. Errors: PARIAN_E_IO, PARIAN_E_FORMAT, PARIAN_E_NOMEM. */
parian_result parian_view_path_read(const parian_env *env, const char *file,
                                    const parian_view_camera *start, parian_view_path *path);
void parian_view_path_free(const parian_env *env, parian_view_path *path);

/* The camera at a share of the way, 0 to 1: eye and target on cubics through the keyframes
 * (Catmull-Rom with the keyframes' times), direction of up and field of view on lines. */
parian_view_camera parian_view_path_at(const parian_view_path *path, double share);

#endif
