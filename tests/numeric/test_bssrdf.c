/* test_bssrdf.c - the dipoles and the directional dipole against values of public implementations.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>

#include "bake/reference/bssrdf.h"
#include "bake/reference/bssrdf_models.h"
#include "bake/reference/half_space.h"
#include "core/fresnel.h"
#include "core/small_maths.h"

static const parian_medium marble = {
    .sigma_s_prime = {2190, 2620, 3000}, .sigma_a = {2.1, 4.1, 7.1}, .eta = 1.5};
static const parian_medium skimmilk = {
    .sigma_s_prime = {700, 1220, 1900}, .sigma_a = {1.4, 2.5, 14.2}, .eta = 1.3};
static const parian_medium ketchup = {
    .sigma_s_prime = {180, 70, 30}, .sigma_a = {61, 970, 1450}, .eta = 1.3};
static const parian_medium skin = {
    .sigma_s_prime = {740, 880, 1010}, .sigma_a = {32, 170, 480}, .eta = 1.3};

static const double origin[3] = {0, 0, 0}, up[3] = {0, 0, 1};

static void assert_close(double found, double expected, double relative)
{
    if (!(fabs(found - expected) <= relative * fabs(expected))) {
        print_error("found %.15g, expected %.15g within %g\n", found, expected, relative);
        fail();
    }
}

static parian_bssrdf_model *make(const parian_medium *medium, parian_reference_model model,
                                 bool fit, bool normalise)
{
    parian_bssrdf_desc desc = {.model = model, .fit_fdr = fit, .normalise = normalise};
    parian_bssrdf_model *made = NULL;
    assert_int_equal(parian_bssrdf_create(NULL, medium, &desc, &made), PARIAN_OK);
    return made;
}

/* R_d in mm^-2 at radii in mm with the printed fit of F_dr, in double precision, from independent
 * code. */
static const struct {
    const parian_medium *medium;
    double r, rd[3];
} dipole_table[] = {
    {&marble, 0.01, {3.904712542881595e-01, 5.582243431247351e-01, 7.309209004388997e-01}},
    {&marble, 0.1, {3.647715370718181e-01, 5.067872047466274e-01, 6.445189158494030e-01}},
    {&marble, 0.5, {1.254475666731829e-01, 1.332122250226276e-01, 1.356644667643509e-01}},
    {&marble, 1, {3.484669173791536e-02, 3.433002694713737e-02, 3.367507959133184e-02}},
    {&marble, 2, {9.093840301924457e-03, 8.983614406564627e-03, 8.582461976271570e-03}},
    {&marble, 5, {1.266692577747422e-03, 1.008447426599410e-03, 7.609526911425855e-04}},
    {&marble, 10, {1.566955881164652e-04, 9.251443213061096e-05, 4.941714418728127e-05}},
    {&marble, 20, {1.011867250659959e-05, 3.359233800790413e-06, 8.917210086706758e-07}},
    {&skimmilk, 0.01, {4.081966249109146e-02, 1.239657995891819e-01, 2.987429386019125e-01}},
    {&skimmilk, 0.1, {4.053556934564799e-02, 1.213767984500001e-01, 2.837131536849031e-01}},
    {&skimmilk, 0.5, {3.457203939500492e-02, 7.892213230720689e-02, 1.186159019090355e-01}},
    {&skimmilk, 1, {2.314369127621228e-02, 3.496763147729057e-02, 3.692696113874398e-02}},
    {&skimmilk, 2, {9.190400345539942e-03, 1.008452292339944e-02, 9.071250547165175e-03}},
    {&skimmilk, 5, {1.662324234580620e-03, 1.532263614569745e-03, 7.729716300540979e-04}},
    {&skimmilk, 10, {3.604257109945278e-04, 2.234971471468509e-04, 4.476318236025486e-05}},
    {&skimmilk, 20, {4.734356295209733e-05, 1.800505088167621e-05, 5.995389768619551e-07}},
    {&ketchup, 0.01, {2.719914817061914e-03, 2.907555423948585e-03, 1.726942047832580e-03}},
    {&ketchup, 0.1, {2.717268932017756e-03, 2.845536876514255e-03, 1.652841876785639e-03}},
    {&ketchup, 0.5, {2.654320669093239e-03, 1.773054301894718e-03, 6.819718386665661e-04}},
    {&ketchup, 1, {2.471434178201860e-03, 5.904482261348886e-04, 1.182608018462696e-04}},
    {&ketchup, 2, {1.903569642881963e-03, 4.875753370377092e-05, 3.580656399084946e-06}},
    {&ketchup, 5, {5.570309794027696e-04, 6.518430211204183e-08, 4.641951051464240e-10}},
    {&ketchup, 10, {7.313976511369959e-05, 4.539788595862478e-12, 6.206488113246600e-16}},
    {&ketchup, 20, {3.287941327084655e-06, 5.160312178087283e-20, 2.209760111841798e-27}},
};

