/* body.h - everything an asset holds of one translucent body, as plain arrays: what the bake makes, the
 * file carries, and the runtime relights. Also the diffuse surroundings and the scene around them.
 *
 * Notation: x texel centroid, A area, beta barycentrics, E transmitted irradiance (W m^-2), Phi flux
 * that enters at a vertex (W), B scattered radiosity (W m^-2), F throughput factors (m^-2), all RGB.
 *
 *   Phi_v   = sum over texels i of  beta_v(x_i) A_i E_i                 (restriction, hats)
 *   B_v     = sum over vertices u of F_vu Phi_u  + sum over texels i of w_v(i) E_i
 *   B(x_o)  = sum over v of beta_v(x_o) B_v  + sum over i in W(o) of  K'_o(i) E_i
 *
 * F has a zero diagonal where a local part exists (the blending weights w take its place) and a
 * diagonal that completes its row's sum where none does. K' is the residual kernel (R_d minus what
 * the global part already carries). W(o) is the square window of kernel_width texels for an
 * interior texel, and an explicit list for a border texel (one whose window leaves its chart, or
 * that is nearer to an opposite side than a window reaches), across charts. The dual-basis form of
 * the paper differs in the restriction alone: 4 beta - 1 takes the place of beta (paper_form).
 *
 * Every array is owned by the body.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_BODY_H
#define PARIAN_CORE_BODY_H

#include <stdbool.h>
#include <stdint.h>

#include "core/half.h"
#include "core/medium.h"
#include "core/mesh.h"
#include "parian/env.h"
#include "parian/result.h"

/* One sparse operator. Rows are runs of consecutive columns, so that both a CPU and a GPU read factors
 * and inputs as two contiguous streams.
 *
 *   y[row][c] += scale[row][c] * sum over runs r in [run_offset[row], run_offset[row+1]),
 *                                 k in [0, run_count[r]) of
 *                factor[run_factor[r] + k][c] * x[run_column[r] + k][c]
 *
 * run_factor[r] is the running sum of run_count (rebuilt at load, not stored). Runs of a row are in
 * ascending order of columns and do not overlap; a run has 1 to PARIAN_RUN_MAX columns. */
enum { PARIAN_RUN_MAX = 256 };
typedef struct parian_operator {
    uint32_t source_register; /* 0: vertex flux Phi */
    uint32_t target_register; /* 1: vertex radiosity B */
    uint32_t row_count;
    uint32_t column_count;
    uint32_t run_total;
    uint64_t factor_total;
    uint32_t *run_offset;       /* [row_count + 1] */
    uint32_t *run_column;       /* [run_total] first column */
    uint16_t *run_count;        /* [run_total] */
    uint64_t *run_factor;       /* [run_total + 1] prefix sum of run_count */
    parian_half (*factor)[3];   /* [factor_total] scaled factors */
    float (*scale)[3];          /* [row_count] powers of two; m^-2 per unit for the transport operator */
} parian_operator;

typedef enum parian_local_form {
    PARIAN_LOCAL_NONE = 0,    /* no local part: the global part alone */
    PARIAN_LOCAL_REBUILT = 1, /* kernels are computed at load, from what the body holds anyway */
    PARIAN_LOCAL_F16 = 2,     /* kernels stored as fp16 with a scale per channel */
    PARIAN_LOCAL_U8 = 3,      /* kernels stored as signed bytes with a scale per kernel and channel */
    PARIAN_LOCAL_SPLIT = 4,   /* R_d cut smoothly by distance; local part from distance alone */
    PARIAN_LOCAL_ONLY = 5     /* no global part: the full kernel R_d in the window, computed at load */
} parian_local_form;

typedef enum parian_bssrdf { PARIAN_BSSRDF_DIPOLE = 0, PARIAN_BSSRDF_DIPOLE_FLUX = 1 } parian_bssrdf;

enum { PARIAN_NO_BORDER = 0xFFFFFFFFu, PARIAN_MAX_OPERATORS = 16, PARIAN_GUTTER_SOURCES = 4 };

