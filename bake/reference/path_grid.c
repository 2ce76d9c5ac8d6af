/* path_grid.c - marks the voxels that triangles may touch, then counts the free layers around each
 * other voxel.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/path_grid.h"

#include <string.h>

#include "bake/reference/vec3d.h"
#include "core/memory.h"

/* By how much a triangle's reach is widened, in voxels: far above rounding, far below a voxel. */
static const double MARGIN = 1e-3;

void parian_path_grid_free(const parian_env *env, parian_path_grid *grid)
{
    if (grid) {
        parian_free(env, grid->layers);
        *grid = (parian_path_grid){0};
    }
}

static size_t voxel_at(const parian_path_grid *grid, uint32_t x, uint32_t y, uint32_t z)
{
    return ((size_t)z * grid->size[1] + y) * grid->size[0] + x;
}

typedef struct flat_triangle {
    double normal[3], offset,
        reach;               /* voxels: plane, and half of a voxel's width along the normal */
    uint32_t from[3], to[3]; /* voxels of the box, both inclusive */
} flat_triangle;

static flat_triangle reach_of(const parian_path_grid *grid, const parian_mesh *mesh, uint32_t t)
{
    flat_triangle flat;
    double p[3][3], a[3], b[3];
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            p[i][k] = (mesh->position[mesh->triangle[t][i]][k] - grid->lower[k]) * grid->inverse;
        }
    }
    vec3d_sub(a, p[1], p[0]);
    vec3d_sub(b, p[2], p[0]);
    vec3d_cross(flat.normal, a, b);
    vec3d_normalize(flat.normal);
    flat.offset = vec3d_dot(flat.normal, p[0]);
    flat.reach =
        MARGIN + 0.5 * (fabs(flat.normal[0]) + fabs(flat.normal[1]) + fabs(flat.normal[2]));
    for (int k = 0; k < 3; k++) {
        double low = fmin(p[0][k], fmin(p[1][k], p[2][k])) - MARGIN;
        double high = fmax(p[0][k], fmax(p[1][k], p[2][k])) + MARGIN;
        double last = (double)(grid->size[k] - 1);
        flat.from[k] = (uint32_t)fmin(fmax(low, 0), last);
        flat.to[k] = (uint32_t)fmin(fmax(high, 0), last);
    }
    return flat;
}

static void mark_triangle(parian_path_grid *grid, const flat_triangle *flat)
{
    for (uint32_t z = flat->from[2]; z <= flat->to[2]; z++) {
        for (uint32_t y = flat->from[1]; y <= flat->to[1]; y++) {
            for (uint32_t x = flat->from[0]; x <= flat->to[0]; x++) {
                double middle[3] = {(double)x + 0.5, (double)y + 0.5, (double)z + 0.5};
                if (fabs(vec3d_dot(flat->normal, middle) - flat->offset) <= flat->reach) {
                    grid->layers[voxel_at(grid, x, y, z)] = 0;
                }
            }
        }
    }
}

/* One pass of the chessboard distance: each voxel takes the least of those that the pass has left
 * behind, plus one. Voxels beyond the rim count as free. */
static void relax_voxel(parian_path_grid *grid, uint32_t x, uint32_t y, uint32_t z, int way)
{
    size_t here = voxel_at(grid, x, y, z);
    unsigned least = grid->layers[here];
    for (int i = 0; i < 13 && least > 0; i++) { /* the 13 of 26 neighbours that come before it */
        int64_t nx = (int64_t)x + way * (i % 3 - 1), ny = (int64_t)y + way * (i / 3 % 3 - 1);
        int64_t nz = (int64_t)z + way * (i / 9 - 1);
        if (nx < 0 || ny < 0 || nz < 0 || nx >= grid->size[0] || ny >= grid->size[1] ||
            nz >= grid->size[2]) {
            continue;
        }
        unsigned next = grid->layers[voxel_at(grid, (uint32_t)nx, (uint32_t)ny, (uint32_t)nz)] + 1u;
        least = next < least ? next : least;
    }
    grid->layers[here] = (uint8_t)least;
}

static void count_layers(parian_path_grid *grid)
{
    for (int way = 1; way >= -1; way -= 2) {
        for (uint32_t k = 0; k < grid->size[2]; k++) {
            for (uint32_t j = 0; j < grid->size[1]; j++) {
                for (uint32_t i = 0; i < grid->size[0]; i++) {
                    uint32_t x = way > 0 ? i : grid->size[0] - 1 - i;
                    uint32_t y = way > 0 ? j : grid->size[1] - 1 - j;
                    uint32_t z = way > 0 ? k : grid->size[2] - 1 - k;
                    relax_voxel(grid, x, y, z, way);
                }
            }
        }
    }
}

parian_result parian_path_grid_make(const parian_env *env, const parian_mesh *mesh,
                                    uint32_t resolution, parian_path_grid *grid)
{
    double upper[3], extent = 0;
    parian_mesh_bounds(mesh, grid->lower, upper);
    for (int k = 0; k < 3; k++) {
        extent = fmax(extent, upper[k] - grid->lower[k]);
    }
    extent = extent > 0 ? extent : 1;
    grid->voxel = extent / (double)resolution;
    grid->inverse = 1 / grid->voxel;
    for (int k = 0; k < 3; k++) { /* half a voxel of air on both sides */
        grid->size[k] = (uint32_t)ceil((upper[k] - grid->lower[k]) * grid->inverse) + 1;
        grid->lower[k] -= 0.5 * ((double)grid->size[k] * grid->voxel - (upper[k] - grid->lower[k]));
    }
    size_t count = (size_t)grid->size[0] * grid->size[1] * grid->size[2];
    if (!PARIAN_NEW(env, grid->layers, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu voxels", count);
    }
    memset(grid->layers, 255, count);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        flat_triangle flat = reach_of(grid, mesh, t);
        mark_triangle(grid, &flat);
    }
    count_layers(grid);
    for (size_t i = 0; i < count; i++) { /* a voxel with n - 1 free layers around it */
        grid->layers[i] = (uint8_t)(grid->layers[i] > 0 ? grid->layers[i] - 1 : 0);
    }
    return PARIAN_OK;
}
