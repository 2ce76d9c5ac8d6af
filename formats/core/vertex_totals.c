/* vertex_totals.c - the whole energy that R_d carries to, or from, each vertex, by quadrature on
 * the surface.
 *
 * The hats alone (a row of factors times the vertex areas) are a poor quadrature where R_d is
 * narrower than the triangles; near triangles are therefore integrated, those around the vertex in
 * polar form.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdatomic.h>
#include <string.h>

#include "core/memory.h"
#include "core/small_maths.h"
#include "core/vertex_frame.h"

enum { POLAR_ANGLES = 6, POLAR_RADII = 12, CUTS_MAX = 12, ROWS_PER_BLOCK = 32 };
static const float NEAR_EDGES =
    8; /* edges: 0.03 % of the total at two mean free paths an edge; 0.12 % with 5 */

typedef struct totals_job {
    const parian_env *env;
    const parian_body *body;
    const parian_transport_model *model;
    const parian_vertex_frame *frame;
    bool as_source;
    float (*total)[3];
    atomic_bool failed;
    double angle[POLAR_ANGLES], angle_weight[POLAR_ANGLES];
    double radius[POLAR_RADII], radius_weight[POLAR_RADII];
} totals_job;

/* Add weight times R_d between vertex v and the point of triangle t with barycentrics beta. */
static void add_point(const totals_job *job, uint32_t v, uint32_t t, const double beta[3],
                      double weight, double sum[3])
{
    const uint32_t *corner = job->body->triangle[t];
    float x[3], n[3], value[3];
    double length = 0, normal[3];
    for (int k = 0; k < 3; k++) {
        double p = 0, q = 0;
        for (int j = 0; j < 3; j++) {
            p += beta[j] * job->body->vertex_position[corner[j]][k];
            q += beta[j] * job->frame->normal[corner[j]][k];
        }
        x[k] = (float)p;
        normal[k] = q;
        length += q * q;
    }
    length = length > 0 ? sqrt(length) : 1;
    for (int k = 0; k < 3; k++) {
        n[k] = (float)(normal[k] / length);
    }
    const float *here = job->body->vertex_position[v], *up = job->frame->normal[v];
    if (job->as_source) {
        parian_transport_model_eval(job->model, here, up, x, n, value);
    } else {
        parian_transport_model_eval(job->model, x, n, here, up, value);
    }
    for (int c = 0; c < 3; c++) {
        sum[c] += weight * value[c];
    }
}

/* Along one ray of a triangle with corner v, from tau to tau + span; weight is 2 A times that of
 * the ray. */
static void add_ray(const totals_job *job, uint32_t v, uint32_t t, int k, double s, double length,
                    double tau, double span, double weight, double sum[3])
{
    double z = job->model->z_min;
    for (int j = 0; j < POLAR_RADII; j++) {
        double at = tau + span * job->radius[j], rho = z / length * sinh(at), beta[3];
        double step = span * job->radius_weight[j] * z / length * cosh(at);
        beta[k] = 1 - rho;
        beta[(k + 1) % 3] = rho * (1 - s);
        beta[(k + 2) % 3] = rho * s;
        add_point(job, v, t, beta, weight * step * rho, sum);
    }
}

/* A triangle with corner v: x = v + rho (p(s) - v) with p along the opposite edge has the area
 * element 2 A rho; r = z sinh(tau) grades the radius towards the peak at v, in two panels. */
static void add_polar(const totals_job *job, uint32_t v, uint32_t t, double sum[3])
{
    static const double PEAK = 4; /* r = 27 z_r */
    const uint32_t *corner = job->body->triangle[t];
    int k = corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
    double area = job->frame->triangle_area[t], a[3], b[3];
    parian_sub3(job->body->vertex_position[corner[(k + 1) % 3]], job->body->vertex_position[v], a);
    parian_sub3(job->body->vertex_position[corner[(k + 2) % 3]], job->body->vertex_position[v], b);
    for (int i = 0; i < POLAR_ANGLES; i++) {
        double s = job->angle[i], length2 = 0, weight = 2 * area * job->angle_weight[i];
        for (int j = 0; j < 3; j++) {
            double p = a[j] + s * (b[j] - a[j]);
            length2 += p * p;
        }
        double length = sqrt(length2), top = asinh(length / job->model->z_min);
        if (length > 0) {
            add_ray(job, v, t, k, s, length, 0, fmin(top, PEAK), weight, sum);
        }
        if (length > 0 && top > PEAK) {
            add_ray(job, v, t, k, s, length, PEAK, top - PEAK, weight, sum);
        }
    }
}

