/* transport_model.c - R_d of a body between any two surface points.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/transport_model.h"

#include <math.h>

#include "core/clones.h"
#include "core/memory.h"
#include "core/small_maths.h"

double parian_split_weight(double t)
{
    return t >= 1 ? 1 : t <= 0 ? 0 : t * t * t * (10 - 15 * t + 6 * t * t);
}

static double share_weight(const parian_transport_model *model, double r2)
{
    if (model->share == PARIAN_MODEL_FULL) {
        return 1;
    }
    double far = parian_split_weight(sqrt(r2) / model->split_radius);
    return model->share == PARIAN_MODEL_FAR ? far : 1 - far;
}

double parian_transport_model_exact(const parian_transport_model *model, int channel, double r2)
{
    return share_weight(model, r2) * parian_dipole_rd(&model->dipole[channel], r2);
}

static double tabulate_value(const void *context, int channel, double r2)
{
    return parian_transport_model_exact(context, channel, r2);
}

/* 4 (f' + r2 f'') by differences in r2; the closed form where nothing is cut. */
static double tabulate_laplacian(const void *context, int channel, double r2)
{
    const parian_transport_model *model = context;
    if (model->share == PARIAN_MODEL_FULL) {
        return parian_dipole_laplacian(&model->dipole[channel], r2);
    }
    double h = 1e-3 * (r2 + model->z_min * model->z_min), s = fmax(r2, h);
    double f0 = parian_transport_model_exact(model, channel, s - h);
    double f1 = parian_transport_model_exact(model, channel, s);
    double f2 = parian_transport_model_exact(model, channel, s + h);
    return 4 * ((f2 - f0) / (2 * h) + s * (f2 - 2 * f1 + f0) / (h * h));
}

/* f' by differences in r2; the closed form where nothing is cut. */
static double tabulate_slope(const void *context, int channel, double r2)
{
    const parian_transport_model *model = context;
    if (model->share == PARIAN_MODEL_FULL) {
        return parian_dipole_slope(&model->dipole[channel], r2);
    }
    double h = 1e-3 * (r2 + model->z_min * model->z_min), s = fmax(r2, h);
    return (parian_transport_model_exact(model, channel, s + h) -
            parian_transport_model_exact(model, channel, s - h)) /
           (2 * h);
}

static double tabulate_gradient(const void *context, int channel, double q2)
{
    const parian_transport_model *model = context;
    const parian_dipole *d = &model->dipole[channel];
    double q = sqrt(fmax(q2, model->z_min * model->z_min / 16)), s = d->sigma_tr;
    return d->albedo / (4 * PARIAN_PI) * (1 + s * q) * exp(-s * q) / (q * q * q);
}

/* Diagonal of the box around the vertices. */
static double body_diagonal(const parian_body *body)
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        float low = INFINITY, high = -INFINITY;
        for (uint32_t v = 0; v < body->vertex_count; v++) {
            low = fminf(low, body->vertex_position[v][k]);
            high = fmaxf(high, body->vertex_position[v][k]);
        }
        if (high > low) {
            sum += ((double)high - low) * ((double)high - low);
        }
    }
    return sqrt(sum);
}

static void make_dipoles(const parian_body *body, parian_transport_model *model, double *z_max)
{
    model->z_min = INFINITY;
    *z_max = 0;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        model->dipole[c] = parian_dipole_make(&body->medium, c, body->fit_fdr);
        if (model->dipole[c].albedo > 0) {
            model->z_min = fmin(model->z_min, model->dipole[c].z_r);
            *z_max = fmax(*z_max, model->dipole[c].z_v);
        }
    }
    if (!isfinite(model->z_min)) {
        model->z_min = *z_max = 1;
    }
}

