/* half_space.c - the reflectance of a half-space by discrete ordinates and doubling.
 *
 * Radiance in N directions up and N down, mean over azimuth, obeys
 *   dI_down/dx = -a I_down + b I_up,   dI_up/dx = a I_up - b I_down      (x: optical depth)
 * with a = (1 - albedo P_same W / 2) / mu and b = (albedo P_opposite W / 2) / mu. The reflection of
 * the half-space solves R a + a R = b + R b R. A layer's reflection and transmission by the
 * implicit midpoint rule have the same invariant subspaces as the exact ones, so doubling it
 * converges to R itself, whatever the first thickness.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/half_space.h"

#include <math.h>
#include <string.h>

#include "core/fresnel.h"
#include "core/small_maths.h"

enum { PANEL_MAX = 24, NODE_MAX = 2 * PANEL_MAX, DOUBLINGS_MAX = 64 };

typedef double matrix[NODE_MAX][NODE_MAX];

typedef struct ordinates {
    int panel, count;         /* nodes per panel, altogether */
    double mu[NODE_MAX];      /* cosine with the normal, inside */
    double weight[NODE_MAX];  /* sums to 1 */
    double reflect[NODE_MAX]; /* Fresnel reflectance of the boundary from inside */
} ordinates;

/* Two panels that meet at the critical angle, below which the boundary reflects all. Above it
 * mu = critical + (1 - critical) s^2 takes the root out of the Fresnel terms. */
static void place_ordinates(int panel, double eta, ordinates *o)
{
    double node[PANEL_MAX], weight[PANEL_MAX];
    double meet = eta > 1 ? sqrt(1 - 1 / (eta * eta)) : 0.25;
    parian_gauss_legendre(panel, node, weight);
    o->panel = panel;
    o->count = 2 * panel;
    for (int i = 0; i < panel; i++) {
        o->mu[i] = meet * node[i];
        o->weight[i] = meet * weight[i];
        o->mu[panel + i] = meet + (1 - meet) * node[i] * node[i];
        o->weight[panel + i] = 2 * node[i] * (1 - meet) * weight[i];
    }
    for (int i = 0; i < o->count; i++) {
        o->reflect[i] = parian_fresnel_reflectance(o->mu[i], 1 / eta);
    }
}

/* Add the phase function's part of the rate matrices: same[i][j] and opposite[i][j] take albedo W /
 * 2 times the phase function from direction j to i, on the same and on the other side. Moments up
 * to panel - 1 are integrated exactly by the nodes, which keeps energy; what is left of the peak,
 * |g|^panel, goes on straight (g > 0) or straight back (g < 0). */
static void phase_matrices(const ordinates *o, double albedo, double g, matrix same,
                           matrix opposite)
{
    double legendre[NODE_MAX][PANEL_MAX];
    double peak = pow(fabs(g), o->panel), sign = g < 0 ? -1 : 1;
    for (int i = 0; i < o->count; i++) {
        legendre[i][0] = 1;
        legendre[i][1] = o->mu[i];
        for (int l = 2; l < o->panel; l++) {
            legendre[i][l] =
                ((2 * l - 1) * o->mu[i] * legendre[i][l - 1] - (l - 1) * legendre[i][l - 2]) / l;
        }
    }
    for (int i = 0; i < o->count; i++) {
        for (int j = 0; j < o->count; j++) {
            double even = 0, odd = 0, power = 1, flip = 1;
            for (int l = 0; l < o->panel; l++) {
                double term = (2 * l + 1) * (power - peak * flip) * legendre[i][l] * legendre[j][l];
                *(l % 2 ? &odd : &even) += term;
                power *= g;
                flip *= sign;
            }
            same[i][j] = 0.5 * albedo * o->weight[j] * (even + odd);
            opposite[i][j] = 0.5 * albedo * o->weight[j] * (even - odd);
        }
        (g < 0 ? opposite : same)[i][i] += albedo * peak;
    }
}

static void swap_rows(int n, double *a, double *b)
{
    for (int j = 0; j < n; j++) {
        double kept = a[j];
        a[j] = b[j];
        b[j] = kept;
    }
}

/* Solve a x = b for the columns of b, in place, by elimination with row pivots; a is destroyed. */
static void solve(int n, matrix a, int columns, double (*b)[NODE_MAX])
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            pivot = fabs(a[i][k]) > fabs(a[pivot][k]) ? i : pivot;
        }
        swap_rows(n, a[k], a[pivot]);
        swap_rows(columns, b[k], b[pivot]);
        for (int i = 0; i < n; i++) {
            double factor = i == k ? 0 : a[i][k] / a[k][k];
            for (int j = k; factor != 0 && j < n; j++) {
                a[i][j] -= factor * a[k][j];
            }
            for (int j = 0; factor != 0 && j < columns; j++) {
                b[i][j] -= factor * b[k][j];
            }
        }
    }
    for (int k = 0; k < n; k++) {
        for (int j = 0; j < columns; j++) {
            b[k][j] /= a[k][k];
        }
    }
}

