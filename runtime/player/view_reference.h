/* view_reference.h - a truth to compare with: B at points, or a picture; and the colours of the
 * difference.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_REFERENCE_H
#define PARIAN_VIEW_REFERENCE_H

#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"
#include "view_nearest.h"

typedef struct parian_view_reference {
    /* Points; count is 0 for a picture. */
    size_t count;
    float (*position)[3], (*normal)[3], (*radiosity)[3]; /* [count]; normal may be NULL */
    double mean;                                         /* of B over points and channels */
    /* Nearest receiver of each texel, nearest texel of each receiver: [texel_count], [count]. Made
     * when first needed; NULL before. */
    uint32_t *receiver_at, *texel_at;
    /* A picture, rows from top to bottom; linear radiance, or (encoded) the linear values of
     * display colours. */
    uint32_t width, height;
    float (*pixel)[3];
    bool encoded;
} parian_view_reference;

/* A folder with receiver_position.npy and receiver_radiosity.npy (parian-bake reference) or
 * texel_position.npy and texel_radiosity.npy (--dump), normals beside them; or a .png or .exr
 * picture. Errors: PARIAN_E_IO, PARIAN_E_FORMAT, PARIAN_E_LIMIT, PARIAN_E_NOMEM. */
parian_result parian_view_reference_read(const parian_env *env, const char *path,
                                         parian_view_reference *reference);
void parian_view_reference_free(const parian_env *env, parian_view_reference *reference);
/* Forget what belongs to the texels of one asset. */
void parian_view_reference_forget(const parian_env *env, parian_view_reference *reference);

/* value and color below may be the same array. */

/* Colours of B - B_ref over the mean of B_ref, averaged over channels, at each texel: white for 0,
 * red for `scale` and more, blue for -scale and less; a texel shows its nearest point of the
 * reference. error: relative L2 of B at those points. color: [texels->count]. Errors:
 * PARIAN_E_NOMEM. */
parian_result parian_view_reference_paint(const parian_env *env, parian_view_reference *reference,
                                          const parian_view_points *texels,
                                          const float (*radiosity)[3], double scale,
                                          float (*color)[3], double *error);

/* The same for pictures of the reference's size: value [height * width][4]. Colours are of the
 * difference over the mean of the reference. */
void parian_view_reference_compare(const parian_view_reference *reference, const float (*value)[4],
                                   double scale, float (*color)[4], double *error);

/* White for 0, red for 1 and more, blue for -1 and less; linear. */
void parian_view_reference_color(double share, float color[3]);

#endif
