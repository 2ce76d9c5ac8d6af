/* vec3d.h - three-vectors of doubles, inline.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_VEC3D_H
#define PARIAN_BAKE_VEC3D_H

#include <math.h>

static inline double vec3d_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vec3d_length(const double a[3])
{
    return sqrt(vec3d_dot(a, a));
}

static inline void vec3d_copy(double to[3], const double a[3])
{
    to[0] = a[0];
    to[1] = a[1];
    to[2] = a[2];
}

static inline void vec3d_sub(double to[3], const double a[3], const double b[3])
{
    to[0] = a[0] - b[0];
    to[1] = a[1] - b[1];
    to[2] = a[2] - b[2];
}

static inline void vec3d_add_scaled(double to[3], const double a[3], double s)
{
    to[0] += s * a[0];
    to[1] += s * a[1];
    to[2] += s * a[2];
}

static inline void vec3d_scale(double a[3], double s)
{
    a[0] *= s;
    a[1] *= s;
    a[2] *= s;
}

static inline void vec3d_cross(double to[3], const double a[3], const double b[3])
{
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

/* Scale to unit length and return the length that it had; a vector of length 0 is left as it is. */
static inline double vec3d_normalize(double a[3])
{
    double length = vec3d_length(a);
    if (length > 0) {
        vec3d_scale(a, 1 / length);
    }
    return length;
}

static inline void vec3d_from_float(double to[3], const float a[3])
{
    to[0] = (double)a[0];
    to[1] = (double)a[1];
    to[2] = (double)a[2];
}

#endif
