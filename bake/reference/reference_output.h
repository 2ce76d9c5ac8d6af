/* reference_output.h - writes what a reference has computed: arrays of the receivers and a summary.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFERENCE_OUTPUT_H
#define PARIAN_BAKE_REFERENCE_OUTPUT_H

#include "bake/reference/planar.h"
#include "bake/reference/reference.h"

/* What the summary says beside the result. */
typedef struct parian_reference_about {
    parian_reference_model model;
    bool spread;              /* receivers stand for the whole surface: B over it can be summed */
    bool fit_fdr;             /* BSSRDF models */
    const double (*scale)[3]; /* [body_count] factors of the normalisation, or NULL */
    uint64_t seed;
} parian_reference_about;

/* Write receiver_*.npy and summary.json into a folder, which is created. Each file appears whole;
 * on failure those of this call are removed again. Errors: PARIAN_E_IO, PARIAN_E_NOMEM. */
parian_result parian_reference_write(const parian_env *env, const char *folder,
                                     const parian_reference_scene *scene,
                                     const parian_receivers *receivers,
                                     const parian_reference_result *result,
                                     const parian_reference_about *about);

/* Tables of planes: one per shape and incidence, three channels each. */
typedef struct parian_planar_table {
    const char *name;           /* "half_space_diffuse": of the files */
    parian_planar_desc desc[3]; /* per channel, as it was run */
    parian_planar_profile profile[3];
} parian_planar_table;

typedef struct parian_planar_about {
    const parian_medium *medium;
    double thickness; /* of the slab, m; 0: none */
    uint64_t photons, seed;
    double seconds;
} parian_planar_about;

/* Write NAME.csv, NAME.npy of every table and summary.json, as above. */
parian_result parian_planar_write(const parian_env *env, const char *folder,
                                  const parian_planar_table *tables, size_t count,
                                  const parian_planar_about *about);

/* "dipole", "dipole-flux", "directional", "pbd", "path". */
const char *parian_reference_model_name(parian_reference_model model);

#endif
