/* body_file.h - carries bodies, surroundings and scene data to and from a .parian container.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_BODY_FILE_H
#define PARIAN_CORE_BODY_FILE_H

#include "core/body.h"
#include "parian/format.h"

/* Append every chunk of the scene to an open writer. */
parian_result parian_scene_data_write(parian_writer *writer, const parian_scene_data *scene);

/* Read a scene, checking every array against the schema (shapes, index ranges, finite numbers, partitions
 * of unity, ordered rows) so that nothing after it needs to check again; derived arrays are computed.
 * Unknown optional chunks are ignored, unknown required ones are PARIAN_E_UNSUPPORTED by name.
 * Errors: PARIAN_E_FORMAT (chunk, object, rule), PARIAN_E_UNSUPPORTED, PARIAN_E_NOMEM. */
parian_result parian_scene_data_read(const parian_env *env, const parian_reader *reader, parian_scene_data *scene);

/* Whether the schema has a chunk of this name; *codec: the one that parian_scene_data_write gives it. */
bool parian_scene_knows_chunk(const char *name, parian_codec *codec);
/* Refuse a file with a chunk that is required and unknown. Errors: PARIAN_E_UNSUPPORTED by its name. */
parian_result parian_scene_check_required(const parian_env *env, const parian_reader *reader);

#endif
