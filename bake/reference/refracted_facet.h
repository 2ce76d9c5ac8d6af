/* refracted_facet.h - the path of light through one flat facet to a point inside: Snell, Fresnel,
 * flux.
 *
 * A ray tube of solid angle dOmega from a point light at height h1 above the facet's plane spreads,
 * at a point h2 below it, over dA_perp = r dphi * dr cos_t with r = h1 tan_i + h2 tan_t. The factor
 * T dOmega / dA_perp is written without sin_i, r or a bare 1 / cos_t, so that normal incidence and
 * total reflection are ordinary values.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_REFRACTED_FACET_H
#define PARIAN_BAKE_REFRACTED_FACET_H

#include <math.h>

#include "bake/reference/refracted_paths.h"
#include "core/small_maths.h"

typedef struct parian_refracting_facet {
    double corner[3][3]; /* counterclockwise seen from outside, metres */
    double normal[3];    /* unit, outward */
    uint32_t triangle;   /* of the mesh */
} parian_refracting_facet;

/* eta and what is computed from it once. */
typedef struct parian_refracting_eta {
    double eta, inverse, inverse2; /* eta, 1 / eta, 1 / eta^2 */
    double excess;                 /* eta^2 - 1 */
} parian_refracting_eta;

/* T cos_i / cos_t of unpolarised light, both cosines positive: finite up to total reflection. */
static inline double parian_refracted_gain(double eta, double cos_i, double cos_t)
{
    double s = cos_i / (cos_i + eta * cos_t), p = cos_i / (eta * cos_i + cos_t);
    return 2 * eta * (s * s + p * p);
}

/* Tangent, on the optically thinner side, of the one path between points at heights h_thin and
 * h_dense from a plane, r apart along it; index >= 1 is dense over thin. The function is concave
 * and rises, so that Newton's steps from zero approach the root from below and never pass it.
 * INFINITY where there is none (h_thin = 0). */
static inline double parian_refracted_tangent(double h_thin, double h_dense, double index, double r)
{
    enum { STEPS = 100 };
    double square = index * index, excess = (index - 1) * (index + 1);
    double k = r / (h_thin + h_dense / index);
    for (int i = 0; i < STEPS; i++) {
        double root2 = square + excess * k * k, root = sqrt(root2);
        double rest = r - (h_thin + h_dense / root) * k;
        double step = rest / (h_thin + h_dense * square / (root2 * root));
        if (!(step > 1e-15 * k)) {
            return k;
        }
        k += step;
    }
    return h_thin > 0 ? k : INFINITY;
}

/* On which side of the line through x along out an edge a-b passes (both relative to x): the sign
 * is that of out . (a x b), bit for bit opposite for b-a. A line that meets the edge is moved by a
 * fixed infinitesimal offset, so that exactly one of the facets around an edge or a corner has it
 * inside. */
static inline bool parian_edge_is_left(const double out[3], const double a[3], const double b[3])
{
    static const double offset[2][3] = {{0.57, 0.21, 0.79}, {-0.38, 0.91, 0.16}};
    double cross[3];
    parian_cross3(a, b, cross);
    double side = parian_dot3(out, cross);
    double edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    for (int k = 0; side == 0 && k < 2; k++) {
        parian_cross3(edge, offset[k], cross);
        side = parian_dot3(out, cross);
    }
    return side > 0;
}

/* Whether the line through x along out (outward, unit) meets the facet. */
static inline bool parian_facet_is_met(const parian_refracting_facet *facet, const double x[3],
                                       const double out[3])
{
    double a[3][3];
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            a[c][k] = facet->corner[c][k] - x[k];
        }
    }
    return parian_edge_is_left(out, a[0], a[1]) && parian_edge_is_left(out, a[1], a[2]) &&
           parian_edge_is_left(out, a[2], a[0]);
}

/* Height of the facet's plane above x, along the normal. */
static inline double parian_facet_height(const parian_refracting_facet *facet, const double x[3])
{
    double d[3] = {facet->corner[0][0] - x[0], facet->corner[0][1] - x[1],
                   facet->corner[0][2] - x[2]};
    return parian_dot3(facet->normal, d);
}