typedef struct parian_body {
    char name[PARIAN_NAME_MAX];
    parian_medium medium;
    parian_bssrdf bssrdf;
    bool fit_fdr; /* F_dr by the printed fit instead of the exact moment */
    bool paper_form; /* restriction by 4 beta - 1 */

    /* Transfer surface. */
    uint32_t vertex_count, triangle_count;
    float (*vertex_position)[3];  /* [vertex_count] metres; ordered along the surface so that near
                                   * vertices have near indices (long runs) */
    uint32_t (*triangle)[3];      /* [triangle_count] */
    float (*corner_normal)[3][3]; /* [triangle_count][corner] unit shading normals */
    float (*corner_uv)[3][2];     /* [triangle_count][corner] atlas position in texels: texel (u,v)
                                   * covers [u,u+1] x [v,v+1] */
    uint32_t *triangle_chart;     /* [triangle_count] */

    /* Atlas: owned texels in row-major order (v * atlas_size + u ascending). */
    uint32_t atlas_size; /* side, texels */
    uint32_t chart_count;
    uint32_t texel_count;
    uint32_t *texel_index;          /* [texel_count] v * atlas_size + u */
    uint32_t *texel_triangle;       /* [texel_count] triangle that holds the centroid */
    float (*texel_barycentric)[2];  /* [texel_count] of corners 0 and 1; corner 2 is the rest; in [0,1] */
    float *texel_area;              /* [texel_count] m^2; they sum to the area of the transfer surface */
    /* Derived on load or by parian_body_derive, never stored: */
    float (*texel_position)[3]; /* [texel_count] metres, world space */
    float (*texel_normal)[3];   /* [texel_count] unit, interpolated corner normals */
    uint32_t *texel_at;         /* [atlas_size^2] texel ordinal, or 0xFFFFFFFF where none */

    /* Surface detail, each NULL where the source has none. */
    float (*texel_normal_map)[3]; /* [texel_count] unit normals of the source surface, world space */
    float (*texel_albedo)[3];     /* [texel_count] surface texture T_p, linear, in (0,1] */

    /* Gutter: unowned texels near a chart take their values as a weighted mean of owned texels of the
     * neighbouring surface, so that bilinear look-ups show no seam. */
    uint32_t gutter_count;
    uint32_t *gutter_index;                        /* [gutter_count] v * atlas_size + u, ascending */
    uint32_t (*gutter_source)[PARIAN_GUTTER_SOURCES]; /* [gutter_count] texel ordinals */
    float (*gutter_weight)[PARIAN_GUTTER_SOURCES];    /* [gutter_count] sum to 1 */

    /* Border texels: those whose window leaves the chart. Lists are symmetric: i is in W(o) exactly when
     * o is in W(i), for every pair of texels, window and lists taken together. */
    uint32_t border_count;
    uint32_t *border_texel;      /* [border_count] texel ordinals, ascending */
    uint32_t *border_offset;     /* [border_count + 1] into border_neighbour */
    uint32_t *border_neighbour;  /* [border_offset[border_count]] texel ordinals, ascending in a list,
                                  * the texel itself included */
    uint32_t *texel_border;      /* [texel_count] ordinal among the border texels, or PARIAN_NO_BORDER; derived */

    /* Global part. */
    bool has_global;
    uint32_t operator_count;
    /* Applied in this order. The first leads from flux to radiosity at the vertices, and is complete
     * where windows and rings look; others may carry far pairs over coarse points. */
    parian_operator operators[PARIAN_MAX_OPERATORS];

    /* Blending: weights by which E of a texel adds to B of its triangle's three vertices. Absent (NULL)
     * with local_form NONE, SPLIT and ONLY. */
    parian_half (*blend_weight)[3][3]; /* [texel_count][corner][channel] */

    /* Local part. Interior texels have one kernel of kernel_width^2 taps, tap (dv + h) * width + (du + h),
     * h = width / 2; border texels one value for each entry of border_neighbour. A value is the weight of
     * E_i in B_o. Only forms F16 and U8 store values. */
    parian_local_form local_form;
    uint32_t kernel_width;
    float split_radius_m;         /* SPLIT only */
    float kernel_channel_scale[3];   /* F16: value = half * scale */
    parian_half (*kernel_f16)[3];    /* [(texel_count - border_count) * width^2], interior texels in order */
    parian_half (*border_f16)[3];    /* [border_offset[border_count]] */
    int8_t (*kernel_s8)[3];          /* U8: value = byte * scale / 127 */
    int8_t (*border_s8)[3];
    float (*kernel_scale)[3];        /* U8: [texel_count] */

    char *plan_json; /* the plan and its reasons; NUL-terminated, may be NULL */
} parian_body;

/* A piece of the diffuse surroundings: a mesh that casts shadows and reflects light. */
typedef struct parian_surrounding {
    char name[PARIAN_NAME_MAX];
    uint32_t vertex_count, triangle_count;
    float (*vertex_position)[3];  /* [vertex_count] metres */
    uint32_t (*triangle)[3];      /* [triangle_count] */
    float (*corner_normal)[3][3]; /* [triangle_count] */
    float reflectance[3];         /* linear */
} parian_surrounding;

/* What a file holds. */
typedef struct parian_scene_data {
    uint32_t body_count, surrounding_count;
    parian_body *bodies;
    parian_surrounding *surroundings;
    char *lights_json;     /* default lights in the lights-file form, or NULL */
    char *provenance_json; /* tool version, resolved settings, input hashes, or NULL */
} parian_scene_data;

/* Free every array and zero the struct; NULL and zeroed structs are fine. */
void parian_operator_free(const parian_env *env, parian_operator *op);
void parian_body_free(const parian_env *env, parian_body *body);
void parian_scene_data_free(const parian_env *env, parian_scene_data *scene);

/* Unit normal of a texel that light falls on: that of the source surface where the body holds it, since the
 * transfer surface has lost its relief, else that of the transfer surface. */
static inline const float *parian_body_lit_normal(const parian_body *body, uint32_t texel)
{
    return body->texel_normal_map ? body->texel_normal_map[texel] : body->texel_normal[texel];
}

/* Compute the derived arrays (texel_position, texel_normal, texel_at, texel_border, run_factor) from the
 * stored ones, replacing what is there. Errors: PARIAN_E_NOMEM. Threads: uses env->par. */
parian_result parian_body_derive(const parian_env *env, parian_body *body);

#endif
