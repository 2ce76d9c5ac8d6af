/* surface.h - makes a sound surface of a source mesh: welds, repairs what is safe, orients, checks.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SURFACE_H
#define PARIAN_BAKE_SURFACE_H

#include "core/mesh.h"

/* Corners sharper than this keep separate normals, in bodies, their surroundings and references alike. */
#define PARIAN_CREASE_DEG 50.0

typedef struct parian_surface_report {
    uint32_t welded_vertices, unreferenced_vertices, degenerate_triangles, duplicate_triangles;
    uint32_t split_vertices;     /* non-manifold vertices and edges duplicated */
    uint32_t flipped_triangles;  /* orientation made consistent */
    uint32_t components, boundary_edges, self_intersections;
    bool closed;      /* no boundary edge */
    bool inverted;    /* the whole was inside out and was turned */
    bool orientable;  /* false: cut along an edge path where orientation cannot be consistent */
} parian_surface_report;

/* Work on mesh in place (corner attributes follow their triangles). What is merely open, inside out, mixed
 * in orientation, of several parts, with duplicate or unreferenced vertices is accepted with a warning that
 * says what was done; PARIAN_E_FORMAT only when no surface can be made of it (no triangle with an area).
 * Afterwards the mesh is an oriented 2-manifold with boundary, without degenerate triangles. */
parian_result parian_stage_surface(const parian_env *env, parian_mesh *mesh, parian_surface_report *report);

#endif
