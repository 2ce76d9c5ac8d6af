/* implicit.c - frames, primitive solids, smooth set operations and noise.
 *
 * SPDX-License-Identifier: MIT
 */
#include "implicit.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

enum { TUBE_STEPS = 6, TUBE_POINTS_MAX = 16 }; /* TUBE_STEPS: cones per span of a tube */

frame frame_make(vec3 origin, vec3 z, vec3 up)
{
    frame f;
    f.origin = origin;
    f.z = v3_normalize(z);
    f.x = v3_normalize(v3_cross(up, f.z));
    f.y = v3_cross(f.z, f.x);
    return f;
}

vec3 frame_local(const frame *f, vec3 p)
{
    vec3 d = v3_sub(p, f->origin);
    return v3(v3_dot(d, f->x), v3_dot(d, f->y), v3_dot(d, f->z));
}

double smoothstep(double a, double b, double t)
{
    double s = clamp01((t - a) / (b - a));
    return s * s * (3 - 2 * s);
}

double solid_sphere(vec3 p, vec3 center, double radius)
{
    return v3_length(v3_sub(p, center)) - radius;
}

double solid_ellipsoid(vec3 p, vec3 center, vec3 radii)
{
    vec3 d = v3_sub(p, center);
    vec3 a = v3(d.x / radii.x, d.y / radii.y, d.z / radii.z);
    vec3 b = v3(a.x / radii.x, a.y / radii.y, a.z / radii.z);
    double smallest = fmin(radii.x, fmin(radii.y, radii.z));
    double k = v3_length(a), g = v3_length(b);
    return k < 0.2 ? -0.8 * smallest : fmax(k * (k - 1) / g, -smallest);
}

double solid_cone(vec3 p, vec3 a, vec3 b, double radius_a, double radius_b)
{
    vec3 axis = v3_sub(b, a), d = v3_sub(p, a);
    double length = v3_length(axis);
    if (length <= fabs(radius_a - radius_b)) { /* one sphere holds the other */
        return radius_a > radius_b ? v3_length(d) - radius_a : solid_sphere(p, b, radius_b);
    }
    double t = v3_dot(d, axis) / length;
    double across = sqrt(fmax(v3_dot(d, d) - t * t, 0));
    double sine = (radius_a - radius_b) / length, cosine = sqrt(1 - sine * sine);
    double s = t - across * sine / cosine; /* where the foot of the slanted perpendicular lies */
    if (s < 0) {
        return v3_length(d) - radius_a;
    }
    if (s > length) {
        return solid_sphere(p, b, radius_b);
    }
    return across * cosine + t * sine - radius_a;
}

double solid_torus(vec3 p, vec3 center, double ring_radius, double radius)
{
    vec3 d = v3_sub(p, center);
    return length2(length2(d.x, d.z) - ring_radius, d.y) - radius;
}

double solid_plate(double outline, double across, double h)
{
    return length2(fmax(outline + h, 0), across) - h;
}

double solid_join(double a, double b, double k)
{
    double h = fmax(k - fabs(a - b), 0) / k;
    return fmin(a, b) - h * h * k * 0.25;
}

double solid_meet(double a, double b, double k)
{
    return -solid_join(-a, -b, k);
}

double solid_cut(double a, double b, double k)
{
    return solid_meet(a, -b, k);
}

/* A span of a Catmull-Rom curve: its end points and their neighbours. */
typedef struct span_points {
    vec3 p0, p1, p2, p3;
} span_points;

static span_points span_at(const vec3 *point, int count, int span)
{
    span_points s = {.p1 = point[span], .p2 = point[span + 1]};
    s.p0 = span > 0 ? point[span - 1] : v3_sub(v3_scale(s.p1, 2), s.p2);
    s.p3 = span + 2 < count ? point[span + 2] : v3_sub(v3_scale(s.p2, 2), s.p1);
    return s;
}

