/* blend_solve.c - the least-squares problem of one texel's three blending weights.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/blend_solve.h"

#include <math.h>
#include <string.h>

void parian_blend_add(parian_blend_system *system, const float psi[3], const float direct[3],
                      const float carried[3])
{
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            system->normal[j][k] += (double)psi[j] * psi[k];
        }
        for (int c = 0; c < 3; c++) {
            system->right[j][c] += (double)psi[j] * ((double)direct[c] - carried[c]);
        }
    }
    system->count++;
}

/* Inverse of a symmetric positive definite 3 x 3 matrix by cofactors; false where it is singular.
 */
static bool invert(const double m[3][3], double inverse[3][3])
{
    double cofactor[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, p = (j + 1) % 3, q = (j + 2) % 3;
            cofactor[i][j] = m[a][p] * m[b][q] - m[a][q] * m[b][p];
        }
    }
    double det = m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
    double trace = m[0][0] + m[1][1] + m[2][2];
    if (!(det > 1e-14 * trace * trace * trace)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            inverse[i][j] = cofactor[j][i] / det;
        }
    }
    return true;
}

/* Minimum of (d, M d) / 2 - (b, d) with d = 0 where fixed and (reach, d) = 0 over the rest. */
static bool descend(const parian_blend_system *system, const double matrix[3][3], const double b[3],
                    const bool fixed[3], double d[3])
{
    double m[3][3], inverse[3][3], mb[3], mc[3], above = 0, below = 0;
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) {
            m[j][k] = fixed[j] || fixed[k] ? (j == k ? matrix[0][0] : 0) : matrix[j][k];
        }
    }
    if (!invert(m, inverse)) {
        return false;
    }
    for (int j = 0; j < 3; j++) {
        mb[j] = mc[j] = 0;
        for (int k = 0; k < 3; k++) {
            mb[j] += fixed[j] || fixed[k] ? 0 : inverse[j][k] * b[k];
            mc[j] += fixed[j] || fixed[k] ? 0 : inverse[j][k] * system->reach[k];
        }
        above += system->reach[j] * mb[j];
        below += system->reach[j] * mc[j];
    }
    for (int j = 0; j < 3; j++) {
        d[j] = mb[j] - (below > 0 ? above / below * mc[j] : 0);
    }
    return true;
}

/* Raise weights below their floor to it and take the energy from the others, in proportion to what
 * they are above theirs. */
static void raise_to_floor(const parian_blend_system *system, int c, double q[3])
{
    double owed = 0, spare = 0;
    for (int k = 0; k < 3; k++) {
        double above = q[k] - system->floor[k][c];
        owed += above < 0 ? -above * system->reach[k] : 0;
        spare += above > 0 ? above * system->reach[k] : 0;
    }
    if (owed <= 0) {
        return;
    }
    double keep = spare > owed ? 1 - owed / spare : 0;
    for (int k = 0; k < 3; k++) {
        q[k] = system->floor[k][c] + keep * fmax(0, q[k] - system->floor[k][c]);
    }
}

static void solve_channel(const parian_blend_system *system, const double matrix[3][3],
                          double epsilon, bool fit, double gain, int c, double q[3])
{
    double start[3], b[3], d[3];
    bool fixed[3] = {false, false, false};
    for (int k = 0; k < 3; k++) {
        start[k] = q[k] = gain * system->beta[k];
    }
    for (int k = 0; k < 3; k++) {
        b[k] = system->right[k][c] + epsilon * start[k];
        for (int j = 0; j < 3; j++) {
            b[k] -= matrix[k][j] * start[j];
        }
    }
    if (fit && descend(system, matrix, b, fixed, d)) {
        for (int k = 0; k < 3; k++) {
            q[k] = start[k] + d[k];
        }
    }
    raise_to_floor(system, c, q);
    for (int k = 0; k < 3; k++) {
        q[k] = fmin(q[k], system->ceiling[c]);
    }
}

static double regularised(const parian_blend_system *system, double share, double matrix[3][3])
{
    const double(*n)[3] = system->normal;
    double epsilon = share * (n[0][0] + n[1][1] + n[2][2]);
    memcpy(matrix, n, sizeof system->normal);
    for (int k = 0; k < 3; k++) {
        matrix[k][k] += epsilon;
    }
    return epsilon;
}

void parian_blend_solve(const parian_blend_system *system, bool fit, double q[3][3])
{
    double matrix[3][3], epsilon = regularised(system, 1e-4, matrix), reach = 0, all = 0;
    for (int k = 0; k < 3; k++) {
        reach += system->reach[k] * system->beta[k];
        all += fabs(system->reach[k]);
    }
    for (int c = 0; c < 3; c++) {
        double channel[3] = {0, 0, 0};
        if (reach > 1e-6 * all && reach > 0) {
            solve_channel(system, matrix, epsilon, fit, system->missing[c] / reach, c, channel);
        }
        for (int k = 0; k < 3; k++) {
            q[k][c] = channel[k];
        }
    }
}

void parian_blend_solve_free(const parian_blend_system *system, bool fit, double q[3][3])
{
    double matrix[3][3], inverse[3][3];
    regularised(system, 1e-6, matrix);
    memset(q, 0, 9 * sizeof **q);
    if (!fit || !invert(matrix, inverse)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++) {
            for (int j = 0; j < 3; j++) {
                q[k][c] += inverse[k][j] * system->right[j][c];
            }
        }
    }
}
