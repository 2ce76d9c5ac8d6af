/* surface_samples.c - points of samples.
 *
 * SPDX-License-Identifier: MIT
 */
#include "core/surface_samples.h"

#include "core/memory.h"
#include "core/small_maths.h"

void parian_surface_samples_free(const parian_env *env, parian_surface_samples *samples)
{
    if (samples) {
        parian_free(env, samples->triangle);
        parian_free(env, samples->barycentric);
        parian_free(env, samples->area);
        parian_free(env, samples->radius);
        *samples = (parian_surface_samples){0};
    }
}

parian_point parian_surface_point(const parian_sampled_surface *surface, uint32_t triangle,
                                  const float barycentric[2])
{
    const uint32_t *c = surface->triangle[triangle];
    const float *corner[3] = {surface->vertex[c[0]], surface->vertex[c[1]], surface->vertex[c[2]]};
    double share[3] = {(double)barycentric[0], (double)barycentric[1], 0}, edge[2][3];
    parian_point point = {{0}, {0}};
    share[2] = 1 - share[0] - share[1];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            point.position[i] += share[k] * (double)corner[k][i];
        }
    }
    parian_sub3(corner[1], corner[0], edge[0]);
    parian_sub3(corner[2], corner[0], edge[1]);
    parian_cross3(edge[0], edge[1], point.normal);
    double length = sqrt(parian_dot3(point.normal, point.normal));
    for (int i = 0; i < 3; i++) {
        point.normal[i] = length > 0 ? point.normal[i] / length : 0;
    }
    return point;
}
