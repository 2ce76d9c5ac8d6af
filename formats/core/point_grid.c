/* point_grid.c - a hash table of cells as linked lists.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/point_grid.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/random.h"

enum { ROOM_MIN = 64, ROOM_MAX = 1u << 30 };

static uint64_t hash_of_cell(const int64_t cell[3])
{
    uint64_t key = (uint64_t)cell[0] * 0xD1342543DE82EF95u;
    key ^= (uint64_t)cell[1] * 0xAF251AF3B0F025B5u;
    key ^= (uint64_t)cell[2] * 0x9FB21C651E98DF25u;
    return parian_random_mix(key);
}

static void cell_of(const parian_point_grid *grid, const double position[3], int64_t cell[3])
{
    for (int k = 0; k < 3; k++) {
        cell[k] = (int64_t)floor(position[k] / grid->cell);
    }
}

static uint32_t bucket_of(const parian_point_grid *grid, const int64_t cell[3])
{
    return (uint32_t)hash_of_cell(cell) & grid->bucket_mask;
}

static void link_point(parian_point_grid *grid, uint32_t i)
{
    int64_t cell[3];
    cell_of(grid, grid->point[i].position, cell);
    uint32_t bucket = bucket_of(grid, cell);
    grid->next[i] = grid->bucket[bucket];
    grid->bucket[bucket] = i;
}

/* A table of twice as many buckets as there is room for points. */
static parian_result make_room(const parian_env *env, parian_point_grid *grid, uint32_t room)
{
    parian_point_grid made = {.cell = grid->cell, .count = grid->count, .room = room};
    made.bucket_mask = ROOM_MIN - 1;
    while (made.bucket_mask / 2 < room) {
        made.bucket_mask = 2 * made.bucket_mask + 1;
    }
    if (!PARIAN_NEW(env, made.point, room) || !PARIAN_NEW(env, made.next, room) ||
        !PARIAN_NEW(env, made.bucket, (size_t)made.bucket_mask + 1)) {
        parian_point_grid_free(env, &made);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u points", room);
    }
    memset(made.bucket, 0xFF, ((size_t)made.bucket_mask + 1) * sizeof *made.bucket);
    if (grid->count > 0) {
        memcpy(made.point, grid->point, grid->count * sizeof *made.point);
    }
    for (uint32_t i = 0; i < made.count; i++) {
        link_point(&made, i);
    }
    parian_point_grid_free(env, grid);
    *grid = made;
    return PARIAN_OK;
}

parian_result parian_point_grid_create(const parian_env *env, double cell, uint32_t room,
                                       parian_point_grid *grid)
{
    *grid = (parian_point_grid){.cell = cell};
    return make_room(env, grid, room < ROOM_MIN ? ROOM_MIN : room > ROOM_MAX ? ROOM_MAX : room);
}

void parian_point_grid_free(const parian_env *env, parian_point_grid *grid)
{
    parian_free(env, grid->point);
    parian_free(env, grid->next);
    parian_free(env, grid->bucket);
    *grid = (parian_point_grid){0};
}

void parian_point_grid_clear(parian_point_grid *grid, double cell)
{
    grid->cell = cell;
    grid->count = 0;
    memset(grid->bucket, 0xFF, ((size_t)grid->bucket_mask + 1) * sizeof *grid->bucket);
}

parian_result parian_point_grid_put(const parian_env *env, parian_point_grid *grid,
                                    const parian_point *point)
{
    if (grid->count == grid->room) {
        if (grid->room >= ROOM_MAX) {
            return parian_fail(env, PARIAN_E_LIMIT, "more than %u points", ROOM_MAX);
        }
        parian_result r = make_room(env, grid, 2 * grid->room);
        if (r != PARIAN_OK) {
            return r;
        }
    }
    grid->point[grid->count] = *point;
    link_point(grid, grid->count);
    grid->count++;
    return PARIAN_OK;
}

/* ---- queries ---- */

/* The cells that a ball reaches. */
typedef struct cell_range {
    int64_t low[3], high[3], at[3];
} cell_range;

static cell_range range_of(const parian_point_grid *grid, const parian_point *at, double reach)
{
    cell_range range;
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = at->position[k] - reach;
        high[k] = at->position[k] + reach;
    }
    cell_of(grid, low, range.low);
    cell_of(grid, high, range.high);
    memcpy(range.at, range.low, sizeof range.at);
    return range;
}

static bool next_cell(cell_range *range)
{
    for (int k = 0; k < 3; k++) {
        if (++range->at[k] <= range->high[k]) {
            return true;
        }
        range->at[k] = range->low[k];
    }
    return false;
}

void parian_point_grid_visit(const parian_point_grid *grid, const parian_point *at, double reach,
                             parian_point_visit visit, void *context)
{
    double limit = reach * reach;
    cell_range range = range_of(grid, at, reach);
    do {
        for (uint32_t i = grid->bucket[bucket_of(grid, range.at)]; i != PARIAN_NO_POINT;
             i = grid->next[i]) {
            const parian_point *point = &grid->point[i];
            double squared = parian_points_squared(at, point);
            int64_t cell[3];
            if (squared < limit && parian_points_face_alike(at, point)) {
                /* Cells that share a bucket: each point counts in its own cell alone. */
                cell_of(grid, point->position, cell);
                if (memcmp(cell, range.at, sizeof cell) == 0) {
                    visit(context, i, squared);
                }
            }
        }
    } while (next_cell(&range));
}

uint32_t parian_point_grid_nearest(const parian_point_grid *grid, const parian_point *at,
                                   double reach, uint32_t skip, double *squared)
{
    uint32_t nearest = PARIAN_NO_POINT;
    double limit = reach * reach;
    cell_range range = range_of(grid, at, reach);
    do {
        for (uint32_t i = grid->bucket[bucket_of(grid, range.at)]; i != PARIAN_NO_POINT;
             i = grid->next[i]) {
            double d = parian_points_squared(at, &grid->point[i]);
            bool first = d < limit || (d == limit && nearest != PARIAN_NO_POINT && i < nearest);
            if (first && i != skip && parian_points_face_alike(at, &grid->point[i])) {
                limit = d;
                nearest = i;
            }
        }
    } while (next_cell(&range));
    *squared = limit;
    return nearest;
}

bool parian_point_grid_has(const parian_point_grid *grid, const parian_point *at, double reach)
{
    double limit = reach * reach;
    cell_range range = range_of(grid, at, reach);
    do {
        for (uint32_t i = grid->bucket[bucket_of(grid, range.at)]; i != PARIAN_NO_POINT;
             i = grid->next[i]) {
            if (parian_points_squared(at, &grid->point[i]) < limit &&
                parian_points_face_alike(at, &grid->point[i])) {
                return true;
            }
        }
    } while (next_cell(&range));
    return false;
}
