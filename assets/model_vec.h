/* model_vec.h - vectors of three doubles.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_ASSETS_MODEL_VEC_H
#define PARIAN_ASSETS_MODEL_VEC_H

#include <math.h>

typedef struct vec3 {
    double x, y, z;
} vec3;

/* The length of (x, y); hypot without its care for extreme values. */
static inline double length2(double x, double y)
{
    return sqrt(x * x + y * y);
}

static inline vec3 v3(double x, double y, double z)
{
    return (vec3){x, y, z};
}

static inline vec3 v3_add(vec3 a, vec3 b)
{
    return v3(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline vec3 v3_sub(vec3 a, vec3 b)
{
    return v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline vec3 v3_scale(vec3 a, double s)
{
    return v3(a.x * s, a.y * s, a.z * s);
}

static inline vec3 v3_lerp(vec3 a, vec3 b, double t)
{
    return v3_add(a, v3_scale(v3_sub(b, a), t));
}

static inline vec3 v3_cross(vec3 a, vec3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline double v3_dot(vec3 a, vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline double v3_length(vec3 a)
{
    return sqrt(v3_dot(a, a));
}

static inline vec3 v3_normalize(vec3 a)
{
    double length = v3_length(a);
    return length > 0 ? v3_scale(a, 1 / length) : v3(0, 0, 1);
}

/* p with x made positive: solids that are alike left and right. */
static inline vec3 v3_mirror(vec3 p)
{
    return v3(fabs(p.x), p.y, p.z);
}

static inline double clamp01(double t)
{
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

#endif
