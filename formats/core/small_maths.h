/* small_maths.h - vectors of three, barycentrics, Gauss-Legendre nodes: what several stages share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_SMALL_MATHS_H
#define PARIAN_CORE_SMALL_MATHS_H

#include <math.h>

#define PARIAN_PI 3.14159265358979323846

enum { PARIAN_GAUSS_MAX = 64 };

/* Nodes and weights of n-point Gauss-Legendre quadrature on [0, 1], n from 1 to PARIAN_GAUSS_MAX;
 * ascending, accurate to a few 1e-16. */
void parian_gauss_legendre(int n, double *node, double *weight);

static inline void parian_sub3(const float a[3], const float b[3], double out[3])
{
    for (int k = 0; k < 3; k++) {
        out[k] = (double)a[k] - (double)b[k];
    }
}

static inline double parian_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void parian_cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Squared distance of two points, in float: the same bits wherever it is computed. */
static inline float parian_distance2f(const float a[3], const float b[3])
{
    float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

/* Area of a triangle of float points; 0 for a degenerate one. */
double parian_triangle_area(const float a[3], const float b[3], const float c[3]);

#endif
