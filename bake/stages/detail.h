/* detail.h - carries detail of the source surface over to the texels: normals and surface colour.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_DETAIL_H
#define PARIAN_BAKE_DETAIL_H

#include "bake/stages/import.h"
#include "core/body.h"

typedef struct parian_detail_desc {
    const parian_mesh *source;                /* the source surface, after the surface stage */
    const parian_source_material *materials;  /* of the scene; NULL for none */
    uint32_t material_count;
    uint32_t material;                        /* of this body; 0xFFFFFFFF for none */
    const parian_picture *pictures;
    uint32_t picture_count;
    bool normal_map; /* the source is denser than the transfer surface */
} parian_detail_desc;

/* Fill texel_normal_map and texel_albedo, each only where the source has such detail (a constant white
 * base colour is none). Errors: PARIAN_E_NOMEM, PARIAN_E_COMPUTE. */
parian_result parian_stage_detail(const parian_env *env, const parian_detail_desc *desc, parian_body *body);

#endif
