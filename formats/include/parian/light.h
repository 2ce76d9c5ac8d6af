/* light.h - light sources, as the runtime relights with and the reference integrates over.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_LIGHT_H
#define PARIAN_LIGHT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum parian_light_type {
    PARIAN_LIGHT_POINT = 0,       /* position, intensity */
    PARIAN_LIGHT_DIRECTIONAL = 1, /* direction, irradiance */
    PARIAN_LIGHT_SPOT = 2,        /* position, direction, intensity, cone, optional image */
    PARIAN_LIGHT_RECT = 3,        /* center, axes, radiance; emits to the side of axis_u x axis_v */
    PARIAN_LIGHT_ENVIRONMENT = 4  /* radiance, optional latitude-longitude image, rotation */
} parian_light_type;

/* A linear RGB picture, rows from top to bottom. */
typedef struct parian_light_image {
    uint32_t width, height;
    const float (*pixel)[3]; /* [height * width], owned by the caller, must outlive its use */
} parian_light_image;

/* One light. What a type does not use is ignored. World space, metres. */
typedef struct parian_light {
    parian_light_type type;
    float position[3];  /* point, spot: metres; rect: centre */
    float direction[3]; /* directional, spot: in which the light travels; any length but 0 */
    float up[3];        /* spot with image: top of the picture; zeros choose one */
    float color[3];     /* point, spot: intensity W/sr; directional: irradiance W/m^2 on a perpendicular
                         * plane; rect, environment: radiance W/(m^2 sr) (a factor on the image, if any) */
    float inner_deg, outer_deg; /* spot: half angles of full light and of none, 0 < inner <= outer < 90 */
    float axis_u[3], axis_v[3]; /* rect: half-edges from the centre, metres */
    float rotation_deg;         /* environment: about +y */
    parian_light_image image;   /* spot: the square around the outer cone; pixel == NULL for none */
} parian_light;

#ifdef __cplusplus
}
#endif
#endif