parian_result parian_transport_model_make(const parian_env *env, const parian_body *body,
                                          parian_model_share share, parian_transport_model *model)
{
    double z_max, reach = 1.01 * body_diagonal(body);
    memset(model, 0, sizeof *model);
    model->share = body->local_form == PARIAN_LOCAL_SPLIT ? share : PARIAN_MODEL_FULL;
    model->split_radius = body->split_radius_m;
    model->flux = body->bssrdf == PARIAN_BSSRDF_DIPOLE_FLUX;
    make_dipoles(body, model, &z_max);
    double offset = model->z_min * model->z_min;
    if (model->share != PARIAN_MODEL_FULL) {
        offset = fmin(offset, model->split_radius * model->split_radius / 16);
    }
    parian_result result =
        parian_radial_table_make(env, tabulate_value, model, offset, reach, &model->value);
    if (result == PARIAN_OK) {
        result = parian_radial_table_make(env, tabulate_laplacian, model, offset, reach,
                                          &model->laplacian);
    }
    if (result == PARIAN_OK) {
        result = parian_radial_table_make(env, tabulate_slope, model, offset, reach, &model->slope);
    }
    if (result == PARIAN_OK && model->flux) {
        result = parian_radial_table_make(env, tabulate_gradient, model, offset / 16, reach + z_max,
                                          &model->gradient);
    }
    if (result != PARIAN_OK) {
        parian_transport_model_free(env, model);
    }
    return result;
}

void parian_transport_model_free(const parian_env *env, parian_transport_model *model)
{
    parian_radial_table_free(env, &model->value);
    parian_radial_table_free(env, &model->laplacian);
    parian_radial_table_free(env, &model->slope);
    parian_radial_table_free(env, &model->gradient);
}

/* Flux of the two sources of one channel; dot products of d = x_o - x_i with the normals are given.
 */
static inline float flux_value(const parian_radial_table *table, int channel, float z_r, float z_v,
                               float d2, float d_ni, float d_no, float ni_no)
{
    float least = z_r * z_r * (1.0f / 16), t, u;
    float real2 = fmaxf(d2 + 2 * z_r * d_ni + z_r * z_r, least);
    float image2 = fmaxf(d2 - 2 * z_v * d_ni + z_v * z_v, least);
    const float *p = table->cell + PARIAN_TABLE_STRIDE * parian_radial_cell(table, real2, &t);
    const float *q = table->cell + PARIAN_TABLE_STRIDE * parian_radial_cell(table, image2, &u);
    float real = p[channel] + t * (p[channel + 3] + t * p[channel + 6]);
    float image = q[channel] + u * (q[channel + 3] + u * q[channel + 6]);
    return fmaxf(0.0f, (d_no + z_r * ni_no) * real - (d_no - z_v * ni_no) * image);
}

static inline float dot3f(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void eval_flux(const parian_transport_model *model, const float x_i[3], const float n_i[3],
                      const float x_o[3], const float n_o[3], float value[3])
{
    float d[3] = {x_o[0] - x_i[0], x_o[1] - x_i[1], x_o[2] - x_i[2]};
    float d2 = dot3f(d, d), d_ni = dot3f(d, n_i), d_no = dot3f(d, n_o), ni_no = dot3f(n_i, n_o);
    float weight = (float)share_weight(model, d2);
    for (int c = 0; c < 3; c++) {
        value[c] = weight * flux_value(&model->gradient, c, (float)model->dipole[c].z_r,
                                       (float)model->dipole[c].z_v, d2, d_ni, d_no, ni_no);
    }
}

void parian_transport_model_eval(const parian_transport_model *model, const float x_i[3],
                                 const float n_i[3], const float x_o[3], const float n_o[3],
                                 float value[3])
{
    if (model->flux) {
        eval_flux(model, x_i, n_i, x_o, n_o, value);
    } else {
        parian_radial_eval(&model->value, parian_distance2f(x_i, x_o), value);
    }
}

parian_result parian_point_arrays_make(const parian_env *env, const float (*position)[3],
                                       const float (*normal)[3], uint32_t count,
                                       parian_point_arrays *points)
{
    size_t padded = ((size_t)count + 15) & ~(size_t)15;
    memset(points, 0, sizeof *points);
    if (!PARIAN_NEW(env, points->base, padded * (normal ? 6 : 3))) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u points", count);
    }
    float *column[6];
    for (int k = 0; k < 6; k++) {
        column[k] = k < 3 || normal ? points->base + k * padded : NULL;
    }
    for (size_t i = 0; i < padded; i++) {
        size_t from = i < count ? i : count - 1;
        for (int k = 0; k < 3; k++) {
            column[k][i] = position[from][k];
            if (normal) {
                column[3 + k][i] = normal[from][k];
            }
        }
    }
    points->count = count;
    points->padded = (uint32_t)padded;
    points->x = column[0], points->y = column[1], points->z = column[2];
    points->nx = column[3], points->ny = column[4], points->nz = column[5];
    return PARIAN_OK;
}

