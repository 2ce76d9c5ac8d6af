/* global_rounding.h - rounds the factors of a row to what their sums need, so that files get small.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLOBAL_ROUNDING_H
#define PARIAN_BAKE_GLOBAL_ROUNDING_H

#include "bake/stages/global_rows.h"

/* Round the kept factors (work->keep) of the row in work to multiples of a step, a power of two for
 * each channel: the largest for which independent errors come to a share of the threshold, itself a
 * share of the row's sum (an eighth; between coarse points a 256th). What one factor loses goes to
 * the next by area, so that a row keeps its sum, and each stretch of it too. Negative factors are
 * rounded towards zero: with what coarser points carry nothing comes out below zero. Zeros stay.
 * Numbers so rounded have zeros in most of their bits, which is what the file's codec saves.
 *
 * area_mean_m2: of the points. Nothing is done without a threshold by share. */
void parian_row_round(const parian_row_maker *maker, double area_mean_m2, parian_row_work *work);

#endif
