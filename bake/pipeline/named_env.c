/* named_env.c - an env whose log lines begin with what they are about.
 *
 * Stages know arrays, not files; the pipeline adds which file or body a line is about.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/pipeline/named_env.h"

#include <stdio.h>

#include "core/memory.h"

static void *named_alloc(void *user, size_t size)
{
    const parian_env *base = ((const parian_named_env *)user)->base;
    return base->alloc(base->user, size);
}

static void named_free(void *user, void *ptr)
{
    const parian_env *base = ((const parian_named_env *)user)->base;
    base->free(base->user, ptr);
}

static void named_log(void *user, parian_log_level level, const char *text)
{
    const parian_named_env *named = user;
    char line[PARIAN_NAMED_LINE_MAX];
    if (level != PARIAN_LOG_ERROR) {
        snprintf(line, sizeof line, "%s: %s", named->name, text);
    } else if (named->several) {
        snprintf(line, sizeof line, "%s: %s: %s", named->file, named->name, text);
    } else {
        snprintf(line, sizeof line, "%s: %s", named->file, text);
    }
    named->base->log(named->base->user, level, line);
}

static void named_par(void *user, size_t count, void (*body)(void *context, size_t index),
                      void *context)
{
    const parian_env *base = ((const parian_named_env *)user)->base;
    base->par(base->user, count, body, context);
}

static void named_progress(void *user, const char *stage, double fraction)
{
    const parian_env *base = ((const parian_named_env *)user)->base;
    base->progress(base->user, stage, fraction);
}

static bool named_cancelled(void *user)
{
    const parian_env *base = ((const parian_named_env *)user)->base;
    return base->cancelled(base->user);
}

void parian_named_env_init(parian_named_env *named, const parian_env *base, const char *file,
                           const char *name, bool several)
{
    *named = (parian_named_env){.base = base, .file = file, .name = name, .several = several};
    named->env = (parian_env){.alloc = base->alloc ? named_alloc : NULL,
                              .free = base->free ? named_free : NULL,
                              .log = base->log ? named_log : NULL,
                              .par = base->par ? named_par : NULL,
                              .progress = base->progress ? named_progress : NULL,
                              .cancelled = base->cancelled ? named_cancelled : NULL,
                              .user = named};
}