/* 1e-6 is asked for; rounding alone gives 1e-12. On a plane the flux form is the same number, but
 * for what its differences of like terms leave. */
static void dipole_matches_table(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof dipole_table / sizeof *dipole_table; i++) {
        parian_bssrdf_model *plain =
            make(dipole_table[i].medium, PARIAN_REFERENCE_DIPOLE, true, false);
        parian_bssrdf_model *flux =
            make(dipole_table[i].medium, PARIAN_REFERENCE_DIPOLE_FLUX, true, false);
        double x_o[3] = {0.6e-3 * dipole_table[i].r, -0.8e-3 * dipole_table[i].r, 0}, R[3], F[3];
        parian_bssrdf_value(plain, origin, up, up, x_o, up, R);
        parian_bssrdf_value(flux, origin, up, up, x_o, up, F);
        for (int c = 0; c < 3; c++) {
            assert_close(R[c] * 1e-6, dipole_table[i].rd[c], 1e-10);
            assert_close(F[c], R[c], 1e-10);
        }
        parian_bssrdf_destroy(NULL, plain);
        parian_bssrdf_destroy(NULL, flux);
    }
}

/* Fluence at p of one channel's two point sources for light that enters at the origin along -z, per
 * unit of flux, over albedo' / (4 pi D): a source z_r below the surface and its image z_v above. */
static double sources_at(const parian_dipole *d, const double p[3])
{
    double near = sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] + d->z_r) * (p[2] + d->z_r));
    double far = sqrt(p[0] * p[0] + p[1] * p[1] + (p[2] - d->z_v) * (p[2] - d->z_v));
    return exp(-d->sigma_tr * near) / near - exp(-d->sigma_tr * far) / far;
}

/* Away from the plane the flux form is -D times the gradient of the fluence along the receiver's
 * normal, and not the same with both ends swapped. Central differences of 1e-5 of the distance:
 * 1e-8. */
static void flux_is_the_gradient_at_the_receiver(void **state)
{
    static const double place[][2][3] = {{{1e-3, 0.4e-3, -0.5e-3}, {0.6, 0.48, 0.64}},
                                         {{-0.3e-3, 1.7e-3, -2e-3}, {-0.36, 0.48, -0.8}},
                                         {{0.1e-3, 0.2e-3, -1.5e-3}, {0, 0, -1}}};
    parian_bssrdf_model *flux = make(&marble, PARIAN_REFERENCE_DIPOLE_FLUX, false, false);
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double *x = place[i][0], *n = place[i][1];
        double R[3], step = 1e-5 * sqrt(parian_dot3(x, x));
        parian_bssrdf_value(flux, origin, up, up, x, n, R);
        for (int c = 0; c < 3; c++) {
            parian_dipole d = parian_dipole_make(&marble, c, false);
            double before[3], after[3];
            for (int k = 0; k < 3; k++) {
                before[k] = x[k] - step * n[k];
                after[k] = x[k] + step * n[k];
            }
            double slope = (sources_at(&d, after) - sources_at(&d, before)) / (2 * step);
            assert_true(R[c] > 0);
            assert_close(R[c], -d.albedo / (4 * PARIAN_PI) * slope, 1e-6);
        }
    }
    parian_bssrdf_destroy(NULL, flux);
}

