/* error_map.h - pictures of an error: colours of a signed or unsigned value, a legend, PNG and EXR.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_ERROR_MAP_H
#define PARIAN_MEASURE_ERROR_MAP_H

#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

/* One value per pixel [height * width], NaN where there is none; limit: the value of the last colour, 0 takes the
 * 99th percentile of the magnitude. Signed maps go from blue over white to red. */
typedef struct parian_error_map {
    uint32_t width, height;
    const float *value;
    double limit;
    int is_signed;
    const char *title; /* drawn under the picture with the scale */
} parian_error_map;

/* PNG with a colour scale and its numbers under the picture; EXR with the plain values in R, G and B. */
parian_result parian_error_map_write(const parian_env *env, const char *folder, const char *name,
                                     const parian_error_map *map);

#endif
