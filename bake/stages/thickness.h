/* thickness.h - how many mean free paths thick a body is, and whether a BSSRDF can hold for it.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_THICKNESS_H
#define PARIAN_BAKE_THICKNESS_H

#include "core/body.h"

typedef struct parian_thickness_report {
    double thin_m;     /* 5 % of the area is thinner, straight inwards */
    double median_m;   /* half of it is; both INFINITY where rays leave through an open rim */
    double flight_m;   /* mean free path 1 / sigma_t' of the clearest channel */
    double thin_share; /* of the area that is thinner than PARIAN_THIN_FLIGHTS of these */
} parian_thickness_report;

enum { PARIAN_THIN_FLIGHTS = 4 };

/* Measure the transfer surface by rays from its triangles' middles against their normals to the
 * other side. Needs surface and medium. Errors: PARIAN_E_NOMEM. Threads: env->par. */
parian_result parian_stage_thickness(const parian_env *env, const parian_body *body,
                                     parian_thickness_report *report);

#endif
