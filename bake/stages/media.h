/* media.h - media from glTF volume extensions.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_MEDIA_H
#define PARIAN_BAKE_MEDIA_H

#include "bake/stages/import.h"

/* The medium of a glTF material with scattering. Errors: PARIAN_E_FORMAT where its numbers give no
 * medium. */
parian_result parian_media_from_material(const parian_env *env,
                                         const parian_source_material *material,
                                         parian_medium *medium);

#endif
