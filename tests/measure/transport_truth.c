/* transport_truth.c - sums E over all texels of a body.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tests/measure/transport_truth.h"

#include <math.h>
#include <stdatomic.h>

#include "core/memory.h"
#include "core/small_maths.h"
#include "core/transport_model.h"

enum { RECEIVERS_PER_PIECE = 16 };
static const double NEAR_EDGES_SQUARED =
    400; /* r^2 over the texel's area below which Gauss points are taken */

/* One body's texels, ready for sums over all of them. */
typedef struct transport_sum {
    const parian_env *env;
    const parian_body *body;
    const float (*irradiance)[3]; /* of its texels */
    parian_transport_model model;
    parian_point_arrays points;
    const parian_texel_choice *choice;
    size_t first; /* its first texel in the scene */
    double (*radiosity)[3];
    atomic_bool no_memory;
} transport_sum;

/* R of texel i at receiver o, as the mean over 2 x 2 Gauss points on the tangent plane of i. */
static void gauss_mean(const transport_sum *sum, uint32_t i, uint32_t o, double R[3])
{
    const parian_body *body = sum->body;
    double n[3], n_o[3], x_o[3], u[3], v[3], axis[3] = {0, 0, 0},
                                             step = sqrt(body->texel_area[i] / 12.0);
    for (int k = 0; k < 3; k++) {
        n[k] = body->texel_normal[i][k];
        n_o[k] = body->texel_normal[o][k];
        x_o[k] = body->texel_position[o][k];
        R[k] = 0;
    }
    axis[fabs(n[0]) < 0.6 ? 0 : 1] = 1;
    parian_cross3(n, axis, u);
    double length = sqrt(parian_dot3(u, u));
    for (int k = 0; k < 3; k++) {
        u[k] /= length;
    }
    parian_cross3(n, u, v);
    for (int q = 0; q < 4; q++) {
        double a = q & 1 ? step : -step, b = q & 2 ? step : -step, p[3], square = 0;
        for (int k = 0; k < 3; k++) {
            p[k] = body->texel_position[i][k] + a * u[k] + b * v[k];
            square += (p[k] - x_o[k]) * (p[k] - x_o[k]);
        }
        for (int c = 0; c < 3; c++) {
            R[c] +=
                0.25 * (sum->model.flux ? parian_dipole_flux(&sum->model.dipole[c], p, n, x_o, n_o)
                                        : parian_dipole_rd(&sum->model.dipole[c], square));
        }
    }
}

static void self_value(const transport_sum *sum, uint32_t o, double R[3])
{
    double area = sum->body->texel_area[o];
    for (int c = 0; c < 3; c++) {
        R[c] = parian_dipole_disc_energy(&sum->model.dipole[c], sqrt(area / PARIAN_PI)) / area;
    }
}

/* row: squared distances and three channels, [padded] each. */
static void sum_receiver(const transport_sum *sum, uint32_t o, float *row, double B[3])
{
    const parian_body *body = sum->body;
    size_t padded = sum->points.padded;
    float *const value[3] = {row + padded, row + 2 * padded, row + 3 * padded};
    parian_transport_model_row(&sum->model, body->texel_position[o], body->texel_normal[o], false,
                               &sum->points, row, value);
    B[0] = B[1] = B[2] = 0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        double area = body->texel_area[i], R[3] = {value[0][i], value[1][i], value[2][i]};
        if (i == o) {
            self_value(sum, o, R);
        } else if (row[i] < NEAR_EDGES_SQUARED * area) {
            gauss_mean(sum, i, o, R);
        }
        for (int c = 0; c < 3; c++) {
            B[c] += area * R[c] * sum->irradiance[i][c];
        }
    }
}

static void sum_piece(void *context, size_t piece)
{
    transport_sum *sum = context;
    size_t begin = piece * RECEIVERS_PER_PIECE, end = begin + RECEIVERS_PER_PIECE;
    float *row = parian_alloc(sum->env, sum->points.padded, 4 * sizeof *row);
    if (!row) {
        atomic_store(&sum->no_memory, true);
        return;
    }
    for (size_t k = begin; k < end && k < sum->choice->count && !parian_cancelled(sum->env); k++) {
        size_t texel = sum->choice->texel[k];
        if (texel >= sum->first && texel < sum->first + sum->body->texel_count) {
            sum_receiver(sum, (uint32_t)(texel - sum->first), row, sum->radiosity[k]);
        }
    }
    parian_free(sum->env, row);
}

static parian_result sum_body(const parian_env *env, transport_sum *sum)
{
    const parian_body *body = sum->body;
    parian_result r = parian_transport_model_make(env, body, PARIAN_MODEL_FULL, &sum->model);
    if (r != PARIAN_OK) {
        return r;
    }
    r = parian_point_arrays_make(env, (const float(*)[3])body->texel_position,
                                 sum->model.flux ? (const float(*)[3])body->texel_normal : NULL,
                                 body->texel_count, &sum->points);
    if (r == PARIAN_OK) {
        parian_par(env, (sum->choice->count + RECEIVERS_PER_PIECE - 1) / RECEIVERS_PER_PIECE,
                   sum_piece, sum);
        parian_point_arrays_free(env, &sum->points);
    }
    parian_transport_model_free(env, &sum->model);
    if (r == PARIAN_OK && atomic_load(&sum->no_memory)) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u texels", body->texel_count);
    }
    return r == PARIAN_OK && parian_cancelled(env) ? PARIAN_E_INTERRUPTED : r;
}

parian_result parian_transport_truth(const parian_env *env, const parian_body *bodies,
                                     uint32_t body_count, const float (*irradiance)[3],
                                     const parian_texel_choice *choice, double (*radiosity)[3])
{
    size_t first = 0;
    parian_result r = PARIAN_OK;
    for (uint32_t b = 0; r == PARIAN_OK && b < body_count; b++) {
        transport_sum sum = {.env = env,
                             .body = &bodies[b],
                             .irradiance = irradiance + first,
                             .choice = choice,
                             .first = first,
                             .radiosity = radiosity};
        r = sum_body(env, &sum);
        first += bodies[b].texel_count;
    }
    return r;
}