/* The fit is a different number: at eta 1.5 by about 2e-4 in F_dr, hence in R_d. */
static void fit_has_an_effect(void **state)
{
    static const parian_reference_model models[] = {
        PARIAN_REFERENCE_DIPOLE, PARIAN_REFERENCE_DIPOLE_FLUX, PARIAN_REFERENCE_DIRECTIONAL};
    double x_o[3] = {1e-3, 0, 0};
    (void)state;
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        parian_bssrdf_model *fit = make(&marble, models[i], true, false);
        parian_bssrdf_model *exact = make(&marble, models[i], false, false);
        double F[3], R[3];
        parian_bssrdf_value(fit, origin, up, up, x_o, up, F);
        parian_bssrdf_value(exact, origin, up, up, x_o, up, R);
        for (int c = 0; c < 3; c++) {
            double ratio = fabs(F[c] / R[c] - 1);
            assert_true(ratio > 1e-5 && ratio < 5e-3);
        }
        parian_bssrdf_destroy(NULL, fit);
        parian_bssrdf_destroy(NULL, exact);
    }
}

/* S_d in mm^-2 sr^-1, geometry in mm. sd: the authors' sample code, which ray_engine reproduces to
 * 1e-14. raw: appleseed's kernel before it divides by 4 C_phi(1 / eta), hence smaller by that
 * factor, 0.908 for eta 1.5 and 0.939 for 1.3. None holds the transmission on entry or exit. All
 * three take the printed polynomials for the Fresnel moments. */
static const struct {
    const char *name;
    const parian_medium *medium;
    double x_i[3], n_i[3], w_i[3], x_o[3], n_o[3];
    double sd[3], raw[3];
} directional_table[] = {
    {"plane_normal_r0.1",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0, 1},
     {0.10000000000000001, 0, 0},
     {0, 0, 1},
     {2.887107588688187e-01, 3.458881420713671e-01, 3.930109553909595e-01},
     {2.622145357047934e-01, 3.141445055057580e-01, 3.569426563752062e-01}},
    {"plane_normal_r0.5",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0, 1},
     {0.5, 0, 0},
     {0, 0, 1},
     {4.132487442170177e-02, 4.553853719202901e-02, 4.856540648420386e-02},
     {3.753231366230089e-02, 4.135927054907198e-02, 4.410835107934538e-02}},
    {"plane_normal_r1",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0, 1},
     {1, 0, 0},
     {0, 0, 1},
     {1.481978637074075e-02, 1.576677203385765e-02, 1.620976014906884e-02},
     {1.345971108826489e-02, 1.431978782023774e-02, 1.472212101837678e-02}},
    {"plane_normal_r5",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0, 1},
     {5, 0, 0},
     {0, 0, 1},
     {5.212073798269881e-04, 4.037040845863539e-04, 3.002007797803412e-04},
     {4.733739457535885e-04, 3.666544312955016e-04, 2.726500681745833e-04}},
    {"plane_60deg_fwd_r1",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {-0.86602540378443849, 0, 0.5},
     {1, 0, 0},
     {0, 0, 1},
     {1.874857203142175e-02, 1.964506651262991e-02, 1.998018615871580e-02},
     {1.702793525814144e-02, 1.784215460027104e-02, 1.814651888079962e-02}},
    {"plane_60deg_back_r1",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {-0.86602540378443849, 0, 0.5},
     {-1, 0, 0},
     {0, 0, 1},
     {1.041189810323653e-02, 1.127924511798800e-02, 1.175060733856711e-02},
     {9.456353610245204e-03, 1.024410047378115e-02, 1.067220376408524e-02}},
    {"plane_60deg_side_r1",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {-0.86602540378443849, 0, 0.5},
     {0, 1, 0},
     {0, 0, 1},
     {1.441813960071668e-02, 1.533277542129778e-02, 1.575666245111818e-02},
     {1.309492516296086e-02, 1.392562093603255e-02, 1.431060603721523e-02}},
    {"plane_45deg_fwd_r2_skimmilk",
     &skimmilk,
     {0, 0, 0},
     {0, 0, 1},
     {-0.70710678118654757, 0, 0.70710678118654768},
     {2, 0, 0},
     {0, 0, 1},
     {4.774659125744507e-03, 5.564445525722259e-03, 4.909076151789377e-03},
     {4.482851883002370e-03, 5.224369833722644e-03, 4.609053901291764e-03}},
    {"plane_80deg_diag_r3_skimmilk",
     &skimmilk,
     {0, 0, 0},
     {0, 0, 1},
     {-0.98480775301220802, 0, 0.17364817766693044},
     {2, 2.2360679774997898, 0},
     {0, 0, 1},
     {2.302983592381349e-03, 2.309308787765118e-03, 1.587160388278728e-03},
     {2.162234844779729e-03, 2.168173470614525e-03, 1.490159768025876e-03}},
    {"plane_30deg_r1_ketchup",
     &ketchup,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0.5, 0.8660254037844386},
     {0.59999999999999998, -0.80000000000000004, 0},
     {0, 0, 1},
     {4.067620824051589e-03, 3.045928477864006e-03, 1.753214880372023e-03},
     {3.819024812079338e-03, 2.859774038917194e-03, 1.646065702451166e-03}},
    {"sphere10_30deg_normal",
     &marble,
     {0, 0, 10},
     {0, 0, 1},
     {0, 0, 1},
     {4.9999999999999991, 0, 8.6602540378443855},
     {0.5, 0, 0.8660254037844386},
     {5.116705221005560e-04, 3.888296138603161e-04, 2.847050869284806e-04},
     {4.647123263161381e-04, 3.531450544694901e-04, 2.585764814385207e-04}},
    {"corner90_top_to_side",
     &marble,
     {-1, 0, 0},
     {0, 0, 1},
     {-0.70710678118654757, 0, 0.70710678118654768},
     {0, 0, -1},
     {1, 0, 0},
     {1.456595053345571e-02, 1.407052700182309e-02, 1.335675107814918e-02},
     {1.322917085318770e-02, 1.277921446142295e-02, 1.213094481204540e-02}},
    {"slab5_back_offset2",
     &marble,
     {0, 0, 0},
     {0, 0, 1},
     {0, 0, 1},
     {2, 0, -5},
     {0, 0, -1},
     {3.687366591090143e-04, 2.660330417671645e-04, 1.886262656962754e-04},
     {3.348961162529405e-04, 2.416180498517784e-04, 1.713152252277208e-04}},
    {"slab5_back_60deg_offset3",
     &skimmilk,
     {0, 0, 0},
     {0, 0, 1},
     {-0.86602540378443849, 0, 0.5},
     {3, 0, -5},
     {0, 0, -1},
     {5.639539203138599e-04, 2.771195018839731e-04, 9.555401420174197e-05},
     {5.294874098915592e-04, 2.601831142539503e-04, 8.971415156802827e-05}},
    {"generic_pair",
     &skimmilk,
     {0.29999999999999999, -0.20000000000000001, 0.10000000000000001},
     {0.19518001458970663, 0.097590007294853315, 0.97590007294853309},
     {0.5050762722761053, -0.30304576336566319, 0.80812203564176865},
     {1.5, 0.90000000000000002, -0.40000000000000002},
     {0.6188527477552761, 0.30942637387763805, 0.72199487238115534},
     {5.831296537277087e-03, 7.156017878650941e-03, 6.831453169571591e-03},
     {5.474912024929461e-03, 6.718671925528694e-03, 6.413943257170486e-03}},
};

