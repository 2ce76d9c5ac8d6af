/* headless_egl.h - an OpenGL context without a window, through EGL.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_HEADLESS_EGL_H
#define PARIAN_HEADLESS_EGL_H

#include "parian/env.h"
#include "parian/result.h"
#include "view_options.h"

typedef struct parian_headless parian_headless;

/* Make a context current on this thread: on the first EGL device that has one, else on Mesa's
 * surfaceless platform, else on the default display; OpenGL 3.3 core before OpenGL ES 3.0 unless
 * api says otherwise. Errors: PARIAN_E_DEVICE (what was tried), PARIAN_E_NOMEM. */
parian_result parian_headless_create(const parian_env *env, parian_view_gl api,
                                     parian_headless **headless);
void parian_headless_destroy(const parian_env *env, parian_headless *headless);

/* "core" or "es". */
const char *parian_headless_api(const parian_headless *headless);
/* For parian_renderer_desc. */
void *parian_headless_proc_address(const char *name);

#endif
