/* path_grid.h - a grid over one body that says how far a walk may go without meeting the surface:
 * deep inside, a flight needs no ray.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PATH_GRID_H
#define PARIAN_BAKE_PATH_GRID_H

#include <math.h>
#include <stdint.h>

#include "core/mesh.h"

typedef struct parian_path_grid {
    uint32_t size[3];
    double lower[3], voxel, inverse; /* metres; 1 / voxel */
    uint8_t *layers;                 /* [z][y][x] voxels without surface all around, up to 255 */
} parian_path_grid;

/* resolution: voxels along the longest side. Errors: PARIAN_E_NOMEM. */
parian_result parian_path_grid_make(const parian_env *env, const parian_mesh *mesh,
                                    uint32_t resolution, parian_path_grid *grid);
void parian_path_grid_free(const parian_env *env, parian_path_grid *grid);

/* A lower bound of the distance from x to the surface, metres; negative outside the mesh's box. */
static inline double parian_path_grid_distance(const parian_path_grid *grid, const double x[3])
{
    double u[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (x[k] - grid->lower[k]) * grid->inverse;
        if (!(u[k] >= 0 && u[k] < (double)grid->size[k])) {
            return -1;
        }
    }
    size_t at =
        ((size_t)(uint32_t)u[2] * grid->size[1] + (uint32_t)u[1]) * grid->size[0] + (uint32_t)u[0];
    return (double)grid->layers[at] * grid->voxel;
}

#endif
