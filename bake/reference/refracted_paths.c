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

typedef struct child_bounds {
    float centre[3], half[3], axis[3], spread;
} child_bounds;

static inline float larger(float a, float b)
{
    return a > b ? a : b;
}

static inline float smaller(float a, float b)
{
    return a < b ? a : b;
}

static inline float dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Direction of light at the middle of the box, and by how much it differs over the box (10 where
 * anything goes). asin(s) <= s + (pi / 2 - 1) s^3 on [0, 1], since every term of its series is
 * positive. */
static inline float light_over_box(const search *s, const child_bounds *c, bool near_by,
                                   float light[3])
{
    if (!near_by) {
        light[0] = s->light[0];
        light[1] = s->light[1];
        light[2] = s->light[2];
        return s->width;
    }
    float to[3] = {s->light[0] - c->centre[0], s->light[1] - c->centre[1],
                   s->light[2] - c->centre[2]};
    float scale = 1 / sqrtf(larger(dot(to, to), 1e-20f));
    float sine = sqrtf(dot(c->half, c->half)) * scale;
    light[0] = to[0] * scale;
    light[1] = to[1] * scale;
    light[2] = to[2] * scale;
    return sine < 1 ? 1.0001f * (sine + 0.5708f * sine * sine * sine) + 1e-6f : 10;
}

/* Half angle of the cone of refracted directions, where normals differ by up to spread from their
 * axis, and light by up to width. cos_least is a lower bound of cos_i over both, 0 where some of
 * the normals face away. */
static inline float cone_of_refraction(const search *s, bool denser, float spread, float width,
                                       float cos_least)
{
    float cos2_t = (s->excess + cos_least * cos_least) * s->inverse2;
    if (denser) {
        float K = 1 - cos_least * s->inverse / (sqrtf(larger(cos2_t, 0)) + 1e-20f);
        return K * spread + width * (cos_least > 0 ? s->inverse : 1 + K);
    }
    float K = cos_least * s->inverse / sqrtf(larger(cos2_t, 1e-3f)) - 1;
    return cos2_t > 1e-3f ? K * spread + (1 + K) * width : 10;
}

/* Whether the segment from x along q, as long as may be, meets the box grown by the width of the
 * cone. Separating axes of box and segment. d: from x to the middle of the box. */
static inline int cone_meets_box(const search *s, const child_bounds *c, const float d[3],
                                 const float q[3], float cone)
{
    float gap[3], h[3], m[3], a[3];
    float reach = smaller(s->reach, sqrtf(dot(d, d)) + sqrtf(dot(c->half, c->half)) + s->pad);
    float grown = cone * reach + s->pad, middle = 0.5f * reach;
    for (int k = 0; k < 3; k++) {
        gap[k] = larger(fabsf(d[k]) - c->half[k], 0);
        h[k] = c->half[k] + grown;
        m[k] = d[k] - q[k] * middle;
        a[k] = fabsf(q[k]);
    }
    float limit = s->reach + s->pad;
    return (dot(gap, gap) <= limit * limit) & (fabsf(m[0]) <= h[0] + a[0] * middle) &
           (fabsf(m[1]) <= h[1] + a[1] * middle) & (fabsf(m[2]) <= h[2] + a[2] * middle) &
           (fabsf(m[1] * q[2] - m[2] * q[1]) <= h[1] * a[2] + h[2] * a[1]) &
           (fabsf(m[2] * q[0] - m[0] * q[2]) <= h[2] * a[0] + h[0] * a[2]) &
           (fabsf(m[0] * q[1] - m[1] * q[0]) <= h[0] * a[1] + h[1] * a[0]);
}

/* Whether a child may hold a facet that carries a path; false only where none can. Free of
 * branches, so that four children are tested at once. */
static inline int may_carry(const search *s, const child_bounds *c, bool near_by, bool denser)
{
    float light[3], q[3], d[3];
    float width = light_over_box(s, c, near_by, light), turn = c->spread + width;
    float cos_a = dot(c->axis, light), sin_a = sqrtf(larger(1 - cos_a * cos_a, 1e-12f));
    float cos_i = larger(cos_a, 0),
          cos_t = sqrtf(larger((s->excess + cos_i * cos_i) * s->inverse2, 0));
    /* an axis that faces away is replaced by the nearest normal that does not */
    float below = smaller(cos_a, 0), scale = cos_a < 0 ? 1 / sin_a : 1,
          along = cos_t - cos_i * s->inverse;
    for (int k = 0; k < 3; k++) {
        q[k] = light[k] * s->inverse + along * scale * (c->axis[k] - below * light[k]);
        d[k] = c->centre[k] - s->x[k];
    }
    float cos_least = larger(cos_i * (1 - 0.5f * turn * turn) - sin_a * turn - 5e-4f, 0);
    float cone = 1.001f * cone_of_refraction(s, denser, c->spread, width, cos_least) + 1e-5f;
    float cos_most = cos_i + sin_a * turn;
    int crosses = denser | (turn > 1) | (cos_most * cos_most >= -0.999f * s->excess - 1e-5f);
    return crosses & (cos_a >= -turn) & cone_meets_box(s, c, d, q, cone);
}

static inline void test_children(const search *s, const parian_refractor_node *node, bool near_by,
                                 bool denser, int32_t pass[PARIAN_TREE_WIDTH])
{
    for (int k = 0; k < PARIAN_TREE_WIDTH; k++) {
        child_bounds c = {
            .centre = {node->centre[0][k], node->centre[1][k], node->centre[2][k]},
            .half = {node->half[0][k], node->half[1][k], node->half[2][k]},
            .axis = {node->axis[0][k], node->axis[1][k], node->axis[2][k]},
            .spread = node->spread[k],
        };
        pass[k] = may_carry(s, &c, near_by, denser);
    }
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
        int32_t pass[PARIAN_TREE_WIDTH];
        q->cost->nodes++;
        test_children(s, node, near_by, denser, pass);
        for (int k = PARIAN_TREE_WIDTH - 1; k >= 0; k--) {
            if (pass[k]) {
                stack[size].first = node->children.first[k];
                stack[size++].count = node->children.count[k];
            }
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
    if (!(far <= OUT_OF_SIGHT && length > 0 && isfinite(length) && q->max_length >= 0)) {
        return false;
    }
    *near_by = !q->at_infinity && length <= FAR_AWAY;
    for (int k = 0; k < 3; k++) {
        s->light[k] = (float)(*near_by ? light[k] : light[k] / length);
    }
    s->width = (float)(q->at_infinity ? 1e-6 : 1.01 / length + 1e-6);
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
