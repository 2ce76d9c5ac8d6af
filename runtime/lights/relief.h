/* relief.h - what the transfer surface has lost of the source's relief, and where rays may start
 * because of it.
 *
 * Light falls on the source's normals. Where these face a light and the transfer surface's own do
 * not, a ray from the latter would meet it at once: it starts farther on.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_RELIEF_H
#define PARIAN_RELIEF_H

#include "core/body.h"

/* Distance of the texel's two unit normals; 0 where the body holds one. */
float parian_relief_of_texel(const parian_body *body, uint32_t texel);
/* One and a half root mean square edges of the transfer surface's triangles, metres: how far its
 * facets hide what they should not. */
float parian_relief_reach(const parian_body *body);

/* Metres that a ray to a light starts away from the surface: none while the light stands three
 * times the relief above the horizon, the whole reach when it stands less than twice. cosine: of
 * the source's normal with the light. */
static inline float parian_relief_start(float relief, float cosine, float reach)
{
    float share = relief > 1e-4f ? 3.0f - cosine / relief : 0.0f;
    return reach * (share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share);
}

#endif
