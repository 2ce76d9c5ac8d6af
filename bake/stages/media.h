/* media.h - media from presets, JSON files and glTF volume extensions.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_MEDIA_H
#define PARIAN_BAKE_MEDIA_H

#include "bake/stages/import.h"

/* Presets in the order of --list-materials; names as in the literature tables. */
uint32_t parian_media_preset_count(void);
const parian_medium *parian_media_preset(uint32_t index);

/* Look a preset up; case, spaces, '-' and '_' do not matter. NULL when there is none. */
const parian_medium *parian_media_find(const char *name);

/* Read a material file (docs: command-line contract). Errors: PARIAN_E_IO, PARIAN_E_FORMAT with the key named. */
parian_result parian_media_read_file(const parian_env *env, const char *path, parian_medium *medium);

/* The medium of a glTF material with scattering. Errors: PARIAN_E_FORMAT where its numbers give no medium. */
parian_result parian_media_from_material(const parian_env *env, const parian_source_material *material,
                                         parian_medium *medium);

/* Refuse what is physically impossible (negative, not finite, no scattering at all, eta outside [1, 4],
 * |g| >= 1), naming the coefficient: PARIAN_E_ARGUMENT. g is capped at +-0.995 with a warning. */
parian_result parian_media_check(const parian_env *env, parian_medium *medium);

#endif