/* Degree 2 with three points, or degree 5 with seven on n^2 parts, as distance over size asks. */
static void add_plain(const totals_job *job, uint32_t v, uint32_t t, int cuts, double sum[3])
{
    static const double seven[3][2] = {{1.0 / 3, 0.225},
                                       {0.470142064105115, 0.132394152788506},
                                       {0.101286507323456, 0.125939180544827}};
    double area = job->frame->triangle_area[t];
    if (cuts == 0) {
        for (int k = 0; k < 3; k++) {
            double beta[3] = {1.0 / 6, 1.0 / 6, 1.0 / 6};
            beta[k] = 2.0 / 3;
            add_point(job, v, t, beta, area / 3, sum);
        }
        return;
    }
    for (int i = 0; i < cuts * cuts; i++) { /* part i: row, position in it, pointing up or down */
        int row = (int)sqrt((double)i), place = i - row * row, up = place % 2 == 0;
        double centre[3], size = (up ? 1.0 : -1.0) / cuts;
        centre[0] = 1 - (row + (up ? 2.0 : 1.0) / 3) / cuts;
        centre[1] = (place / 2 + (up ? 1.0 : 2.0) / 3) / cuts;
        centre[2] = 1 - centre[0] - centre[1];
        for (int q = 0; q < 7; q++) {
            int orbit = (q + 2) / 3, special = (q + 2) % 3;
            double small = seven[orbit][0], beta[3];
            for (int k = 0; k < 3; k++) {
                double own = k == special && orbit > 0 ? 1 - 2 * small : small;
                beta[k] = centre[k] + size * (own - 1.0 / 3);
            }
            add_point(job, v, t, beta, area / (cuts * cuts) * seven[orbit][1], sum);
        }
    }
}

static int choose_cuts(const totals_job *job, uint32_t t, const float *r2)
{
    const uint32_t *corner = job->body->triangle[t];
    float nearest = fminf(r2[corner[0]], fminf(r2[corner[1]], r2[corner[2]])), longest = 0;
    for (int k = 0; k < 3; k++) {
        longest =
            fmaxf(longest, parian_distance2f(job->body->vertex_position[corner[k]],
                                             job->body->vertex_position[corner[(k + 1) % 3]]));
    }
    double z = job->model->z_min, ratio = sqrt(longest / (nearest + z * z));
    return ratio < 0.4 ? 0 : ratio > CUTS_MAX ? CUTS_MAX : (int)ceil(ratio);
}

/* Put the integral over triangle t in the place of its share of the hats' sum. */
static void correct_triangle(const totals_job *job, uint32_t v, uint32_t t, const parian_row *row,
                             double sum[3])
{
    const uint32_t *corner = job->body->triangle[t];
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++) {
            sum[c] -= job->frame->triangle_area[t] / 3.0 * row->value[c][corner[k]];
        }
    }
    if (corner[0] == v || corner[1] == v || corner[2] == v) {
        add_polar(job, v, t, sum);
    } else {
        add_plain(job, v, t, choose_cuts(job, t, row->r2), sum);
    }
}

static void total_of_vertex(const totals_job *job, uint32_t v, parian_row *row, uint32_t *stamp)
{
    const parian_vertex_frame *frame = job->frame;
    float reach2 = NEAR_EDGES * NEAR_EDGES * 16 * frame->bias[v];
    double sum[3];
    parian_transport_model_row(job->model, job->body->vertex_position[v], frame->normal[v],
                               job->as_source, &frame->points, row->r2, row->value);
    for (int c = 0; c < 3; c++) {
        row->value[c][v] = 0; /* no share in the sum that cancellation could spoil */
        sum[c] = parian_row_dot(frame->area, row->value[c], frame->points.padded);
    }
    for (uint32_t u = 0; u < frame->points.count; u++) {
        if (row->r2[u] > reach2) {
            continue;
        }
        for (uint32_t i = frame->fan_offset[u]; i < frame->fan_offset[u + 1]; i++) {
            uint32_t t = frame->fan[i];
            if (stamp[t] != v + 1 && frame->triangle_area[t] > 0) {
                stamp[t] = v + 1;
                correct_triangle(job, v, t, row, sum);
            }
        }
    }
    for (int c = 0; c < 3; c++) {
        job->total[v][c] = (float)fmax(0, sum[c]);
    }
}

static void totals_block(void *context, size_t block)
{
    totals_job *job = context;
    parian_row row = {0};
    uint32_t *stamp = NULL, first = (uint32_t)block * ROWS_PER_BLOCK;
    uint32_t last = first + ROWS_PER_BLOCK;
    last = last < job->body->vertex_count ? last : job->body->vertex_count;
    if (parian_row_make(job->env, job->frame, &row) != PARIAN_OK ||
        !PARIAN_NEW0(job->env, stamp, job->body->triangle_count)) {
        job->failed = true;
    } else {
        for (uint32_t v = first; v < last; v++) {
            total_of_vertex(job, v, &row, stamp);
        }
    }
    parian_row_free(job->env, &row);
    parian_free(job->env, stamp);
}

parian_result parian_vertex_totals(const parian_env *env, const parian_body *body,
                                   const parian_transport_model *model,
                                   const parian_vertex_frame *frame, bool as_source,
                                   float (*total)[3])
{
    totals_job job = {.env = env, .body = body, .model = model, .frame = frame};
    job.as_source = as_source;
    job.total = total;
    parian_gauss_legendre(POLAR_ANGLES, job.angle, job.angle_weight);
    parian_gauss_legendre(POLAR_RADII, job.radius, job.radius_weight);
    parian_par(env, (body->vertex_count + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK, totals_block, &job);
    return job.failed ? parian_fail(env, PARIAN_E_NOMEM, "no memory for the vertex totals")
                      : PARIAN_OK;
}
