/* point_grid.h - points of a surface in cells, found by where they are and which way they face.
 *
 * Two points *face alike* when their normals have a positive dot product: the two sides of a thin
 * plate do not, so neither hides a gap of the other.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PARIAN_CORE_POINT_GRID_H
#define PARIAN_CORE_POINT_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "parian/env.h"
#include "parian/result.h"

enum { PARIAN_NO_POINT = 0xFFFFFFFFu };

typedef struct parian_point {
    double position[3]; /* metres */
    double normal[3];   /* unit */
} parian_point;

/* Points in the order in which they were put. Reading is safe from many threads while nobody puts.
 */
typedef struct parian_point_grid {
    double cell; /* side, metres: the farthest that queries look */
    uint32_t count, room, bucket_mask;
    parian_point *point; /* [room], count of them in use */
    uint32_t *next;      /* [room] next point of a bucket */
    uint32_t *bucket;    /* [bucket_mask + 1] first point of a bucket */
} parian_point_grid;

/* A grid without points and with room for some; it grows. Errors: PARIAN_E_NOMEM. */
parian_result parian_point_grid_create(const parian_env *env, double cell, uint32_t room,
                                       parian_point_grid *grid);
void parian_point_grid_free(const parian_env *env, parian_point_grid *grid);
/* Forget the points, keep the memory. */
void parian_point_grid_clear(parian_point_grid *grid, double cell);
/* Errors: PARIAN_E_NOMEM, PARIAN_E_LIMIT (2^31 points). */
parian_result parian_point_grid_put(const parian_env *env, parian_point_grid *grid,
                                    const parian_point *point);

/* The nearest point that faces alike and is nearer than both reach and the grid's cell;
 * PARIAN_NO_POINT where there is none. Of equally near ones the first put. squared: of its
 * distance. skip: a point that does not count, or PARIAN_NO_POINT. */
uint32_t parian_point_grid_nearest(const parian_point_grid *grid, const parian_point *at,
                                   double reach, uint32_t skip, double *squared);
/* Whether any point that faces alike is nearer than reach (at most the cell). */
bool parian_point_grid_has(const parian_point_grid *grid, const parian_point *at, double reach);

/* Called with each point that faces alike and is nearer than reach (at most the cell). */
typedef void (*parian_point_visit)(void *context, uint32_t point, double squared);
void parian_point_grid_visit(const parian_point_grid *grid, const parian_point *at, double reach,
                             parian_point_visit visit, void *context);

static inline bool parian_points_face_alike(const parian_point *a, const parian_point *b)
{
    return a->normal[0] * b->normal[0] + a->normal[1] * b->normal[1] + a->normal[2] * b->normal[2] >
           0;
}

static inline double parian_points_squared(const parian_point *a, const parian_point *b)
{
    double x = a->position[0] - b->position[0], y = a->position[1] - b->position[1];
    double z = a->position[2] - b->position[2];
    return x * x + y * y + z * z;
}

#endif
