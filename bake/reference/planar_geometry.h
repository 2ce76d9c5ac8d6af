/* planar_geometry.h - where a straight flight leaves a half-space, a slab or a ball, and what total
 * reflection does there. Inline, for these are inner loops.
 *
 * Planes: the medium is at -size < z < 0, lit from +z at the origin. Sphere: centre at the origin,
 * lit at (0, 0, size).
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_PLANAR_GEOMETRY_H
#define PARIAN_BAKE_PLANAR_GEOMETRY_H

#include "bake/reference/planar.h"

typedef struct planar_ray {
    double position[3], direction[3];
} planar_ray;

static inline void planar_advance(planar_ray *ray, double length)
{
    for (int k = 0; k < 3; k++) {
        ray->position[k] += length * ray->direction[k];
    }
}

static inline double planar_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Distance to the boundary; INFINITY where there is none ahead. */
static inline double planar_distance(parian_planar_shape shape, double size, const planar_ray *ray)
{
    if (shape == PARIAN_SPHERE) {
        double along = planar_dot(ray->position, ray->direction);
        double depth = size * size - planar_dot(ray->position, ray->position);
        return sqrt(along * along + (depth > 0 ? depth : 0)) - along;
    }
    double z = ray->position[2], dz = ray->direction[2];
    if (dz > 0) {
        return -z / dz;
    }
    return shape == PARIAN_SLAB && dz < 0 ? (size + z) / -dz : INFINITY;
}

/* Put a ray that went planar_distance exactly on the boundary; the outward normal there. */
static inline void planar_land(parian_planar_shape shape, double size, planar_ray *ray,
                               double normal[3])
{
    if (shape == PARIAN_SPHERE) {
        double ratio = planar_dot(ray->position, ray->position) / (size * size);
        for (int k = 0; k < 3; k++) {
            ray->position[k] *= 1.5 - 0.5 * ratio; /* a step of Newton towards length size */
            normal[k] = ray->position[k] / size;
        }
        return;
    }
    bool far_side = shape == PARIAN_SLAB && ray->direction[2] < 0;
    ray->position[2] = far_side ? -size : 0;
    normal[0] = normal[1] = 0;
    normal[2] = far_side ? -1 : 1;
}

/* Total reflection goes on at the same angle for ever: after one, take all whole hops of a flight
 * of `length` at once. Returns what is left of it; without this, flights far longer than the body
 * would take as many hops. */
static inline double planar_skip_slab(double size, planar_ray *ray, double length)
{
    double hop = size / fabs(ray->direction[2]);
    if (!(length > 8 * hop)) {
        return length;
    }
    double count = floor(length / hop);
    ray->position[0] += count * hop * ray->direction[0];
    ray->position[1] += count * hop * ray->direction[1];
    if (fmod(count, 2) == 1) {
        ray->position[2] = -size - ray->position[2];
        ray->direction[2] = -ray->direction[2];
    }
    return fmax(length - count * hop, 0);
}

/* The same in a ball, where each hop turns the ray in its plane by the same angle; cosine is that
 * of the angle to the normal. */
static inline double planar_skip_sphere(double size, double cosine, planar_ray *ray, double length)
{
    double hop = 2 * size * cosine, sine = sqrt(1 - cosine * cosine), angle, rest = 0;
    if (!(length > 8 * hop)) {
        return length;
    }
    if (cosine > 1e-12) {
        double count = floor(length / hop);
        angle = count * 2 * asin(cosine);
        rest = fmax(length - count * hop, 0);
    } else {
        angle = length / size; /* along the surface */
    }
    double c = cos(angle), s = sin(angle);
    for (int k = 0; k < 3; k++) {
        double out = ray->position[k] / size;
        double tangent = (ray->direction[k] + cosine * out) / sine;
        double turned = c * out + s * tangent;
        ray->position[k] = size * turned;
        ray->direction[k] = sine * (c * tangent - s * out) - cosine * turned;
    }
    return rest;
}

/* Distance from the entry point along the surface: radius or arc. */
static inline double planar_reach(parian_planar_shape shape, double size, const double position[3])
{
    double radius = sqrt(position[0] * position[0] + position[1] * position[1]);
    return shape == PARIAN_SPHERE ? size * atan2(radius, position[2]) : radius;
}

#endif
