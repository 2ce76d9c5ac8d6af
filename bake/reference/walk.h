/* walk.h - what every random walk in a medium shares: free flights, scattering, the
 * boundary, roulette and the books that prove its energy. Inline, for these are the inner loops.
 *
 * A walk carries a weight. At a scattering event it leaves the absorbed share behind
 * (parian_walk_absorb), at the boundary the share that crosses (parian_walk_leave), and goes on
 * with the rest; two roulettes end it (parian_walk_continue). No mathematics of the C library but
 * sqrt, which is exact: a walk's steps are the same on every machine.
 *
 * Source  phase function [Henyey41]; frame about an axis [Duff17]
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_WALK_H
#define PARIAN_BAKE_WALK_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "core/medium.h"
#include "core/random.h"

/* Roulette by weight acts below THRESHOLD and lifts survivors to TARGET. Roulette by length acts at
 * events FIRST, 2 FIRST, 4 FIRST, ...: a walk survives with probability 1/sqrt(2). Without
 * absorption the number of events in a half-space has a tail of n^-1/2 and no mean; with this
 * factor, and with no other, both the mean cost and the variance grow only with the logarithm of
 * the number of walks. */
#define PARIAN_WALK_THRESHOLD    0.1
#define PARIAN_WALK_TARGET       0.2
#define PARIAN_WALK_LENGTH_FIRST 1024u

/* One channel of a medium as a walk sees it. Where a medium is known only by its reduced
 * coefficients, g is 0 and sigma_s is sigma_s'. */
typedef struct parian_walk_medium {
    double sigma_s, sigma_a, sigma_t; /* m^-1 */
    double albedo;                    /* sigma_s / sigma_t; 0 where both are */
    double g, eta;
} parian_walk_medium;

/* Where the energy of walks went. started + roulette_added = left + absorbed + roulette_removed +
 * lost. */
typedef struct parian_walk_books {
    double started, left, absorbed, roulette_added, roulette_removed;
    double lost;     /* by walks that a hole let out, or that neither matter nor boundary can end */
    uint64_t events; /* scattering events */
    uint64_t lost_walks;
} parian_walk_books;

/* sigma_s is not reduced. */
static inline parian_walk_medium parian_walk_medium_of(double sigma_s, double sigma_a, double g,
                                                       double eta)
{
    double sigma_t = sigma_s + sigma_a;
    return (parian_walk_medium){.sigma_s = sigma_s,
                                .sigma_a = sigma_a,
                                .sigma_t = sigma_t,
                                .albedo = sigma_t > 0 ? sigma_s / sigma_t : 0,
                                .g = g,
                                .eta = eta};
}

static inline parian_walk_medium parian_walk_medium_make(const parian_medium *medium, int channel)
{
    double g = medium->reduced_only ? 0 : medium->g[channel];
    return parian_walk_medium_of(medium->sigma_s_prime[channel] / (1 - g), medium->sigma_a[channel],
                                 g, medium->eta);
}

/* Add a to b; the order of additions is the caller's. */
static inline void parian_walk_books_add(parian_walk_books *b, const parian_walk_books *a)
{
    b->started += a->started;
    b->left += a->left;
    b->absorbed += a->absorbed;
    b->roulette_added += a->roulette_added;
    b->roulette_removed += a->roulette_removed;
    b->lost += a->lost;
    b->events += a->events;
    b->lost_walks += a->lost_walks;
}

/* (started + added - left - absorbed - removed - lost) / started: rounding, and nothing else. */
static inline double parian_walk_books_gap(const parian_walk_books *b)
{
    double in = b->started + b->roulette_added;
    double out = b->left + b->absorbed + b->roulette_removed + b->lost;
    return b->started > 0 ? (in - out) / b->started : in - out;
}

/* Russian roulette: below threshold a walk survives with probability weight / target and goes on
 * with weight target; expectation is kept, and the books say what was added and removed. Returns
 * false when it ended. */
static inline bool parian_walk_roulette(double *weight, double threshold, double target,
                                        parian_random *random, parian_walk_books *books)
{
    if (*weight >= threshold) {
        return true;
    }
    if (parian_random_unit(random) * target < *weight) {
        books->roulette_added += target - *weight;
        *weight = target;
        return true;
    }
    books->roulette_removed += *weight;
    return false;
}

/* Both roulettes, after scattering event number `event` (from 1) of a walk that started with
 * weight 1. */
