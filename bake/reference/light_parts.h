/* light_parts.h - what the files of the light sampler share.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_LIGHT_PARTS_H
#define PARIAN_BAKE_LIGHT_PARTS_H

#include "bake/reference/light_sampler.h"

/* Sums by which pixels of an environment are drawn in proportion to their power. A pixel has one
 * radiance all over the solid angle that it covers. */
typedef struct parian_sky_table {
    const parian_light_image *image;
    double rotation; /* radians about +y */
    double color[3];
    double *row_cosine; /* [height + 1] of the polar angles at the borders of the rows */
    double *row_sum;    /* [height] power of this row and those above */
    double *pixel_sum;  /* [height][width] power of this pixel and those left of it */
} parian_sky_table;

parian_result parian_sky_table_make(const parian_env *env, const parian_light *light,
                                    parian_sky_table *table);
void parian_sky_table_free(const parian_env *env, parian_sky_table *table);
/* Draw a direction with two uniform numbers; irradiance is radiance over density. False for a black
 * picture. */
bool parian_sky_sample(const parian_sky_table *table, double u, double v, double direction[3],
                       double irradiance[3]);
void parian_sky_radiance(const parian_sky_table *table, const double direction[3],
                         double radiance[3]);

/* What is wrong with a light, or NULL. */
const char *parian_light_fault(const parian_light *light);

#endif