/* R = pi C S_d = pi raw. With the polynomials to rounding (1e-6 is asked for); with exact moments
 * the values differ by up to 0.29 %, because the polynomial of C2 is 0.4 % off. */
static void directional_matches_table(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof directional_table / sizeof *directional_table; i++) {
        parian_exitance fitted = parian_exitance_make(directional_table[i].medium->eta, true);
        double x_i[3], x_o[3], R[3];
        for (int k = 0; k < 3; k++) {
            x_i[k] = 1e-3 * directional_table[i].x_i[k];
            x_o[k] = 1e-3 * directional_table[i].x_o[k];
        }
        for (int fit = 0; fit < 2; fit++) {
            parian_bssrdf_model *model =
                make(directional_table[i].medium, PARIAN_REFERENCE_DIRECTIONAL, fit, false);
            parian_bssrdf_value(model, x_i, directional_table[i].n_i, directional_table[i].w_i, x_o,
                                directional_table[i].n_o, R);
            for (int c = 0; c < 3; c++) {
                double kernel = R[c] * 1e-6 / PARIAN_PI;
                assert_close(kernel, directional_table[i].raw[c], fit ? 1e-9 : 0.0032);
                assert_close(kernel / fitted.exit_norm, directional_table[i].sd[c],
                             fit ? 1e-9 : 0.0032);
            }
            parian_bssrdf_destroy(NULL, model);
        }
    }
}

