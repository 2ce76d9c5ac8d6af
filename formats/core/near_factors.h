/* near_factors.h - what the global part already carries between near texels, looked up triangle by
 * triangle.
 *
 * The residual kernel is R_d less the global part's response, so the factors must be the stored
 * ones. A patch gathers the vertices near one triangle and the factors between them and its corners
 * once; then every pair of texels costs nine products per channel.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_NEAR_FACTORS_H
#define PARIAN_CORE_NEAR_FACTORS_H

#include "core/body.h"

/* Factor of a row and column of an operator as it is applied, zeros where none is stored. */
void parian_operator_factor(const parian_operator *op, uint32_t row, uint32_t column,
                            float factor[3]);

/* The texels of each triangle. */
typedef struct parian_texel_lists {
    uint32_t *offset; /* [triangle_count + 1] */
    uint32_t *texel;  /* [texel_count], ascending within a triangle */
} parian_texel_lists;
parian_result parian_texel_lists_make(const parian_env *env, const parian_body *body,
                                      parian_texel_lists *lists);
void parian_texel_lists_free(const parian_env *env, parian_texel_lists *lists);

/* Scratch of one thread: the vertices near one triangle. */
typedef struct parian_patch {
    const parian_env *env;
    const parian_body *body;
    uint32_t triangle;
    uint32_t *slot;           /* [vertex_count] place in vertex, or 0xFFFFFFFF */
    uint32_t *triangle_stamp; /* [triangle_count] last triangle + 1 whose patch holds it */
    uint32_t count, capacity;
    uint32_t *vertex;      /* [count] */
    float (*factor)[3][3]; /* [count][corner][channel] */
    float (*mix)[3];       /* [count] factors between a texel of the triangle and the vertices */
} parian_patch;

parian_result parian_patch_make(const parian_env *env, const parian_body *body,
                                parian_patch *patch);
void parian_patch_free(parian_patch *patch);

/* Begin with a triangle; then add the texels that will be asked for; then gather the factors: with
 * corners_receive, of the corners' rows, else of their columns. */
void parian_patch_begin(parian_patch *patch, uint32_t triangle);
parian_result parian_patch_add(parian_patch *patch, uint32_t texel);
void parian_patch_gather(parian_patch *patch, bool corners_receive);

/* Mix the corners' factors by weights of the corners: one texel of the triangle against all
 * vertices. */
void parian_patch_mix(parian_patch *patch, const float weight[3]);

/* Response between the mixed texel and another, given the other's weights of its corners. */
static inline void parian_patch_response(const parian_patch *patch, uint32_t texel,
                                         const float weight[3], float value[3])
{
    const uint32_t *corner = patch->body->triangle[patch->body->texel_triangle[texel]];
    const float *a = patch->mix[patch->slot[corner[0]]], *b = patch->mix[patch->slot[corner[1]]];
    const float *c = patch->mix[patch->slot[corner[2]]];
    for (int k = 0; k < 3; k++) {
        value[k] = weight[0] * a[k] + weight[1] * b[k] + weight[2] * c[k];
    }
}

/* The hats at a texel, and the weights by which its flux enters at the corners (4 beta - 1 in the
 * paper's form). */
static inline void parian_texel_hats(const parian_body *body, uint32_t texel, float beta[3])
{
    beta[0] = body->texel_barycentric[texel][0];
    beta[1] = body->texel_barycentric[texel][1];
    beta[2] = 1 - beta[0] - beta[1];
}

static inline void parian_texel_entry(const parian_body *body, uint32_t texel, float weight[3])
{
    parian_texel_hats(body, texel, weight);
    for (int k = 0; k < 3 && body->paper_form; k++) {
        weight[k] = 4 * weight[k] - 1;
    }
}

#endif
