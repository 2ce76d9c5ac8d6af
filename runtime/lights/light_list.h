/* light_list.h - the lights of a renderer as samples: what both the shaders and the C evaluation
 * read.
 *
 * A light becomes one sample (point, directional, spot) or several (a rectangle is a grid of small
 * emitters; an environment is cut into cells: small bright ones are directional lights, of the
 * others nine spherical-harmonic coefficients give the unshadowed irradiance, and directional
 * probes tell how much of it is blocked). sample_set.h makes other samples of the same lights.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_LIGHT_LIST_H
#define PARIAN_LIGHT_LIST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/light.h"
#include "parian/result.h"

typedef enum parian_sample_kind {
    PARIAN_SAMPLE_POINT = 0,
    PARIAN_SAMPLE_DIRECTIONAL = 1,
    PARIAN_SAMPLE_SPOT = 2,
    PARIAN_SAMPLE_PATCH = 3, /* small piece of a rectangle: a point with a cosine */
    PARIAN_SAMPLE_PROBE = 4 /* direction from which an environment shines; tells visibility alone */
} parian_sample_kind;

enum {
    PARIAN_RECT_GRID = 4,  /* a rectangle is cut into 4 x 4 patches */
    PARIAN_SKY_CELLS = 64, /* of one environment, where nothing else is asked for */
    PARIAN_SH_COUNT = 9,
    PARIAN_LIGHT_MAX = 256,          /* lights, and samples, of one renderer */
    PARIAN_IMAGE_PIXEL_MAX = 1 << 24 /* of all projected pictures with their mip levels */
};

typedef struct parian_light_sample {
    parian_sample_kind kind;
    float position[3];
    float direction[3];    /* unit, in which the light travels */
    float right[3], up[3]; /* unit, of the projected picture */
    float color[3];        /* W/sr, or W/m^2 for directions */
    float cos_inner, cos_outer, tan_outer;
    uint32_t image_offset, image_width, image_height, image_levels; /* levels 0: none */
    uint32_t layer_first, layer_count; /* shadow maps, tried in this order */
} parian_light_sample;

/* One shadow map. For a point p, with p1 = (p, 1): x = row[0].p1, y = row[1].p1, depth = row[2].p1
 * (0 at the near plane, 1 at the far plane, linear in space), w = row[3].p1; it falls on (x/w, y/w)
 * of [-1, 1]^2. */
typedef struct parian_shadow_layer {
    float row[4][4];
    float texel_scale; /* side of a shadow texel in metres is texel_scale * w */
    float near_m, far_m;
    bool perspective;
} parian_shadow_layer;

/* A rectangle, for other points of it. */
typedef struct parian_rect_source {
    float position[3], axis_u[3], axis_v[3];
    float power[3]; /* radiance times area, W/sr */
    uint32_t first_sample;
} parian_rect_source;

typedef struct parian_sky parian_sky; /* sky_cells.h */

typedef struct parian_light_list {
    parian_light_sample *sample;
    uint32_t sample_count;
    float (*image)[4]; /* [image_total] pictures with all their mip levels, one after the other */
    uint32_t image_total;
    parian_rect_source *rect;
    parian_sky *sky;
    uint32_t rect_count, sky_count;
    float environment_sh[PARIAN_SH_COUNT][3]; /* radiance */
    parian_shadow_layer *layer;
    uint32_t layer_count, shadow_size;
} parian_light_list;

/* Check the lights and turn them into samples; pictures are copied. sky_cells: of one environment,
 * 0 takes PARIAN_SKY_CELLS. Shadow layers are not made here. Errors: PARIAN_E_ARGUMENT (light index
 * and what is wrong), PARIAN_E_NOMEM, PARIAN_E_LIMIT. */
parian_result parian_light_list_build(const parian_env *env, const parian_light *lights,
                                      size_t count, uint32_t sky_cells, parian_light_list *list);
void parian_light_list_free(const parian_env *env, parian_light_list *list);

/* Whether two lists shine alike; their shadow layers do not matter. */
bool parian_light_list_equal(const parian_light_list *a, const parian_light_list *b);

/* A ball in world space. */
typedef struct parian_ball {
    float center[3], radius;
} parian_ball;

/* Fit the shadow maps of shading: one that covers the bodies as tightly as possible, and one for
 * everything where there are surroundings; six for a light that sits inside. Probes get maps only
 * with surroundings, which alone ask for them. corners: the box of everything that casts. */
parian_result parian_shadow_fit(const parian_env *env, parian_light_list *list,
                                uint32_t shadow_size, uint64_t memory_max,
                                const parian_ball *bodies, const parian_ball *everything,
                                bool has_surroundings, const float lower[3], const float upper[3]);

/* Tables as the shaders read them: PARIAN_LIGHT_ROW float[4] for each sample, PARIAN_LAYER_ROW for
 * each layer. */
enum { PARIAN_LIGHT_ROW = 8, PARIAN_LAYER_ROW = 8 };
void parian_light_list_tables(const parian_light_list *list, float (*samples)[4],
                              float (*layers)[4]);
/* The samples' table alone, of any samples of the list. */
void parian_light_sample_table(const parian_light_sample *sample, uint32_t count, float (*row)[4]);

/* Mip levels of a picture: dimensions of a level, and pixels of all levels together. */
uint32_t parian_image_level_side(uint32_t side, uint32_t level);
uint32_t parian_image_level_count(uint32_t width, uint32_t height);

#endif
