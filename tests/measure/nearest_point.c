/* nearest_point.c - a grid of points, searched in growing shells of cells.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/nearest_point.h"

#include <math.h>
#include <stdlib.h>

#include "core/memory.h"

enum { SIDE_MAX = 96, PIECE = 1024 };

typedef struct point_grid {
    const float (*point)[3], (*query)[3];
    size_t count, query_count;
    double lower[3], cell; /* metres */
    int side[3];
    uint32_t *first; /* [cells + 1] into order */
    uint32_t *order; /* [count] points by cell */
    uint32_t *nearest;
} point_grid;

static int cell_along(const point_grid *grid, int c, double x)
{
    double i = floor((x - grid->lower[c]) / grid->cell);
    return i < 0 ? 0 : i >= grid->side[c] ? grid->side[c] - 1 : (int)i;
}

static size_t cell_of(const point_grid *grid, const float p[3])
{
    size_t index = 0;
    for (int c = 2; c >= 0; c--) {
        index = index * (size_t)grid->side[c] + (size_t)cell_along(grid, c, p[c]);
    }
    return index;
}

/* Cells of a size that gives a surface a few points in each. */
static void lay_out(point_grid *grid)
{
    double extent = 0, upper[3];
    for (int c = 0; c < 3; c++) {
        grid->lower[c] = INFINITY;
        upper[c] = -INFINITY;
        for (size_t i = 0; i < grid->count; i++) {
            grid->lower[c] = fmin(grid->lower[c], grid->point[i][c]);
            upper[c] = fmax(upper[c], grid->point[i][c]);
        }
        extent = fmax(extent, upper[c] - grid->lower[c]);
    }
    double along = fmin(fmax(sqrt((double)grid->count / 4), 1), SIDE_MAX);
    grid->cell = extent > 0 ? extent / along : 1;
    for (int c = 0; c < 3; c++) {
        grid->side[c] =
            (int)fmin(floor((upper[c] - grid->lower[c]) / grid->cell) + 1, SIDE_MAX + 1);
    }
}

static void sort_into_cells(point_grid *grid)
{
    size_t cells = (size_t)grid->side[0] * (size_t)grid->side[1] * (size_t)grid->side[2];
    for (size_t i = 0; i < grid->count; i++) {
        grid->first[cell_of(grid, grid->point[i]) + 1]++;
    }
    for (size_t k = 0; k < cells; k++) {
        grid->first[k + 1] += grid->first[k];
    }
    for (size_t i = grid->count; i-- > 0;) { /* from behind: first[] ends as it was, moved by one */
        size_t k = cell_of(grid, grid->point[i]);
        grid->order[--grid->first[k + 1]] = (uint32_t)i;
    }
    for (size_t k = 0; k < cells; k++) {
        grid->first[k] = grid->first[k + 1];
    }
    grid->first[cells] = (uint32_t)grid->count;
}

typedef struct best_point {
    double square;
    uint32_t index;
} best_point;

static void search_cell(const point_grid *grid, int x, int y, int z, const float q[3],
                        best_point *best)
{
    size_t k = ((size_t)z * (size_t)grid->side[1] + (size_t)y) * (size_t)grid->side[0] + (size_t)x;
    for (uint32_t i = grid->first[k]; i < grid->first[k + 1]; i++) {
        const float *p = grid->point[grid->order[i]];
        double d[3] = {(double)p[0] - q[0], (double)p[1] - q[1], (double)p[2] - q[2]};
        double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (square < best->square || (square == best->square && grid->order[i] < best->index)) {
            *best = (best_point){square, grid->order[i]};
        }
    }
}

static void search_shell(const point_grid *grid, const int at[3], int r, const float q[3],
                         best_point *best)
{
    for (int z = at[2] - r; z <= at[2] + r; z++) {
        for (int y = at[1] - r; y <= at[1] + r; y++) {
            int rim = abs(z - at[2]) == r || abs(y - at[1]) == r;
            for (int x = at[0] - r; x <= at[0] + r; x += rim || r == 0 ? 1 : 2 * r) {
                if (x >= 0 && y >= 0 && z >= 0 && x < grid->side[0] && y < grid->side[1] &&
                    z < grid->side[2]) {
                    search_cell(grid, x, y, z, q, best);
                }
            }
        }
    }
}

/* What lies in shell r + 1 or beyond is at least r cells away, as long as the query is within its
 * own cell; one outside the grid is nearer to nothing than its clamped place is. */
static void search_piece(void *context, size_t piece)
{
    const point_grid *grid = context;
    size_t end = (piece + 1) * PIECE < grid->query_count ? (piece + 1) * PIECE : grid->query_count;
    for (size_t i = piece * PIECE; i < end; i++) {
        const float *q = grid->query[i];
        best_point best = {INFINITY, 0};
        int at[3] = {cell_along(grid, 0, q[0]), cell_along(grid, 1, q[1]),
                     cell_along(grid, 2, q[2])};
        for (int r = 0; r <= SIDE_MAX + 1; r++) {
            if (best.square < (r - 1) * grid->cell * (r - 1) * grid->cell && r > 0) {
                break;
            }
            search_shell(grid, at, r, q, &best);
        }
        grid->nearest[i] = best.index;
    }
}

parian_result parian_nearest_points(const parian_env *env, const float (*point)[3], size_t count,
                                    const float (*query)[3], size_t query_count, uint32_t *nearest)
{
    point_grid grid = {.point = point,
                       .query = query,
                       .count = count,
                       .query_count = query_count,
                       .nearest = nearest};
    if (count == 0) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "no point to be near to");
    }
    lay_out(&grid);
    size_t cells = (size_t)grid.side[0] * (size_t)grid.side[1] * (size_t)grid.side[2];
    if (!PARIAN_NEW0(env, grid.first, cells + 2) || !PARIAN_NEW(env, grid.order, count)) {
        parian_free(env, grid.first);
        parian_free(env, grid.order);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a grid of %zu points", count);
    }
    sort_into_cells(&grid);
    parian_par(env, (query_count + PIECE - 1) / PIECE, search_piece, &grid);
    parian_free(env, grid.first);
    parian_free(env, grid.order);
    return PARIAN_OK;
}
