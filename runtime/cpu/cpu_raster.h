/* cpu_raster.h - which points of which triangles are seen through which pixels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CPU_RASTER_H
#define PARIAN_CPU_RASTER_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_raster_desc {
    uint32_t width, height; /* pixels; row 0 is at y = +1 */
    uint32_t triangle_count;
    const uint32_t (*triangle)[3];
    const float (*position)[3];
    float row_x[4], row_y[4], row_w[4]; /* clip coordinates: x = row_x . (p, 1) and so on */
    float near_w;                       /* what has a smaller w is not seen; 0 for no such limit */
    /* Called for each covered pixel centre, by one thread for a pixel, in the order of the
     * triangles. share[k]: barycentric of corner k divided by w there; their sum is 1 / w > 0. */
    void (*fragment)(void *context, uint32_t pixel, uint32_t triangle, const float share[3]);
    void *context;
} parian_raster_desc;

/* Triangles are seen from both sides, and need no clipping. Errors: PARIAN_E_NOMEM.
 * Threads: uses env->par, by bands of rows.
 * Source   [OlanoGreer97], homogeneous edge functions */
parian_result parian_raster_run(const parian_env *env, const parian_raster_desc *desc);

#endif
