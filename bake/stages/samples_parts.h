/* samples_parts.h - what the files of the samples stage share.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_SAMPLES_PARTS_H
#define PARIAN_BAKE_SAMPLES_PARTS_H

#include <math.h>

#include "core/surface_samples.h"

/* A surface that is being sampled, and the samples so far. */
typedef struct sampling {
    const parian_sampled_surface *surface;
    double *until;       /* [triangle_count] area of the triangles up to and with this one, m^2 */
    double (*normal)[3]; /* [triangle_count] unit, or zero without area */
    double area, diagonal, lower[3], extent[3];
    uint64_t seed;

    double radius;
    parian_point_grid grid;  /* of the samples; cells as large as the radius */
    uint32_t *triangle;      /* [room] */
    float (*barycentric)[2]; /* [room] */
    uint32_t room;
    double uncovered;
} sampling;

/* Put a sample if nothing that faces alike is nearer than the radius. */
parian_result sampling_put(const parian_env *env, sampling *s, uint32_t triangle,
                           const float barycentric[2]);
/* Fill the surface from nothing with samples at a radius until nothing is left uncovered. */
parian_result sampling_fill(const parian_env *env, sampling *s, double radius);
/* Find the order in which samples are well spread: order[k] is the k-th sample, [count]. */
parian_result sampling_order(const parian_env *env, const sampling *s, uint32_t *order);
/* Give each sample the surface that is nearest to it: area [count], m^2. */
parian_result sampling_areas(const parian_env *env, const sampling *s, double *area);

static inline double sampling_triangle_area(const sampling *s, uint32_t triangle)
{
    return s->until[triangle] - (triangle > 0 ? s->until[triangle - 1] : 0);
}

static inline bool sampling_has_area(const sampling *s, uint32_t triangle)
{
    const double *n = s->normal[triangle];
    return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

/* A point inside a triangle from two uniform numbers, uniform by area. */
static inline void sampling_place(double u, double v, float barycentric[2])
{
    double root = sqrt(u);
    barycentric[0] = (float)(1 - root);
    barycentric[1] = (float)(root * (1 - v));
    if (barycentric[0] + barycentric[1] > 1.0f) {
        barycentric[1] = 1.0f - barycentric[0];
    }
}

/* A piece of a triangle: barycentrics 0 and 1 of its corners. */
typedef struct sampling_piece {
    uint32_t triangle;
    double corner[3][2];
} sampling_piece;

/* The corners' places; returns the longest edge, and which one it is (from corner k to k + 1). */
double sampling_piece_places(const sampling *s, const sampling_piece *piece, double place[3][3],
                             int *longest);
/* The two halves of a piece on either side of the middle of an edge. */
void sampling_piece_split(const sampling_piece *piece, int edge, sampling_piece half[2]);
/* Share of its triangle's area. */
double sampling_piece_share(const sampling_piece *piece);

#endif
