/* dipole.c - the standard dipole.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/dipole.h"

#include <math.h>

#include "core/fresnel.h"
#include "core/small_maths.h"

parian_dipole parian_dipole_make(const parian_medium *medium, int channel, bool fit_fdr)
{
    parian_dipole d = {0};
    double scatter = medium->sigma_s_prime[channel], absorb = medium->sigma_a[channel];
    d.sigma_t_prime = scatter + absorb;
    if (!(d.sigma_t_prime > 0)) {
        d.sigma_t_prime = 1; /* an empty channel: any length will do, the albedo is zero */
    }
    d.albedo = scatter / d.sigma_t_prime;
    d.diffusion = 1 / (3 * d.sigma_t_prime);
    d.sigma_tr = sqrt(3 * absorb * d.sigma_t_prime);
    d.f_dr = fit_fdr ? parian_fresnel_fdr_fit(medium->eta) : parian_fresnel_fdr(medium->eta);
    d.a = (1 + d.f_dr) / (1 - d.f_dr);
    d.z_r = 1 / d.sigma_t_prime;
    d.z_v = d.z_r + 4 * d.a * d.diffusion;
    return d;
}

/* (1 + s q) exp(-s q) / q^3, the field's gradient over its distance; and its derivative by q^2. */
static double gradient_term(double s, double q2)
{
    double q = sqrt(q2);
    return (1 + s * q) * exp(-s * q) / (q2 * q);
}

static double gradient_term_slope(double s, double q2)
{
    double q = sqrt(q2), sq = s * q;
    return -(3 + 3 * sq + sq * sq) * exp(-sq) / (2 * q2 * q2 * q);
}

static double gradient_term_curvature(double s, double q2)
{
    double q = sqrt(q2), sq = s * q;
    return (15 + 15 * sq + 6 * sq * sq + sq * sq * sq) * exp(-sq) / (4 * q2 * q2 * q2 * q);
}

double parian_dipole_rd(const parian_dipole *d, double r2)
{
    return d->albedo / (4 * PARIAN_PI) *
           (d->z_r * gradient_term(d->sigma_tr, r2 + d->z_r * d->z_r) +
            d->z_v * gradient_term(d->sigma_tr, r2 + d->z_v * d->z_v));
}

double parian_dipole_slope(const parian_dipole *d, double r2)
{
    return d->albedo / (4 * PARIAN_PI) *
           (d->z_r * gradient_term_slope(d->sigma_tr, r2 + d->z_r * d->z_r) +
            d->z_v * gradient_term_slope(d->sigma_tr, r2 + d->z_v * d->z_v));
}

double parian_dipole_laplacian(const parian_dipole *d, double r2)
{
    double curvature = d->albedo / (4 * PARIAN_PI) *
                       (d->z_r * gradient_term_curvature(d->sigma_tr, r2 + d->z_r * d->z_r) +
                        d->z_v * gradient_term_curvature(d->sigma_tr, r2 + d->z_v * d->z_v));
    return 4 * (parian_dipole_slope(d, r2) + r2 * curvature);
}

/* z (1/z - 1/q) without cancellation, with the decay: exp(-s z) - z exp(-s q) / q, q^2 = R^2 + z^2.
 */
static double disc_term(double s, double z, double radius)
{
    double q = sqrt(radius * radius + z * z), rise = radius * radius / (q + z);
    return exp(-s * z) * (rise / q - z / q * expm1(-s * rise));
}

double parian_dipole_disc_energy(const parian_dipole *d, double radius)
{
    return 0.5 * d->albedo *
           (disc_term(d->sigma_tr, d->z_r, radius) + disc_term(d->sigma_tr, d->z_v, radius));
}

double parian_dipole_total(const parian_dipole *d)
{
    return 0.5 * d->albedo * (exp(-d->sigma_tr * d->z_r) + exp(-d->sigma_tr * d->z_v));
}

double parian_dipole_flux(const parian_dipole *d, const double x_i[3], const double n_i[3],
                          const double x_o[3], const double n_o[3])
{
    double real[3], image[3];
    for (int k = 0; k < 3; k++) {
        double between = x_o[k] - x_i[k];
        real[k] = between + d->z_r * n_i[k];
        image[k] = between - d->z_v * n_i[k];
    }
    double least2 = d->z_r * d->z_r / 16;
    double real2 = fmax(parian_dot3(real, real), least2);
    double image2 = fmax(parian_dot3(image, image), least2);
    double value = parian_dot3(real, n_o) * gradient_term(d->sigma_tr, real2) -
                   parian_dot3(image, n_o) * gradient_term(d->sigma_tr, image2);
    return fmax(0.0, d->albedo / (4 * PARIAN_PI) * value);
}
