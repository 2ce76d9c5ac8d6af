/* transfer_mesh_fit.c - moves the vertices of the transfer mesh to where it represents the source
 * best.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <string.h>

#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

/* A triangle may turn by 60 degrees and shrink to a tenth in one move. */
static const double turn_cosine_min = 0.5;
static const double shrink_min = 0.1;
/* Source triangles within 78 degrees of a normal are candidates: the far side of a sheet is not. */
static const double agree_cosine_min = 0.2;

/* Ridges are pulled onto the source as seen from so many reaches outside. */
static const double ridge_lift = 0.5;

enum { UNDO_ROUNDS = 8, FIT_SAMPLES = 3 };

static void normalise(double v[3])
{
    double length = norm(v);
    for (int k = 0; k < 3; k++) {
        v[k] = length > 0.0 ? v[k] / length : 0.0;
    }
}

static void triangle_area_vector(const parian_mesh *mesh, const double (*position)[3], uint32_t t,
                                 double out[3])
{
    const uint32_t *c = mesh->triangle[t];
    area_vector(position[c[0]], position[c[1]], position[c[2]], out);
}

/* Area-weighted unit normals. */
static void make_vertex_normals(const parian_mesh *mesh, double (*normal)[3])
{
    memset(normal, 0, mesh->vertex_count * sizeof *normal);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double n[3];
        triangle_area_vector(mesh, (const double(*)[3])mesh->position, t, n);
        for (int corner = 0; corner < 3; corner++) {
            for (int k = 0; k < 3; k++) {
                normal[mesh->triangle[t][corner]][k] += n[k];
            }
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        normalise(normal[v]);
    }
}

static bool is_spoiled(const double before[3], const double after[3])
{
    double a = norm(before), b = norm(after);
    return b < shrink_min * a || parian_dot3(before, after) < turn_cosine_min * a * b;
}

/* Take the new positions, except around triangles that they would turn over: there the old ones
 * stay. */
static void take_positions(parian_mesh *mesh, double (*wanted)[3])
{
    for (int round = 0; round < UNDO_ROUNDS; round++) {
        uint32_t spoiled = 0;
        for (uint32_t t = 0; t < mesh->triangle_count; t++) {
            const uint32_t *c = mesh->triangle[t];
            double before[3], after[3];
            triangle_area_vector(mesh, (const double(*)[3])mesh->position, t, before);
            triangle_area_vector(mesh, (const double(*)[3])wanted, t, after);
            if (!is_spoiled(before, after)) {
                continue;
            }
            spoiled++;
            for (int k = 0; k < 3; k++) {
                memcpy(wanted[c[k]], mesh->position[c[k]], sizeof wanted[0]);
            }
        }
        if (!spoiled) {
            memcpy(mesh->position, wanted, mesh->vertex_count * sizeof *wanted);
            return;
        }
    }
}

/* To the middle of the neighbours, within the tangent plane. sum, count: [vertex_count], zeroed. */
static void relax(const parian_mesh *mesh, const bool *fixed, const double (*normal)[3],
                  double (*sum)[3], uint32_t *count, double (*wanted)[3])
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            uint32_t v = mesh->triangle[t][corner];
            count[v] += 2;
            for (int k = 0; k < 3; k++) {
                sum[v][k] += mesh->position[mesh->triangle[t][(corner + 1) % 3]][k] +
                             mesh->position[mesh->triangle[t][(corner + 2) % 3]][k];
            }
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double move[3];
        for (int k = 0; k < 3; k++) {
            move[k] = fixed[v] ? 0.0 : sum[v][k] / count[v] - mesh->position[v][k];
        }
        double along = parian_dot3(move, normal[v]);
        for (int k = 0; k < 3; k++) {
            wanted[v][k] = mesh->position[v][k] + move[k] - along * normal[v][k];
        }
    }
}

/* Angle-weighted normals of the vertices on rounded ridges: halfway between both sides, however
 * many triangles each has. */
