/* view_medium.h - the medium, size and tint that the bodies are shown with.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_MEDIUM_H
#define PARIAN_VIEW_MEDIUM_H

#include "core/medium.h"
#include "parian/runtime.h"
#include "view_options.h"

/* Of all bodies; zero is as baked. */
typedef struct parian_view_medium {
    char name[PARIAN_NAME_MAX]; /* of a preset or file; empty: as baked */
    parian_medium_edit edit;
    parian_medium_report report; /* of the body that came out worst, after it was sent */
} parian_view_medium;

/* Take a preset's coefficients, or those of a material file (*.json); NULL or "": as baked.
 * Errors: PARIAN_E_ARGUMENT (no such preset), as parian_media_read_file. */
parian_result parian_view_medium_choose(const parian_env *env, const char *name,
                                        parian_view_medium *medium);

/* What the command line asks for. */
parian_result parian_view_medium_read(const parian_env *env, const parian_view_options *options,
                                      parian_view_medium *medium);

/* Give it to every body of a renderer; the renderer logs what could not follow. */
parian_result parian_view_medium_send(parian_renderer *renderer, uint32_t body_count,
                                      parian_view_medium *medium);

#endif
