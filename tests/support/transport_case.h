/* transport_case.h - bodies for the transport tests, their evaluation in plain C, and brute-force
 * quadrature of the same R_d over all texels.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_TEST_TRANSPORT_CASE_H
#define PARIAN_TEST_TRANSPORT_CASE_H

#include <math.h>
#include <string.h>

#include "core/body.h"
#include "core/dipole.h"
#include "core/half.h"
#include "core/kernel.h"
#include "core/memory.h"
#include "core/operator.h"
#include "core/small_maths.h"

static const parian_medium case_marble = {.name = "marble",
                                          .sigma_s_prime = {2190, 2620, 3000},
                                          .sigma_a = {2.1, 4.1, 7.1},
                                          .eta = 1.5,
                                          .reduced_only = true};
static const parian_medium case_skimmilk = {.name = "skimmilk",
                                            .sigma_s_prime = {700, 1220, 1900},
                                            .sigma_a = {1.4, 2.5, 14.2},
                                            .eta = 1.3,
                                            .reduced_only = true};

/* Copy a mesh into a zeroed body, with smooth corner normals. */
static inline void case_body(const parian_env *env, parian_mesh *mesh, parian_body *body)
{
    memset(body, 0, sizeof *body);
    assert_int_equal(parian_mesh_make_corner_normals(env, mesh, 60), PARIAN_OK);
    body->vertex_count = mesh->vertex_count;
    body->triangle_count = mesh->triangle_count;
    assert_true(PARIAN_NEW(env, body->vertex_position, mesh->vertex_count));
    assert_true(PARIAN_NEW(env, body->triangle, mesh->triangle_count));
    assert_true(PARIAN_NEW(env, body->corner_normal, mesh->triangle_count));
    for (size_t i = 0; i < (size_t)mesh->vertex_count * 3; i++) {
        body->vertex_position[i / 3][i % 3] = (float)mesh->position[i / 3][i % 3];
    }
    memcpy(body->triangle, mesh->triangle, mesh->triangle_count * sizeof *body->triangle);
    memcpy(body->corner_normal, mesh->corner_normal,
           mesh->triangle_count * sizeof *body->corner_normal);
    body->kernel_width = 7;
}

/* Bend a sphere mesh of radius r into a body with hollows, a ridge and an ear; its box is about 2
 * r. */
static inline void case_bump(parian_mesh *mesh, double r)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double *p = mesh->position[v], x = p[0] / r, y = p[1] / r, z = p[2] / r;
        double ear2 = (x - 0.6) * (x - 0.6) + (y - 0.6) * (y - 0.6) + (z - 0.5) * (z - 0.5);
        double s = 1 + 0.18 * sin(3 * x + 1) * cos(2.5 * y) + 0.1 * sin(5 * z + 2 * x);
        s += 0.25 * exp(-12 * ear2);
        for (int k = 0; k < 3; k++) {
            p[k] *= 0.8 * s;
        }
    }
}

/* Irradiance, already transmitted: uniform, from afar, from a point, and a slide of a checkerboard,
 * 8 squares across, projected along z. `size` is the extent of the body. */
typedef enum case_light_kind {
    CASE_UNIFORM,
    CASE_DIRECTIONAL,
    CASE_POINT,
    CASE_CHECKER
} case_light_kind;

static inline void case_illuminate(const parian_body *body, case_light_kind kind, double size,
                                   float (*e)[3])
{
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *p = body->texel_position[i], *n = body->texel_normal[i];
        double value = 1, d[3] = {0.6 * size - p[0], 0.2 * size - p[1], size - p[2]};
        double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (kind == CASE_DIRECTIONAL) {
            value = fmax(0, 0.36 * n[0] + 0.48 * n[1] + 0.8 * n[2]);
        } else if (kind == CASE_POINT) {
            value =
                fmax(0, (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]) / sqrt(r2)) * size * size / r2;
        } else if (kind == CASE_CHECKER) {
            int square = (int)floor(8 * p[0] / size + 100) + (int)floor(8 * p[1] / size + 100);
            value = square & 1 ? fmax(0, n[2]) : 0;
        }
        for (int c = 0; c < 3; c++) {
            e[i][c] = (float)value;
        }
    }
}

