/* bssrdf_channel.c - one channel of a medium and the boundary's constants, as the BSSRDF models
 * take them.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/reference/bssrdf_models.h"
#include "core/fresnel.h"

parian_bssrdf_channel parian_bssrdf_channel_make(const parian_medium *medium, int channel)
{
    parian_bssrdf_channel c = {.eta = medium->eta, .sigma_a = medium->sigma_a[channel]};
    double reduced = medium->sigma_s_prime[channel];
    c.g = medium->reduced_only ? 0 : fmin(fmax(medium->g[channel], -0.995), 0.995);
    c.sigma_s = reduced / (1 - c.g);
    c.sigma_t = c.sigma_s + c.sigma_a;
    c.sigma_t_prime = reduced + c.sigma_a;
    if (!(c.sigma_t_prime > 0)) {
        c.sigma_t_prime = c.sigma_t =
            1; /* an empty channel: any length will do, the albedo is zero */
    }
    c.albedo = c.sigma_s / c.sigma_t;
    c.albedo_prime = reduced / c.sigma_t_prime;
    return c;
}

/* 2 C1 and 3 C2 for light inside a body of index n, n > 1, and 2 C1 for light outside one (n < 1),
 * as printed. */
static double first_moment_fit(double n)
{
    if (n >= 1) {
        return -9.23372 +
               n * (22.2272 + n * (-20.9292 + n * (10.2291 + n * (-2.54396 + 0.254913 * n))));
    }
    return 0.919317 + n * (-3.4793 + n * (6.75335 + n * (-7.80989 + n * (4.98554 - 1.36881 * n))));
}

static double second_moment_fit(double n)
{
    return -1641.1 + n * (1213.67 + n * (-568.556 + n * (164.798 + n * (-27.0181 + 1.91826 * n)))) +
           ((135.926 / n - 656.175) / n + 1376.53) / n;
}

parian_exitance parian_exitance_make(double eta, bool fit)
{
    bool polynomial = fit && eta > 1;
    double first = polynomial ? first_moment_fit(eta) : 2 * parian_fresnel_c1(1 / eta);
    double second = polynomial ? second_moment_fit(eta) : 3 * parian_fresnel_c2(1 / eta);
    double outside = polynomial ? first_moment_fit(1 / eta) : 2 * parian_fresnel_c1(eta);
    parian_exitance e = {
        .c_phi = 0.25 * (1 - first), .c_e = 0.5 * (1 - second), .exit_norm = 1 - outside};
    e.a = (1 - e.c_e) / (2 * e.c_phi);
    return e;
}
