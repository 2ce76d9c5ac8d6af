/* quadrature_sums.c - what a replicate's places bring to receivers: shared places of far strata in
 * plain loops, fresh places around each receiver.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/reference/quadrature_parts.h"
#include "core/clones.h"

enum { LANES = 16, STACK_MAX = 160 };

/* A receiver as the loops want it. */
typedef struct quadrature_receiver {
    double x[3], n[3]; /* relative to the tree's origin; smooth normal */
    float xf[3], nf[3];
    quadrature_lattice lattice; /* for its fresh places, */
    uint64_t fresh;             /* as many as there are so far */
} quadrature_receiver;

static quadrature_receiver take_receiver(const quadrature_job *job, size_t at)
{
    uint32_t i = job->index[at];
    quadrature_receiver r;
    for (int a = 0; a < 3; a++) {
        r.x[a] = job->receivers->position[i][a] - job->surface.tree.origin[a];
        r.n[a] = job->receivers->smooth_normal[i][a];
        r.xf[a] = (float)r.x[a];
        r.nf[a] = (float)r.n[a];
    }
    return r;
}

static double distance2(const double a[3], const double b[3])
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static bool stratum_is_near(const quadrature_surface *surface, size_t stratum, const double x[3])
{
    const parian_stratum *s = &surface->stratum[stratum];
    return quadrature_must_split(&surface->guide, s->radius, s->area, distance2(s->centre, x));
}

/* Whether any stratum of a block may be near: the widest and largest one at the nearest point of
 * the box. */
static bool block_is_near(const quadrature_surface *surface, const quadrature_block *block,
                          const double x[3])
{
    double r2 = 0;
    for (int a = 0; a < 3; a++) {
        double out = fmax(0, fmax(block->lower[a] - x[a], x[a] - block->upper[a]));
        r2 += out * out;
    }
    return quadrature_must_split(&surface->guide, block->radius_max, block->area_max, r2);
}

/* ---- far ---------------------------------------------------------------------------------------
 */
PARIAN_CLONES
static double dot_block(const float *restrict value, const float *restrict flux)
{
    float lane[LANES] = {0};
    double sum = 0;
    for (int i = 0; i < QUADRATURE_BLOCK; i += LANES) {
        for (int l = 0; l < LANES; l++) {
            lane[l] += value[i + l] * flux[i + l];
        }
    }
    for (int l = 0; l < LANES; l++) {
        sum += lane[l];
    }
    return sum;
}

/* The block's flux without that of near strata. */
static void mask_flux(const quadrature_surface *surface, const quadrature_block *block,
                      const double x[3], float masked[3][QUADRATURE_BLOCK])
{
    for (int c = 0; c < 3; c++) {
        memcpy(masked[c], surface->flux[c] + block->first, sizeof masked[c]);
    }
    for (uint32_t i = 0; i < block->count; i++) {
        if (stratum_is_near(surface, block->first + i, x)) {
            masked[0][i] = masked[1][i] = masked[2][i] = 0;
        }
    }
}

static void add_block(const quadrature_surface *surface, const quadrature_block *block,
                      const quadrature_receiver *receiver, double B[3])
{
    float r2[QUADRATURE_BLOCK], value[3][QUADRATURE_BLOCK], masked[3][QUADRATURE_BLOCK];
    float *const values[3] = {value[0], value[1], value[2]};
    parian_point_arrays points = {.count = QUADRATURE_BLOCK, .padded = QUADRATURE_BLOCK};
    bool cut = block_is_near(surface, block, receiver->x);
    points.x = surface->position[0] + block->first, points.nx = surface->normal[0] + block->first;
    points.y = surface->position[1] + block->first, points.ny = surface->normal[1] + block->first;
    points.z = surface->position[2] + block->first, points.nz = surface->normal[2] + block->first;
    parian_transport_model_row(&surface->model, receiver->xf, receiver->nf, false, &points, r2,
                               values);
    if (cut) {
        mask_flux(surface, block, receiver->x, masked);
    }
    for (int c = 0; c < 3; c++) {
        B[c] += dot_block(value[c], cut ? masked[c] : surface->flux[c] + block->first);
    }
}

/* The same where the direction of the light counts. */
static void add_arrivals(const quadrature_surface *surface, const quadrature_block *block,
                         const quadrature_receiver *receiver, double B[3])
{
    const quadrature_arrival *arrival =
        surface->arrival + (size_t)block->first * surface->arrivals_per_place;
    bool cut = block_is_near(surface, block, receiver->x);
    for (uint32_t i = 0; i < block->arrival_count; i++) {
        uint32_t p = arrival[i].place;
        double x[3], n[3], w[3], R[3];
        if (cut && stratum_is_near(surface, p, receiver->x)) {
            continue;
        }
        for (int a = 0; a < 3; a++) {
            x[a] = surface->position[a][p];
            n[a] = surface->normal[a][p];
            w[a] = arrival[i].direction[a];
        }
        parian_bssrdf_value(surface->bssrdf, x, n, w, receiver->x, receiver->n, R);
        for (int c = 0; c < 3; c++) {
            B[c] += R[c] * arrival[i].flux[c];
        }
    }
}

