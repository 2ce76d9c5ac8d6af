/* bssrdf_pbd.c - photon beam diffusion: dipoles along the refracted beam and exact single
 * scattering, by distance.
 *
 * Lengths here are in units of the reduced mean free path 1 / sigma_t'. Integrals along the beam
 * are taken over the logarithm of depth, where the integrands are analytic and fall off at both
 * ends: the trapezoidal rule converges exponentially. Near the beam the profile grows as 1 / r; a
 * small core holds its mean, so that energy is kept.
 *
 * Source  [Habel13], in the form of [PBRT]. Differs: integrals instead of 100 samples, exact
 * Fresnel moments
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/reference/bssrdf_models.h"
#include "core/fresnel.h"
#include "core/memory.h"
#include "core/small_maths.h"

#define BEAM_STEP  0.25 /* of the logarithm of depth: error exp(-pi^2 / step) */
#define TABLE_STEP 0.05 /* of the logarithm of distance */

/* Grosjean's diffusion for a medium of unit sigma_t'. */
typedef struct beam {
    double diffusion, sigma_tr, image; /* image: of a source at depth 0, above the surface */
    double c_phi, c_e;
} beam;

static beam make_beam(const parian_bssrdf_channel *c, const parian_exitance *e)
{
    double absorbed = 1 - c->albedo_prime;
    beam b = {.diffusion = (1 + absorbed) / 3, .c_phi = e->c_phi, .c_e = e->c_e};
    b.sigma_tr = sqrt(absorbed / b.diffusion);
    b.image = 4 * b.diffusion * e->a;
    return b;
}

/* Exitance at distance r of a point source of unit power at depth z and its image, with the
 * correction kappa for what diffusion gets wrong close to the beam. Differences of like terms are
 * formed without cancellation. */
static double dipole_exitance(const beam *b, double r, double z)
{
    double s = b->sigma_tr, z_v = z + b->image;
    double d_r = sqrt(r * r + z * z), d_v = sqrt(r * r + z_v * z_v);
    double longer = b->image * (z + z_v) / (d_r + d_v); /* d_v - d_r */
    double near = exp(-s * d_r), far = exp(-s * d_v);
    double fluence = near * (longer / (d_r * d_v) - expm1(-s * longer) / d_v) / b->diffusion;
    double flux = z * (1 + s * d_r) * near / (d_r * d_r * d_r) +
                  z_v * (1 + s * d_v) * far / (d_v * d_v * d_v);
    double kappa = -expm1(-2 * (d_r + z));
    return kappa * (b->c_phi * fluence + b->c_e * flux) / (4 * PARIAN_PI);
}

double parian_pbd_multiple(const parian_bssrdf_channel *c, const parian_exitance *e, double r)
{
    beam b = make_beam(c, e);
    double sum = 0, first = log(1e-9 * fmin(r, 1)), last = log(50.0);
    for (double t = first; t < last; t += BEAM_STEP) {
        double z = exp(t);
        sum += z * exp(-z) * dipole_exitance(&b, r, z);
    }
    return c->albedo_prime * c->albedo_prime * BEAM_STEP * sum;
}

/* Henyey-Greenstein's phase function, sr^-1. */
static double phase(double cosine, double g)
{
    double base = 1 + g * g - 2 * g * cosine;
    return (1 - g * g) / (4 * PARIAN_PI * base * sqrt(base));
}

/* Light scattered once, at depth z, straight to the surface: only from depths beyond r sqrt(eta^2 -
 * 1), where the boundary does not reflect all of it. */
