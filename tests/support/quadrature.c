/* quadrature.c - brute-force quadrature of the dipole over the texels of a scene.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/quadrature.h"

#include <math.h>
#include <stdlib.h>

#include "core/dipole.h"
#include "core/memory.h"
#include "core/small_maths.h"

static const double NEAR_EDGES = 20;

typedef struct quadrature_job {
    const quadrature_texels *texels;
    const size_t *receiver;
    parian_dipole dipole[3];
    double (*truth)[3];
} quadrature_job;

/* R_d in a loop over pairs: distances for the two sources, one exponential each. */
static inline double dipole_value(const parian_dipole *p, double r2)
{
    double dr = sqrt(r2 + p->z_r * p->z_r), dv = sqrt(r2 + p->z_v * p->z_v), s = p->sigma_tr;
    return p->albedo / (4 * PARIAN_PI) *
           (p->z_r * (1 + s * dr) * exp(-s * dr) / (dr * dr * dr) +
            p->z_v * (1 + s * dv) * exp(-s * dv) / (dv * dv * dv));
}

static void tangent_frame(const float n[3], double t[3], double u[3])
{
    double normal[3] = {n[0], n[1], n[2]}, axis[3] = {0, 0, 0};
    int k = fabs(normal[0]) < fabs(normal[1]) ? 0 : 1;
    k = fabs(normal[2]) < fabs(normal[k]) ? 2 : k;
    axis[k] = 1;
    parian_cross3(normal, axis, t);
    double length = sqrt(parian_dot3(t, t));
    for (int i = 0; i < 3; i++) {
        t[i] /= length;
    }
    parian_cross3(normal, t, u);
}

/* Squared distances of the four Gauss points of a texel to x. */
static void gauss_distances(const quadrature_texels *texels, size_t i, const double x[3],
                            double r2[4])
{
    double t[3], u[3], h = sqrt(texels->area[i] / 12.0);
    tangent_frame(texels->normal[i], t, u);
    for (int k = 0; k < 4; k++) {
        double a = k & 1 ? h : -h, b = k & 2 ? h : -h, d[3];
        for (int j = 0; j < 3; j++) {
            d[j] = texels->position[i][j] + a * t[j] + b * u[j] - x[j];
        }
        r2[k] = parian_dot3(d, d);
    }
}

static void add_texel(const quadrature_job *job, size_t i, size_t own, const double x[3],
                      double sum[3])
{
    const quadrature_texels *texels = job->texels;
    double area = texels->area[i], d[3], r2[4];
    const float *e = texels->irradiance[i];
    if (e[0] == 0 && e[1] == 0 && e[2] == 0) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        d[k] = texels->position[i][k] - x[k];
    }
    double far2 = parian_dot3(d, d);
    bool is_near = far2 < NEAR_EDGES * NEAR_EDGES * area;
    if (is_near) {
        gauss_distances(texels, i, x, r2);
    }
    for (int c = 0; c < 3; c++) {
        const parian_dipole *p = &job->dipole[c];
        if (i == own) {
            sum[c] += e[c] * parian_dipole_disc_energy(p, sqrt(area / PARIAN_PI));
        } else if (is_near) {
            sum[c] += e[c] * area * 0.25 *
                      (dipole_value(p, r2[0]) + dipole_value(p, r2[1]) + dipole_value(p, r2[2]) +
                       dipole_value(p, r2[3]));
        } else {
            sum[c] += e[c] * area * dipole_value(p, far2);
        }
    }
}

static void one_receiver(void *context, size_t k)
{
    const quadrature_job *job = context;
    size_t own = job->receiver[k];
    double x[3], sum[3] = {0, 0, 0};
    for (int j = 0; j < 3; j++) {
        x[j] = job->texels->position[own][j];
    }
    for (size_t i = 0; i < job->texels->count; i++) {
        add_texel(job, i, own, x, sum);
    }
    for (int c = 0; c < 3; c++) {
        job->truth[k][c] = sum[c];
    }
}

parian_result quadrature_radiosity(const parian_env *env, const parian_medium *medium, bool fit_fdr,
                                   const quadrature_texels *texels, const size_t *receiver,
                                   size_t count, double (*truth)[3])
{
    quadrature_job job = {.texels = texels, .receiver = receiver, .truth = truth};
    for (int c = 0; c < 3; c++) {
        job.dipole[c] = parian_dipole_make(medium, c, fit_fdr);
    }
    parian_par(env, count, one_receiver, &job);
    return PARIAN_OK;
}

/* splitmix64, for the offset of the systematic sample. */
static double random_unit(uint64_t seed)
{
    uint64_t z = seed + UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

void quadrature_pick(const quadrature_texels *texels, size_t count, uint64_t seed, size_t *receiver)
{
    double total = 0, below = 0;
    size_t i = 0;
    for (size_t k = 0; k < texels->count; k++) {
        total += texels->area[k];
    }
    for (size_t k = 0; k < count; k++) {
        double target = total * ((double)k + random_unit(seed)) / (double)count;
        while (i + 1 < texels->count && below + texels->area[i] < target) {
            below += texels->area[i++];
        }
        receiver[k] = i;
    }
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double smallest_share(const quadrature_texels *texels, const float (*radiosity)[3])
{
    float low = 0, high = 0;
    for (size_t i = 0; i < texels->count; i++) {
        for (int c = 0; c < 3; c++) {
            low = fminf(low, radiosity[i][c]);
            high = fmaxf(high, radiosity[i][c]);
        }
    }
    return high > 0 ? low / high : 0;
}

quadrature_error quadrature_compare(const quadrature_texels *texels, const float (*radiosity)[3],
                                    const size_t *receiver, size_t count, const double (*truth)[3])
{
    quadrature_error error = {.smallest = smallest_share(texels, radiosity)};
    double *difference = malloc((count ? count : 1) * sizeof *difference);
    for (int c = 0; c < 3 && difference; c++) {
        double d1 = 0, d2 = 0, t1 = 0, t2 = 0, b1 = 0;
        for (size_t k = 0; k < count; k++) {
            double b = radiosity[receiver[k]][c], t = truth[k][c];
            difference[k] = fabs(b - t);
            d1 += fabs(b - t);
            d2 += (b - t) * (b - t);
            t1 += t;
            t2 += t * t;
            b1 += b;
        }
        qsort(difference, count, sizeof *difference, compare_doubles);
        error.l1[c] = t1 > 0 ? d1 / t1 : 0;
        error.l2[c] = t2 > 0 ? sqrt(d2 / t2) : 0;
        error.energy[c] = t1 > 0 ? b1 / t1 : 1;
        error.p999[c] =
            t1 > 0 ? difference[(size_t)(0.999 * (double)(count - 1))] * (double)count / t1 : 0;
    }
    free(difference);
    return error;
}
