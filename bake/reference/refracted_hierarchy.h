/* refracted_hierarchy.h - the trees that find facets for refracted paths: order, nodes of four,
 * bounds.
 *
 * Trees are made by halving sets of facets at the median of the widest of six keys, and need no
 * stored shape beyond it. Bounds are floats, rounded outwards, in units of the mesh's radius about
 * its centre; what they let through is decided in double by refracted_facet.h.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFRACTED_HIERARCHY_H
#define PARIAN_BAKE_REFRACTED_HIERARCHY_H

#include "bake/reference/refracted_facet.h"

enum { PARIAN_TREE_WIDTH = 4, PARIAN_TREE_KEYS = 6, PARIAN_TREE_STACK = 64 };
enum { PARIAN_TREE_INNER = 0xFFFFFFFFu };

/* One float for each child. */
typedef float parian_four[PARIAN_TREE_WIDTH];

/* Children of a node: count[k] facets from first[k] on, or where count[k] is PARIAN_TREE_INNER the
 * node first[k]. A missing child has no facets. */
typedef struct parian_tree_children {
    uint32_t first[PARIAN_TREE_WIDTH], count[PARIAN_TREE_WIDTH];
} parian_tree_children;

/* Boxes and cones of normals. spread: half angle of the cone about axis, radians. 192 bytes. */
typedef struct parian_refractor_node {
    parian_four centre[3], half[3], axis[3], spread;
    parian_tree_children children;
} parian_refractor_node;

struct parian_refractor {
    parian_env env;
    parian_refracting_eta eta;
    uint32_t facet_count, node_count;
    parian_refracting_facet *facet; /* [facet_count] in the order of the tree */
    parian_refractor_node *node;    /* [node_count], 0 is the root */
    double centre[3], radius;       /* of a ball around the facets, metres */
};

/* What a tree is ordered by: the widest key is halved first. */
typedef struct parian_tree_item {
    float key[PARIAN_TREE_KEYS];
    uint32_t facet;
} parian_tree_item;

/* Sort items [count] so that any node's range is halved at its middle; leaf: largest count of a
 * leaf. */
void parian_tree_order(parian_tree_item *item, uint32_t count, uint32_t leaf);
/* Number of nodes over count items. */
uint32_t parian_tree_node_count(uint32_t count, uint32_t leaf);
/* Bounds of the four ranges below first .. first + count; returns how many there are (0 to 4), ends
 * [5]. */
int parian_tree_ranges(uint32_t first, uint32_t count, uint32_t leaf,
                       uint32_t ends[PARIAN_TREE_WIDTH + 1]);

/* Write the nodes over first .. first + count depth first from node *next on; bound(context, node,
 * child, first, count) fills a child's bounds; count 0: those of a missing child, best met by
 * nothing. Returns the node written. */
typedef struct parian_tree_writer {
    void *context;
    parian_tree_children *(*children)(void *context, uint32_t node);
    void (*bound)(void *context, uint32_t node, int child, uint32_t first, uint32_t count);
    uint32_t leaf, next;
} parian_tree_writer;
uint32_t parian_tree_write(parian_tree_writer *writer, uint32_t first, uint32_t count);

/* value as a float that is not larger / not smaller. */
float parian_float_below(double value);
float parian_float_above(double value);

#endif
