/* implicit.h - solids as scalar fields: negative inside, about the distance to the surface near it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_IMPLICIT_H
#define PARIAN_ASSETS_IMPLICIT_H

#include "model_vec.h"

/* A field grows by at most about 1 per unit of length, so that |value| bounds the distance from
 * below. */
typedef double (*field_function)(vec3 p);

/* A right-handed local frame; y is the second axis. */
typedef struct frame {
    vec3 origin, x, y, z;
} frame;

/* The frame at origin whose z is `z` and whose y is as near to `up` as can be. */
frame frame_make(vec3 origin, vec3 z, vec3 up);
vec3 frame_local(const frame *f, vec3 p);

/* 0 below a, 1 above b, smooth between; also for a > b. */
double smoothstep(double a, double b, double t);

double solid_sphere(vec3 p, vec3 center, double radius);
/* Axis-aligned; near the surface within a few per cent of the distance for mild aspect ratios. */
double solid_ellipsoid(vec3 p, vec3 center, vec3 radii);
/* The hull of two spheres. */
double solid_cone(vec3 p, vec3 a, vec3 b, double radius_a, double radius_b);
/* A torus about y. */
double solid_torus(vec3 p, vec3 center, double ring_radius, double radius);
/* A plate of half thickness h and rounded rim over an outline of signed distance `outline`;
 * `across` is the height over the plate's middle. */
double solid_plate(double outline, double across, double h);

/* Union, intersection and difference that blend over a width of about k. */
double solid_join(double a, double b, double k);
double solid_meet(double a, double b, double k);
double solid_cut(double a, double b, double k);

/* A chain of spheres along the Catmull-Rom curve through `count` (2 to 16) points with radii
 * `radius`. Returns the field; *along (may be NULL) is the curve parameter of the nearest part, 0
 * at the first point and count - 1 at the last. */
double solid_tube(vec3 p, const vec3 *point, const double *radius, int count, double *along);

/* Smooth noise in about [-1, 1], features of size 1; the same everywhere. */
double noise3(vec3 p);

#endif
