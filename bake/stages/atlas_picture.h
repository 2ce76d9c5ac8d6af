/* atlas_picture.h - the atlas as a picture: charts in distinct colours, borders darker, gutter
 * grey.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_ATLAS_PICTURE_H
#define PARIAN_BAKE_ATLAS_PICTURE_H

#include "core/body.h"

/* Paint the texels of a body that went through the texels stage. rgba: [atlas_size * atlas_size],
 * row v of the atlas at row v of the picture. Errors: PARIAN_E_ARGUMENT (no texels yet). Threads:
 * uses env->par. */
parian_result parian_atlas_picture(const parian_env *env, const parian_body *body,
                                   uint8_t (*rgba)[4]);

#endif
