/* openmesh_import.h - reads OBJ, PLY, STL and OFF through OpenMesh as a soup of polygons.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_OPENMESH_IMPORT_H
#define PARIAN_BAKE_OPENMESH_IMPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Polygons over shared vertices, every one that the file holds, manifold or not. */
typedef struct parian_polygons {
    uint32_t vertex_count, polygon_count;
    double (*position)[3]; /* [vertex_count] file units */
    uint32_t *offset;      /* [polygon_count + 1] into corner */
    uint32_t *corner;      /* [offset[polygon_count]] vertex indices, in range */
} parian_polygons;

/* Read a file that lies in memory.
 *
 * name    for messages
 * format  "obj", "ply", "stl" or "off"
 * binary  how an STL or PLY is coded
 *
 * Errors   PARIAN_E_FORMAT, PARIAN_E_LIMIT (2^31 corners), PARIAN_E_NOMEM
 * Threads  one call at a time does its work (the library's readers are single objects) */
parian_result parian_openmesh_read(const parian_env *env, const char *name, const char *format,
                                   bool binary, const void *data, size_t size,
                                   parian_polygons *polygons);
void parian_polygons_free(const parian_env *env, parian_polygons *polygons);

#ifdef __cplusplus
}
#endif
#endif
