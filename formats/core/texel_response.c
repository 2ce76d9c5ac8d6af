/* texel_response.c - R_d between two texels, averaged over the source texel where that matters.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/texel_response.h"

#include <math.h>

#include "core/small_maths.h"

enum { DISC_POINTS = 12 };

void parian_texel_response_init(const parian_body *body, const parian_transport_model *model,
                                parian_texel_response *response)
{
    double node[PARIAN_RESPONSE_POINTS], weight[PARIAN_RESPONSE_POINTS];
    response->body = body;
    response->model = model;
    response->z2 = (float)(model->z_min * model->z_min);
    parian_gauss_legendre(DISC_POINTS, response->node, response->weight);
    parian_gauss_legendre(PARIAN_RESPONSE_POINTS, node, weight);
    for (int k = 0; k < PARIAN_RESPONSE_POINTS; k++) {
        response->offset[k] = (float)(node[k] - 0.5);
        response->share[k] = (float)weight[k];
    }
}

/* Mean over the disc of the texel's area: closed form, or radial quadrature where R_d is cut. */
static void disc_mean(const parian_texel_response *response, uint32_t i, float value[3])
{
    const parian_transport_model *model = response->model;
    double area = response->body->texel_area[i], radius = sqrt(area / PARIAN_PI), sum[3] = {0};
    if (model->share == PARIAN_MODEL_FULL) {
        for (int c = 0; c < 3; c++) {
            value[c] = (float)(parian_dipole_disc_energy(&model->dipole[c], radius) / area);
        }
        return;
    }
    double z = model->z_min, top = asinh(radius / z);
    for (int k = 0; k < DISC_POINTS; k++) {
        double r = z * sinh(top * response->node[k]);
        double gain =
            response->weight[k] * top * z * cosh(top * response->node[k]) * 2 * PARIAN_PI * r;
        float at[3];
        parian_radial_eval(&model->value, (float)(r * r), at);
        for (int c = 0; c < 3; c++) {
            sum[c] += gain * at[c];
        }
    }
    for (int c = 0; c < 3; c++) {
        value[c] = (float)(sum[c] / area);
    }
}

/* The square that stands for texel i, seen from o: centre, and axes of its side length, the first
 * along the line of sight. Two texels do not overlap, so the centre is kept at 0.85 of the sum of
 * their discs' radii: no change on a regular grid, but a sliver's centroid may lie nearer. */
static void place_square(const parian_body *body, uint32_t i, uint32_t o, float centre[3],
                         float u[3], float v[3])
{
    const float *x = body->texel_position[o], *n = body->texel_normal[i];
    double d[3], normal[3] = {n[0], n[1], n[2]}, across[3], along[3],
                 side = sqrt(body->texel_area[i]);
    double least = 0.85 * (side + sqrt(body->texel_area[o])) / sqrt(PARIAN_PI);
    parian_sub3(body->texel_position[i], x, d);
    double distance = sqrt(parian_dot3(d, d));
    const float *m = body->texel_normal[o];
    bool opposed = n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0; /* sides of a wall may be near */
    if (!(distance > 1e-6 * least)) {
        d[0] = fabs(n[0]) < 0.6, d[1] = fabs(n[0]) >= 0.6, d[2] = 0;
        d[0] *= least, d[1] *= least;
    } else if (distance < least && !opposed) {
        for (int k = 0; k < 3; k++) {
            d[k] *= least / distance;
        }
    }
    parian_cross3(normal, d, across);
    double length = sqrt(parian_dot3(across, across));
    for (int k = 0; k < 3; k++) {
        across[k] *= length > 0 ? side / length : 0;
        centre[k] = (float)(x[k] + d[k]);
        v[k] = (float)across[k];
    }
    parian_cross3(across, normal, along);
    for (int k = 0; k < 3; k++) {
        u[k] = (float)along[k];
    }
}

/* Mean over the square; never more than over a disc of its area around the receiver. */
static void square_mean(const parian_texel_response *response, uint32_t i, uint32_t o,
                        float value[3])
{
    const parian_body *body = response->body;
    float x[3], u[3], v[3], most[3];
    place_square(body, i, o, x, u, v);
    value[0] = value[1] = value[2] = 0;
    for (int j = 0; j < PARIAN_RESPONSE_POINTS * PARIAN_RESPONSE_POINTS; j++) {
        int a = j % PARIAN_RESPONSE_POINTS, b = j / PARIAN_RESPONSE_POINTS;
        float p[3], at[3];
        for (int k = 0; k < 3; k++) {
            p[k] = x[k] + response->offset[a] * u[k] + response->offset[b] * v[k];
        }
        parian_transport_model_eval(response->model, p, body->texel_normal[i],
                                    body->texel_position[o], body->texel_normal[o], at);
        for (int c = 0; c < 3; c++) {
            value[c] += response->share[a] * response->share[b] * at[c];
        }
    }
    disc_mean(response, i, most);
    for (int c = 0; c < 3; c++) {
        value[c] = fminf(value[c], most[c]);
    }
}

/* Share of the squared distance that is the height of o above the plane of texel i. */
static float height_share(const parian_body *body, uint32_t i, uint32_t o, float r2)
{
    const float *n = body->texel_normal[i], *x = body->texel_position[i];
    const float *y = body->texel_position[o];
    float height = n[0] * (y[0] - x[0]) + n[1] * (y[1] - x[1]) + n[2] * (y[2] - x[2]);
    return r2 > 0 ? fminf(1, height * height / r2) : 0;
}

/* The mean of R_d over texel i: R_d + A/24 times its Laplacian over the texel's plane where that is
 * small, else by points. */
void parian_texel_response_eval(const parian_texel_response *response, uint32_t i, uint32_t o,
                                float value[3])
{
    const parian_body *body = response->body;
    const parian_transport_model *model = response->model;
    float area = body->texel_area[i];
    float r2 = parian_distance2f(body->texel_position[i], body->texel_position[o]);
    if (!body->paper_form && i == o && area > 0) {
        disc_mean(response, i, value);
    } else if (!body->paper_form && area > 0.25f * (r2 + response->z2)) {
        square_mean(response, i, o, value);
    } else {
        float laplacian[3], slope[3];
        parian_transport_model_eval(model, body->texel_position[i], body->texel_normal[i],
                                    body->texel_position[o], body->texel_normal[o], value);
        if (!body->paper_form) {
            float off = height_share(body, i, o, r2);
            parian_radial_eval(&model->laplacian, r2, laplacian);
            parian_radial_eval(&model->slope, r2, slope);
            for (int c = 0; c < 3; c++) {
                float widening = laplacian[c] - off * (laplacian[c] - 4 * slope[c]);
                value[c] = fmaxf(0, value[c] + area * (1.0f / 24) * widening);
            }
        }
    }
}