static void multiply(int n, matrix a, matrix b, matrix product)
{
    for (int i = 0; i < n; i++) {
        memset(product[i], 0, sizeof product[i]);
        for (int k = 0; k < n; k++) {
            for (int j = 0; j < n; j++) {
                product[i][j] += a[i][k] * b[k][j];
            }
        }
    }
}

/* Reflection and transmission of a layer as thick as the smallest cosine: what leaves both sides in
 * sum and in difference, (1 + A -+ B)^-1 (1 - A +- B), with A and B half the thickness times a and
 * b. */
static void first_layer(const ordinates *o, double albedo, double g, matrix reflection,
                        matrix transmission)
{
    int n = o->count;
    matrix same, opposite, left;
    memset(same, 0, sizeof same);
    memset(opposite, 0, sizeof opposite);
    phase_matrices(o, albedo, g, same, opposite);
    for (int parity = 0; parity < 2; parity++) {
        double(*right)[NODE_MAX] = parity ? reflection : transmission;
        for (int i = 0; i < n; i++) {
            double half = 0.5 * o->mu[0] / o->mu[i];
            for (int j = 0; j < n; j++) {
                double one = i == j, across = parity ? -opposite[i][j] : opposite[i][j];
                double rate = half * (one - same[i][j] - across);
                left[i][j] = one + rate;
                right[i][j] = one - rate;
            }
        }
        solve(n, left, n, right);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double sum = transmission[i][j], difference = reflection[i][j];
            transmission[i][j] = 0.5 * (sum + difference);
            reflection[i][j] = 0.5 * (sum - difference);
        }
    }
}

/* Put a layer on its equal: with X = (1 - r r)^-1 t, t' = t X and r' = r + t r X. Returns the
 * largest element of the new transmission. */
static double double_layer(int n, matrix reflection, matrix transmission)
{
    matrix between, light, product;
    multiply(n, reflection, reflection, between);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            between[i][j] = (i == j) - between[i][j];
        }
    }
    memcpy(light, transmission, sizeof light);
    solve(n, between, n, light);
    multiply(n, transmission, reflection, product);
    multiply(n, product, light, between);
    multiply(n, transmission, light, product);
    double largest = 0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            reflection[i][j] += between[i][j];
            transmission[i][j] = product[i][j];
            largest = fmax(largest, fabs(product[i][j]));
        }
    }
    return largest;
}

/* Flux out per flux in: the light inside going up is I = R (S + F I), S what came in, F the
 * boundary's reflection. */
static double close_boundary(const ordinates *o, matrix reflection)
{
    int n = o->count;
    matrix system;
    double up[NODE_MAX][NODE_MAX], in = 0, out = 0;
    for (int i = 0; i < n; i++) {
        up[i][0] = 0;
        for (int j = 0; j < n; j++) {
            system[i][j] = (i == j) - reflection[i][j] * o->reflect[j];
            up[i][0] += reflection[i][j] * (1 - o->reflect[j]);
        }
    }
    solve(n, system, 1, up);
    for (int i = 0; i < n; i++) {
        double crossing = o->weight[i] * o->mu[i] * (1 - o->reflect[i]);
        in += crossing;
        out += crossing * up[i][0];
    }
    return out / in;
}

double parian_half_space_reflectance(double albedo, double g, double eta)
{
    const double conservative =
        1 - 1e-12; /* beyond: what is lost is below 1e-5, and rounding takes over */
    if (!(albedo > 0)) {
        return 0;
    }
    if (albedo >= conservative) {
        return 1;
    }
    double mean_cosine = fmin(fmax(g, -0.995), 0.995);
    ordinates o;
    matrix reflection, transmission;
    place_ordinates(mean_cosine == 0 ? PANEL_MAX / 2 : PANEL_MAX, eta, &o);
    memset(reflection, 0, sizeof reflection);
    memset(transmission, 0, sizeof transmission);
    first_layer(&o, albedo, mean_cosine, reflection, transmission);
    double left = 1;
    for (int i = 0; left > 1e-9 && i < DOUBLINGS_MAX; i++) {
        left = double_layer(o.count, reflection, transmission);
    }
    return close_boundary(&o, reflection);
}