void parian_point_arrays_free(const parian_env *env, parian_point_arrays *points)
{
    parian_free(env, points->base);
    memset(points, 0, sizeof *points);
}

PARIAN_CLONES
static void distance_row(const parian_point_arrays *points, const float p[3], float *restrict r2)
{
    const float *restrict x = points->x, *restrict y = points->y, *restrict z = points->z;
    float px = p[0], py = p[1], pz = p[2];
    for (uint32_t i = 0; i < points->padded; i++) {
        float dx = px - x[i], dy = py - y[i], dz = pz - z[i];
        r2[i] = dx * dx + dy * dy + dz * dz;
    }
}

PARIAN_CLONES
static void flux_row(const parian_transport_model *model, int channel, const float p[3],
                     const float n[3], bool as_source, const parian_point_arrays *points,
                     const float *restrict r2, float *restrict value)
{
    const parian_radial_table table = model->gradient;
    float z_r = (float)model->dipole[channel].z_r, z_v = (float)model->dipole[channel].z_v;
    float sign = as_source ? 1.0f : -1.0f; /* d points from source to receiver */
    for (uint32_t i = 0; i < points->padded; i++) {
        float dx = sign * (points->x[i] - p[0]), dy = sign * (points->y[i] - p[1]);
        float dz = sign * (points->z[i] - p[2]);
        float here = dx * n[0] + dy * n[1] + dz * n[2];
        float there = dx * points->nx[i] + dy * points->ny[i] + dz * points->nz[i];
        float nn = points->nx[i] * n[0] + points->ny[i] * n[1] + points->nz[i] * n[2];
        value[i] = flux_value(&table, channel, z_r, z_v, r2[i], as_source ? here : there,
                              as_source ? there : here, nn);
    }
}

/* Weigh a row of the flux form by its share; the distance-only tables hold the share already. */
static void weigh_row(const parian_transport_model *model, uint32_t count, const float *r2,
                      float *const value[3])
{
    float radius2 = (float)(model->split_radius * model->split_radius);
    for (uint32_t i = 0; i < count; i++) {
        if (model->share == PARIAN_MODEL_FAR && r2[i] >= radius2) {
            continue;
        }
        float weight = (float)share_weight(model, r2[i]);
        for (int c = 0; c < 3; c++) {
            value[c][i] *= weight;
        }
    }
}

void parian_transport_model_row(const parian_transport_model *model, const float x[3],
                                const float n[3], bool as_source, const parian_point_arrays *points,
                                float *r2, float *const value[3])
{
    distance_row(points, x, r2);
    if (!model->flux) {
        parian_radial_eval_array(&model->value, r2, points->padded, value[0], value[1], value[2]);
        return;
    }
    for (int c = 0; c < 3; c++) {
        flux_row(model, c, x, n, as_source, points, r2, value[c]);
    }
    if (model->share != PARIAN_MODEL_FULL) {
        weigh_row(model, points->padded, r2, value);
    }
}
