/* nearest_point.h - the nearest of a set of points, by a grid.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_NEAREST_POINT_H
#define PARIAN_MEASURE_NEAREST_POINT_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* nearest[i] is the index of the point [count] nearest to query[i] [query_count]; the first of
 * equals. count must not be 0. Errors: PARIAN_E_ARGUMENT, PARIAN_E_NOMEM. Threads: env->par. */
parian_result parian_nearest_points(const parian_env *env, const float (*point)[3], size_t count,
                                    const float (*query)[3], size_t query_count, uint32_t *nearest);

#endif
