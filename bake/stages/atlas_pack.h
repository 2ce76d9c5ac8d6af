/* atlas_pack.h - places the shapes of charts in a square. Internal to the atlas stage.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_ATLAS_PACK_H
#define PARIAN_BAKE_ATLAS_PACK_H

#include "bake/stages/chart.h"

/* Where a chart lies: corner of its bounding box in cells of the packing grid. */
typedef struct chart_place {
    uint32_t x, y;
    uint32_t width, height; /* of the box before it is turned, cells */
    double slack[2];        /* free room at the low sides of the box before it is turned, cells */
    uint32_t quarter;       /* counterclockwise quarter turns: 1 takes (u, v) to (height - v, u) */
} chart_place;

typedef struct pack_grid {
    uint32_t side; /* cells */
    uint32_t gap;  /* free cells between charts */
    double scale;  /* cells per metre */
} pack_grid;

/* Ways to place, none of which wins on every set of charts. */
enum { PACK_TACTICS = 4 };

/* Place all charts of positive extent by one of the tactics; fits tells whether there was room.
 * place: [chart_count], written only where fits. Charts never overlap, keep `gap` cells (diagonally
 * too) from each other and one from the side of the grid. Errors: PARIAN_E_NOMEM. Threads: pure
 * function. */
parian_result chart_set_pack(const parian_env *env, const chart_set *set, const pack_grid *grid,
                             unsigned tactic, chart_place *place, bool *fits);

/* Position of a corner of a chart in the packed grid, cells. */
void chart_place_point(const chart_place *place, double scale, const double flat[2], double out[2]);

#endif
