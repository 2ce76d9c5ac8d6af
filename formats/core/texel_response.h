/* texel_response.h - R_d between two texels, averaged over the source texel where that matters.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_TEXEL_RESPONSE_H
#define PARIAN_CORE_TEXEL_RESPONSE_H

#include "core/body.h"
#include "core/transport_model.h"

enum { PARIAN_RESPONSE_POINTS = 4 };

typedef struct parian_texel_response {
    const parian_body *body;
    const parian_transport_model *model;
    float z2;                                                            /* z_min^2 */
    double node[12], weight[12];                                         /* for the texel itself */
    float offset[PARIAN_RESPONSE_POINTS], share[PARIAN_RESPONSE_POINTS]; /* across a square */
} parian_texel_response;

void parian_texel_response_init(const parian_body *body, const parian_transport_model *model,
                                parian_texel_response *response);

/* Radiosity at texel o per unit of flux that enters spread over texel i, m^-2: the disc average
 * where i = o; R_d + A/24 Laplacian where the texel is small against the distance or the mean free
 * path; else 4 x 4 Gauss points on a square in the tangent plane. The paper's form samples R_d. */
void parian_texel_response_eval(const parian_texel_response *response, uint32_t i, uint32_t o,
                                float value[3]);

#endif