void quadrature_far(const quadrature_job *job, size_t from, size_t to, double (*B)[3])
{
    const quadrature_surface *surface = &job->surface;
    for (size_t b = 0; b < surface->block_count; b++) {
        const quadrature_block *block = &surface->block[b];
        for (size_t k = from; block->lit && k < to; k++) {
            quadrature_receiver receiver = take_receiver(job, k);
            if (surface->tabulated) {
                add_block(surface, block, &receiver, B[k - from]);
            } else {
                add_arrivals(surface, block, &receiver, B[k - from]);
            }
        }
    }
}

/* ---- near --------------------------------------------------------------------------------------
 */
static void add_value(const quadrature_surface *surface, const double x[3],
                      const parian_place *place, const double w[3],
                      const quadrature_receiver *receiver, const double flux[3], double B[3])
{
    double R[3];
    parian_bssrdf_value(surface->bssrdf, x, place->smooth_normal, w, receiver->x, receiver->n, R);
    for (int c = 0; c < 3; c++) {
        B[c] += R[c] * flux[c];
    }
}

/* One fresh place: one sample of every light, and the kernel. */
static void add_fresh_place(const quadrature_job *job, const parian_stratum *stratum,
                            quadrature_receiver *receiver, parian_random *random, double B[3])
{
    const quadrature_surface *surface = &job->surface;
    parian_place place;
    double sum[3] = {0, 0, 0}, x[3], at[2];
    parian_stratum_place(&surface->tree, stratum, surface->body, random, &place);
    for (int a = 0; a < 3; a++) {
        x[a] = place.position[a] - surface->tree.origin[a];
    }
    quadrature_lattice_at(&receiver->lattice, receiver->fresh++, at);
    for (uint32_t l = 0; l < job->scene->light_count; l++) {
        double direction[3], E[3];
        parian_reference_light_sample_at(job->scene, l, &place, at[0], at[1], direction, E);
        bool lit = E[0] > 0 || E[1] > 0 || E[2] > 0;
        for (int c = 0; c < 3; c++) {
            E[c] *= stratum->area;
            sum[c] += E[c];
        }
        if (lit && !surface->tabulated) {
            add_value(surface, x, &place, direction, receiver, E, B);
        }
    }
    if (surface->tabulated && (sum[0] > 0 || sum[1] > 0 || sum[2] > 0)) {
        add_value(surface, x, &place, place.smooth_normal, receiver, sum, B);
    }
}

/* Cut a near stratum until its parts may stay whole; a fresh place in each. Returns their number.
 */
static void refine(const quadrature_job *job, const parian_stratum *whole,
                   quadrature_receiver *receiver, parian_random *random, double B[3])
{
    const quadrature_surface *surface = &job->surface;
    parian_stratum stack[STACK_MAX];
    size_t depth = 0;
    stack[depth++] = *whole;
    while (depth > 0) {
        parian_stratum s = stack[--depth], half[2];
        bool split =
            depth + 2 <= STACK_MAX && quadrature_must_split(&surface->guide, s.radius, s.area,
                                                            distance2(s.centre, receiver->x));
        if (split) {
            parian_stratum_split(&surface->tree, &s, half);
            stack[depth++] = half[1];
            stack[depth++] = half[0];
        } else if (s.area > 0) {
            add_fresh_place(job, &s, receiver, random, B);
        }
    }
}

static void near_receiver(const quadrature_job *job, size_t at, double B[3])
{
    const quadrature_surface *surface = &job->surface;
    quadrature_receiver receiver = take_receiver(job, at);
    uint32_t index = job->index[at];
    parian_random random = parian_random_stream(job->desc->seed ^ QUADRATURE_SALT,
                                                2 * job->replicate + 1, surface->body, index);
    receiver.lattice = quadrature_lattice_make(&random);
    receiver.fresh = 0;
    for (size_t b = 0; b < surface->block_count; b++) {
        const quadrature_block *block = &surface->block[b];
        if (!block_is_near(surface, block, receiver.x)) {
            continue;
        }
        for (uint32_t i = block->first; i < block->first + block->count; i++) {
            if (stratum_is_near(surface, i, receiver.x)) {
                refine(job, &surface->stratum[i], &receiver, &random, B);
            }
        }
    }
    job->near_count[index] += receiver.fresh;
}

void quadrature_near(const quadrature_job *job, size_t from, size_t to, double (*B)[3])
{
    for (size_t k = from; k < to; k++) {
        near_receiver(job, k, B[k - from]);
    }
}
