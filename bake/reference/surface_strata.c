/* surface_strata.c - cuts a surface into compact strata of any fineness.
 *
 * The tree halves the triangles by the widest of six coordinates: position, and normal times a
 * length of the node's own size, so that the two sides of a thin wall part before the wall's length
 * is cut to its thickness.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/surface_strata.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_maths.h"

enum { KEYS = 6, DEPTH_MAX = 128 };
static const double NORMAL_REACH = 0.25; /* a half turn counts as half of the node's size */

typedef struct tree_maker {
    parian_strata_tree *tree;
    float (*key)[KEYS]; /* [triangle_count] centroid and unit normal */
    double *area;       /* [triangle_count] */
} tree_maker;

static void triangle_corners(const parian_mesh *mesh, uint32_t triangle, const double origin[3],
                             double p[3][3])
{
    for (int k = 0; k < 3; k++) {
        for (int a = 0; a < 3; a++) {
            p[k][a] = mesh->position[mesh->triangle[triangle][k]][a] - origin[a];
        }
    }
}

static double measure_triangle(double p[3][3], double normal[3])
{
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
    }
    parian_cross3(u, v, normal);
    double length = sqrt(parian_dot3(normal, normal));
    for (int a = 0; a < 3; a++) {
        normal[a] = length > 0 ? normal[a] / length : 0;
    }
    return 0.5 * length;
}

static void measure_triangles(const tree_maker *maker)
{
    const parian_strata_tree *tree = maker->tree;
    for (uint32_t t = 0; t < tree->mesh->triangle_count; t++) {
        double p[3][3], normal[3];
        triangle_corners(tree->mesh, t, tree->origin, p);
        maker->area[t] = measure_triangle(p, normal);
        tree->order[t] = t;
        for (int a = 0; a < 3; a++) {
            maker->key[t][a] = (float)((p[0][a] + p[1][a] + p[2][a]) / 3);
            maker->key[t][3 + a] = (float)normal[a];
        }
    }
}

/* Centre of the box around the triangles of a node, and the radius of the ball around it. */
static void bound_node(const tree_maker *maker, parian_strata_node *node)
{
    const parian_strata_tree *tree = maker->tree;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double p[3][3], radius2 = 0;
    for (uint32_t i = node->first; i < node->end; i++) {
        triangle_corners(tree->mesh, tree->order[i], tree->origin, p);
        for (int j = 0; j < 9; j++) {
            low[j % 3] = fmin(low[j % 3], p[j / 3][j % 3]);
            high[j % 3] = fmax(high[j % 3], p[j / 3][j % 3]);
        }
    }
    for (int a = 0; a < 3; a++) {
        node->centre[a] = (float)(0.5 * (low[a] + high[a]));
        radius2 += 0.25 * (high[a] - low[a]) * (high[a] - low[a]);
    }
    node->radius = (float)sqrt(radius2);
}

static int widest_key(const tree_maker *maker, const parian_strata_node *node)
{
    int best = 0;
    double widest = -1;
    for (int k = 0; k < KEYS; k++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t i = node->first; i < node->end; i++) {
            float x = maker->key[maker->tree->order[i]][k];
            low = fminf(low, x);
            high = fmaxf(high, x);
        }
        double width = (double)(high - low) * (k < 3 ? 1 : NORMAL_REACH * 2 * node->radius);
        if (width > widest) {
            widest = width;
            best = k;
        }
    }
    return best;
}

static bool key_before(const tree_maker *maker, int key, uint32_t a, uint32_t b)
{
    float x = maker->key[a][key], y = maker->key[b][key];
    return x < y || (!(y < x) && a < b);
}

/* Order the triangles so that those before `middle` have the smaller keys. */
static void select_middle(const tree_maker *maker, int key, uint32_t low, uint32_t high,
                          uint32_t middle)
{
    uint32_t *order = maker->tree->order;
    while (high - low > 1) {
        uint32_t pivot = order[low + (high - low) / 2], i = low, j = high - 1;
        while (i <= j) {
            while (key_before(maker, key, order[i], pivot)) {
                i++;
            }
            while (key_before(maker, key, pivot, order[j])) {
                j--;
            }
            if (i <= j) {
                uint32_t swap = order[i];
                order[i++] = order[j];
                order[j] = swap;
                if (j == 0) {
                    break;
                }
                j--;
            }
        }
        if (middle <= j) {
            high = j + 1;
        } else if (middle >= i) {
            low = i;
        } else {
            return;
        }
    }
}

