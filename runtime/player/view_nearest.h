/* view_nearest.h - for each point of one set, the nearest of another.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_NEAREST_H
#define PARIAN_VIEW_NEAREST_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_view_points {
    size_t count;               /* below 2^32 */
    const float (*position)[3]; /* finite */
    const float (*normal)[3];   /* or NULL */
} parian_view_points;

/* found: [from->count] index into `to`, which holds at least one point. Where both have normals, a
 * point that faces the same way is preferred to one that faces away, up to four times as far: thin
 * walls have two sides. Of points at one distance the first. Errors: PARIAN_E_NOMEM. Threads: uses
 * env->par. */
parian_result parian_view_nearest(const parian_env *env, const parian_view_points *from,
                                  const parian_view_points *to, uint32_t *found);

#endif
