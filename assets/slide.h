/* slide.h - the picture that a projecting light shows.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_SLIDE_H
#define PARIAN_ASSETS_SLIDE_H

#include "parian/env.h"
#include "parian/result.h"

/* Write 8 x 8 black and white checks, 512 x 512 pixels. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result slide_write(const parian_env *env, const char *path);

#endif
