/* lit_body.h - bodies with texels on every triangle, made by hand from any mesh: for tests of light
 * and transfer that need no bake.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_LIT_BODY_H
#define PARIAN_TEST_LIT_BODY_H

#include "core/body.h"

typedef struct test_lit_desc {
    uint32_t cut; /* legs of each triangle's chart, texels: cut (cut + 1) / 2 texels; 0 takes 4 */
    parian_local_form form; /* F16 and U8 get made-up kernels */
    uint32_t kernel_width;  /* 0 takes 3 */
    bool transport;         /* made-up throughput factors, in runs with gaps; else none */
    bool smooth_sphere;     /* normals are those of a ball around the origin */
    bool detail;            /* normal map and albedo */
    bool paper_form;
} test_lit_desc;

/* Each triangle is a chart of its own; texel areas sum to the surface, centroids are exact. Derived
 * arrays are there. Values of kernels and factors depend on their index alone. */
parian_result test_lit_body(const parian_env *env, const parian_mesh *mesh,
                            const test_lit_desc *desc, parian_body *body);

/* A ball of radius r with lumps and two thin ears, closed; 10 cuts^2 + 2 vertices. */
parian_result test_figure(const parian_env *env, double radius, unsigned cuts, parian_mesh *mesh);

#endif
