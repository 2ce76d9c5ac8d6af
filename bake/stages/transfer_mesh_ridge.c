/* transfer_mesh_ridge.c - finds the two sides of rounded ridges and rims that are sharp to the
 * transfer mesh.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

/* Neighbourhoods reach so many edges of the transfer mesh; the largest number of triangles that is
 * looked at in one. */
static const double reach_edges = 1.5;
enum { NEAR_MAX = 384, TABLE_SIZE = 1024 };
/* The variance of the normals, at least: two sides of one size at 33 degrees have that. */
static const double variance_min = 0.08;
enum { CHUNK = 256, SQUARINGS = 6 };

typedef struct ridge_job {
    const parian_mesh *mesh;
    const uint32_t (*neighbour)[3];
    double reach;
    double (*centroid)[3], (*normal)[3]; /* unit normals, and */
    double *area;
    double (*side)[3];
} ridge_job;

static void measure_triangle(ridge_job *job, uint32_t t)
{
    const uint32_t *c = job->mesh->triangle[t];
    const double(*p)[3] = (const double(*)[3])job->mesh->position;
    double twice;
    area_vector(p[c[0]], p[c[1]], p[c[2]], job->normal[t]);
    twice = norm(job->normal[t]);
    job->area[t] = 0.5 * twice;
    for (int k = 0; k < 3; k++) {
        job->normal[t][k] = twice > 0.0 ? job->normal[t][k] / twice : 0.0;
        job->centroid[t][k] = (p[c[0]][k] + p[c[1]][k] + p[c[2]][k]) / 3.0;
    }
}

/* Put a triangle into a hash table of indices + 1; false where it was there. */
static bool insert(uint32_t table[TABLE_SIZE], uint32_t triangle)
{
    uint32_t slot = triangle * 2654435761u % TABLE_SIZE;
    for (; table[slot]; slot = (slot + 1) % TABLE_SIZE) {
        if (table[slot] == triangle + 1) {
            return false;
        }
    }
    table[slot] = triangle + 1;
    return true;
}

/* The triangles within reach that can be walked to within reach, the start first. */
static int gather_near(const ridge_job *job, uint32_t start, uint32_t near[NEAR_MAX])
{
    uint32_t table[TABLE_SIZE] = {0};
    int count = 1;
    near[0] = start;
    insert(table, start);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t half = job->neighbour[near[i]][k], other = half / 3;
            double away[3];
            if (half == PARIAN_NO_NEIGHBOUR || count == NEAR_MAX) {
                continue;
            }
            subtract(job->centroid[other], job->centroid[start], away);
            if (parian_dot3(away, away) <= job->reach * job->reach && insert(table, other)) {
                near[count++] = other;
            }
        }
    }
    return count;
}

/* Area-weighted mean of the normals, and their covariance; returns the trace of it. */
static double find_covariance(const ridge_job *job, const uint32_t *near, int count, double mean[3],
                              double covariance[3][3])
{
    double area = 0.0, trace = 0.0;
    memset(mean, 0, 3 * sizeof *mean);
    memset(covariance, 0, 3 * sizeof *covariance);
    for (int i = 0; i < count; i++) {
        const double *n = job->normal[near[i]], a = job->area[near[i]];
        area += a;
        for (int k = 0; k < 3; k++) {
            mean[k] += a * n[k];
            for (int l = 0; l < 3; l++) {
                covariance[k][l] += a * n[k] * n[l];
            }
        }
    }
    for (int k = 0; k < 3 && area > 0.0; k++) {
        mean[k] /= area;
    }
    for (int k = 0; k < 3 && area > 0.0; k++) {
        for (int l = 0; l < 3; l++) {
            covariance[k][l] = covariance[k][l] / area - mean[k] * mean[l];
        }
        trace += covariance[k][k];
    }
    return trace;
}

