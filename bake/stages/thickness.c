/* thickness.c - rays straight inwards from a spread of triangles; percentiles of their lengths by
 * area.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/thickness.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/reference/rays.h"
#include "core/memory.h"
#include "core/small_maths.h"

enum { RAYS_MAX = 4096 };
static const double THIN_PERCENTILE = 0.05;

typedef struct probe {
    double thickness, area;
} probe;

typedef struct probe_job {
    const parian_mesh *mesh;
    const parian_rays *rays;
    size_t stride;
    probe *probe;
} probe_job;

static parian_result copy_mesh(const parian_env *env, const parian_body *body, parian_mesh *mesh)
{
    *mesh =
        (parian_mesh){.vertex_count = body->vertex_count, .triangle_count = body->triangle_count};
    if (!PARIAN_NEW(env, mesh->position, body->vertex_count) ||
        !PARIAN_NEW(env, mesh->triangle, body->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to measure %u triangles",
                           body->triangle_count);
    }
    for (uint32_t v = 0; v < body->vertex_count; v++) {
        for (int k = 0; k < 3; k++) {
            mesh->position[v][k] = (double)body->vertex_position[v][k];
        }
    }
    memcpy(mesh->triangle, body->triangle, body->triangle_count * sizeof *mesh->triangle);
    return PARIAN_OK;
}

static void shoot(void *context, size_t i)
{
    probe_job *job = context;
    uint32_t t = (uint32_t)(i * job->stride);
    const uint32_t *c = job->mesh->triangle[t];
    const double(*p)[3] = (const double(*)[3])job->mesh->position;
    parian_ray ray = {.length = INFINITY, .mesh = 0, .triangle = t};
    parian_ray_hit hit;
    double e[2][3], normal[3];
    for (int k = 0; k < 3; k++) {
        e[0][k] = p[c[1]][k] - p[c[0]][k];
        e[1][k] = p[c[2]][k] - p[c[0]][k];
        ray.origin[k] = (p[c[0]][k] + p[c[1]][k] + p[c[2]][k]) / 3;
    }
    parian_cross3(e[0], e[1], normal);
    double length = sqrt(parian_dot3(normal, normal));
    for (int k = 0; k < 3; k++) {
        ray.direction[k] = length > 0 ? -normal[k] / length : 0;
    }
    bool met = length > 0 && parian_rays_nearest(job->rays, &ray, PARIAN_RAY_NONE, &hit);
    job->probe[i] = (probe){met ? hit.distance : INFINITY, 0.5 * length};
}

static int compare_probes(const void *a, const void *b)
{
    const probe *x = a, *y = b;
    return (x->thickness > y->thickness) - (x->thickness < y->thickness);
}

/* Thickness below which a share of the area lies. */
static double percentile(const probe *sorted, size_t count, double total, double share)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += sorted[i].area;
        if (sum >= share * total) {
            return sorted[i].thickness;
        }
    }
    return INFINITY;
}

static void summarise(const parian_body *body, probe *probes, size_t count,
                      parian_thickness_report *report)
{
    double total = 0, thin = 0, clearest = INFINITY;
    for (int c = 0; c < PARIAN_CHANNELS; c++) {
        clearest = fmin(clearest, body->medium.sigma_s_prime[c] + body->medium.sigma_a[c]);
    }
    report->flight_m = 1 / clearest;
    qsort(probes, count, sizeof *probes, compare_probes);
    for (size_t i = 0; i < count; i++) {
        total += probes[i].area;
        thin += probes[i].thickness < PARIAN_THIN_FLIGHTS * report->flight_m ? probes[i].area : 0;
    }
    report->thin_share = total > 0 ? thin / total : 0;
    report->thin_m = percentile(probes, count, total, THIN_PERCENTILE);
    report->median_m = percentile(probes, count, total, 0.5);
}

parian_result parian_stage_thickness(const parian_env *env, const parian_body *body,
                                     parian_thickness_report *report)
{
    parian_mesh mesh;
    parian_rays *rays = NULL;
    size_t stride = (body->triangle_count + RAYS_MAX - 1) / RAYS_MAX, count = 0;
    probe *probes = NULL;
    parian_result r = copy_mesh(env, body, &mesh);
    *report = (parian_thickness_report){0};
    if (r == PARIAN_OK) {
        const parian_mesh *all[1] = {&mesh};
        r = parian_rays_create(env, all, 1, &rays);
    }
    if (r == PARIAN_OK && stride > 0) {
        count = (body->triangle_count + stride - 1) / stride;
        if (!PARIAN_NEW(env, probes, count)) {
            r = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu rays", count);
        }
    }
    if (r == PARIAN_OK) {
        probe_job job = {&mesh, rays, stride, probes};
        parian_par(env, count, shoot, &job);
        summarise(body, probes, count, report);
    }
    parian_free(env, probes);
    parian_rays_destroy(rays);
    parian_mesh_free(env, &mesh);
    return r;
}