double parian_pbd_single(const parian_bssrdf_channel *c, double r)
{
    double sigma_t = c->sigma_t / c->sigma_t_prime, eta = c->eta;
    double critical = eta > 1 ? r * sqrt(eta * eta - 1) : 0;
    double sum = 0, first = log(1e-8 * fmin(r, 1 / sigma_t)), last = log(50 / sigma_t);
    for (double t = first; t < last; t += BEAM_STEP) {
        double past = exp(t), z = critical + past, d = sqrt(r * r + z * z), cosine = z / d;
        double through = parian_fresnel_transmittance(cosine, 1 / eta);
        sum += past * exp(-sigma_t * (z + d)) / (d * d) * phase(-cosine, c->g) * through * cosine;
    }
    return c->albedo * sigma_t * BEAM_STEP * sum;
}

static double profile_at(const parian_bssrdf_channel *c, const parian_exitance *e, double r)
{
    return parian_pbd_multiple(c, e, r) + parian_pbd_single(c, r);
}

/* Mean over the disc of radius core, where r R is smooth. */
static double core_mean(const parian_bssrdf_channel *c, const parian_exitance *e, double core)
{
    enum { N = 24 };
    double node[N], weight[N], sum = 0;
    parian_gauss_legendre(N, node, weight);
    for (int i = 0; i < N; i++) {
        sum += weight[i] * 2 * node[i] * profile_at(c, e, core * node[i]);
    }
    return sum;
}

parian_result parian_pbd_profile_make(const parian_env *env, const parian_bssrdf_channel *c,
                                      parian_pbd_profile *profile)
{
    *profile = (parian_pbd_profile){.unit = 1 / c->sigma_t_prime, .core = 1};
    if (!(c->albedo_prime > 0)) {
        return PARIAN_OK;
    }
    parian_exitance e = parian_exitance_make(c->eta, false);
    double sigma_tr = make_beam(c, &e).sigma_tr;
    double reach = sigma_tr > 0 ? fmin(1e7, 200 / sigma_tr) : 1e7;
    profile->core = 1e-3 * c->sigma_t_prime / fmax(c->sigma_t, c->sigma_t_prime);
    profile->log_first = log(profile->core);
    profile->step = TABLE_STEP;
    profile->count = 4 + (int)((log(reach) - profile->log_first) / TABLE_STEP);
    if (!PARIAN_NEW(env, profile->log_value, (size_t)profile->count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a profile of %d places",
                           profile->count);
    }
    profile->core_value = core_mean(c, &e, profile->core);
    profile->total = PARIAN_PI * profile->core * profile->core * profile->core_value;
    for (int i = 0; i < profile->count; i++) {
        double r = exp(profile->log_first + i * TABLE_STEP), value = profile_at(c, &e, r);
        profile->log_value[i] = log(fmax(value, 1e-300));
        profile->total += (i ? 1 : 0.5) * 2 * PARIAN_PI * r * r * value * TABLE_STEP;
    }
    return PARIAN_OK;
}

void parian_pbd_profile_free(const parian_env *env, parian_pbd_profile *profile)
{
    parian_free(env, profile->log_value);
    profile->log_value = NULL;
}

/* Cubic through the four places around t, in steps from the first; straight on beyond the last. */
static double interpolate(const double *value, int count, double t)
{
    if (t >= count - 1) {
        return value[count - 1] + (t - (count - 1)) * (value[count - 1] - value[count - 2]);
    }
    int i = (int)t;
    i = i < 1 ? 1 : i > count - 3 ? count - 3 : i;
    double u = t - i;
    return value[i - 1] * (-u * (u - 1) * (u - 2) / 6) +
           value[i] * ((u + 1) * (u - 1) * (u - 2) / 2) +
           value[i + 1] * (-(u + 1) * u * (u - 2) / 2) + value[i + 2] * ((u + 1) * u * (u - 1) / 6);
}

double parian_pbd_profile_value(const parian_pbd_profile *profile, double distance)
{
    double r = distance / profile->unit;
    if (!profile->log_value) {
        return 0;
    }
    if (!(r > profile->core)) {
        return profile->core_value / (profile->unit * profile->unit);
    }
    double t = (log(r) - profile->log_first) / profile->step;
    return exp(interpolate(profile->log_value, profile->count, t)) /
           (profile->unit * profile->unit);
}
