/* refracted_tree.c - orders facets for a tree of four-way nodes and writes its nodes.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/refracted_hierarchy.h"

#include "core/random.h"

float parian_float_below(double value)
{
    float f = (float)value;
    return (double)f > value ? nextafterf(f, -INFINITY) : f;
}

float parian_float_above(double value)
{
    float f = (float)value;
    return (double)f < value ? nextafterf(f, INFINITY) : f;
}

static int widest_key(const parian_tree_item *item, uint32_t count)
{
    float lower[PARIAN_TREE_KEYS], upper[PARIAN_TREE_KEYS];
    for (int k = 0; k < PARIAN_TREE_KEYS; k++) {
        lower[k] = INFINITY;
        upper[k] = -INFINITY;
    }
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < PARIAN_TREE_KEYS; k++) {
            lower[k] = fminf(lower[k], item[i].key[k]);
            upper[k] = fmaxf(upper[k], item[i].key[k]);
        }
    }
    int widest = 0;
    for (int k = 1; k < PARIAN_TREE_KEYS; k++) {
        widest = upper[k] - lower[k] > upper[widest] - lower[widest] ? k : widest;
    }
    return widest;
}

/* By the key, and by the facet among equals: a strict order. */
static bool is_before(const parian_tree_item *a, const parian_tree_item *b, int key)
{
    return a->key[key] < b->key[key] || (a->key[key] == b->key[key] && a->facet < b->facet);
}

/* Partly sort item [count] so that those before place `middle` come before it in the order (Hoare's
 * selection, with pivots that depend on the range alone). */
static void select_middle(parian_tree_item *item, uint32_t count, uint32_t middle, int key)
{
    int64_t low = 0, high = (int64_t)count - 1;
    while (low < high) {
        uint64_t mixed = parian_random_mix((uint64_t)high << 32 | (uint64_t)low);
        parian_tree_item pivot = item[low + (int64_t)(mixed % (uint64_t)(high - low + 1))];
        int64_t i = low, j = high;
        while (i <= j) {
            while (is_before(&item[i], &pivot, key)) {
                i++;
            }
            while (is_before(&pivot, &item[j], key)) {
                j--;
            }
            if (i <= j) {
                parian_tree_item swap = item[i];
                item[i++] = item[j];
                item[j--] = swap;
            }
        }
        low = j < middle ? i : low;
        high = middle < i ? j : high;
    }
}

static void halve(parian_tree_item *item, uint32_t count)
{
    select_middle(item, count, count / 2, widest_key(item, count));
}

int parian_tree_ranges(uint32_t first, uint32_t count, uint32_t leaf,
                       uint32_t ends[PARIAN_TREE_WIDTH + 1])
{
    int n = 0;
    ends[0] = first;
    if (count <= leaf) {
        ends[1] = first + count;
        return count > 0;
    }
    uint32_t half[3] = {0, count / 2, count};
    for (int k = 0; k < 2; k++) {
        uint32_t size = half[k + 1] - half[k];
        if (size > leaf) {
            ends[++n] = first + half[k] + size / 2;
        }
        ends[++n] = first + half[k + 1];
    }
    return n;
}

void parian_tree_order(parian_tree_item *item, uint32_t count, uint32_t leaf)
{
    if (count <= leaf) {
        return;
    }
    uint32_t half = count / 2;
    halve(item, count);
    parian_tree_order(item, half, leaf);
    parian_tree_order(item + half, count - half, leaf);
}

uint32_t parian_tree_node_count(uint32_t count, uint32_t leaf)
{
    uint32_t ends[PARIAN_TREE_WIDTH + 1], nodes = 1;
    int n = parian_tree_ranges(0, count, leaf, ends);
    for (int k = 0; k < n; k++) {
        uint32_t size = ends[k + 1] - ends[k];
        nodes += size > leaf ? parian_tree_node_count(size, leaf) : 0;
    }
    return nodes;
}

uint32_t parian_tree_write(parian_tree_writer *writer, uint32_t first, uint32_t count)
{
    uint32_t ends[PARIAN_TREE_WIDTH + 1], node = writer->next++;
    int n = parian_tree_ranges(first, count, writer->leaf, ends);
    for (int k = 0; k < PARIAN_TREE_WIDTH; k++) {
        uint32_t start = k < n ? ends[k] : first, size = k < n ? ends[k + 1] - ends[k] : 0;
        bool inner = size > writer->leaf;
        uint32_t child = inner ? parian_tree_write(writer, start, size) : start;
        parian_tree_children *children = writer->children(writer->context, node);
        children->first[k] = child;
        children->count[k] = inner ? PARIAN_TREE_INNER : size;
        writer->bound(writer->context, node, k, start, size);
    }
    return node;
}
