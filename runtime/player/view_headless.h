/* view_headless.h - renders frames without a window and writes what was asked for.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_HEADLESS_H
#define PARIAN_VIEW_HEADLESS_H

#include "view_app.h"

/* With an open app. Errors: those of the renderer, PARIAN_E_DEVICE, PARIAN_E_IO,
 * PARIAN_E_INTERRUPTED. */
parian_result parian_view_run_headless(parian_view_app *app);

#endif
