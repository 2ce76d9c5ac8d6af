/* tiny_body.h - a small body made by hand, with every array that an asset can hold.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_TINY_BODY_H
#define PARIAN_TEST_TINY_BODY_H

#include "core/body.h"

/* A square of 20 mm in the plane z = 0, facing +z: two triangles, one chart of side x side texels
 * (side >= 4) in the middle of an atlas with a margin of 4, kernels 3 wide, one operator over its
 * four vertices (none with PARIAN_LOCAL_ONLY), normal map and albedo. Values are smooth and
 * plausible, not those of a bake. Derived arrays are there. */
parian_result test_tiny_body(const parian_env *env, parian_local_form form, uint32_t side,
                             parian_body *body);

/* Two such bodies (the form, and REBUILT), one surrounding, lights and provenance. */
parian_result test_tiny_scene(const parian_env *env, parian_local_form form, uint32_t side,
                              parian_scene_data *scene);

/* True when every stored value of two scenes is the same, bit for bit. */
bool test_scene_equal(const parian_scene_data *a, const parian_scene_data *b);

#endif
