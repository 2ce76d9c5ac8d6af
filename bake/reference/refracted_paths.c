/* refracted_paths.c - finds the facets that carry a refracted path to a point, for any light.
 *
 * A subtree holds no path where no refracted direction can lead from its box to x. The refracted
 * direction of the mean normal for light to the middle of the box is the axis of a cone that holds
 * the directions of all: refraction moves by at most K for each radian that the normal turns, by at
 * most M for each radian that the light turns, K = |1 - cos_i / (eta cos_t)| at the largest
 * incidence, M the larger of 1 / eta and cos_i / (eta cos_t). The segment from x along the axis has
 * to meet the box grown by the width of the cone. [Walter09] bounds the half-vector instead; this
 * is the same condition seen from x, narrower by about K.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/refracted_paths.h"

#include "bake/reference/refracted_four.h"
#include "bake/reference/refracted_hierarchy.h"

/* Points of light farther than this, in radii of the mesh, are searched as directions with a width.
 */
static const double FAR_AWAY = 1e3;
/* x farther than this, in radii, has no paths: squares of floats would overflow. */
static const double OUT_OF_SIGHT = 1e15;

/* A query in units of the mesh's radius about its centre. */
typedef struct search {
    float x[3];
    float light[3]; /* unit direction, or the point */
    float width;    /* radians by which the direction differs over the mesh */
    float reach, pad;
    float inverse, inverse2, excess;
} search;

/* The four children of a node. */
typedef struct child_bounds {
    four centre[3], half[3], axis[3], spread, radius;
} child_bounds;

/* Direction of light at the middle of the boxes; returns by how much it differs over them (10 where
 * anything goes). asin(s) <= s + (pi / 2 - 1) s^3 on [0, 1], since every term of its series is
 * positive. */
static inline four light_over_boxes(const search *s, const child_bounds *c, bool near_by,
                                    four light[3])
{
    if (!near_by) {
        for (int k = 0; k < 3; k++) {
            light[k] = four_of(s->light[k]);
        }
        return four_of(s->width);
    }
    four to[3];
    for (int k = 0; k < 3; k++) {
        to[k] = s->light[k] - c->centre[k];
    }
    four scale = 1 / four_sqrt(four_larger(four_dot(to, to), four_of(1e-20f)));
    four sine = c->radius * scale;
    for (int k = 0; k < 3; k++) {
        light[k] = to[k] * scale;
    }
    four angle = 1.0001f * (sine + 0.5708f * sine * sine * sine) + 1e-6f;
    return four_where(sine < 1, angle, four_of(10));
}

/* Half angle of the cones of refracted directions, where normals differ by up to spread from their
 * axis, and light by up to width. cos_first and cos_least are lower bounds of cos_i once the light,
 * and then the normal, has turned, 0 where some of the normals face away. K rises with incidence,
 * and is convex: its mean over the normal's turn is at most that of its ends, or K at the end where
 * the turn goes beyond the horizon. */
static inline four cones_of_refraction(const search *s, bool denser, four spread, four width,
                                       four cos_first, four cos_least)
{
    four cos2_t = (s->excess + cos_least * cos_least) * s->inverse2;
    four cos2_first = (s->excess + cos_first * cos_first) * s->inverse2;
    four least2 = four_of(denser ? 1e-30f : 1e-3f);
    four m = cos_least * s->inverse / four_sqrt(four_larger(cos2_t, least2));
    four m_first = cos_first * s->inverse / four_sqrt(four_larger(cos2_first, least2));
    if (denser) {
        four_mask whole = cos_least > 0;
        four K = four_where(whole, 1 - 0.5f * (m + m_first), four_of(1));
        K = s->excess > 0 ? K : four_of(0); /* light goes straight on */
        return K * spread + four_where(whole, four_of(s->inverse), four_of(2)) * width;
    }
    four cone = (0.5f * (m + m_first) - 1) * spread + m * width;
    return four_where(cos2_t > 1e-3f, cone, four_of(10));
}

