/* surface_walk.h - vertices near one vertex along the edges of the transfer surface.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SURFACE_WALK_H
#define PARIAN_BAKE_SURFACE_WALK_H

#include "core/vertex_frame.h"

typedef struct parian_walk_step {
    float distance; /* metres along edges */
    uint32_t vertex;
} parian_walk_step;

typedef struct parian_walk {
    const parian_body *body;
    const parian_vertex_frame *frame;
    uint32_t count;
    parian_walk_step *found; /* [count] nearest first, the start included */
    parian_walk_step *heap;
    uint32_t heap_count, token;
    float *distance; /* [vertex_count], valid where stamp is token */
    uint32_t *stamp;
} parian_walk;

parian_result parian_walk_make(const parian_env *env, const parian_body *body,
                               const parian_vertex_frame *frame, parian_walk *walk);
void parian_walk_free(const parian_env *env, parian_walk *walk);

/* Find the vertices within reach of start, over vertices whose normals have a cosine of at least
 * `facing` with start's. */
void parian_walk_from(parian_walk *walk, uint32_t start, double reach, double facing);

#endif
