/* refracted_hierarchy.c - builds the tree of boxes and cones of normals over the facets of a mesh.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/refracted_hierarchy.h"

#include "core/memory.h"

enum { LEAF = 1 };

/* Coordinates beyond this are taken as not finite: their squares must not overflow. */
static const double COORDINATE_MAX = 1e100;

/* Normals next to places in the order of the tree: facets that differ by one radian are held as far
 * apart as ones this many mean facet sizes away. */
static const double NORMAL_WEIGHT = 12;

static bool make_facet(const parian_mesh *mesh, uint32_t t, parian_refracting_facet *facet)
{
    double edge[2][3], cross[3];
    facet->triangle = t;
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            facet->corner[c][k] = mesh->position[mesh->triangle[t][c]][k];
            if (!(fabs(facet->corner[c][k]) <= COORDINATE_MAX)) {
                return false;
            }
        }
    }
    for (int k = 0; k < 3; k++) {
        edge[0][k] = facet->corner[1][k] - facet->corner[0][k];
        edge[1][k] = facet->corner[2][k] - facet->corner[0][k];
    }
    parian_cross3(edge[0], edge[1], cross);
    double length = sqrt(parian_dot3(cross, cross));
    for (int k = 0; k < 3; k++) {
        facet->normal[k] = cross[k] / length;
    }
    return length > 0 && isfinite(length) && parian_dot3(facet->normal, facet->normal) > 0.5;
}

static parian_result make_facets(parian_refractor *refractor, const parian_mesh *mesh)
{
    if (!PARIAN_NEW(&refractor->env, refractor->facet, mesh->triangle_count)) {
        return parian_fail(&refractor->env, PARIAN_E_NOMEM,
                           "refracted paths: no memory for %u facets", mesh->triangle_count);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int c = 0; c < 3; c++) {
            if (mesh->triangle[t][c] >= mesh->vertex_count) {
                return parian_fail(&refractor->env, PARIAN_E_ARGUMENT,
                                   "refracted paths: triangle %u names vertex %u of %u", t,
                                   mesh->triangle[t][c], mesh->vertex_count);
            }
        }
        refractor->facet_count += make_facet(mesh, t, &refractor->facet[refractor->facet_count]);
    }
    return PARIAN_OK;
}

/* A ball around all facets: the middle of their box, and the farthest corner from it. */
static void find_ball(parian_refractor *refractor)
{
    double lower[3] = {INFINITY, INFINITY, INFINITY}, upper[3] = {-INFINITY, -INFINITY, -INFINITY},
           far2 = 0;
    for (size_t i = 0; i < (size_t)refractor->facet_count * 9; i++) {
        double value = refractor->facet[i / 9].corner[i / 3 % 3][i % 3];
        lower[i % 3] = fmin(lower[i % 3], value);
        upper[i % 3] = fmax(upper[i % 3], value);
    }
    for (int k = 0; k < 3; k++) {
        refractor->centre[k] = refractor->facet_count > 0 ? 0.5 * (lower[k] + upper[k]) : 0;
    }
    for (size_t i = 0; i < (size_t)refractor->facet_count * 3; i++) {
        const double *p = refractor->facet[i / 3].corner[i % 3];
        double d[3] = {p[0] - refractor->centre[0], p[1] - refractor->centre[1],
                       p[2] - refractor->centre[2]};
        far2 = fmax(far2, parian_dot3(d, d));
    }
    refractor->radius = far2 > 0 ? sqrt(far2) : 1;
}

/* Put the facets into the order of the tree. */
static parian_result order_facets(parian_refractor *refractor)
{
    uint32_t n = refractor->facet_count;
    parian_tree_item *item = NULL;
    parian_refracting_facet *sorted = NULL;
    if (!PARIAN_NEW(&refractor->env, item, n) || !PARIAN_NEW(&refractor->env, sorted, n)) {
        parian_free(&refractor->env, item);
        return parian_fail(&refractor->env, PARIAN_E_NOMEM,
                           "refracted paths: no memory to sort %u facets", n);
    }
    double weight =
        NORMAL_WEIGHT * sqrt(4 * PARIAN_PI / (n + 1.0)); /* a mean facet of a ball of radius 1 */
    for (uint32_t i = 0; i < n; i++) {
        const parian_refracting_facet *f = &refractor->facet[i];
        item[i].facet = i;
        for (int k = 0; k < 3; k++) {
            double middle = (f->corner[0][k] + f->corner[1][k] + f->corner[2][k]) / 3;
            item[i].key[k] = (float)((middle - refractor->centre[k]) / refractor->radius);
            item[i].key[3 + k] = (float)(weight * f->normal[k]);
        }
    }
    parian_tree_order(item, n, LEAF);
    for (uint32_t i = 0; i < n; i++) {
        sorted[i] = refractor->facet[item[i].facet];
    }
    parian_free(&refractor->env, refractor->facet);
    parian_free(&refractor->env, item);
    refractor->facet = sorted;
    return PARIAN_OK;
}

