/* fresnel.c - exact unpolarised Fresnel reflection and its moments.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/fresnel.h"

#include "core/small_maths.h"

double parian_fresnel_reflectance(double cos_i, double eta)
{
    double ci = cos_i < 0 ? 0 : cos_i > 1 ? 1 : cos_i;
    double sin2 = (1 - ci * ci) / (eta * eta);
    if (eta == 1) {
        return 0;
    }
    if (sin2 >= 1) {
        return 1;
    }
    double ct = sqrt(1 - sin2);
    double rs = (ci - eta * ct) / (ci + eta * ct);
    double rp = (eta * ci - ct) / (eta * ci + ct);
    return 0.5 * (rs * rs + rp * rp);
}

double parian_fresnel_transmittance(double cos_i, double eta)
{
    return 1 - parian_fresnel_reflectance(cos_i, eta);
}

float parian_fresnel_transmittancef(float cos_i, float eta)
{
    float ci = cos_i < 0 ? 0 : cos_i > 1 ? 1 : cos_i;
    float sin2 = (1 - ci * ci) / (eta * eta);
    if (eta == 1) {
        return 1;
    }
    if (sin2 >= 1) {
        return 0;
    }
    float ct = sqrtf(1 - sin2);
    float rs = (ci - eta * ct) / (ci + eta * ct);
    float rp = (eta * ci - ct) / (eta * ci + ct);
    return 1 - 0.5f * (rs * rs + rp * rp);
}

/* Integral over mu in [a, b] of R mu^power; mu = a + (b - a) s^2 takes the square-root behaviour at
 * a (the critical angle) out of the integrand. */
static double integrate_moment(double a, double b, double eta, int power)
{
    enum { N = PARIAN_GAUSS_MAX };
    double node[N], weight[N], sum = 0;
    parian_gauss_legendre(N, node, weight);
    for (int i = 0; i < N; i++) {
        double s = node[i], mu = a + (b - a) * s * s;
        sum += weight[i] * 2 * s * (b - a) * parian_fresnel_reflectance(mu, eta) * pow(mu, power);
    }
    return sum;
}

static double moment(double eta, int power)
{
    if (eta == 1) {
        return 0;
    }
    if (eta > 1) {
        return integrate_moment(0, 1, eta, power);
    }
    double critical = sqrt(1 - eta * eta);
    return pow(critical, power + 1) / (power + 1) + integrate_moment(critical, 1, eta, power);
}

double parian_fresnel_c1(double eta)
{
    return moment(eta, 1);
}

double parian_fresnel_c2(double eta)
{
    return moment(eta, 2);
}

double parian_fresnel_fdr(double eta)
{
    return 2 * parian_fresnel_c1(1 / eta);
}

double parian_fresnel_fdr_fit(double eta)
{
    if (eta == 1) {
        return 0;
    }
    if (eta < 1) {
        return -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / (eta * eta * eta);
    }
    return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
}

double parian_fresnel_exit_norm(double eta)
{
    return 1 - 2 * parian_fresnel_c1(eta);
}
