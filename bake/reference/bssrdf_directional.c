/* bssrdf_directional.c - the directional dipole: a ray source and its image in a modified tangent
 * plane.
 *
 * The value is pi C S_d in the paper's terms; S_d holds neither the transmission on entry nor that
 * on exit. The model has no factor of albedo: media that mostly absorb come out far too bright,
 * unless normalised.
 *
 * Source  [Frisvad14], and its authors' sample code. Differs: exact Fresnel moments (unless the fit
 * is asked for), a least distance to the real source, n* = n_i where it is undefined
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/reference/bssrdf_models.h"
#include "core/fresnel.h"
#include "core/small_maths.h"

parian_directional_dipole parian_directional_dipole_make(const parian_bssrdf_channel *c, bool fit)
{
    parian_directional_dipole d = {.exitance = parian_exitance_make(c->eta, fit),
                                   .albedo_prime = c->albedo_prime,
                                   .eta = c->eta,
                                   .diffusion = 1 / (3 * c->sigma_t_prime)};
    d.sigma_tr = sqrt(c->sigma_a / d.diffusion);
    d.extrapolation = 2.131 * d.diffusion / sqrt(fmax(c->albedo_prime, 1e-12));
    d.back_lit2 = 1 / (9 * c->sigma_t * c->sigma_t);
    d.least_distance = d.diffusion / 8;
    return d;
}

/* S' of one source at distance r, without 1 / (4 C_phi(1 / eta)); x from the source's origin to
 * x_o. */
static double ray_source(const parian_directional_dipole *d, const double x[3], const double w[3],
                         const double n_o[3], double r)
{
    double D = d->diffusion, sr = d->sigma_tr * r, one = 1 + sr;
    double along = parian_dot3(x, w), up = parian_dot3(x, n_o), turn = parian_dot3(w, n_o);
    double fluence = r * r / D + 3 * one * along;
    double flux = 3 * D * one * turn - (one + 3 * D * (3 * one + sr * sr) / (r * r) * along) * up;
    return exp(-sr) / (4 * PARIAN_PI * PARIAN_PI * r * r * r) *
           (d->exitance.c_phi * fluence - d->exitance.c_e * flux);
}

/* Distance that stands for the real source: lengthened by the boundary's effect on light from the
 * front. */
static double real_distance(const parian_directional_dipole *d, double r2, double along, double mu)
{
    double D = d->diffusion, de = d->extrapolation, added = d->back_lit2;
    if (mu > 0) {
        double cos_beta = -sqrt(fmax(0, r2 - along * along) / (r2 + de * de));
        added = D * mu * (D * mu - 2 * de * cos_beta);
    }
    return fmax(sqrt(r2 + added), d->least_distance);
}

double parian_directional_dipole_value(const parian_directional_dipole *d, const double x[3],
                                       const double w[3], const double star[3], const double n_o[3])
{
    if (!(d->albedo_prime > 0)) {
        return 0;
    }
    double height = 2 * d->exitance.a * d->extrapolation, turn = 2 * parian_dot3(w, star);
    double x_v[3], w_v[3];
    for (int k = 0; k < 3; k++) {
        x_v[k] = x[k] - height * star[k];
        w_v[k] = w[k] - turn * star[k];
    }
    double along = parian_dot3(x, w), r2 = parian_dot3(x, x);
    double near = real_distance(d, r2, along, -parian_dot3(n_o, w));
    double far = fmax(sqrt(parian_dot3(x_v, x_v)), d->least_distance);
    double value = ray_source(d, x, w, n_o, near) - ray_source(d, x_v, w_v, n_o, far);
    return fmax(0, PARIAN_PI * value);
}

/* The integrand r^2 R is smooth over log r and falls off at both ends, as r^2 and at least as 1 /
 * r, and periodic over azimuth: the trapezoidal rule converges fast in both. */
double parian_directional_dipole_planar_total(const parian_directional_dipole *d, double mu)
{
    enum { AZIMUTHS = 16 }; /* over half a turn; the other half mirrors it */
    const double step = 0.125, first = log(1e-4), last = log(1e6);
    const double up[3] = {0, 0, 1}, w[3] = {sqrt(fmax(0, 1 - mu * mu)), 0, -mu};
    double reach = d->sigma_tr > 0 ? log(200 / (d->sigma_tr * d->diffusion)) : last, sum = 0;
    for (double t = first; t < fmin(reach, last); t += step) {
        double r = d->diffusion * exp(t), ring = 0;
        for (int i = 0; i < AZIMUTHS; i++) {
            double azimuth = PARIAN_PI * (i + 0.5) / AZIMUTHS;
            double x[3] = {r * cos(azimuth), r * sin(azimuth), 0};
            ring += parian_directional_dipole_value(d, x, w, up, up);
        }
        sum += ring / AZIMUTHS * r * r;
    }
    return 2 * PARIAN_PI * step * sum;
}

double parian_directional_dipole_diffuse_total(const parian_directional_dipole *d)
{
    enum { ANGLES = 12 };
    double node[ANGLES], weight[ANGLES], in = 0, out = 0;
    double critical = d->eta > 1 ? sqrt(1 - 1 / (d->eta * d->eta)) : 0;
    parian_gauss_legendre(ANGLES, node, weight);
    for (int i = 0; i < ANGLES;
         i++) { /* squared: takes the root at the critical angle out of Fresnel's terms */
        double mu = critical + (1 - critical) * node[i] * node[i];
        double flux = weight[i] * node[i] * mu * parian_fresnel_transmittance(mu, 1 / d->eta);
        in += flux;
        out += flux * parian_directional_dipole_planar_total(d, mu);
    }
    return out / in;
}
