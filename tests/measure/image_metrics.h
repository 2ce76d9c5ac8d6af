/* image_metrics.h - errors of pictures: RMSE, relMSE, PSNR after a stated tone curve, FLIP and
 * HDR-FLIP.
 *
 * Source  FLIP [Andersson20], HDR-FLIP [Andersson21]
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_MEASURE_IMAGE_METRICS_H
#define PARIAN_MEASURE_IMAGE_METRICS_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

typedef struct parian_image_metrics {
    double rmse;    /* of linear values */
    double rel_mse; /* mean (I - R)^2 / (R^2 + 1e-2 mean(R)^2) */
    double psnr;    /* dB, after clamping to [0, 1] and sRGB coding; infinity for equal pictures */
    double flip_mean, flip_p95;         /* LDR, 67 pixels per degree */
    double hdr_flip_mean, hdr_flip_p95; /* over exposures found from the reference */
    size_t not_finite; /* pixels of the image with a NaN or an infinity: left out of the first
                          three, 1 in FLIP */
} parian_image_metrics;

/* image, reference: linear RGBA [height * width][4], rows from the top; alpha is ignored. flip_map:
 * NULL or [height * width], the LDR FLIP error of each pixel. All metrics are NaN where no pixel of
 * the image is finite. Errors: PARIAN_E_ARGUMENT (no pixels, a reference that is not finite),
 * PARIAN_E_NOMEM. Threads: env->par. */
parian_result parian_image_measure(const parian_env *env, uint32_t width, uint32_t height,
                                   const float (*image)[4], const float (*reference)[4],
                                   parian_image_metrics *metrics, float *flip_map);

#endif
