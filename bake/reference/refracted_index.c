/* refracted_index.c - finds refracted paths of one direction of light: a tree of prisms.
 *
 * The points that a facet lights form a prism along its refracted direction. In a frame whose
 * height points to the light a prism's section moves linearly with depth, as a moving object's does
 * with time; so a subtree is bounded by the sections' box on a base plane and by the least and
 * greatest slopes.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/refracted_four.h"
#include "bake/reference/refracted_hierarchy.h"
#include "core/memory.h"

enum { LEAF = 1 };

/* Slopes next to places in the order of the tree: the share of max_length at which prisms are told
 * apart. */
static const double SLOPE_WEIGHT = 0.25;

/* 192 bytes. */
typedef struct prism_node {
    parian_four base, top;             /* heights of the lowest and the highest facet */
    parian_four lower[2], upper[2];    /* of the sections in the plane of the base */
    parian_four least[2], greatest[2]; /* slopes: way in the plane for each unit of depth */
    parian_tree_children children;
} prism_node;

struct parian_refractor_index {
    parian_env env;
    const parian_refractor *refractor;
    double frame[3][3]; /* two across, the third towards the light */
    double steepest;    /* largest slope */
    uint32_t count, node_count;
    uint32_t *place; /* [count] facets of the refractor, in the order of this tree */
    prism_node *node;
};

/* Slopes of a facet's prism; false where light does not enter. */
static bool find_slope(const parian_refractor_index *index, uint32_t facet, double slope[2])
{
    const parian_refracting_eta *e = &index->refractor->eta;
    const double *n = index->refractor->facet[facet].normal, *light = index->frame[2];
    double cos_i = parian_dot3(n, light), cos2_t = (e->excess + cos_i * cos_i) * e->inverse2;
    if (!(cos_i > 0 && cos2_t > 0)) {
        return false;
    }
    double c = sqrt(cos2_t) - cos_i * e->inverse, rise = e->inverse + c * cos_i;
    slope[0] = -c * parian_dot3(n, index->frame[0]) / rise;
    slope[1] = -c * parian_dot3(n, index->frame[1]) / rise;
    return isfinite(slope[0]) && isfinite(slope[1]);
}

/* A point of the mesh in the frame, in units of the mesh's radius. */
static void to_frame(const parian_refractor_index *index, const double p[3], double out[3])
{
    const parian_refractor *r = index->refractor;
    double d[3] = {p[0] - r->centre[0], p[1] - r->centre[1], p[2] - r->centre[2]};
    for (int k = 0; k < 3; k++) {
        out[k] = parian_dot3(index->frame[k], d) / r->radius;
    }
}

static parian_result order_prisms(parian_refractor_index *index, double max_length)
{
    const parian_refractor *r = index->refractor;
    parian_tree_item *item = NULL;
    if (!PARIAN_NEW(&index->env, item, r->facet_count)) {
        return parian_fail(&index->env, PARIAN_E_NOMEM,
                           "refracted paths: no memory to sort %u prisms", r->facet_count);
    }
    double weight = SLOPE_WEIGHT * fmin(max_length / r->radius, 1);
    for (uint32_t i = 0; i < r->facet_count; i++) {
        double slope[2], middle[3] = {0, 0, 0}, p[3];
        if (!find_slope(index, i, slope)) {
            continue;
        }
        for (int c = 0; c < 3; c++) {
            to_frame(index, r->facet[i].corner[c], p);
            for (int k = 0; k < 3; k++) {
                middle[k] += p[k] / 3;
            }
        }
        item[index->count++] =
            (parian_tree_item){{(float)middle[0], (float)middle[1], (float)middle[2],
                                (float)(weight * slope[0]), (float)(weight * slope[1]), 0},
                               i};
        index->steepest = fmax(index->steepest, fmax(fabs(slope[0]), fabs(slope[1])));
    }
    parian_tree_order(item, index->count, LEAF);
    bool made = PARIAN_NEW(&index->env, index->place, index->count);
    for (uint32_t i = 0; made && i < index->count; i++) {
        index->place[i] = item[i].facet;
    }
    parian_free(&index->env, item);
    return made ? PARIAN_OK
                : parian_fail(&index->env, PARIAN_E_NOMEM,
                              "refracted paths: no memory for %u prisms", index->count);
}

