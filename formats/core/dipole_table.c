/* dipole_table.c - RGB functions of squared distance as tables.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/dipole_table.h"

#include <math.h>

#include "core/clones.h"
#include "core/memory.h"

static int32_t cell_number(float x)
{
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits >> PARIAN_TABLE_SHIFT;
}

static double cell_start(int32_t number)
{
    int32_t bits = (int32_t)((uint32_t)number << PARIAN_TABLE_SHIFT);
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Keep subnormal numbers out of the hot loops. */
static float flush(double x)
{
    return fabs(x) < 1e-36 ? 0.0f : (float)x;
}

static void fill_cell(parian_radial_function function, const void *context, double offset,
                      int32_t number, float *cell)
{
    double x0 = cell_start(number), x1 = cell_start(number + 1);
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        double f0 = function(context, c, fmax(0, x0 - offset));
        double fm = function(context, c, fmax(0, 0.5 * (x0 + x1) - offset));
        double f1 = function(context, c, fmax(0, x1 - offset));
        cell[c] = flush(f0);
        cell[3 + c] = flush(4 * fm - 3 * f0 - f1);
        cell[6 + c] = flush(2 * f0 - 4 * fm + 2 * f1);
    }
}

parian_result parian_radial_table_make(const parian_env *env, parian_radial_function function,
                                       const void *context, double offset_m2, double distance_max,
                                       parian_radial_table *table)
{
    double reach2 = fmin(fmax(distance_max * distance_max * 1.001, 1e-29), 1e30);
    double least = fmax(reach2 * 1e-14, 1e-30);
    /* An offset on the start of a cell, so that no cell straddles r2 = 0. */
    float offset = (float)fmin(fmax(offset_m2, least), 1e30);
    table->first = cell_number(offset);
    table->offset = (float)cell_start(table->first);
    table->last = cell_number((float)(table->offset + reach2)) - table->first + 1;
    if (!PARIAN_NEW0(env, table->cell, (size_t)(table->last + 1) * PARIAN_TABLE_STRIDE)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a table of %d cells", table->last);
    }
    for (int32_t i = 0; i < table->last; i++) {
        fill_cell(function, context, table->offset, table->first + i,
                  table->cell + (size_t)i * PARIAN_TABLE_STRIDE);
    }
    return PARIAN_OK;
}

void parian_radial_table_free(const parian_env *env, parian_radial_table *table)
{
    parian_free(env, table->cell);
    memset(table, 0, sizeof *table);
}

PARIAN_CLONES
void parian_radial_eval_array(const parian_radial_table *table, const float *r2, size_t count,
                              float *restrict red, float *restrict green, float *restrict blue)
{
    const parian_radial_table local = *table;
    const float *restrict cell = local.cell;
    for (size_t i = 0; i < count; i++) {
        float t;
        int32_t q = PARIAN_TABLE_STRIDE * parian_radial_cell(&local, r2[i], &t);
        red[i] = cell[q] + t * (cell[q + 3] + t * cell[q + 6]);
        green[i] = cell[q + 1] + t * (cell[q + 4] + t * cell[q + 7]);
        blue[i] = cell[q + 2] + t * (cell[q + 5] + t * cell[q + 8]);
    }
}