/* A flat square of cells x cells quads of `per` x `per` texels of side `texel` metres, all one
 * chart. Texels nearer to the rim than half a window are border texels with their clipped windows
 * as lists. */
static inline void case_plane(const parian_env *env, uint32_t cells, uint32_t per, double texel,
                              parian_body *body)
{
    parian_mesh mesh = {0};
    uint32_t side = cells * per, half = 3;
    assert_int_equal(test_plane(env, side * texel, cells, &mesh), PARIAN_OK);
    case_body(env, &mesh, body);
    parian_mesh_free(env, &mesh);
    body->atlas_size = side;
    body->chart_count = 1;
    body->texel_count = side * side;
    assert_true(PARIAN_NEW0(env, body->triangle_chart, body->triangle_count));
    assert_true(PARIAN_NEW0(env, body->corner_uv, body->triangle_count));
    assert_true(PARIAN_NEW(env, body->texel_index, body->texel_count));
    assert_true(PARIAN_NEW(env, body->texel_triangle, body->texel_count));
    assert_true(PARIAN_NEW(env, body->texel_barycentric, body->texel_count));
    assert_true(PARIAN_NEW(env, body->texel_area, body->texel_count));
    float low[2] = {INFINITY, INFINITY};
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        low[0] = fminf(low[0], body->vertex_position[v][0]);
        low[1] = fminf(low[1], body->vertex_position[v][1]);
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        double x = low[0] + (i % side + 0.5) * texel, y = low[1] + (i / side + 0.5) * texel;
        body->texel_index[i] = i;
        body->texel_area[i] = (float)(texel * texel);
        uint32_t quad = (i / side / per) * cells + i % side / per, found = UINT32_MAX;
        for (uint32_t k = 0; k < body->triangle_count && found == UINT32_MAX; k++) {
            uint32_t t = (2 * quad + k) % body->triangle_count;
            const float *a = body->vertex_position[body->triangle[t][0]];
            const float *b = body->vertex_position[body->triangle[t][1]];
            const float *c = body->vertex_position[body->triangle[t][2]];
            double det = (b[1] - c[1]) * (a[0] - c[0]) + (c[0] - b[0]) * (a[1] - c[1]);
            double p = ((b[1] - c[1]) * (x - c[0]) + (c[0] - b[0]) * (y - c[1])) / det;
            double q = ((c[1] - a[1]) * (x - c[0]) + (a[0] - c[0]) * (y - c[1])) / det;
            if (p >= -1e-4 && q >= -1e-4 && p + q <= 1 + 1e-4) {
                found = t;
                body->texel_barycentric[i][0] = (float)fmin(fmax(p, 0), 1);
                body->texel_barycentric[i][1] = (float)fmin(fmax(q, 0), 1 - fmin(fmax(p, 0), 1));
            }
        }
        assert_true(found != UINT32_MAX);
        body->texel_triangle[i] = found;
    }
    uint32_t borders = body->texel_count - (side - 2 * half) * (side - 2 * half), b = 0, n = 0;
    assert_true(PARIAN_NEW(env, body->border_texel, borders));
    assert_true(PARIAN_NEW(env, body->border_offset, borders + 1));
    assert_true(PARIAN_NEW(env, body->border_neighbour, (size_t)borders * 49));
    for (uint32_t i = 0; i < body->texel_count; i++) {
        uint32_t u = i % side, v = i / side;
        if (u >= half && v >= half && u + half < side && v + half < side) {
            continue;
        }
        body->border_texel[b] = i;
        body->border_offset[b++] = n;
        for (uint32_t y = v < half ? 0 : v - half; y <= v + half && y < side; y++) {
            for (uint32_t x = u < half ? 0 : u - half; x <= u + half && x < side; x++) {
                body->border_neighbour[n++] = y * side + x;
            }
        }
    }
    body->border_count = b;
    body->border_offset[b] = n;
    assert_int_equal(parian_body_derive(env, body), PARIAN_OK);
}

/* The parts of B that an evaluation gives. */
typedef struct case_light {
    float (*e)[3], (*b)[3], (*local)[3]; /* [texel_count] */
} case_light;

