/* factor_row.c - throughput factors between one vertex and all others, prefiltered, before any is
 * dropped.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/factor_row.h"

#include <math.h>
#include <string.h>

#include "core/clones.h"
#include "core/half.h"
#include "core/lanes.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { SCALED_EXPONENT = 13 };
/* Squared distances over 8 (bias_v + bias_u), which is the squared edge of an equilateral mesh. */
static const float PREFILTER_FROM = 1.5f, PREFILTER_FULL = 2.4f, PREFILTER_TO = 144;

parian_result parian_factor_cap(const parian_env *env, parian_factor_maker *maker)
{
    uint32_t count = maker->frame.points.count;
    if (!PARIAN_NEW(env, maker->cap, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the caps of %u vertices", count);
    }
    for (uint32_t v = 0; v < count; v++) {
        double area = maker->frame.area[v];
        for (int c = 0; c < 3; c++) {
            const parian_dipole *d = &maker->model.dipole[c];
            double energy = parian_dipole_disc_energy(d, sqrt(area / PARIAN_PI));
            maker->cap[v][c] = (float)(area > 0 ? energy / area : parian_dipole_rd(d, 0));
        }
    }
    return PARIAN_OK;
}

parian_result parian_factor_maker_make(const parian_env *env, const parian_body *body,
                                       parian_factor_maker *maker)
{
    bool split = body->local_form == PARIAN_LOCAL_SPLIT;
    bool diagonal = split || body->local_form == PARIAN_LOCAL_NONE;
    memset(maker, 0, sizeof *maker);
    maker->body = body;
    maker->position = (const float(*)[3])body->vertex_position;
    parian_result result = parian_transport_model_make(
        env, body, split ? PARIAN_MODEL_FAR : PARIAN_MODEL_FULL, &maker->model);
    if (result == PARIAN_OK) {
        result = parian_vertex_frame_make(env, body, &maker->frame);
    }
    if (result == PARIAN_OK && !body->paper_form) {
        result = parian_factor_cap(env, maker);
    }
    if (result == PARIAN_OK && diagonal && !body->paper_form) {
        if (!PARIAN_NEW(env, maker->total, body->vertex_count)) {
            return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u row sums",
                               body->vertex_count);
        }
        result = parian_vertex_totals(env, body, &maker->model, &maker->frame, false, maker->total);
    }
    return result;
}

void parian_factor_maker_free(const parian_env *env, parian_factor_maker *maker)
{
    parian_transport_model_free(env, &maker->model);
    parian_vertex_frame_free(env, &maker->frame);
    parian_free(env, maker->total);
    parian_free(env, maker->cap);
    parian_free(env, maker->own_position);
    memset(maker, 0, sizeof *maker);
}

/* Linear interpolation at both ends widens R_d by kappa times its Laplacian. The factor takes that
 * off beforehand, as R / (1 + kappa L / R), which never changes sign; nothing in the first ring,
 * where R_d and hats have nothing in common and the blend takes over. */
static float prefilter_factor(float value, float widening, float strength)
{
    if (!(value > 0)) {
        return 1;
    }
    float ratio = strength * widening / value;
    return ratio > 0 ? 1 / (1 + ratio) : fminf(1 - ratio, 2.0f);
}

/* How far a pair is from the first ring, 0 to 1. Opposite sides of a sheet are never neighbours on
 * the surface, however near they are. */
static float prefilter_strength(float t, float facing)
{
    float ramp = (t - PREFILTER_FROM) / (PREFILTER_FULL - PREFILTER_FROM);
    if (facing < 0 || ramp >= 1) {
        return 1;
    }
    return ramp > 0 ? ramp * ramp * (3 - 2 * ramp) : 0;
}

/* Share of the squared distance that lies along a normal. */
static float normal_share(const double d[3], const float n[3], float r2)
{
    double along = d[0] * n[0] + d[1] * n[1] + d[2] * n[2];
    return (float)fmin(1, along * along / r2);
}

/* Vertices far nearer than their areas let expect. */
static void cap_one(const parian_factor_maker *maker, uint32_t v, uint32_t u, const parian_row *row)
{
    for (int c = 0; c < 3; c++) {
        float cap = fminf(maker->cap[v][c], maker->cap[u][c]);
        row->value[c][u] = fminf(row->value[c][u], cap);
    }
}

/* Each end widens R_d by its bias times the Laplacian over its own tangent plane, which is
 * 4 f' + 4 (r^2 - a^2) f'' for a point a away from that plane (f a function of r^2). */
static void prefilter_one(const parian_factor_maker *maker, uint32_t v, uint32_t u,
                          const parian_row *row)
{
    const parian_vertex_frame *frame = &maker->frame;
    float r2 = row->r2[u], plain[3], laplacian[3], slope[3];
    const float *nv = frame->normal[v], *nu = frame->normal[u];
    float t = r2 / (8 * (frame->bias[v] + frame->bias[u]));
    float strength = prefilter_strength(t, nv[0] * nu[0] + nv[1] * nu[1] + nv[2] * nu[2]);
    if (!(t > PREFILTER_FROM)) {
        cap_one(maker, v, u, row);
    }
    if (!(strength > 0 && t < PREFILTER_TO && r2 > 0)) {
        return;
    }
    double d[3];
    parian_sub3(maker->position[u], maker->position[v], d);
    float off_v = normal_share(d, nv, r2), off_u = normal_share(d, nu, r2);
    parian_radial_eval(&maker->model.value, r2, plain);
    parian_radial_eval(&maker->model.laplacian, r2, laplacian);
    parian_radial_eval(&maker->model.slope, r2, slope);
    for (int c = 0; c < 3; c++) {
        float curved = laplacian[c] - 4 * slope[c];
        float widening = frame->bias[v] * (4 * slope[c] + (1 - off_v) * curved) +
                         frame->bias[u] * (4 * slope[c] + (1 - off_u) * curved);
        row->value[c][u] *= prefilter_factor(plain[c], widening, strength);
    }
}

