/* atlas_fill.h - spreads values of owned texels over an atlas, gutters included.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ATLAS_FILL_H
#define PARIAN_ATLAS_FILL_H

#include "core/body.h"

/* Elements [first, first + count) of an atlas of atlas_size^2, to atlas[0] and on: owned and gutter
 * texels get their value and 1, all others 0 and 0. */
void parian_atlas_fill(const parian_body *body, const float (*value)[3], uint64_t first,
                       uint64_t count, float (*atlas)[4]);

/* Index of the first of an ascending list that is not below a value; count where there is none. */
uint32_t parian_find_first(const uint32_t *list, uint32_t count, uint64_t value);

#endif
