/* implicit.c - vectors, primitive solids, smooth set operations and noise.
 *
 * SPDX-License-Identifier: MIT
 */
#include "implicit.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>

enum { TUBE_STEPS = 6 }; /* cones per span of a tube */
static const double TUBE_FAR =
    0.5; /* sizes of a tube from which on its distance is only estimated */

vec3 v3(double x, double y, double z)
{
    return (vec3){x, y, z};
}

vec3 v3_add(vec3 a, vec3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

vec3 v3_sub(vec3 a, vec3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

vec3 v3_scale(vec3 a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}

vec3 v3_lerp(vec3 a, vec3 b, double t)
{
    return v3_add(a, v3_scale(v3_sub(b, a), t));
}

vec3 v3_cross(vec3 a, vec3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

double v3_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

double v3_length(vec3 a)
{
    return sqrt(v3_dot(a, a));
}

vec3 v3_normalize(vec3 a)
{
    double length = v3_length(a);
    return length > 0 ? v3_scale(a, 1 / length) : v3(0, 0, 1);
}

vec3 v3_mirror(vec3 p)
{
    return v3(fabs(p.x), p.y, p.z);
}

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

double clamp01(double t)
{
    return t < 0 ? 0 : t > 1 ? 1 : t;
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
    return hypot(hypot(d.x, d.z) - ring_radius, d.y) - radius;
}

double solid_plate(double outline, double across, double h)
{
    return hypot(fmax(outline + h, 0), across) - h;
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

static vec3 curve_point(const vec3 *point, int count, int span, double t)
{
    vec3 p1 = point[span], p2 = point[span + 1];
    vec3 p0 = span > 0 ? point[span - 1] : v3_sub(v3_scale(p1, 2), p2);
    vec3 p3 = span + 2 < count ? point[span + 2] : v3_sub(v3_scale(p2, 2), p1);
    double t2 = t * t, t3 = t2 * t;
    vec3 sum = v3_scale(p0, -0.5 * t3 + t2 - 0.5 * t);
    sum = v3_add(sum, v3_scale(p1, 1.5 * t3 - 2.5 * t2 + 1));
    sum = v3_add(sum, v3_scale(p2, -1.5 * t3 + 2 * t2 + 0.5 * t));
    return v3_add(sum, v3_scale(p3, 0.5 * t3 - 0.5 * t2));
}

double solid_tube(vec3 p, const vec3 *point, const double *radius, int count, double *along)
{
    vec3 middle = {0, 0, 0};
    double reach = 0, best = INFINITY;
    for (int i = 0; i < count; i++) {
        middle = v3_add(middle, v3_scale(point[i], 1.0 / count));
    }
    for (int i = 0; i < count; i++) {
        reach = fmax(reach, v3_length(v3_sub(point[i], middle)) + radius[i]);
    }
    double away = v3_length(v3_sub(p, middle)) - 1.1 * reach;
    if (away > TUBE_FAR * reach) {
        return away;
    }
    for (int span = 0; span + 1 < count; span++) {
        vec3 a = point[span];
        double radius_a = radius[span];
        for (int i = 1; i <= TUBE_STEPS; i++) {
            double t = (double)i / TUBE_STEPS;
            vec3 b = curve_point(point, count, span, t);
            double radius_b = radius[span] + (radius[span + 1] - radius[span]) * t;
            double d = solid_cone(p, a, b, radius_a, radius_b);
            if (d < best) {
                best = d;
                if (along) {
                    vec3 axis = v3_sub(b, a);
                    double s = clamp01(v3_dot(v3_sub(p, a), axis) / v3_dot(axis, axis));
                    *along = span + (i - 1 + s) / TUBE_STEPS;
                }
            }
            a = b;
            radius_a = radius_b;
        }
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
