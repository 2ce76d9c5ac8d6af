/* occluder_tree.h - everything that casts shadows, as bounding boxes in one array that shaders and
 * C walk without a stack.
 *
 * A mesh begins with two elements: the corner and the scales that take its coordinates to a grid of
 * PARIAN_OCCLUDER_GRID steps a side. Boxes follow in depth-first order, an element each: for each
 * axis lower + PARIAN_OCCLUDER_GRID * upper in steps, then the element that follows the box with
 * all it holds, negative for a leaf. The triangles of a leaf follow it, three elements each: corner
 * 0 and the edges from it to corners 1 and 2. All of these are whole numbers that floats hold
 * exactly.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_OCCLUDER_TREE_H
#define PARIAN_OCCLUDER_TREE_H

#include "core/body.h"
#include "placement.h"

enum {
    PARIAN_OCCLUDER_ELEMENT_MAX = 1 << 24,
    PARIAN_OCCLUDER_ROW = 2048,
    PARIAN_OCCLUDER_GRID = 4096
};

typedef struct parian_occluder_tree {
    uint32_t mesh_count; /* bodies, then surroundings */
    uint32_t *first;     /* [mesh_count + 1] element with which a mesh begins */
    uint32_t element_count;
    float (*element)[4]; /* [parian_occluder_tree_room], zero behind element_count */
} parian_occluder_tree;

/* A mesh that stands somewhere, as the shaders read it: rows that take a point (p, 1) of the world
 * to its own coordinates; first element, and the one after the last. */
typedef struct parian_caster {
    float row[3][4];
    float first, end, unused[2];
} parian_caster;

/* The mesh that an instance has placed, or that stands where it is (at NULL). */
parian_caster parian_caster_place(const parian_occluder_tree *tree, uint32_t mesh,
                                  const parian_placement *at);

/* The tree of a scene's meshes, each in its own coordinates. Errors: PARIAN_E_NOMEM, PARIAN_E_LIMIT
 * (more elements than floats can count). Threads: none; the same scene gives the same tree. Source
 * [Wald07], binned surface area heuristic */
parian_result parian_occluder_tree_build(const parian_env *env, const parian_scene_data *scene,
                                         parian_occluder_tree *tree);
/* Elements that there is room for: an upper bound that needs no tree, a multiple of
 * PARIAN_OCCLUDER_ROW. */
uint64_t parian_occluder_tree_room(const parian_scene_data *scene);
void parian_occluder_tree_free(const parian_env *env, parian_occluder_tree *tree);

#endif
