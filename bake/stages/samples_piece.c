/* samples_piece.c - pieces of triangles: corners, halves, areas.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/samples_parts.h"

double sampling_piece_places(const sampling *s, const sampling_piece *piece, double place[3][3],
                             int *longest)
{
    const uint32_t *c = s->surface->triangle[piece->triangle];
    double most = -1;
    for (int k = 0; k < 3; k++) {
        double a = piece->corner[k][0], b = piece->corner[k][1];
        for (int i = 0; i < 3; i++) {
            place[k][i] = a * (double)s->surface->vertex[c[0]][i] +
                          b * (double)s->surface->vertex[c[1]][i] +
                          (1 - a - b) * (double)s->surface->vertex[c[2]][i];
        }
    }
    for (int k = 0; k < 3; k++) {
        const double *p = place[k], *q = place[(k + 1) % 3];
        double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2], squared = x * x + y * y + z * z;
        if (squared > most) {
            most = squared;
            *longest = k;
        }
    }
    return sqrt(most);
}

void sampling_piece_split(const sampling_piece *piece, int edge, sampling_piece half[2])
{
    int next = (edge + 1) % 3;
    half[0] = half[1] = *piece;
    for (int i = 0; i < 2; i++) {
        double middle = 0.5 * (piece->corner[edge][i] + piece->corner[next][i]);
        half[0].corner[next][i] = half[1].corner[edge][i] = middle;
    }
}

double sampling_piece_share(const sampling_piece *piece)
{
    const double *a = piece->corner[0], *b = piece->corner[1], *c = piece->corner[2];
    return fabs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}