/* The longest column of a high power of a matrix, made unit: its first eigenvector. */
static void find_main_axis(double m[3][3], double axis[3])
{
    for (int round = 0; round < SQUARINGS; round++) {
        double square[3][3], trace = m[0][0] + m[1][1] + m[2][2];
        for (int k = 0; k < 3; k++) {
            for (int l = 0; l < 3; l++) {
                square[k][l] =
                    (m[k][0] * m[0][l] + m[k][1] * m[1][l] + m[k][2] * m[2][l]) / (trace * trace);
            }
        }
        memcpy(m, square, sizeof square);
    }
    int longest = 0; /* m is symmetric: rows are columns */
    for (int k = 1; k < 3; k++) {
        longest = m[k][k] > m[longest][longest] ? k : longest;
    }
    double length = norm(m[longest]);
    for (int k = 0; k < 3; k++) {
        axis[k] = m[longest][k] / length;
    }
}

/* Whether the surface bends outwards along an axis: normals point to where their triangles are. */
static bool is_convex(const ridge_job *job, const uint32_t *near, int count, const double axis[3])
{
    double sum = 0.0, area = 0.0, centre = 0.0;
    for (int i = 0; i < count; i++) {
        area += job->area[near[i]];
        centre += job->area[near[i]] * parian_dot3(job->centroid[near[i]], axis);
    }
    for (int i = 0; i < count; i++) {
        sum += job->area[near[i]] * parian_dot3(job->normal[near[i]], axis) *
               (parian_dot3(job->centroid[near[i]], axis) - centre / area);
    }
    return sum > 0.0;
}

static void find_side(ridge_job *job, uint32_t t)
{
    uint32_t near[NEAR_MAX];
    double mean[3], covariance[3][3], axis[3], away[3];
    int count = gather_near(job, t, near);
    memset(job->side[t], 0, sizeof job->side[t]);
    if (find_covariance(job, near, count, mean, covariance) < variance_min) {
        return;
    }
    find_main_axis(covariance, axis);
    if (!is_convex(job, near, count, axis)) {
        return;
    }
    subtract(job->normal[t], mean, away);
    double sign = parian_dot3(away, axis) < 0.0 ? -1.0 : 1.0;
    for (int k = 0; k < 3; k++) {
        job->side[t][k] = sign * axis[k];
    }
}

static void measure_chunk(void *context, size_t index)
{
    ridge_job *job = context;
    for (uint32_t t = (uint32_t)index * CHUNK;
         t < ((uint32_t)index + 1) * CHUNK && t < job->mesh->triangle_count; t++) {
        measure_triangle(job, t);
    }
}

static void find_chunk(void *context, size_t index)
{
    ridge_job *job = context;
    for (uint32_t t = (uint32_t)index * CHUNK;
         t < ((uint32_t)index + 1) * CHUNK && t < job->mesh->triangle_count; t++) {
        find_side(job, t);
    }
}

parian_result parian_transfer_sides(const parian_env *env, const parian_mesh *mesh, double edge,
                                    double (*side)[3])
{
    parian_result result = PARIAN_E_NOMEM;
    uint32_t count = mesh->triangle_count, (*neighbour)[3] = NULL;
    ridge_job job = {.mesh = mesh, .reach = reach_edges * edge, .side = side};
    if (!PARIAN_NEW(env, neighbour, count) || !PARIAN_NEW(env, job.centroid, count) ||
        !PARIAN_NEW(env, job.normal, count) || !PARIAN_NEW(env, job.area, count)) {
        parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory to look for ridges");
        goto done;
    }
    job.neighbour = (const uint32_t(*)[3])neighbour;
    result = parian_triangle_neighbours(env, mesh->vertex_count, count,
                                        (const uint32_t(*)[3])mesh->triangle, neighbour);
    if (result == PARIAN_OK) {
        size_t chunks = ((size_t)count + CHUNK - 1) / CHUNK;
        parian_par(env, chunks, measure_chunk, &job);
        parian_par(env, chunks, find_chunk, &job);
    }
done:
    parian_free(env, job.area);
    parian_free(env, job.normal);
    parian_free(env, job.centroid);
    parian_free(env, neighbour);
    return result;
}
