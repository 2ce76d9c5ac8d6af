/* gltf_import.h - reads glTF 2.0 (.gltf, .glb; Draco meshes included) as a source scene.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_GLTF_IMPORT_H
#define PARIAN_BAKE_GLTF_IMPORT_H

#include "bake/stages/import.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Read a glTF file that lies in memory. Buffers and pictures that it names are looked for beside
 * path.
 *
 * Node transforms are applied; there is one part for each node and material; materials whose
 * attenuation distance a node scales are copied for that scale. Primitives other than triangles,
 * and textures that are missing or cannot be decoded, are left out with a warning.
 *
 * Errors   PARIAN_E_FORMAT, PARIAN_E_UNSUPPORTED (a required extension), PARIAN_E_LIMIT,
 * PARIAN_E_NOMEM Threads  pure but for reading files */
parian_result parian_gltf_read(const parian_env *env, const char *path, const uint8_t *data,
                               size_t size, parian_source_scene *scene);

#ifdef __cplusplus
}
#endif
#endif