static vec3 span_point(const span_points *s, double t)
{
    double t2 = t * t, t3 = t2 * t;
    vec3 sum = v3_scale(s->p0, -0.5 * t3 + t2 - 0.5 * t);
    sum = v3_add(sum, v3_scale(s->p1, 1.5 * t3 - 2.5 * t2 + 1));
    sum = v3_add(sum, v3_scale(s->p2, -1.5 * t3 + 2 * t2 + 0.5 * t));
    return v3_add(sum, v3_scale(s->p3, 0.5 * t3 - 0.5 * t2));
}

/* No point of the span is nearer to p: its Bezier control points lie in a ball about its middle. */
static double span_distance_min(const span_points *s, vec3 p)
{
    double ends = 0.5 * v3_length(v3_sub(s->p2, s->p1));
    double handle = fmax(v3_length(v3_sub(s->p2, s->p0)), v3_length(v3_sub(s->p3, s->p1))) / 6;
    return v3_length(v3_sub(p, v3_lerp(s->p1, s->p2, 0.5))) - ends - handle;
}

/* The cones of a span; lowers *best and sets *along where one of them is nearer. */
static void span_distance(const span_points *s, vec3 p, double radius_1, double radius_2,
                          double start, double *best, double *along)
{
    vec3 a = s->p1;
    double radius_a = radius_1;
    for (int i = 1; i <= TUBE_STEPS; i++) {
        double t = (double)i / TUBE_STEPS;
        vec3 b = span_point(s, t);
        double radius_b = radius_1 + (radius_2 - radius_1) * t;
        double d = solid_cone(p, a, b, radius_a, radius_b);
        if (d < *best) {
            vec3 axis = v3_sub(b, a);
            *best = d;
            *along = start + (i - 1 + clamp01(v3_dot(v3_sub(p, a), axis) / v3_dot(axis, axis))) /
                                 TUBE_STEPS;
        }
        a = b;
        radius_a = radius_b;
    }
}

double solid_tube(vec3 p, const vec3 *point, const double *radius, int count, double *along)
{
    double bound[TUBE_POINTS_MAX], best = INFINITY, where = 0;
    int nearest = 0;
    for (int i = 0; i + 1 < count; i++) {
        const span_points s = span_at(point, count, i);
        bound[i] = span_distance_min(&s, p) - fmax(radius[i], radius[i + 1]);
        nearest = bound[i] < bound[nearest] ? i : nearest;
    }
    for (int k = 0; k + 1 < count;
         k++) { /* the nearest span first: most others then cannot be nearer */
        int i = k == 0 ? nearest : k <= nearest ? k - 1 : k;
        if (bound[i] < best) {
            const span_points s = span_at(point, count, i);
            span_distance(&s, p, radius[i], radius[i + 1], i, &best, &where);
        }
    }
    if (along) {
        *along = where;
    }
    return best;
}

static double lattice_value(int64_t x, int64_t y, int64_t z)
{
    uint64_t h = (uint64_t)x * 0x9E3779B97F4A7C15u ^ (uint64_t)y * 0xC2B2AE3D27D4EB4Fu ^
                 (uint64_t)z * 0x165667B19E3779F9u;
    h = (h ^ (h >> 31)) * 0xD6E8FEB86659FD93u;
    h ^= h >> 32;
    return (double)(h >> 11) * (2.0 / 9007199254740992.0) - 1;
}

double noise3(vec3 p)
{
    double fx = floor(p.x), fy = floor(p.y), fz = floor(p.z), sum = 0;
    double t[3] = {p.x - fx, p.y - fy, p.z - fz};
    for (int i = 0; i < 3; i++) {
        t[i] = t[i] * t[i] * t[i] * (t[i] * (t[i] * 6 - 15) + 10);
    }
    for (int corner = 0; corner < 8; corner++) {
        int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2;
        double weight = (dx ? t[0] : 1 - t[0]) * (dy ? t[1] : 1 - t[1]) * (dz ? t[2] : 1 - t[2]);
        sum += weight * lattice_value((int64_t)fx + dx, (int64_t)fy + dy, (int64_t)fz + dz);
    }
    return sum;
}
