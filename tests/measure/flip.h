/* flip.h - FLIP: how different two pictures look when they are shown in turn, per pixel, from 0
 * to 1.
 *
 * Source  [Andersson20] (LDR), [Andersson21] (HDR). Differs: values that are not finite count as
 * black; the median luminance behind the last exposure is that of the pixels with light where more
 * than half have none.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_FLIP_H
#define PARIAN_MEASURE_FLIP_H

#include <stdbool.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* A monitor of 0.7 m and 3840 pixels seen from 0.7 m. */
#define PARIAN_FLIP_PIXELS_PER_DEGREE 67.02064327658225

typedef struct parian_flip_desc {
    double pixels_per_degree; /* 0 takes PARIAN_FLIP_PIXELS_PER_DEGREE; else 1 to 400 */
    bool filmic; /* values times 2^exposure go through the filmic curve before they are shown */
    double exposure;
} parian_flip_desc;

/* LDR-FLIP. image, reference: linear RGBA [height * width][4], clamped to [0, 1], alpha ignored;
 * desc: NULL for the defaults; map: [height * width], written only on success. Errors:
 * PARIAN_E_ARGUMENT, PARIAN_E_NOMEM. Threads: env->par, the same bytes for any number. */
parian_result parian_flip_ldr(const parian_env *env, uint32_t width, uint32_t height,
                              const float (*image)[4], const float (*reference)[4],
                              const parian_flip_desc *desc, float *map);

typedef struct parian_flip_exposures {
    double start,
        stop; /* log2 of the factors: the brightest pixel, the median, reach 0.85 of the display */
    unsigned count; /* evenly spread, about one stop apart */
} parian_flip_exposures;

/* The exposures that HDR-FLIP compares at. Errors: PARIAN_E_NOMEM. */
parian_result parian_flip_find_exposures(const parian_env *env, uint32_t width, uint32_t height,
                                         const float (*reference)[4],
                                         parian_flip_exposures *exposures);

/* HDR-FLIP: the largest LDR-FLIP of each pixel over those exposures. Arguments and errors as for
 * parian_flip_ldr. */
parian_result parian_flip_hdr(const parian_env *env, uint32_t width, uint32_t height,
                              const float (*image)[4], const float (*reference)[4],
                              double pixels_per_degree, float *map);

#endif
