/* small_maths.c - Gauss-Legendre nodes and the area of a triangle.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/small_maths.h"

void parian_gauss_legendre(int n, double *node, double *weight)
{
    for (int i = 0; i < n; i++) {
        double x = -cos(PARIAN_PI * (i + 0.75) / (n + 0.5)), slope = 1;
        for (int step = 0; step < 32; step++) { /* Newton on P_n from Tricomi's estimate */
            double p0 = 1, p1 = x;
            for (int k = 2; k <= n; k++) {
                double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = n * (x * p1 - p0) / (x * x - 1);
            double delta = p1 / slope;
            x -= delta;
            if (fabs(delta) < 1e-16) {
                break;
            }
        }
        node[i] = 0.5 * (x + 1);
        weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

double parian_triangle_area(const float a[3], const float b[3], const float c[3])
{
    double u[3], v[3], n[3];
    parian_sub3(b, a, u);
    parian_sub3(c, a, v);
    parian_cross3(u, v, n);
    return 0.5 * sqrt(parian_dot3(n, n));
}