static inline void case_light_make(const parian_env *env, const parian_body *body,
                                   case_light *light)
{
    assert_true(PARIAN_NEW0(env, light->e, body->texel_count));
    assert_true(PARIAN_NEW0(env, light->b, body->texel_count));
    assert_true(PARIAN_NEW0(env, light->local, body->texel_count));
}

static inline void case_light_free(const parian_env *env, case_light *light)
{
    parian_free(env, light->e);
    parian_free(env, light->b);
    parian_free(env, light->local);
}

/* B of a vertex-based part: restriction, transport, blend, interpolation. */
static inline void case_global(const parian_env *env, const parian_body *body,
                               const case_light *light)
{
    float(*flux)[3], (*radiosity)[3];
    assert_true(PARIAN_NEW0(env, flux, body->vertex_count));
    assert_true(PARIAN_NEW0(env, radiosity, body->vertex_count));
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *beta = body->texel_barycentric[i];
        float weight[3] = {beta[0], beta[1], 1 - beta[0] - beta[1]};
        for (int k = 0; k < 9; k++) {
            float w = body->paper_form ? 4 * weight[k / 3] - 1 : weight[k / 3];
            flux[body->triangle[body->texel_triangle[i]][k / 3]][k % 3] +=
                w * body->texel_area[i] * light->e[i][k % 3];
        }
    }
    assert_int_equal(parian_operators_apply(env, body->operators, body->operator_count,
                                            (const float(*)[3])flux, radiosity),
                     PARIAN_OK);
    for (uint32_t i = 0; i < body->texel_count && body->blend_weight; i++) {
        for (int k = 0; k < 9; k++) {
            radiosity[body->triangle[body->texel_triangle[i]][k / 3]][k % 3] +=
                parian_half_to_float(body->blend_weight[i][k / 3][k % 3]) * light->e[i][k % 3];
        }
    }
    for (uint32_t i = 0; i < body->texel_count; i++) {
        const float *beta = body->texel_barycentric[i];
        float weight[3] = {beta[0], beta[1], 1 - beta[0] - beta[1]};
        for (int k = 0; k < 9; k++) {
            float b = radiosity[body->triangle[body->texel_triangle[i]][k / 3]][k % 3];
            light->b[i][k % 3] += weight[k / 3] * b;
        }
    }
    parian_free(env, flux);
    parian_free(env, radiosity);
}

static inline void case_tap(const parian_half kernel[3], const float scale[3], const float e[3],
                            float out[3])
{
    for (int c = 0; c < 3; c++) {
        out[c] += parian_half_to_float(kernel[c]) * scale[c] * e[c];
    }
}

static inline void case_local(const parian_body *body, const parian_kernels *kernels,
                              const case_light *light)
{
    uint32_t rank = 0, width = body->kernel_width, side = body->atlas_size, half = width / 2;
    memset(light->local, 0, body->texel_count * sizeof *light->local);
    for (uint32_t o = 0; o < body->texel_count && kernels->interior; o++) {
        uint32_t border = body->texel_border[o];
        if (border != PARIAN_NO_BORDER) {
            for (uint32_t k = body->border_offset[border]; k < body->border_offset[border + 1];
                 k++) {
                case_tap(kernels->border[k], kernels->channel_scale,
                         light->e[body->border_neighbour[k]], light->local[o]);
            }
            continue;
        }
        const parian_half(*kernel)[3] =
            (const parian_half(*)[3])kernels->interior + (size_t)rank++ * width * width;
        uint32_t corner = body->texel_index[o] - half * side - half;
        for (uint32_t k = 0; k < width * width; k++) {
            uint32_t i = body->texel_at[corner + k / width * side + k % width];
            if (i != PARIAN_NO_BORDER) {
                case_tap(kernel[k], kernels->channel_scale, light->e[i], light->local[o]);
            }
        }
    }
    for (size_t k = 0; k < (size_t)body->texel_count * 3; k++) {
        light->b[k / 3][k % 3] += light->local[k / 3][k % 3];
    }
}

/* Evaluate B of all texels from light->e. */
static inline void case_evaluate(const parian_env *env, const parian_body *body,
                                 const parian_kernels *kernels, const case_light *light)
{
    memset(light->b, 0, body->texel_count * sizeof *light->b);
    case_global(env, body, light);
    if (body->local_form != PARIAN_LOCAL_NONE) {
        case_local(body, kernels, light);
    }
}