static inline bool parian_walk_continue(double *weight, uint64_t event, parian_random *random,
                                        parian_walk_books *books)
{
    const double root = 1.4142135623730951;
    if (event >= PARIAN_WALK_LENGTH_FIRST && (event & (event - 1)) == 0 &&
        !parian_walk_roulette(weight, INFINITY, *weight * root, random, books)) {
        return false;
    }
    return parian_walk_roulette(weight, PARIAN_WALK_THRESHOLD, PARIAN_WALK_TARGET, random, books);
}

/* One scattering event: the share 1 - albedo stays. */
static inline void parian_walk_absorb(double *weight, double albedo, parian_walk_books *books)
{
    double kept = *weight * albedo;
    books->absorbed += *weight - kept;
    books->events++;
    *weight = kept;
}

/* ln x for a normal x > 0, to 2 ulp: x = 2^e m with m in [1/sqrt2, sqrt2), ln m = 2 artanh((m -
 * 1)/(m + 1)). */
static inline double parian_walk_log(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    uint64_t shifted = bits - 0x3FE6A09E667F3BCDu; /* the bits of 1/sqrt2 */
    int64_t exponent = (int64_t)shifted >> 52;
    bits = (shifted & 0x000FFFFFFFFFFFFFu) + 0x3FE6A09E667F3BCDu;
    double m;
    memcpy(&m, &bits, sizeof m);
    double s = (m - 1) / (m + 1), z = s * s, z2 = z * z, z4 = z2 * z2;
    double low = (1.0 / 3 + z * (1.0 / 5)) + z2 * (1.0 / 7 + z * (1.0 / 9));
    double high = (1.0 / 11 + z * (1.0 / 13)) + z2 * (1.0 / 15 + z * (1.0 / 17)) + z4 * (1.0 / 19);
    return (double)exponent * 0.6931471805599453 + 2 * (s + s * z * (low + z4 * high));
}

/* Length of a free flight, m; INFINITY where nothing stops it. */
static inline double parian_walk_flight(double sigma_t, parian_random *random)
{
    double u = parian_random_unit(random);
    return sigma_t > 0 ? -parian_walk_log(1 - u) / sigma_t : INFINITY;
}

/* Cosine and sine of a uniform angle, to 1 ulp: a quadrant, and polynomials within 45 degrees of
 * its middle. */
static inline void parian_walk_azimuth(parian_random *random, double *cosine, double *sine)
{
    uint64_t bits = parian_random_bits(random);
    double a = ((double)(bits >> 11 & 0x7FFFFFFFFFFFFu) * 0x1p-51 - 0.5) * 1.5707963267948966;
    double z = a * a, z2 = z * z, z4 = z2 * z2;
    double s_low = (1 - z * (1.0 / 6)) + z2 * (1.0 / 120 - z * (1.0 / 5040));
    double s_high = (1.0 / 362880 - z * (1.0 / 39916800)) +
                    z2 * (1.0 / 6227020800.0 - z * (1.0 / 1307674368000.0));
    double s = a * (s_low + z4 * s_high);
    double c_low = (1 - z * (1.0 / 2)) + z2 * (1.0 / 24 - z * (1.0 / 720));
    double c_high = (1.0 / 40320 - z * (1.0 / 3628800)) +
                    z2 * (1.0 / 479001600.0 - z * (1.0 / 87178291200.0)) +
                    z4 * (1.0 / 20922789888000.0);
    double c = c_low + z4 * c_high;
    bool turn = bits >> 62 & 1, flip = bits >> 63;
    double x = turn ? -s : c, y = turn ? c : s;
    *cosine = flip ? -x : x;
    *sine = flip ? -y : y;
}

/* out = the direction at a polar angle (cosine, sine) and an azimuth (cosine, sine) about a unit
 * axis; a frame without a singular pole, and a step of Newton that holds the length at 1 however
 * often it is repeated. */
static inline void parian_walk_turn(const double axis[3], double cos_polar, double sin_polar,
                                    double cos_azimuth, double sin_azimuth, double out[3])
{
    double x = axis[0], y = axis[1], z = axis[2];
    double sign = z < 0 ? -1 : 1, a = -1 / (sign + z), b = x * y * a;
    double u = sin_polar * cos_azimuth, v = sin_polar * sin_azimuth;
    double p = u * (1 + sign * x * x * a) + v * b + cos_polar * x;
    double q = u * sign * b + v * (sign + y * y * a) + cos_polar * y;
    double r = cos_polar * z - u * sign * x - v * y;
    double scale = 1.5 - 0.5 * (p * p + q * q + r * r);
    out[0] = p * scale;
    out[1] = q * scale;
    out[2] = r * scale;
}

