/* view.h - a camera as the shading passes need it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_H
#define PARIAN_VIEW_H

#include "parian/runtime.h"

typedef struct parian_view {
    float clip[16]; /* projection times view, column-major */
    float eye[4];   /* position and 1, or, without perspective, the direction to the viewer and 0 */
} parian_view;

parian_view parian_view_make(const parian_camera *camera);

/* True for views of colours that exposure and tone curve leave alone. */
static inline bool parian_view_is_plain(parian_view_mode mode)
{
    return mode == PARIAN_VIEW_NORMALS || mode == PARIAN_VIEW_CHARTS || mode == PARIAN_VIEW_VALUES;
}

/* Samples of a picture with more than one for each pixel: 1 GiB of floats. */
#define PARIAN_VIEW_SAMPLES_MAX ((uint64_t)1 << 26)

/* Samples for a side of a picture pixel, so that neither side exceeds side_max: 2, or 1 for pictures of
 * more than 16 million pixels. */
uint32_t parian_view_supersampling(uint32_t width, uint32_t height, uint32_t side_max);

#endif