/* The bounds of one child while it is gathered. */
typedef struct prism_bounds {
    double base, top, lower[2], upper[2], least[2], greatest[2];
} prism_bounds;

static void bound_heights(const parian_refractor_index *index, uint32_t first, uint32_t count,
                          prism_bounds *b)
{
    for (uint32_t i = first; i < first + count; i++) {
        for (int c = 0; c < 3; c++) {
            double p[3];
            to_frame(index, index->refractor->facet[index->place[i]].corner[c], p);
            b->base = fmin(b->base, p[2]);
            b->top = fmax(b->top, p[2]);
        }
    }
}

static void bound_sections(const parian_refractor_index *index, uint32_t first, uint32_t count,
                           prism_bounds *b)
{
    for (uint32_t i = first; i < first + count; i++) {
        double slope[2] = {0, 0}, p[3];
        find_slope(index, index->place[i], slope);
        for (int k = 0; k < 2; k++) {
            b->least[k] = fmin(b->least[k], slope[k]);
            b->greatest[k] = fmax(b->greatest[k], slope[k]);
        }
        for (int c = 0; c < 3; c++) {
            to_frame(index, index->refractor->facet[index->place[i]].corner[c], p);
            for (int k = 0; k < 2; k++) {
                double section = p[k] + slope[k] * (p[2] - b->base);
                b->lower[k] = fmin(b->lower[k], section);
                b->upper[k] = fmax(b->upper[k], section);
            }
        }
    }
}

static void bound_child(void *context, uint32_t place, int child, uint32_t first, uint32_t count)
{
    parian_refractor_index *index = context;
    prism_node *node = &index->node[place];
    prism_bounds b = {INFINITY,
                      -INFINITY,
                      {INFINITY, INFINITY},
                      {-INFINITY, -INFINITY},
                      {INFINITY, INFINITY},
                      {-INFINITY, -INFINITY}};
    if (count == 0) { /* out of reach of everything */
        b = (prism_bounds){1e15, 1e15, {1e15, 1e15}, {1e15, 1e15}, {0, 0}, {0, 0}};
    } else {
        bound_heights(index, first, count, &b);
        b.base = parian_float_below(b.base);
        bound_sections(index, first, count, &b);
    }
    node->base[child] = (float)b.base;
    node->top[child] = parian_float_above(b.top);
    for (int k = 0; k < 2; k++) {
        node->lower[k][child] = parian_float_below(b.lower[k]);
        node->upper[k][child] = parian_float_above(b.upper[k]);
        node->least[k][child] = parian_float_below(b.least[k]);
        node->greatest[k][child] = parian_float_above(b.greatest[k]);
    }
}

static parian_tree_children *children_of(void *context, uint32_t node)
{
    parian_refractor_index *index = context;
    return &index->node[node].children;
}

static parian_result make_nodes(parian_refractor_index *index)
{
    index->node_count = parian_tree_node_count(index->count, LEAF);
    if (!PARIAN_NEW(&index->env, index->node, index->node_count)) {
        return parian_fail(&index->env, PARIAN_E_NOMEM, "refracted paths: no memory for %u nodes",
                           index->node_count);
    }
    parian_tree_writer writer = {
        .context = index, .children = children_of, .bound = bound_child, .leaf = LEAF};
    parian_tree_write(&writer, 0, index->count);
    return PARIAN_OK;
}

/* A right-handed frame whose third axis is the direction. */
static void make_frame(const double direction[3], double length, double frame[3][3])
{
    int thin = 0;
    for (int k = 0; k < 3; k++) {
        frame[2][k] = direction[k] / length;
        thin = fabs(direction[k]) < fabs(direction[thin]) ? k : thin;
    }
    double axis[3] = {thin == 0, thin == 1, thin == 2};
    parian_cross3(axis, frame[2], frame[0]);
    double across = sqrt(parian_dot3(frame[0], frame[0]));
    for (int k = 0; k < 3; k++) {
        frame[0][k] /= across;
    }
    parian_cross3(frame[2], frame[0], frame[1]);
}