/* Cosine and sine of the polar angle of a Henyey-Greenstein event, |g| < 1. 1 - cos and 1 + cos are
 * formed without a difference, so that neither g near 0 nor g near 1 or -1 loses digits. */
static inline void parian_walk_polar(double g, double u, double *cosine, double *sine)
{
    double below = 1 - g + 2 * g * u, scale = 2 / (below * below);
    double one_less = (1 - g) * (1 - g) * (1 - u) * (1 + g * u) * scale;
    double one_more = (1 + g) * (1 + g) * u * (1 - g * (1 - u)) * scale;
    *cosine = one_less < 1 ? 1 - one_less : one_more - 1;
    *sine = sqrt(one_less * one_more);
}

/* The phase function's value for a cosine, sr^-1; its integral over the sphere is 1. */
static inline double parian_walk_phase(double g, double cosine)
{
    double below = (1 - g) * (1 - g) + 2 * g * (1 - cosine);
    return (1 - g * g) * 0.079577471545947668 / (below * sqrt(below));
}

/* Turn a direction by one scattering event. */
static inline void parian_walk_scatter(double direction[3], double g, parian_random *random)
{
    double u = parian_random_unit(random), cos_polar, sin_polar, cos_azimuth, sin_azimuth;
    parian_walk_azimuth(random, &cos_azimuth, &sin_azimuth);
    if (g == 0) {
        cos_polar = 2 * u - 1;
        sin_polar = 2 * sqrt(u * (1 - u));
        direction[0] = sin_polar * cos_azimuth;
        direction[1] = sin_polar * sin_azimuth;
        direction[2] = cos_polar;
        return;
    }
    parian_walk_polar(g, u, &cos_polar, &sin_polar);
    parian_walk_turn(direction, cos_polar, sin_polar, cos_azimuth, sin_azimuth, direction);
}

/* Exact unpolarised reflectance for a cosine in [0, 1] and eta = n_beyond / n_here, as
 * parian_fresnel_reflectance; cos_beyond (cosine of the refracted direction) is 0 under total
 * reflection. */
static inline double parian_walk_fresnel(double cosine, double eta, double *cos_beyond)
{
    double sin2 = (1 - cosine * cosine) / (eta * eta);
    if (eta == 1) {
        *cos_beyond = cosine;
        return 0;
    }
    if (sin2 >= 1) {
        *cos_beyond = 0;
        return 1;
    }
    double beyond = sqrt(1 - sin2);
    double s_less = cosine - eta * beyond, s_more = cosine + eta * beyond;
    double p_less = eta * cosine - beyond, p_more = eta * cosine + beyond;
    double s = s_less * p_more, p = p_less * s_more, below = s_more * p_more;
    *cos_beyond = beyond;
    return 0.5 * (s * s + p * p) / (below * below);
}

/* out = the direction beyond the boundary. direction: unit, towards the boundary; normal: unit, on
 * the side that it comes from; eta = n_beyond / n_here. Returns the reflectance; 1 under total
 * reflection, out untouched. */
static inline double parian_walk_refract(const double direction[3], const double normal[3],
                                         double eta, double out[3])
{
    double dot = direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
    double cosine = dot > 0 ? 0 : dot < -1 ? 1 : -dot, beyond;
    double reflectance = parian_walk_fresnel(cosine, eta, &beyond);
    if (reflectance < 1) {
        double along = cosine / eta - beyond;
        for (int k = 0; k < 3; k++) {
            out[k] = direction[k] / eta + along * normal[k];
        }
    }
    return reflectance;
}

/* Mirror a direction at a plane with a unit normal (of either side). */
static inline void parian_walk_reflect(double direction[3], const double normal[3])
{
    double twice =
        2 * (direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2]);
    for (int k = 0; k < 3; k++) {
        direction[k] -= twice * normal[k];
    }
}

/* At the boundary: returns the share of the weight that leaves, books it, and keeps the rest. */
static inline double parian_walk_leave(double *weight, double reflectance, parian_walk_books *books)
{
    double kept = *weight * reflectance, out = *weight - kept;
    books->left += out;
    *weight = kept;
    return out;
}

#endif