/* The path from a direction of light through the facet to x. light: unit, towards the light. */
static inline bool parian_facet_path_from_direction(const parian_refracting_facet *facet,
                                                    const parian_refracting_eta *e,
                                                    const double x[3], const double light[3],
                                                    double max_length, parian_refracted_path *path)
{
    const double *n = facet->normal;
    double cos_i = parian_dot3(n, light), h = parian_facet_height(facet, x);
    double cos2_t = (e->excess + cos_i * cos_i) * e->inverse2;
    if (!(cos_i > 0 && h >= 0 && cos2_t > 0)) {
        return false;
    }
    double cos_t = sqrt(cos2_t), length = h / cos_t, c = cos_t - cos_i * e->inverse, out[3];
    for (int k = 0; k < 3; k++) {
        out[k] = light[k] * e->inverse + c * n[k];
    }
    if (!(length <= max_length) || !parian_facet_is_met(facet, x, out)) {
        return false;
    }
    path->triangle = facet->triangle;
    for (int k = 0; k < 3; k++) {
        path->entry[k] = x[k] + length * out[k];
        path->to_light[k] = light[k];
        path->into[k] = -out[k];
    }
    path->light_distance = INFINITY;
    path->length = length;
    path->factor = parian_refracted_gain(e->eta, cos_i, cos_t);
    return true;
}

/* The path from a point of light through the facet to x. */
static inline bool parian_facet_path_from_point(const parian_refracting_facet *facet,
                                                const parian_refracting_eta *e, const double x[3],
                                                const double light[3], double max_length,
                                                parian_refracted_path *path)
{
    const double *n = facet->normal;
    double h1 = -parian_facet_height(facet, light), h2 = parian_facet_height(facet, x), along[3],
           out[3];
    if (!(h1 > 0 && h2 >= 0 && h2 <= max_length)) {
        return false;
    }
    double d[3] = {x[0] - light[0], x[1] - light[1], x[2] - light[2]}, drop = parian_dot3(d, n);
    for (int k = 0; k < 3; k++) {
        along[k] = d[k] - drop * n[k];
    }
    double r = sqrt(parian_dot3(along, along)), cos_i, cos_t;
    if (e->excess >= 0) {
        double tan_i = parian_refracted_tangent(h1, h2, e->eta, r);
        cos_i = 1 / sqrt(1 + tan_i * tan_i);
        cos_t = sqrt(e->excess + cos_i * cos_i) * e->inverse;
    } else {
        double tan_t = parian_refracted_tangent(h2, h1, e->inverse, r);
        cos_t = 1 / sqrt(1 + tan_t * tan_t);
        cos_i = sqrt(e->eta * e->eta * cos_t * cos_t - e->excess);
    }
    double length = h2 / cos_t;
    if (!(cos_i > 0 && cos_t > 0 && length <= max_length)) {
        return false;
    }
    double sine = cos_i * cos_t * e->eta / (h1 * e->eta * cos_t + h2 * cos_i); /* sin_i / r */
    for (int k = 0; k < 3; k++) {
        out[k] = cos_t * n[k] - along[k] * sine * e->inverse;
    }
    if (!parian_facet_is_met(facet, x, out)) {
        return false;
    }
    path->triangle = facet->triangle;
    for (int k = 0; k < 3; k++) {
        path->entry[k] = x[k] + length * out[k];
        path->to_light[k] = cos_i * n[k] - along[k] * sine;
        path->into[k] = -out[k];
    }
    path->light_distance = h1 / cos_i;
    path->length = length;
    double cube_i = cos_i * cos_i * cos_i, cube_t = cos_t * cos_t * cos_t;
    double spread =
        e->eta * cos_i * cube_t / (h1 * e->eta * cube_t + h2 * cube_i); /* di / (dr cos_i) */
    path->factor = parian_refracted_gain(e->eta, cos_i, cos_t) * sine * spread;
    return true;
}

#endif
