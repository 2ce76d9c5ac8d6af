/* media_file.h - media from presets and JSON files.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TOOL_MEDIA_FILE_H
#define PARIAN_TOOL_MEDIA_FILE_H

#include <stdint.h>

#include "core/medium.h"

/* Presets in the order of --list-materials; names as in the literature tables. */
uint32_t parian_media_preset_count(void);
const parian_medium *parian_media_preset(uint32_t index);

/* Look a preset up; case, spaces, '-' and '_' do not matter. NULL when there is none. */
const parian_medium *parian_media_find(const char *name);

/* Read a material file (docs: command-line contract). Errors: PARIAN_E_IO, PARIAN_E_FORMAT with the
 * key named. */
parian_result parian_media_read_file(const parian_env *env, const char *path,
                                     parian_medium *medium);

#endif