parian_result parian_refractor_prepare_direction(const parian_env *env,
                                                 const parian_refractor *refractor,
                                                 const double direction[3], double max_length,
                                                 parian_refractor_index **out)
{
    double length = sqrt(parian_dot3(direction, direction));
    if (!(length > 0 && isfinite(length) && max_length > 0)) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "refracted paths: direction (%g, %g, %g) and longest path %g, expected a direction and "
            "a positive length",
            direction[0], direction[1], direction[2], max_length);
    }
    parian_refractor_index *index = NULL;
    if (!PARIAN_NEW0(env, index, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "refracted paths: no memory");
    }
    index->env = env ? *env : (parian_env){0};
    index->refractor = refractor;
    make_frame(direction, length, index->frame);
    parian_result r = order_prisms(index, max_length);
    r = r == PARIAN_OK ? make_nodes(index) : r;
    if (r != PARIAN_OK) {
        parian_refractor_index_destroy(index);
        return r;
    }
    *out = index;
    return PARIAN_OK;
}

void parian_refractor_index_destroy(parian_refractor_index *index)
{
    if (index) {
        parian_env env = index->env;
        parian_free(&env, index->place);
        parian_free(&env, index->node);
        parian_free(&env, index);
    }
}

/* ---- query ---- */

typedef struct prism_query {
    const parian_refractor_index *index;
    const double *x;
    double max_length;
    uint32_t skip;
    float at[3], reach, pad; /* x in the frame; tolerances, in units of the mesh's radius */
} prism_query;

static inline unsigned test_children(const prism_query *q, const prism_node *node)
{
    four depth = four_load(node->base) - q->at[2];
    four_mask met = (depth <= q->reach) & (q->at[2] <= four_load(node->top) + q->pad);
    for (int k = 0; k < 2; k++) {
        four a = depth * four_load(node->least[k]), b = depth * four_load(node->greatest[k]);
        met &= (four_load(node->lower[k]) + four_smaller(a, b) - q->pad <= q->at[k]) &
               (q->at[k] <= four_load(node->upper[k]) + four_larger(a, b) + q->pad);
    }
    return four_bits(met);
}

static bool prepare_query(prism_query *q)
{
    const parian_refractor *r = q->index->refractor;
    double at[3], far = 0;
    to_frame(q->index, q->x, at);
    for (int k = 0; k < 3; k++) {
        q->at[k] = (float)at[k];
        far += fabs(at[k]);
    }
    q->pad = (float)(1e-6 * (1 + far) * (1 + q->index->steepest));
    q->reach = parian_float_above(fmin(q->max_length / r->radius, far + 2)) + q->pad;
    return far <= 1e15 && q->max_length >= 0;
}

void parian_refractor_index_paths_counted(const parian_refractor_index *index, const double x[3],
                                          double max_length, uint32_t skip_triangle,
                                          parian_refracted_path_found found, void *context,
                                          parian_refracted_cost *cost)
{
    prism_query q = {.index = index, .x = x, .max_length = max_length, .skip = skip_triangle};
    struct {
        uint32_t first, count;
    } stack[PARIAN_TREE_STACK];
    int size = prepare_query(&q);
    stack[0].first = 0;
    stack[0].count = PARIAN_TREE_INNER;
    while (size > 0) {
        uint32_t first = stack[--size].first, count = stack[size].count;
        if (count == PARIAN_TREE_INNER) {
            const prism_node *node = &index->node[first];
            cost->nodes++;
            unsigned pass = test_children(&q, node);
            while (pass) { /* the first child comes out first */
                int k = four_last(&pass);
                stack[size].first = node->children.first[k];
                stack[size++].count = node->children.count[k];
            }
            continue;
        }
        cost->facets += count;
        for (uint32_t i = first; i < first + count; i++) {
            const parian_refracting_facet *facet = &index->refractor->facet[index->place[i]];
            parian_refracted_path path;
            if (facet->triangle != skip_triangle &&
                parian_facet_path_from_direction(facet, &index->refractor->eta, x, index->frame[2],
                                                 max_length, &path)) {
                found(context, &path);
            }
        }
    }
}

void parian_refractor_index_paths(const parian_refractor_index *index, const double x[3],
                                  double max_length, uint32_t skip_triangle,
                                  parian_refracted_path_found found, void *context)
{
    parian_refracted_cost cost = {0, 0};
    parian_refractor_index_paths_counted(index, x, max_length, skip_triangle, found, context,
                                         &cost);
}
