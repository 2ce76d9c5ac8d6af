/* dipole_table.h - RGB functions of squared distance as tables, for loops over many pairs of
 * points.
 *
 * A table is piecewise quadratic on cells of constant relative width of r2 + offset (64 cells for
 * each doubling), found from the bits of the float: no logarithm, no search. Relative error below
 * 1e-5 while R_d has not fallen below about 1e-6 of its peak; zero beyond the largest distance.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_DIPOLE_TABLE_H
#define PARIAN_CORE_DIPOLE_TABLE_H

#include <stdint.h>
#include <string.h>

#include "core/medium.h"
#include "parian/env.h"
#include "parian/result.h"

enum {
    PARIAN_TABLE_CELL_BITS = 6,
    PARIAN_TABLE_SHIFT = 23 - PARIAN_TABLE_CELL_BITS,
    PARIAN_TABLE_STRIDE = 9 /* coefficient k of channel c is [3 k + c] */
};

typedef struct parian_radial_table {
    float offset;        /* m^2, added to r2 */
    int32_t first, last; /* cell number of the offset; index of the last cell, which is zero */
    float *cell;         /* [last + 1][PARIAN_TABLE_STRIDE] */
} parian_radial_table;

/* A function of squared distance (m^2) of one channel. */
typedef double (*parian_radial_function)(const void *context, int channel, double r2);

/* Tabulate function for r2 from 0 to distance_max^2. offset_m2 is the square of the length on which
 * the function varies near 0. Errors: PARIAN_E_NOMEM. */
parian_result parian_radial_table_make(const parian_env *env, parian_radial_function function,
                                       const void *context, double offset_m2, double distance_max,
                                       parian_radial_table *table);
void parian_radial_table_free(const parian_env *env, parian_radial_table *table);

/* Cell and position in it, in [0, 1), of a squared distance. */
static inline int32_t parian_radial_cell(const parian_radial_table *table, float r2, float *t)
{
    float x = r2 + table->offset;
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    int32_t cell = (bits >> PARIAN_TABLE_SHIFT) - table->first;
    int32_t rest = (int32_t)(0x3f800000u | (((uint32_t)bits << PARIAN_TABLE_CELL_BITS) & 0x7fffffu));
    float fraction;
    memcpy(&fraction, &rest, sizeof fraction);
    *t = fraction - 1.0f;
    return cell < table->last ? cell : table->last;
}

static inline void parian_radial_eval(const parian_radial_table *table, float r2, float value[3])
{
    float t;
    const float *q = table->cell + (size_t)PARIAN_TABLE_STRIDE * parian_radial_cell(table, r2, &t);
    for (int c = 0; c < 3; c++) {
        value[c] = q[c] + t * (q[3 + c] + t * q[6 + c]);
    }
}

/* Values at count squared distances, channels apart; the same bits as parian_radial_eval. */
void parian_radial_eval_array(const parian_radial_table *table, const float *r2, size_t count,
                              float *red, float *green, float *blue);

#endif
