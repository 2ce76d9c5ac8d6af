/* medium_field.h - coefficients on a grid, from an array of factors or of values.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_MEDIUM_FIELD_H
#define PARIAN_BAKE_MEDIUM_FIELD_H

#include "bake/reference/reference.h"
#include "tool/files.h"

/* Whether an array can be a field: [z][y][x] factors or [z][y][x][6] sigma_s and sigma_a in mm^-1,
 * two nodes or more along each axis, finite and not negative. Errors: PARIAN_E_FORMAT, naming the
 * file. */
parian_result parian_medium_field_check(const parian_env *env, const char *path,
                                        const parian_npy *array);

/* Give every body a field of the (checked) array over its own box; factors multiply both
 * coefficients of the body's medium. Errors: PARIAN_E_NOMEM; PARIAN_E_FORMAT, naming the file:
 * coefficients from 1e15 m^-1. */
parian_result parian_medium_field_attach(const parian_env *env, const char *path,
                                         const parian_npy *array, parian_reference_scene *scene);

#endif
