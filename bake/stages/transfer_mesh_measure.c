/* transfer_mesh_measure.c - samples the distance between the transfer surface and its source.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/transfer_mesh_parts.h"
#include "core/memory.h"

/* Points spread evenly by area: sample i lies where the running sum of areas passes (i + 1/2) /
 * count; inside its triangle, point i of the two-dimensional sequence of the plastic number. */
static void place_samples(const parian_mesh *mesh, double area, uint32_t count, double (*point)[3])
{
    static const double step[2] = {0.7548776662466927, 0.5698402909980532};
    double passed = 0.0;
    uint32_t i = 0;
    for (uint32_t t = 0; t < mesh->triangle_count && i < count; t++) {
        const double *a = mesh->position[mesh->triangle[t][0]];
        const double *b = mesh->position[mesh->triangle[t][1]];
        const double *c = mesh->position[mesh->triangle[t][2]];
        double n[3];
        area_vector(a, b, c, n);
        passed += 0.5 * norm(n);
        bool last = t + 1 == mesh->triangle_count;
        for (; i < count && (last || (i + 0.5) * area < passed * count); i++) {
            double u = fmod(0.5 + i * step[0], 1.0), v = fmod(0.5 + i * step[1], 1.0);
            double root = sqrt(u);
            for (int k = 0; k < 3; k++) {
                point[i][k] = (1.0 - root) * a[k] + root * (1.0 - v) * b[k] + root * v * c[k];
            }
        }
    }
}

static parian_result add_distances(const parian_env *env, const parian_mesh *from, double area,
                                   const parian_closest *to, uint32_t count, transfer_part *part)
{
    parian_result result = PARIAN_E_NOMEM;
    double(*point)[3] = NULL;
    parian_closest_hit *hit = NULL;
    if (!PARIAN_NEW(env, point, count) || !PARIAN_NEW(env, hit, count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "transfer mesh: out of memory for distances");
        goto done;
    }
    place_samples(from, area, count, point);
    parian_closest_query query = {.count = count, .point = (const double(*)[3])point};
    result = parian_closest_find(env, to, &query, hit);
    for (uint32_t i = 0; result == PARIAN_OK && i < count; i++) {
        part->squared_sum += hit[i].distance * hit[i].distance;
        part->distance_max = fmax(part->distance_max, hit[i].distance);
    }
    part->sample_count += count;
done:
    parian_free(env, hit);
    parian_free(env, point);
    return result;
}

parian_result parian_transfer_measure(const parian_env *env, const parian_closest *source,
                                      uint32_t sample_count, transfer_part *part)
{
    parian_closest *transfer = NULL;
    parian_result result = parian_closest_create(env, &part->result, &transfer);
    if (result == PARIAN_OK) {
        result = add_distances(env, &part->result, parian_mesh_area(&part->result), source,
                               sample_count, part);
    }
    if (result == PARIAN_OK) {
        result = add_distances(env, &part->source, part->area, transfer, sample_count, part);
    }
    parian_closest_destroy(transfer);
    return result;
}
