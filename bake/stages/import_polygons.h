/* import_polygons.h - splits polygons into triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_IMPORT_POLYGONS_H
#define PARIAN_BAKE_IMPORT_POLYGONS_H

#include "bake/adapters/openmesh_import.h"
#include "core/mesh.h"

/* Make a triangle mesh of polygons by cutting ears in the plane of each polygon's mean normal;
 * positions are copied, corners that repeat their predecessor are dropped, polygons of fewer than
 * three corners too. A file whose polygons would take unreasonably long (thousands of corners, all
 * reflex) has the rest of them split as fans, with a warning. Errors: PARIAN_E_LIMIT (2^31
 * triangles), PARIAN_E_NOMEM. */
parian_result parian_triangulate(const parian_env *env, const char *name,
                                 const parian_polygons *polygons, parian_mesh *mesh);

#endif