/* Whether the segments from x along q, as long as may be, meet the boxes grown by the width of the
 * cones: separating axes of box and segment. d: from x to the middle of the box. */
static inline four_mask cones_meet_boxes(const search *s, const child_bounds *c, const four d[3],
                                         const four q[3], four cone)
{
    four gap[3], h[3], m[3], a[3], limit = four_of(s->reach + s->pad);
    four reach = four_smaller(four_of(s->reach), four_sqrt(four_dot(d, d)) + c->radius + s->pad);
    four grown = cone * reach + s->pad, middle = 0.5f * reach;
    for (int k = 0; k < 3; k++) {
        gap[k] = four_larger(four_abs(d[k]) - c->half[k], four_of(0));
        h[k] = c->half[k] + grown;
        m[k] = d[k] - q[k] * middle;
        a[k] = four_abs(q[k]);
    }
    four_mask meets = four_dot(gap, gap) <= limit * limit;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        meets &= four_abs(m[k]) <= h[k] + a[k] * middle;
        meets &= four_abs(m[i] * q[j] - m[j] * q[i]) <= h[i] * a[j] + h[j] * a[i];
    }
    return meets;
}

/* Which children may hold a facet that carries a path; a lane is clear only where none can. */
static inline four_mask may_carry(const search *s, const child_bounds *c, bool near_by, bool denser)
{
    four light[3], q[3], d[3], zero = four_of(0);
    four width = light_over_boxes(s, c, near_by, light), turn = c->spread + width;
    four cos_a = four_dot(c->axis, light);
    four sin_a = four_sqrt(four_larger(1 - cos_a * cos_a, four_of(1e-12f)));
    four cos_i = four_larger(cos_a, zero);
    four cos_t = four_sqrt(four_larger((s->excess + cos_i * cos_i) * s->inverse2, zero));
    /* an axis that faces away is replaced by the nearest normal that does not */
    four below = four_smaller(cos_a, zero);
    four along = (cos_t - cos_i * s->inverse) * four_where(cos_a < 0, 1 / sin_a, four_of(1));
    for (int k = 0; k < 3; k++) {
        q[k] = light[k] * s->inverse + along * (c->axis[k] - below * light[k]);
        d[k] = c->centre[k] - s->x[k];
    }
    four cos_least = four_larger(cos_i * (1 - 0.5f * turn * turn) - sin_a * turn - 5e-4f, zero);
    four cos_first = four_larger(cos_i * (1 - 0.5f * width * width) - sin_a * width - 5e-4f, zero);
    four cone = cones_of_refraction(s, denser, c->spread, width, cos_first, cos_least);
    cone = 1.001f * cone + 1e-5f;
    four_mask met = (cos_a >= -turn) & cones_meet_boxes(s, c, d, q, cone);
    if (!denser) { /* all may be reflected totally */
        four cos_most = cos_i + sin_a * turn;
        met &= (turn > 1) | (cos_most * cos_most >= -0.999f * s->excess - 1e-5f);
    }
    return met;
}

static inline unsigned test_children(const search *s, const parian_refractor_node *node,
                                     bool near_by, bool denser)
{
    child_bounds c;
    for (int k = 0; k < 3; k++) {
        c.centre[k] = four_load(node->centre[k]);
        c.half[k] = four_load(node->half[k]);
        c.axis[k] = four_load(node->axis[k]);
    }
    c.spread = four_load(node->spread);
    c.radius = four_sqrt(four_dot(c.half, c.half));
    return four_bits(may_carry(s, &c, near_by, denser));
}

/* What is asked, in metres. */
typedef struct query {
    const parian_refractor *refractor;
    const double *x, *light;
    bool at_infinity;
    double max_length;
    uint32_t skip;
    parian_refracted_path_found found;
    void *context;
    parian_refracted_cost *cost;
} query;

