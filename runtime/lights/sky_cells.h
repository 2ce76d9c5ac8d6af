/* sky_cells.h - an environment cut into cells, each a directional light.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_SKY_CELLS_H
#define PARIAN_SKY_CELLS_H

#include "lights/light_list.h"

enum { PARIAN_SKY_WIDTH_MAX = 1024, PARIAN_SKY_SUN_MAX = 8 };

/* Pixels [x0, x1) x [y0, y1). */
typedef struct parian_sky_cell {
    uint32_t x0, x1, y0, y1;
} parian_sky_cell;

struct parian_sky {
    uint32_t width, height; /* pixels; those of a larger picture are joined in squares of `join` */
    uint32_t source_width, source_height, join;
    double rotation;      /* about +y */
    float (*radiance)[3]; /* [height * width] */
    double *row_cosine;   /* [height + 1] of the angle to +y at the edges of rows */
    double *power; /* [(height + 1) * (width + 1)] sums of r + g + b times solid angle over all
                    * pixels above and to the left of a corner */
    parian_sky_cell *cell; /* [cell_count] */
    uint32_t cell_count, first_sample;
};

/* Cut an environment (constant without an image) into at most cell_max cells: again and again the
 * one with the largest (power)^2 x (diameter), across its longer side where its power halves. Cells
 * without light are left out. Errors: PARIAN_E_NOMEM. The same light gives the same cells. Source
 * [Debevec05]; differs: cells are chosen by what their shadows' edges can be wrong by */
parian_result parian_sky_build(const parian_env *env, const parian_light *light, uint32_t cell_max,
                               parian_sky *sky);
bool parian_sky_equal(const parian_sky *a, const parian_sky *b);
void parian_sky_free(const parian_env *env, parian_sky *sky);

/* One sample for each cell, from its mean direction; and the coefficients of the smooth rest are
 * added to sh. Up to PARIAN_SKY_SUN_MAX small and bright cells become directional lights of their
 * own, the others probes. */
void parian_sky_samples(const parian_sky *sky, parian_light_sample *sample,
                        float sh[PARIAN_SH_COUNT][3]);

/* A direction of a cell, drawn with `at` in [0, 1)^2 in proportion to r + g + b, as a directional
 * light that stands for the whole cell. */
void parian_sky_draw(const parian_sky *sky, uint32_t cell, const double at[2],
                     parian_light_sample *sample);

#endif
