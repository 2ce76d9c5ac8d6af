/* bssrdf_models.h - the directional dipole and photon beam diffusion, one channel at a time; behind
 * bssrdf.h.
 *
 * R is radiosity per unit of transmitted flux, m^-2: L_o = F_t R Phi / (pi C), C =
 * parian_fresnel_exit_norm(eta).
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_BSSRDF_MODELS_H
#define PARIAN_BAKE_BSSRDF_MODELS_H

#include <stdbool.h>

#include "core/medium.h"
#include "parian/env.h"
#include "parian/result.h"

/* One channel of a medium, with what follows from it. */
typedef struct parian_bssrdf_channel {
    double sigma_s, sigma_a,
        sigma_t;                 /* sigma_s not reduced; sigma_s' where only that is known, m^-1 */
    double g;                    /* within +-0.995; 0 where only sigma_s' is known */
    double sigma_t_prime;        /* positive, also in an empty channel */
    double albedo, albedo_prime; /* of one event; reduced */
    double eta;
} parian_bssrdf_channel;

parian_bssrdf_channel parian_bssrdf_channel_make(const parian_medium *medium, int channel);

/* Boundary constants of diffusion with Fresnel moments: C_phi, C_E and A = (1 - C_E) / (2 C_phi).
 * fit takes the polynomials that [dEon11] prints instead of the exact moments, for eta above 1
 * (below they do not hold). */
typedef struct parian_exitance {
    double c_phi, c_e, a;
    double exit_norm; /* 4 C_phi(1 / eta) */
} parian_exitance;

parian_exitance parian_exitance_make(double eta, bool fit);

/* Directional dipole [Frisvad14]. */
typedef struct parian_directional_dipole {
    parian_exitance exitance;
    double albedo_prime, eta;
    double diffusion;      /* D, m */
    double sigma_tr;       /* m^-1 */
    double extrapolation;  /* d_e, m */
    double back_lit2;      /* added to the squared distance for light from behind, m^2 */
    double least_distance; /* to the real source, m */
} parian_directional_dipole;

parian_directional_dipole parian_directional_dipole_make(const parian_bssrdf_channel *channel,
                                                         bool fit);
/* R for light that travels along w (unit, inside) from x_i to x_o; star is the normal of the
 * modified tangent plane. */
double parian_directional_dipole_value(const parian_directional_dipole *dipole, const double x[3],
                                       const double w[3], const double star[3],
                                       const double n_o[3]);
/* Integral of R over a plane for light that travels inside at cosine mu with the normal, and its
 * mean over diffuse light that has crossed the boundary. Relative error about 1e-4. */
double parian_directional_dipole_planar_total(const parian_directional_dipole *dipole, double mu);
double parian_directional_dipole_diffuse_total(const parian_directional_dipole *dipole);

/* Photon beam diffusion [Habel13] at normal incidence: R by distance as a table over log distance,
 * in units of the reduced mean free path. */
typedef struct parian_pbd_profile {
    double unit;            /* reduced mean free path, m */
    double core;            /* radius of the disc that holds its mean, units */
    double core_value;      /* the mean, units^-2 */
    double log_first, step; /* of the table's places, natural logarithm of units */
    int count;
    double *log_value; /* [count], natural logarithm of units^-2; NULL where the albedo is 0 */
    double total;      /* integral over the plane */
} parian_pbd_profile;

/* Both parts of the profile, without table, units^-2 at r > 0 units; relative error about 1e-8. */
double parian_pbd_multiple(const parian_bssrdf_channel *channel, const parian_exitance *exitance,
                           double r);
double parian_pbd_single(const parian_bssrdf_channel *channel, double r);

/* Errors: PARIAN_E_NOMEM. Interpolation error below 1e-5. Threads: pure function. */
parian_result parian_pbd_profile_make(const parian_env *env, const parian_bssrdf_channel *channel,
                                      parian_pbd_profile *profile);
void parian_pbd_profile_free(const parian_env *env, parian_pbd_profile *profile);
/* R at a distance in metres. */
double parian_pbd_profile_value(const parian_pbd_profile *profile, double distance);

#endif
