/* reference_command.h - parian-bake reference.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_COMMAND_H
#define PARIAN_BAKE_REFERENCE_COMMAND_H

#include "bake/cli/reference_options.h"

/* Run the command; argv[1] is "reference". Returns the exit status. */
int parian_reference_command(int argc, char **argv);

/* --model planar: tables of half-space and slab. Errors: those of its parts. */
parian_result parian_planar_command(const parian_env *env, const parian_reference_options *options);

#endif