/* Nodes in the order in which they are made: children stand side by side behind their parent. */
static void grow_tree(const tree_maker *maker)
{
    parian_strata_tree *tree = maker->tree;
    tree->node[0] = (parian_strata_node){.end = tree->mesh->triangle_count};
    tree->node_count = 1;
    for (uint32_t n = 0; n < tree->node_count; n++) {
        parian_strata_node *node = &tree->node[n];
        bound_node(maker, node);
        if (node->end - node->first > 1) {
            uint32_t middle = node->first + (node->end - node->first) / 2;
            select_middle(maker, widest_key(maker, node), node->first, node->end, middle);
            node->below = tree->node_count;
            tree->node[tree->node_count++] =
                (parian_strata_node){.first = node->first, .end = middle};
            tree->node[tree->node_count++] =
                (parian_strata_node){.first = middle, .end = node->end};
        }
    }
}

static void sum_areas(const tree_maker *maker)
{
    parian_strata_tree *tree = maker->tree;
    for (uint32_t i = 0; i < tree->mesh->triangle_count; i++) {
        tree->sum[i + 1] = tree->sum[i] + maker->area[tree->order[i]];
    }
    tree->area = tree->sum[tree->mesh->triangle_count];
    for (uint32_t n = 0; n < tree->node_count; n++) {
        parian_strata_node *node = &tree->node[n];
        node->area = tree->sum[node->end] - tree->sum[node->first];
    }
}

parian_result parian_strata_tree_make(const parian_env *env, const parian_mesh *mesh,
                                      parian_strata_tree *tree)
{
    tree_maker maker = {.tree = tree};
    double lower[3], upper[3];
    size_t count = mesh->triangle_count;
    memset(tree, 0, sizeof *tree);
    tree->mesh = mesh;
    if (count == 0) {
        return PARIAN_OK;
    }
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW(env, tree->node, 2 * count) || !PARIAN_NEW(env, tree->order, count) ||
        !PARIAN_NEW0(env, tree->sum, count + 1) || !PARIAN_NEW(env, maker.key, count) ||
        !PARIAN_NEW(env, maker.area, count)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for strata of %zu triangles", count);
    } else {
        parian_mesh_bounds(mesh, lower, upper);
        for (int a = 0; a < 3; a++) {
            tree->origin[a] = 0.5 * (lower[a] + upper[a]);
        }
        measure_triangles(&maker);
        grow_tree(&maker);
        sum_areas(&maker);
    }
    parian_free(env, maker.key);
    parian_free(env, maker.area);
    if (r != PARIAN_OK) {
        parian_strata_tree_free(env, tree);
    }
    return r;
}

void parian_strata_tree_free(const parian_env *env, parian_strata_tree *tree)
{
    parian_free(env, tree->node);
    parian_free(env, tree->order);
    parian_free(env, tree->sum);
    memset(tree, 0, sizeof *tree);
}

/* ---- strata ------------------------------------------------------------------------------------
 */
static void stratum_of_node(const parian_strata_tree *tree, uint32_t index, parian_stratum *stratum)
{
    static const double whole[3][2] = {{1, 0}, {0, 1}, {0, 0}};
    const parian_strata_node *node = &tree->node[index];
    *stratum = (parian_stratum){.node = index, .radius = node->radius, .area = node->area};
    for (int a = 0; a < 3; a++) {
        stratum->centre[a] = node->centre[a];
    }
    if (!node->below) {
        stratum->node = PARIAN_STRATUM_PIECE;
        stratum->triangle = tree->order[node->first];
        memcpy(stratum->corner, whole, sizeof whole);
    }
}

void parian_stratum_root(const parian_strata_tree *tree, parian_stratum *stratum)
{
    stratum_of_node(tree, 0, stratum);
}

static void place_piece(const parian_strata_tree *tree, const parian_stratum *stratum,
                        double point[3][3])
{
    double p[3][3];
    triangle_corners(tree->mesh, stratum->triangle, tree->origin, p);
    for (int k = 0; k < 3; k++) {
        double b0 = stratum->corner[k][0], b1 = stratum->corner[k][1], b2 = 1 - b0 - b1;
        for (int a = 0; a < 3; a++) {
            point[k][a] = b0 * p[0][a] + b1 * p[1][a] + b2 * p[2][a];
        }
    }
}

static double distance2(const double a[3], const double b[3])
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* The ball around the centroid. */
static void bound_piece(double point[3][3], parian_stratum *stratum)
{
    double radius2 = 0;
    for (int a = 0; a < 3; a++) {
        stratum->centre[a] = (point[0][a] + point[1][a] + point[2][a]) / 3;
    }
    for (int k = 0; k < 3; k++) {
        radius2 = fmax(radius2, distance2(stratum->centre, point[k]));
    }
    stratum->radius = sqrt(radius2);
}