/* Integral of R over a plane lit from direction w_i: Gauss-Legendre in the logarithm of the radius,
 * panel by panel, and equal steps of azimuth. */
static void plane_total(const parian_bssrdf_model *model, const double w_i[3], double length,
                        double total[3])
{
    enum { PANELS = 12, NODES = 16, AZIMUTHS = 48 };
    double node[NODES], weight[NODES], low = log(1e-4), width = log(1e10) / PANELS;
    parian_gauss_legendre(NODES, node, weight);
    total[0] = total[1] = total[2] = 0;
    for (int p = 0; p < PANELS * NODES; p++) {
        double r = length * exp(low + width * (p / NODES + node[p % NODES]));
        for (int i = 0; i < AZIMUTHS; i++) {
            double azimuth = 2 * PARIAN_PI * i / AZIMUTHS, R[3];
            double x_o[3] = {r * cos(azimuth), r * sin(azimuth), 0};
            parian_bssrdf_value(model, origin, up, w_i, x_o, up, R);
            for (int c = 0; c < 3; c++) {
                total[c] += weight[p % NODES] * width * r * r * 2 * PARIAN_PI / AZIMUTHS * R[c];
            }
        }
    }
}

/* The same over uniform light from outside, weighted with what the boundary lets in. */
static void diffuse_total(const parian_bssrdf_model *model, double eta, double length,
                          double total[3])
{
    enum { N = 20 };
    double node[N], weight[N], entered = 0;
    parian_gauss_legendre(N, node, weight);
    total[0] = total[1] = total[2] = 0;
    for (int i = 0; i < N; i++) {
        double cosine = node[i], w_i[3] = {sqrt(1 - cosine * cosine), 0, cosine}, one[3];
        double flux = weight[i] * cosine * parian_fresnel_transmittance(cosine, eta);
        if (flux > 0) {
            plane_total(model, w_i, length, one);
            entered += flux;
            for (int c = 0; c < 3; c++) {
                total[c] += flux * one[c];
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        total[c] /= entered;
    }
}

/* Totals of the printed model at normal incidence, from independent code: marble 0.977, skin 0.391.
 * 0.3 %: that code's trapezoidal rule, and three decimals. */
static void directional_raw_totals(void **state)
{
    double total[3];
    (void)state;
    parian_bssrdf_model *model = make(&marble, PARIAN_REFERENCE_DIRECTIONAL, false, false);
    plane_total(model, up, 1e-4, total);
    assert_close(total[1], 0.977, 0.003);
    parian_bssrdf_destroy(NULL, model);
    model = make(&skin, PARIAN_REFERENCE_DIRECTIONAL, false, false);
    plane_total(model, up, 1e-4, total);
    assert_close(total[1], 0.391, 0.003);
    assert_true(parian_bssrdf_scale(model, 1) == 1);
    parian_bssrdf_destroy(NULL, model);
}

/* Normalised, a half-space under uniform light reflects what radiative transfer does. 1e-3: two
 * quadratures of the model, with different rules. */
static void directional_normalised(void **state)
{
    parian_medium clear = {.sigma_s_prime = {1000, 1000, 1000}, .sigma_a = {0, 0.1, 100}, .eta = 1};
    parian_medium thin = marble, forward = skimmilk;
    const parian_medium *media[] = {&marble, &skin, &ketchup, &clear, &thin, &forward};
    (void)state;
    thin.eta = 0.7;
    forward.g[0] = 0.8, forward.g[1] = 0.5, forward.g[2] = -0.5;
    for (size_t i = 0; i < sizeof media / sizeof *media; i++) {
        parian_bssrdf_model *model = make(media[i], PARIAN_REFERENCE_DIRECTIONAL, false, true);
        double total[3];
        diffuse_total(model, media[i]->eta, 1e-4, total);
        for (int c = 0; c < 3; c++) {
            parian_bssrdf_channel channel = parian_bssrdf_channel_make(media[i], c);
            double target = parian_half_space_reflectance(channel.albedo, channel.g, channel.eta);
            assert_close(total[c], target, 1e-3);
        }
        parian_bssrdf_destroy(NULL, model);
    }
}

/* The table of docs/reference.md: transfer, dipole, pbd, and the directional dipole under diffuse
 * and normal light, before normalisation. One in the last digit. */
static void documented_totals(void **state)
{
    const parian_medium matched = {
        .sigma_s_prime = {990, 900, 500}, .sigma_a = {10, 100, 500}, .eta = 1};
    parian_medium rarer = matched, forward = matched;
    const struct {
        const parian_medium *medium;
        int channel;
        double total[5];
    } table[] = {
        {&marble, 0, {0.8425, 0.8303, 0.8586, 1.0195, 1.0191}},
        {&marble, 1, {0.8050, 0.7911, 0.8191, 0.9783, 0.9767}},
        {&marble, 2, {0.7677, 0.7528, 0.7798, 0.9374, 0.9346}},
        {&skimmilk, 2, {0.7084, 0.6824, 0.7255, 0.9204, 0.9122}},
        {&skin, 0, {0.4575, 0.4360, 0.4627, 0.6568, 0.6359}},
        {&skin, 1, {0.2272, 0.2274, 0.2282, 0.4199, 0.3906}},
        {&ketchup, 0, {0.1586, 0.1639, 0.1598, 0.3499, 0.3191}},
        {&ketchup, 2, {0.0017, 0.0018, 0.0016, 0.1726, 0.1410}},
        {&matched, 0, {0.7946, 0.7467, 0.8411, 1.0982, 1.0866}},
        {&rarer, 1, {0.4525, 0.3704, 0.4479, 0.7382, 0.6710}},
        {&forward, 1, {0.2970, 0.2992, 0.2428, 0.5015, 0.4746}},
    };
    (void)state;
    rarer.eta = 0.7;
    forward.eta = 1.3;
    forward.g[1] = 0.9;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        parian_bssrdf_channel channel =
            parian_bssrdf_channel_make(table[i].medium, table[i].channel);
        parian_dipole dipole = parian_dipole_make(table[i].medium, table[i].channel, false);
        parian_directional_dipole ray = parian_directional_dipole_make(&channel, false);
        parian_pbd_profile profile;
        assert_int_equal(parian_pbd_profile_make(NULL, &channel, &profile), PARIAN_OK);
        const double found[5] = {
            parian_half_space_reflectance(channel.albedo, channel.g, channel.eta),
            parian_dipole_total(&dipole), profile.total,
            parian_directional_dipole_diffuse_total(&ray),
            parian_directional_dipole_planar_total(&ray, 1)};
        for (int k = 0; k < 5; k++) {
            assert_true(fabs(found[k] - table[i].total[k]) < 1e-4);
        }
        parian_pbd_profile_free(NULL, &profile);
    }
}

/* Turning the whole scene turns nothing else: values depend on relative places and directions only.
 */
static void directional_is_invariant(void **state)
{
    const double n_i[3] = {0, 0, 1}, w_i[3] = {0.6, 0, 0.8}, x_o[3] = {1e-3, 5e-4, -2e-4},
                 n_o[3] = {0.8, 0, 0.6};
    const double n_j[3] = {1, 0, 0}, w_j[3] = {0.8, 0.6, 0}, x_j[3] = {1 - 2e-4, 1e-3, 5e-4},
                 n_p[3] = {0.6, 0.8, 0};
    const double shift[3] = {1, 0, 0};
    double R[3], Q[3];
    (void)state;
    parian_bssrdf_model *model = make(&marble, PARIAN_REFERENCE_DIRECTIONAL, false, false);
    assert_true(parian_bssrdf_is_directional(model));
    parian_bssrdf_value(model, origin, n_i, w_i, x_o, n_o, R);
    parian_bssrdf_value(model, shift, n_j, w_j, x_j, n_p, Q);
    for (int c = 0; c < 3; c++) {
        assert_true(R[c] > 0);
        assert_close(Q[c], R[c], 1e-9);
    }
    parian_bssrdf_destroy(NULL, model);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dipole_matches_table),
        cmocka_unit_test(flux_is_the_gradient_at_the_receiver),
        cmocka_unit_test(fit_has_an_effect),
        cmocka_unit_test(directional_matches_table),
        cmocka_unit_test(directional_raw_totals),
        cmocka_unit_test(directional_normalised),
        cmocka_unit_test(directional_is_invariant),
        cmocka_unit_test(documented_totals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