/* B at one texel by quadrature over all texels in double precision: 2 x 2 Gauss points over near
 * texels (within 20 of their edges), the disc's closed form for the texel itself. */
static inline void case_reference(const parian_body *body, const parian_dipole dipole[3],
                                  uint32_t o, const float (*e)[3], double out[3])
{
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = 0; i < body->texel_count; i++) {
        double d[3], area = body->texel_area[i];
        parian_sub3(body->texel_position[i], body->texel_position[o], d);
        double r2 = parian_dot3(d, d), u[3] = {0}, v[3] = {0}, n[3] = {0},
               lit = e[i][0] + e[i][1] + e[i][2];
        bool near = r2 < 400 * area;
        if (lit == 0) {
            continue;
        }
        if (near && i != o) {
            for (int k = 0; k < 3; k++) {
                n[k] = body->texel_normal[i][k];
            }
            double axis[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0};
            parian_cross3(n, axis, u);
            double length = sqrt(parian_dot3(u, u));
            for (int k = 0; k < 3; k++) {
                u[k] /= length;
            }
            parian_cross3(n, u, v);
        }
        for (int c = 0; c < 3; c++) {
            double rd = 0, step = sqrt(area / 12);
            if (i == o) {
                rd = parian_dipole_disc_energy(&dipole[c], sqrt(area / PARIAN_PI)) / area;
            } else if (near) {
                for (int q = 0; q < 4; q++) {
                    double a = q & 1 ? step : -step, b = q & 2 ? step : -step, p[3];
                    for (int k = 0; k < 3; k++) {
                        p[k] = d[k] + a * u[k] + b * v[k];
                    }
                    rd += parian_dipole_rd(&dipole[c], parian_dot3(p, p)) / 4;
                }
            } else {
                rd = parian_dipole_rd(&dipole[c], r2);
            }
            out[c] += area * rd * e[i][c];
        }
    }
}

/* Relative L2 error, energy ratio, and the least B over the largest, at receivers (every step-th
 * texel), weighted by area. */
typedef struct case_error {
    double l2[3], energy[3], least;
} case_error;

typedef struct case_error_job {
    const parian_body *body;
    const case_light *light;
    parian_dipole dipole[3];
    uint32_t step;
    double (*sum)[4][3]; /* [receivers] error^2, reference^2, B, reference */
} case_error_job;

static inline void case_error_one(void *context, size_t index)
{
    const case_error_job *job = context;
    uint32_t o = (uint32_t)index * job->step;
    double want[3], area = job->body->texel_area[o];
    case_reference(job->body, job->dipole, o, (const float(*)[3])job->light->e, want);
    for (int c = 0; c < 3; c++) {
        double got = job->light->b[o][c];
        job->sum[index][0][c] = area * (got - want[c]) * (got - want[c]);
        job->sum[index][1][c] = area * want[c] * want[c];
        job->sum[index][2][c] = area * got;
        job->sum[index][3][c] = area * want[c];
    }
}

static inline case_error case_compare(const parian_env *env, const parian_body *body,
                                      const case_light *light, uint32_t receivers)
{
    case_error error = {.least = 0};
    case_error_job job = {.body = body, .light = light};
    job.step = body->texel_count / receivers ? body->texel_count / receivers : 1;
    size_t count = (body->texel_count - 1) / job.step + 1;
    for (int c = 0; c < 3; c++) {
        job.dipole[c] = parian_dipole_make(&body->medium, c, body->fit_fdr);
    }
    assert_true(PARIAN_NEW(env, job.sum, count));
    parian_par(env, count, case_error_one, &job);
    for (int c = 0; c < 3; c++) {
        double sum[4] = {0}, least = INFINITY, most = 0;
        for (size_t i = 0; i < count * 4; i++) {
            sum[i % 4] += job.sum[i / 4][i % 4][c];
        }
        for (uint32_t i = 0; i < body->texel_count; i++) {
            least = fmin(least, light->b[i][c]);
            most = fmax(most, light->b[i][c]);
        }
        error.l2[c] = sqrt(sum[0] / sum[1]);
        error.energy[c] = sum[2] / sum[3];
        error.least = fmin(error.least, least / most);
    }
    parian_free(env, job.sum);
    return error;
}

#endif