static void try_facets(const query *q, uint32_t first, uint32_t count)
{
    const parian_refractor *r = q->refractor;
    q->cost->facets += count;
    for (uint32_t i = first; i < first + count; i++) {
        parian_refracted_path path;
        const parian_refracting_facet *facet = &r->facet[i];
        if (facet->triangle != q->skip &&
            (q->at_infinity ? parian_facet_path_from_direction(facet, &r->eta, q->x, q->light,
                                                               q->max_length, &path)
                            : parian_facet_path_from_point(facet, &r->eta, q->x, q->light,
                                                           q->max_length, &path))) {
            q->found(q->context, &path);
        }
    }
}

static inline void visit(const query *q, const search *s, bool near_by, bool denser)
{
    struct {
        uint32_t first, count;
    } stack[PARIAN_TREE_STACK];
    int size = 1;
    stack[0].first = 0;
    stack[0].count = PARIAN_TREE_INNER;
    while (size > 0) {
        uint32_t first = stack[--size].first, count = stack[size].count;
        if (count != PARIAN_TREE_INNER) {
            try_facets(q, first, count);
            continue;
        }
        const parian_refractor_node *node = &q->refractor->node[first];
        q->cost->nodes++;
        unsigned pass = test_children(s, node, near_by, denser);
        while (pass) { /* the first child comes out first */
            int k = four_last(&pass);
            stack[size].first = node->children.first[k];
            stack[size++].count = node->children.count[k];
        }
    }
}

/* The query in the units of the tree; false where it has no paths. near_by: the light is searched
 * as a point. */
static bool prepare_search(const query *q, search *s, bool *near_by)
{
    const parian_refractor *r = q->refractor;
    double light[3], x2 = 0, light2 = 0;
    for (int k = 0; k < 3; k++) {
        double x = (q->x[k] - r->centre[k]) / r->radius;
        light[k] = q->at_infinity ? q->light[k] : (q->light[k] - r->centre[k]) / r->radius;
        x2 += x * x;
        light2 += light[k] * light[k];
        s->x[k] = (float)x;
    }
    double far = sqrt(x2), length = sqrt(light2);
    bool placed =
        isfinite(length) && (length > 0 || !q->at_infinity); /* a lamp may be at the centre */
    if (!(far <= OUT_OF_SIGHT && placed && q->max_length >= 0)) {
        return false;
    }
    *near_by = !q->at_infinity && length <= FAR_AWAY;
    for (int k = 0; k < 3; k++) {
        s->light[k] = (float)(*near_by ? light[k] : light[k] / length);
    }
    s->width =
        (float)(q->at_infinity ? 1e-6 : 1.01 / fmax(length, 1) + 1e-6); /* of far ones alone */
    s->reach = parian_float_above(fmin(q->max_length / r->radius, far + 2));
    s->pad = (float)(2e-6 * (1 + far));
    s->inverse = (float)r->eta.inverse;
    s->inverse2 = (float)r->eta.inverse2;
    s->excess = (float)r->eta.excess;
    return true;
}

void parian_refracted_paths_counted(const parian_refractor *refractor, const double x[3],
                                    const parian_light_point *light, double max_length,
                                    uint32_t skip_triangle, parian_refracted_path_found found,
                                    void *context, parian_refracted_cost *cost)
{
    query q = {.refractor = refractor,
               .x = x,
               .light = light->at_infinity ? light->direction : light->position,
               .at_infinity = light->at_infinity,
               .max_length = max_length,
               .skip = skip_triangle,
               .found = found,
               .context = context,
               .cost = cost};
    search s;
    bool near_by, denser = refractor->eta.excess >= 0;
    if (!prepare_search(&q, &s, &near_by)) {
        return;
    }
    if (near_by && denser) {
        visit(&q, &s, true, true);
    } else if (near_by) {
        visit(&q, &s, true, false);
    } else if (denser) {
        visit(&q, &s, false, true);
    } else {
        visit(&q, &s, false, false);
    }
}

void parian_refracted_paths(const parian_refractor *refractor, const double x[3],
                            const parian_light_point *light, double max_length,
                            uint32_t skip_triangle, parian_refracted_path_found found,
                            void *context)
{
    parian_refracted_cost cost = {0, 0};
    parian_refracted_paths_counted(refractor, x, light, max_length, skip_triangle, found, context,
                                   &cost);
}
