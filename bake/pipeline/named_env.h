/* named_env.h - an env whose log lines begin with what they are about.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_NAMED_ENV_H
#define PARIAN_BAKE_NAMED_ENV_H

#include "parian/env.h"

enum { PARIAN_NAMED_LINE_MAX = 2048 };

typedef struct parian_named_env {
    parian_env env; /* to be passed on; valid as long as this struct */
    const parian_env *base;
    const char *file; /* begins errors, with the name behind it where several is true */
    const char *name; /* begins the other lines */
    bool several;
} parian_named_env;

/* Forward everything to base; lines of the log as "file: line" or "name: line". base is not NULL
 * and, as file and name, outlives the result. */
void parian_named_env_init(parian_named_env *named, const parian_env *base, const char *file,
                           const char *name, bool several);

#endif
