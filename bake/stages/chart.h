/* chart.h - charts of a surface while the atlas is made. Internal to the atlas stage.
 *
 * The files in order: chart_surface.c (what is measured of each triangle), chart_grow.c,
 * chart_merge.c, chart_split.c (charts whose projection overlaps itself), chart_flatten.c
 * (projection and rectangle).
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#ifndef PARIAN_BAKE_CHART_H
#define PARIAN_BAKE_CHART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/body.h"

enum { PARIAN_NO_CHART = 0xFFFFFFFFu };

/* A surface cut into charts. All arrays are owned. */
typedef struct chart_set {
    uint32_t triangle_count;
    const uint32_t (*triangle)[3]; /* of the body */
    const float (*position)[3];    /* of the body */
    uint32_t (*neighbour)[3];      /* [triangle_count] half-edge across, or PARIAN_NO_NEIGHBOUR */
    double (*normal)[3];           /* [triangle_count] unit, or zero where there is no area */
    double (*centre)[3];           /* [triangle_count] centroid */
    double (*edge)[3];             /* [triangle_count] lengths of the edges */
    double *area;                  /* [triangle_count] */
    double area_total;
    uint32_t *chart; /* [triangle_count] PARIAN_NO_CHART where not yet given */
    uint32_t chart_count;
    uint32_t *chart_begin;  /* [chart_count + 1] into chart_member, made by chart_set_list */
    uint32_t *chart_member; /* [triangle_count] triangles chart by chart, ascending in each */
    double (*flat)[3][2];   /* [triangle_count] corners in the chart's own rectangle, made by
                               chart_set_flatten */
    double (
        *extent)[2]; /* [chart_count] sides of the rectangle, metres, made by chart_set_flatten */
} chart_set;

/* Measure a body's triangles; no chart is given yet. */
parian_result chart_set_create(const parian_env *env, const parian_body *body, chart_set *set);
void chart_set_free(const parian_env *env, chart_set *set);

/* Give every triangle a chart whose triangles deviate by at most the angle from its average normal.
 */
parian_result chart_set_grow(const parian_env *env, chart_set *set, double angle_deg);
/* Grow all charts again at once, from their centres, each held to its present average normal. */
parian_result chart_set_relax(const parian_env *env, chart_set *set, double angle_deg);
/* Join neighbouring charts whose union keeps to the angle, and small ones at wider angles. */
parian_result chart_set_merge(const parian_env *env, chart_set *set, double angle_deg);
/* Cut charts whose orthographic projection overlaps itself. */
parian_result chart_set_split(const parian_env *env, chart_set *set);
/* Project every chart along its average normal and turn it to its minimal rectangle. */
parian_result chart_set_flatten(const parian_env *env, chart_set *set);

/* Number charts by their first triangle, without gaps, and list their triangles. */
parian_result chart_set_list(const parian_env *env, chart_set *set);
/* Sum of area times normal over the listed triangles of a chart; its direction is the average
 * normal. */
void chart_set_normal(const chart_set *set, uint32_t chart, double sum[3]);
/* Two unit vectors that complete a unit normal to a right-handed frame. */
void chart_frame(const double normal[3], double tangent[3], double bitangent[3]);

/* A binary heap of items by cost, ties by item: the order never depends on how it was filled. */
typedef struct chart_heap_entry {
    double cost;
    uint32_t item, tag;
} chart_heap_entry;
typedef struct chart_heap {
    chart_heap_entry *entry;
    size_t count, room;
} chart_heap;
bool chart_heap_push(const parian_env *env, chart_heap *heap, double cost, uint32_t item,
                     uint32_t tag);
bool chart_heap_pop(chart_heap *heap, chart_heap_entry *out);

static inline double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