/* Least of sixteen, to pass over what is far. */
static float least_of_16(const float *r2)
{
    float least = r2[0];
    for (int k = 1; k < 16; k++) {
        least = r2[k] < least ? r2[k] : least;
    }
    return least;
}

static void prefilter_row(const parian_factor_maker *maker, uint32_t v, const parian_row *row)
{
    const parian_point_arrays *points = &maker->frame.points;
    float reach2 = PREFILTER_TO * 8 * (maker->frame.bias[v] + maker->frame.bias_max);
    for (uint32_t u = 0; u < points->padded; u += 16) {
        if (least_of_16(row->r2 + u) > reach2) {
            continue;
        }
        for (uint32_t k = u; k < u + 16 && k < points->count; k++) {
            prefilter_one(maker, v, k, row);
        }
    }
}

void parian_factor_row(const parian_factor_maker *maker, uint32_t v, const parian_row *row)
{
    const parian_point_arrays *points = &maker->frame.points;
    parian_transport_model_row(&maker->model, maker->position[v], maker->frame.normal[v], false,
                               points, row->r2, row->value);
    if (maker->cap) {
        prefilter_row(maker, v, row);
    }
    for (int c = 0; c < 3; c++) {
        for (uint32_t u = points->count; u < points->padded; u++) {
            row->value[c][u] = 0;
        }
        row->value[c][v] = 0;
        float area = maker->frame.area[v];
        if (maker->total && area > 0) {
            double rest = maker->total[v][c] -
                          parian_row_dot(maker->frame.area, row->value[c], points->padded);
            row->value[c][v] = (float)fmax(0, rest / area);
        }
    }
}

PARIAN_CLONES
static float largest(const float *value, uint32_t padded)
{
    parian_lanes v, most = {0};
    for (uint32_t i = 0; i < padded; i += 16) {
        PARIAN_LANES_LOAD(v, value + i);
        v = (parian_lanes)((parian_lane_mask)v & 0x7fffffff);
        parian_lane_mask more = v > most;
        most = (parian_lanes)(((parian_lane_mask)v & more) | ((parian_lane_mask)most & ~more));
    }
    float all = 0;
    for (int k = 0; k < 16; k++) {
        all = most[k] > all ? most[k] : all;
    }
    return all;
}

/* Power of two that brings the largest factor into [2^13, 2^14). */
static float choose_scale(float most)
{
    int exponent;
    if (!(most > 0)) {
        return 1;
    }
    frexpf(most, &exponent);
    exponent -= SCALED_EXPONENT + 1;
    return ldexpf(1, exponent < -120 ? -120 : exponent > 120 ? 120 : exponent);
}

float parian_factor_scale(const float *value, uint32_t padded)
{
    return choose_scale(largest(value, padded));
}

/* The number towards zero that a half can hold. */
static inline float truncate_to_half(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits &= 0xffffe000u;
    memcpy(&value, &bits, sizeof bits);
    return value;
}

/* What would be a subnormal half is 2^-28 of the row's largest factor: zero. */
static inline float scale_factor(float value, float inverse)
{
    float scaled = value * inverse;
    scaled = scaled < 0 ? truncate_to_half(scaled) : scaled;
    return fabsf(scaled) < PARIAN_HALF_MIN_NORMAL ? 0.0f : scaled;
}

PARIAN_CLONES
static void interleave(const float *restrict r, const float *restrict g, const float *restrict b,
                       const float inverse[3], uint32_t count, float (*restrict out)[3])
{
    float ir = inverse[0], ig = inverse[1], ib = inverse[2];
    for (uint32_t i = 0; i < count; i++) {
        out[i][0] = scale_factor(r[i], ir);
        out[i][1] = scale_factor(g[i], ig);
        out[i][2] = scale_factor(b[i], ib);
    }
}

void parian_factor_code_run(const parian_row *row, const float scale[3], uint32_t first,
                            uint32_t count, float (*coded)[3], parian_half (*factor)[3])
{
    const float inverse[3] = {1 / scale[0], 1 / scale[1], 1 / scale[2]};
    interleave(row->value[0] + first, row->value[1] + first, row->value[2] + first, inverse, count,
               coded);
    parian_half_from_float_array(coded[0], factor[0], 3 * (size_t)count);
}

void parian_factor_code(const parian_row *row, float (*coded)[3], parian_operator *op, uint32_t v)
{
    for (uint32_t r = op->run_offset[v]; r < op->run_offset[v + 1]; r++) {
        parian_factor_code_run(row, op->scale[v], op->run_column[r], op->run_count[r], coded,
                               op->factor + op->run_factor[r]);
    }
}
