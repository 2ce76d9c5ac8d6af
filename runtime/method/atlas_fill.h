/* atlas_fill.h - spreads values of owned texels over an atlas, gutters included.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ATLAS_FILL_H
#define PARIAN_ATLAS_FILL_H

#include "core/body.h"

/* atlas: [atlas_size^2]; owned and gutter texels get their value and 1, all others 0 and 0. */
void parian_atlas_fill(const parian_body *body, const float (*value)[3], float (*atlas)[4]);

#endif
