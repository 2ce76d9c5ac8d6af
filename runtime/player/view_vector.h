/* view_vector.h - vectors of three doubles, as far as the player needs them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_VIEW_VECTOR_H
#define PARIAN_VIEW_VECTOR_H

#include <math.h>

static inline double vector_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vector_length(const double a[3])
{
    return sqrt(vector_dot(a, a));
}

static inline void vector_cross(const double a[3], const double b[3], double out[3])
{
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2],
                 z = a[0] * b[1] - a[1] * b[0];
    out[0] = x;
    out[1] = y;
    out[2] = z;
}

/* out = a + s b */
static inline void vector_add_scaled(const double a[3], double s, const double b[3], double out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] = a[c] + s * b[c];
    }
}

/* Makes a unit vector; a vector without length becomes +z. */
static inline void vector_normalize(double a[3])
{
    const double length = vector_length(a);
    for (int c = 0; c < 3; c++) {
        a[c] = length > 0 ? a[c] / length : (c == 2 ? 1.0 : 0.0);
    }
}

/* Turn v about a unit axis, radians (Rodrigues). */
static inline void vector_rotate(const double axis[3], double angle, double v[3])
{
    double across[3];
    const double c = cos(angle), s = sin(angle), along = vector_dot(axis, v) * (1 - c);
    vector_cross(axis, v, across);
    for (int k = 0; k < 3; k++) {
        v[k] = v[k] * c + across[k] * s + axis[k] * along;
    }
}

#endif