static void split_piece(const parian_strata_tree *tree, const parian_stratum *stratum,
                        parian_stratum half[2])
{
    double point[3][3], middle[3], longest = -1;
    int k = 0;
    place_piece(tree, stratum, point);
    for (int e = 0; e < 3; e++) {
        double length2 = distance2(point[e], point[(e + 1) % 3]);
        if (length2 > longest) {
            longest = length2;
            k = e;
        }
    }
    for (int a = 0; a < 3; a++) {
        middle[a] = 0.5 * (point[k][a] + point[(k + 1) % 3][a]);
    }
    for (int h = 0; h < 2; h++) {
        int moved = (k + h) % 3;
        double corners[3][3];
        half[h] = *stratum;
        half[h].area = 0.5 * stratum->area;
        for (int a = 0; a < 2; a++) {
            half[h].corner[moved][a] =
                0.5 * (stratum->corner[k][a] + stratum->corner[(k + 1) % 3][a]);
        }
        memcpy(corners, point, sizeof corners);
        memcpy(corners[moved], middle, sizeof middle);
        bound_piece(corners, &half[h]);
    }
}

void parian_stratum_split(const parian_strata_tree *tree, const parian_stratum *stratum,
                          parian_stratum half[2])
{
    if (stratum->node == PARIAN_STRATUM_PIECE) {
        split_piece(tree, stratum, half);
    } else {
        uint32_t below = tree->node[stratum->node].below;
        stratum_of_node(tree, below, &half[0]);
        stratum_of_node(tree, below + 1, &half[1]);
    }
}

/* Count the strata of a cut, and store them where there is room. */
static size_t walk_cut(const parian_strata_tree *tree, double area_max, parian_stratum *strata)
{
    parian_stratum stack[DEPTH_MAX];
    size_t count = 0, depth = 0;
    if (!(tree->area > 0)) {
        return 0;
    }
    parian_stratum_root(tree, &stack[depth++]);
    while (depth > 0) {
        parian_stratum s = stack[--depth], half[2];
        if (s.area > area_max && depth + 2 <= DEPTH_MAX) {
            parian_stratum_split(tree, &s, half);
            stack[depth++] = half[1];
            stack[depth++] = half[0];
        } else if (s.area > 0) {
            if (strata) {
                strata[count] = s;
            }
            count++;
        }
    }
    return count;
}

parian_result parian_strata_cut(const parian_env *env, const parian_strata_tree *tree,
                                double area_max, parian_stratum **strata, size_t *count)
{
    *count = walk_cut(tree, area_max, NULL);
    if (!PARIAN_NEW(env, *strata, *count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu strata", *count);
    }
    walk_cut(tree, area_max, *strata);
    return PARIAN_OK;
}

/* ---- places ------------------------------------------------------------------------------------
 */

/* The triangle of a node at a share of its area. */
static uint32_t pick_triangle(const parian_strata_tree *tree, const parian_strata_node *node,
                              double u)
{
    double target = tree->sum[node->first] + u * node->area;
    uint32_t low = node->first, high = node->end;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (tree->sum[middle] <= target) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return tree->order[low];
}

static void fill_place(const parian_mesh *mesh, parian_place *place)
{
    double p[3][3];
    const double *b = place->barycentric, zero[3] = {0, 0, 0};
    triangle_corners(mesh, place->triangle, zero, p);
    measure_triangle(p, place->normal);
    for (int a = 0; a < 3; a++) {
        place->position[a] = b[0] * p[0][a] + b[1] * p[1][a] + b[2] * p[2][a];
    }
    memcpy(place->smooth_normal, place->normal, sizeof place->normal);
    if (mesh->corner_normal) {
        double n[3];
        for (int a = 0; a < 3; a++) {
            n[a] = b[0] * mesh->corner_normal[place->triangle][0][a] +
                   b[1] * mesh->corner_normal[place->triangle][1][a] +
                   b[2] * mesh->corner_normal[place->triangle][2][a];
        }
        double length = sqrt(parian_dot3(n, n));
        for (int a = 0; length > 0 && a < 3; a++) {
            place->smooth_normal[a] = n[a] / length;
        }
    }
}

void parian_stratum_place(const parian_strata_tree *tree, const parian_stratum *stratum,
                          uint32_t body, parian_random *random, parian_place *place)
{
    bool piece = stratum->node == PARIAN_STRATUM_PIECE;
    double pick = parian_random_unit(random), root = sqrt(parian_random_unit(random));
    double across = parian_random_unit(random);
    double w[3] = {1 - root, root * (1 - across), root * across};
    place->body = body;
    place->triangle =
        piece ? stratum->triangle : pick_triangle(tree, &tree->node[stratum->node], pick);
    memcpy(place->barycentric, w, sizeof w);
    if (piece) {
        const double(*c)[2] = stratum->corner;
        place->barycentric[0] = w[0] * c[0][0] + w[1] * c[1][0] + w[2] * c[2][0];
        place->barycentric[1] = w[0] * c[0][1] + w[1] * c[1][1] + w[2] * c[2][1];
        place->barycentric[2] = fmax(0, 1 - place->barycentric[0] - place->barycentric[1]);
    }
    fill_place(tree->mesh, place);
}
