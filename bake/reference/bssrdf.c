/* bssrdf.c - the BSSRDF models behind one call, and their normalisation.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/reference/bssrdf.h"

#include <math.h>

#include "bake/reference/bssrdf_models.h"
#include "bake/reference/half_space.h"
#include "core/memory.h"
#include "core/small_maths.h"

struct parian_bssrdf_model {
    parian_reference_model model;
    double eta;
    double scale[PARIAN_CHANNELS];
    parian_dipole dipole[PARIAN_CHANNELS];
    parian_directional_dipole directional[PARIAN_CHANNELS];
    parian_pbd_profile pbd[PARIAN_CHANNELS];
};

static parian_result check(const parian_env *env, const parian_medium *medium,
                           const parian_bssrdf_desc *desc)
{
    if (desc->model < PARIAN_REFERENCE_DIPOLE || desc->model > PARIAN_REFERENCE_PBD) {
        return parian_fail(env, PARIAN_E_ARGUMENT, "reference model %d is not a BSSRDF",
                           (int)desc->model);
    }
    if (!(medium->eta > 0) || !isfinite(medium->eta)) {
        return parian_fail(env, PARIAN_E_ARGUMENT,
                           "medium %s: index of refraction %g, expected a positive number",
                           medium->name, medium->eta);
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        double s = medium->sigma_s_prime[c], a = medium->sigma_a[c];
        if (!(s >= 0 && a >= 0 && isfinite(s) && isfinite(a)) || !isfinite(medium->g[c])) {
            return parian_fail(env, PARIAN_E_ARGUMENT,
                               "medium %s, channel %d: sigma_s' %g, sigma_a %g, g %g: expected "
                               "finite numbers, coefficients not negative",
                               medium->name, c, s, a, medium->g[c]);
        }
    }
    return PARIAN_OK;
}

/* The model of one channel, and its planar total under diffuse light. */
static parian_result make_channel(const parian_env *env, const parian_medium *medium,
                                  const parian_bssrdf_desc *desc, int c, parian_bssrdf_model *m)
{
    parian_bssrdf_channel channel = parian_bssrdf_channel_make(medium, c);
    parian_result result = PARIAN_OK;
    double total = 0;
    m->scale[c] = 1;
    if (desc->model == PARIAN_REFERENCE_DIRECTIONAL) {
        m->directional[c] = parian_directional_dipole_make(&channel, desc->fit_fdr);
        total = desc->normalise ? parian_directional_dipole_diffuse_total(&m->directional[c]) : 0;
    } else if (desc->model == PARIAN_REFERENCE_PBD) {
        result = parian_pbd_profile_make(env, &channel, &m->pbd[c]);
        total = desc->normalise ? m->pbd[c].total : 0;
    } else {
        m->dipole[c] = parian_dipole_make(medium, c, desc->fit_fdr);
    }
    if (total > 0) {
        m->scale[c] = parian_half_space_reflectance(channel.albedo, channel.g, channel.eta) / total;
    }
    return result;
}

parian_result parian_bssrdf_create(const parian_env *env, const parian_medium *medium,
                                   const parian_bssrdf_desc *desc, parian_bssrdf_model **model)
{
    parian_bssrdf_model *m;
    parian_result result = check(env, medium, desc);
    if (result != PARIAN_OK) {
        return result;
    }
    if (!PARIAN_NEW0(env, m, 1)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a BSSRDF model");
    }
    m->model = desc->model;
    m->eta = medium->eta;
    for (int c = 0; c < PARIAN_CHANNELS && result == PARIAN_OK; c++) {
        result = make_channel(env, medium, desc, c, m);
    }
    if (result != PARIAN_OK) {
        parian_bssrdf_destroy(env, m);
        return result;
    }
    *model = m;
    return PARIAN_OK;
}

void parian_bssrdf_destroy(const parian_env *env, parian_bssrdf_model *model)
{
    for (int c = 0; model && c < PARIAN_CHANNELS; c++) {
        parian_pbd_profile_free(env, &model->pbd[c]);
    }
    parian_free(env, model);
}

bool parian_bssrdf_is_directional(const parian_bssrdf_model *model)
{
    return model->model == PARIAN_REFERENCE_DIRECTIONAL;
}

double parian_bssrdf_core_length(const parian_bssrdf_model *model, int channel)
{
    switch (model->model) {
    case PARIAN_REFERENCE_DIRECTIONAL:
        return model->directional[channel].diffusion / 2;
    case PARIAN_REFERENCE_PBD:
        return model->pbd[channel].unit / 8;
    default:
        return model->dipole[channel].z_r;
    }
}

double parian_bssrdf_scale(const parian_bssrdf_model *model, int channel)
{
    return model->scale[channel];
}

/* Direction in which light from w_i travels inside; false where the boundary reflects all of it.
 * Light from below the surface is taken as grazing. */
static bool refract(const double n[3], const double w_i[3], double eta, double w[3])
{
    double cos_i = fmin(1, fmax(0, parian_dot3(n, w_i))), sine2 = (1 - cos_i * cos_i) / (eta * eta);
    double along[3], length = 0;
    for (int k = 0; k < 3; k++) {
        along[k] = parian_dot3(n, w_i) * n[k] - w_i[k];
    }
    length = sqrt(parian_dot3(along, along));
    double sine = length > 0 ? sqrt(sine2) / length : 0;
    for (int k = 0; k < 3; k++) {
        w[k] = along[k] * sine - n[k] * sqrt(fmax(0, 1 - sine2));
    }
    return sine2 <= 1;
}

/* Normal of the modified tangent plane: holds x and is as close to n_i as that allows. */
static void modified_normal(const double x[3], const double n_i[3], double star[3])
{
    double side[3], length2 = parian_dot3(x, x);
    parian_cross3(n_i, x, side);
    double side2 = parian_dot3(side, side);
    parian_cross3(x, side, star);
    double scale = side2 > 1e-20 * length2 ? 1 / sqrt(length2 * side2) : 0;
    for (int k = 0; k < 3; k++) {
        star[k] = scale > 0 ? scale * star[k] : n_i[k];
    }
}

static void directional_value(const parian_bssrdf_model *model, const double x[3],
                              const double n_i[3], const double w_i[3], const double n_o[3],
                              double R[3])
{
    double w[3], star[3];
    if (!refract(n_i, w_i, model->eta, w)) {
        R[0] = R[1] = R[2] = 0;
        return;
    }
    modified_normal(x, n_i, star);
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        R[c] = model->scale[c] *
               parian_directional_dipole_value(&model->directional[c], x, w, star, n_o);
    }
}

void parian_bssrdf_value(const parian_bssrdf_model *model, const double x_i[3], const double n_i[3],
                         const double w_i[3], const double x_o[3], const double n_o[3], double R[3])
{
    double x[3] = {x_o[0] - x_i[0], x_o[1] - x_i[1], x_o[2] - x_i[2]}, r2 = parian_dot3(x, x);
    if (model->model == PARIAN_REFERENCE_DIRECTIONAL) {
        directional_value(model, x, n_i, w_i, n_o, R);
        return;
    }
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        switch (model->model) {
        case PARIAN_REFERENCE_DIPOLE_FLUX:
            R[c] = parian_dipole_flux(&model->dipole[c], x_i, n_i, x_o, n_o);
            break;
        case PARIAN_REFERENCE_PBD:
            R[c] = model->scale[c] * parian_pbd_profile_value(&model->pbd[c], sqrt(r2));
            break;
        default:
            R[c] = parian_dipole_rd(&model->dipole[c], r2);
        }
    }
}
