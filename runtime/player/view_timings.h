/* view_timings.h - gathers times of passes over frames, for --timings.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_TIMINGS_H
#define PARIAN_VIEW_TIMINGS_H

#include "view_app.h"

typedef struct parian_view_timings parian_view_timings;

/* Room for this many frames. NULL when there is no memory. */
parian_view_timings *parian_view_timings_create(const parian_env *env, size_t frames);
void parian_view_timings_destroy(const parian_env *env, parian_view_timings *timings);

/* Take the pass times of the renderer's last relight and draw, and the whole of each in
 * milliseconds. */
void parian_view_timings_add(parian_view_timings *timings, const parian_renderer *renderer,
                             double relight_ms, double draw_ms);

/* {"renderer":..., "passes":[{"name","median_ms","minimum_ms","maximum_ms","runs"}], "relight_ms",
 * ...}. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_view_timings_write(const parian_view_timings *timings,
                                        const parian_view_app *app, const char *api,
                                        const char *path);
/* Medians of the whole, milliseconds; 0 before the first frame. */
double parian_view_timings_relight_ms(const parian_view_timings *timings);
double parian_view_timings_draw_ms(const parian_view_timings *timings);

#endif