static void make_ridge_normals(const parian_mesh *mesh, const uint32_t (*along)[2],
                               double (*normal)[3])
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3 && along[v][0] != PARIAN_NO_NEIGHBOUR; k++) {
            normal[v][k] = 0.0;
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int corner = 0; corner < 3; corner++) {
            const uint32_t *c = mesh->triangle[t], v = c[corner];
            double a[3], b[3], n[3];
            if (along[v][0] == PARIAN_NO_NEIGHBOUR) {
                continue;
            }
            subtract(mesh->position[c[(corner + 1) % 3]], mesh->position[v], a);
            subtract(mesh->position[c[(corner + 2) % 3]], mesh->position[v], b);
            parian_cross3(a, b, n);
            double angle = atan2(norm(n), parian_dot3(a, b));
            normalise(n);
            for (int k = 0; k < 3; k++) {
                normal[v][k] += angle * n[k];
            }
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (along[v][0] != PARIAN_NO_NEIGHBOUR) {
            normalise(normal[v]);
        }
    }
}

/* Halfway to the middle of the neighbours along the ridge (all the way would let them swing), and
 * out of the surface. */
static void relax_ridges(const parian_mesh *mesh, const uint32_t (*along)[2],
                         const double (*normal)[3], double lift, double (*wanted)[3])
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (along[v][0] == PARIAN_NO_NEIGHBOUR) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            wanted[v][k] = 0.5 * mesh->position[v][k] + 0.25 * mesh->position[along[v][0]][k] +
                           0.25 * mesh->position[along[v][1]][k] + lift * normal[v][k];
        }
    }
}

parian_result parian_transfer_relax(const parian_env *env, const parian_closest *source,
                                    const parian_remesher_features *features, double reach,
                                    parian_mesh *mesh)
{
    parian_result result = PARIAN_E_NOMEM;
    uint32_t vertex_count = mesh->vertex_count, *count = NULL;
    double(*normal)[3] = NULL, (*wanted)[3] = NULL, (*sum)[3] = NULL;
    const uint32_t(*along)[2] = (const uint32_t(*)[2])features->along;
    parian_closest_hit *hit = NULL;
    if (!PARIAN_NEW(env, normal, vertex_count) || !PARIAN_NEW(env, wanted, vertex_count) ||
        !PARIAN_NEW0(env, sum, vertex_count) || !PARIAN_NEW0(env, count, vertex_count) ||
        !PARIAN_NEW(env, hit, vertex_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory to relax");
        goto done;
    }
    make_vertex_normals(mesh, normal);
    make_ridge_normals(mesh, along, normal);
    relax(mesh, features->on, (const double(*)[3])normal, sum, count, wanted);
    relax_ridges(mesh, along, (const double(*)[3])normal, ridge_lift * reach, wanted);
    parian_closest_query query = {vertex_count, (const double(*)[3])wanted,
                                  (const double(*)[3])normal, agree_cosine_min, reach};
    result = parian_closest_find(env, source, &query, hit);
    if (result != PARIAN_OK) {
        goto done;
    }
    for (uint32_t v = 0; v < vertex_count; v++) {
        bool stay = features->on[v] && along[v][0] == PARIAN_NO_NEIGHBOUR;
        stay = stay || hit[v].distance > reach;
        memcpy(wanted[v], stay ? mesh->position[v] : hit[v].point, sizeof wanted[0]);
    }
    take_positions(mesh, wanted);
done:
    parian_free(env, hit);
    parian_free(env, count);
    parian_free(env, sum);
    parian_free(env, wanted);
    parian_free(env, normal);
    return result;
}

typedef struct fit_samples {
    double (*point)[3];  /* [triangle_count][FIT_SAMPLES] */
    double (*normal)[3]; /* the triangle's */
    parian_closest_hit *hit;
} fit_samples;

/* Barycentrics of the samples: the midpoints of the lines from the centroid to the corners, exact
 * for second-degree polynomials. */
static double sample_weight(int sample, int corner)
{
    return sample == corner ? 2.0 / 3.0 : 1.0 / 6.0;
}

static void place_samples(const parian_mesh *mesh, fit_samples *samples)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *c = mesh->triangle[t];
        double n[3];
        triangle_area_vector(mesh, (const double(*)[3])mesh->position, t, n);
        normalise(n);
        for (int s = 0; s < FIT_SAMPLES; s++) {
            size_t i = (size_t)t * FIT_SAMPLES + s;
            memcpy(samples->normal[i], n, sizeof n);
            for (int k = 0; k < 3; k++) {
                samples->point[i][k] = sample_weight(s, 0) * mesh->position[c[0]][k] +
                                       sample_weight(s, 1) * mesh->position[c[1]][k] +
                                       sample_weight(s, 2) * mesh->position[c[2]][k];
            }
        }
    }
}

