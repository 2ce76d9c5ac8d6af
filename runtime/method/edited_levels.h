/* edited_levels.h - factors of another medium for a body with coarse levels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_EDITED_LEVELS_H
#define PARIAN_EDITED_LEVELS_H

#include "method/edited_body.h"

/* Fill the operators of made->body, whose medium is the new one, with their own factors and scales
 * at the stored pairs, the coarsest level first; and beyond_mean, beyond_max: the share of a vertex's
 * row that falls on pairs which neither file nor coarse levels hold. The interpolations are copied.
 * Errors: PARIAN_E_NOMEM, PARIAN_E_UNSUPPORTED (operators that are no hierarchy). Threads: uses
 * env->par; the same values for any number of threads. */
parian_result parian_edited_levels_make(const parian_env *env, const parian_body *baked,
                                        parian_edited_body *made);

#endif