static void bound_box(const parian_refractor *refractor, parian_refractor_node *node, int child,
                      uint32_t first, uint32_t count)
{
    for (int k = 0; k < 3; k++) {
        double lower = INFINITY, upper = -INFINITY;
        for (uint32_t i = 3 * first; i < 3 * (first + count); i++) {
            double value = refractor->facet[i / 3].corner[i % 3][k];
            lower = fmin(lower, value);
            upper = fmax(upper, value);
        }
        lower = (lower - refractor->centre[k]) / refractor->radius;
        upper = (upper - refractor->centre[k]) / refractor->radius;
        float centre = (float)(0.5 * (lower + upper));
        node->centre[k][child] = centre;
        node->half[k][child] =
            parian_float_above(fmax(upper - (double)centre, (double)centre - lower));
    }
}

static void bound_normals(const parian_refractor *refractor, parian_refractor_node *node, int child,
                          uint32_t first, uint32_t count)
{
    double sum[3] = {0, 0, 0}, axis[3], least = 1;
    for (uint32_t i = first; i < first + count; i++) {
        for (int k = 0; k < 3; k++) {
            sum[k] += refractor->facet[i].normal[k];
        }
    }
    double length = sqrt(parian_dot3(sum, sum));
    for (int k = 0; k < 3; k++) {
        axis[k] = length > 1e-6 ? sum[k] / length : k == 0;
        node->axis[k][child] = (float)axis[k];
    }
    for (uint32_t i = first; i < first + count; i++) {
        least = fmin(least, parian_dot3(axis, refractor->facet[i].normal));
    }
    node->spread[child] =
        (float)(acos(fmax(least, -1)) + 2e-6); /* of axis as floats, of acos near 1 */
}

static void bound_child(void *context, uint32_t index, int child, uint32_t first, uint32_t count)
{
    parian_refractor *refractor = context;
    parian_refractor_node *node = &refractor->node[index];
    if (count > 0) {
        bound_box(refractor, node, child, first, count);
        bound_normals(refractor, node, child, first, count);
        return;
    }
    for (int k = 0; k < 3; k++) { /* out of reach of everything */
        node->centre[k][child] = 1e15f;
        node->half[k][child] = 0;
        node->axis[k][child] = k == 0;
    }
    node->spread[child] = 0;
}

static parian_tree_children *children_of(void *context, uint32_t index)
{
    parian_refractor *refractor = context;
    return &refractor->node[index].children;
}

static parian_result make_nodes(parian_refractor *refractor)
{
    refractor->node_count = parian_tree_node_count(refractor->facet_count, LEAF);
    if (!PARIAN_NEW(&refractor->env, refractor->node, refractor->node_count)) {
        return parian_fail(&refractor->env, PARIAN_E_NOMEM,
                           "refracted paths: no memory for %u nodes", refractor->node_count);
    }
    parian_tree_writer writer = {
        .context = refractor, .children = children_of, .bound = bound_child, .leaf = LEAF};
    parian_tree_write(&writer, 0, refractor->facet_count);
    return PARIAN_OK;
}

parian_result parian_refractor_create(const parian_env *env, const parian_mesh *mesh, double eta,
                                      parian_refractor **out)
{
    if (!(eta > 0 && isfinite(eta))) {
        return parian_fail(
            env, PARIAN_E_ARGUMENT,
            "refracted paths: the index of refraction is %g, expected a positive number", eta);
    }
    parian_refractor *refractor = NULL;
    if (!PARIAN_NEW0(env, refractor, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "refracted paths: no memory");
    }
    refractor->env = env ? *env : (parian_env){0};
    refractor->eta = (parian_refracting_eta){eta, 1 / eta, 1 / (eta * eta), (eta - 1) * (eta + 1)};
    parian_result r = make_facets(refractor, mesh);
    if (r == PARIAN_OK) {
        find_ball(refractor);
        r = order_facets(refractor);
    }
    r = r == PARIAN_OK ? make_nodes(refractor) : r;
    if (r != PARIAN_OK) {
        parian_refractor_destroy(refractor);
        return r;
    }
    *out = refractor;
    return PARIAN_OK;
}

void parian_refractor_destroy(parian_refractor *refractor)
{
    if (refractor) {
        parian_env env = refractor->env;
        parian_free(&env, refractor->facet);
        parian_free(&env, refractor->node);
        parian_free(&env, refractor);
    }
}