/* Sum over the samples around each vertex: hat times area, and that times the height of the source
 * over the mesh. A sample without a counterpart within reach counts as height 0. */
static void gather_heights(const parian_mesh *mesh, const fit_samples *samples, double reach,
                           double *mass, double *height)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double n[3];
        triangle_area_vector(mesh, (const double(*)[3])mesh->position, t, n);
        for (int s = 0; s < FIT_SAMPLES; s++) {
            size_t i = (size_t)t * FIT_SAMPLES + s;
            double to_source[3];
            subtract(samples->hit[i].point, samples->point[i], to_source);
            double h =
                samples->hit[i].distance > reach ? 0.0 : parian_dot3(to_source, samples->normal[i]);
            for (int corner = 0; corner < 3; corner++) {
                double weight = sample_weight(s, corner) * norm(n);
                mass[mesh->triangle[t][corner]] += weight;
                height[mesh->triangle[t][corner]] += weight * h;
            }
        }
    }
}

static bool allocate_samples(const parian_env *env, size_t count, fit_samples *samples)
{
    return PARIAN_NEW(env, samples->point, count) && PARIAN_NEW(env, samples->normal, count) &&
           PARIAN_NEW(env, samples->hit, count);
}

static void free_samples(const parian_env *env, fit_samples *samples)
{
    parian_free(env, samples->point);
    parian_free(env, samples->normal);
    parian_free(env, samples->hit);
}

static void raise_vertices(const parian_mesh *mesh, const bool *fixed, const double *mass,
                           const double *height, const double (*normal)[3], double (*wanted)[3])
{
    memcpy(wanted, mesh->position, mesh->vertex_count * sizeof *wanted);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        for (int k = 0; k < 3 && !fixed[v] && mass[v] > 0.0; k++) {
            wanted[v][k] += normal[v][k] * height[v] / mass[v];
        }
    }
}

parian_result parian_transfer_fit(const parian_env *env, const parian_closest *source,
                                  const bool *fixed, double reach, parian_mesh *mesh)
{
    parian_result result = PARIAN_E_NOMEM;
    size_t sample_count = (size_t)mesh->triangle_count * FIT_SAMPLES;
    fit_samples samples = {0};
    double(*normal)[3] = NULL, (*wanted)[3] = NULL, *mass = NULL, *height = NULL;
    if (!allocate_samples(env, sample_count, &samples) ||
        !PARIAN_NEW(env, normal, mesh->vertex_count) ||
        !PARIAN_NEW(env, wanted, mesh->vertex_count) ||
        !PARIAN_NEW0(env, mass, mesh->vertex_count) ||
        !PARIAN_NEW0(env, height, mesh->vertex_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for the fit");
        goto done;
    }
    place_samples(mesh, &samples);
    parian_closest_query query = {sample_count, (const double(*)[3])samples.point,
                                  (const double(*)[3])samples.normal, agree_cosine_min, reach};
    result = parian_closest_find(env, source, &query, samples.hit);
    if (result == PARIAN_OK) {
        make_vertex_normals(mesh, normal);
        gather_heights(mesh, &samples, reach, mass, height);
        raise_vertices(mesh, fixed, mass, height, (const double(*)[3])normal, wanted);
        take_positions(mesh, wanted);
    }
done:
    free_samples(env, &samples);
    parian_free(env, height);
    parian_free(env, mass);
    parian_free(env, wanted);
    parian_free(env, normal);
    return result;
}
