/* samples_area.c - shares the surface out among the samples, each piece to the nearest that faces
 * alike.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/samples_parts.h"
#include "core/memory.h"

enum { BLOCK = 256, STACK_MAX = 128 };

/* Pieces have edges of at most half the radius. The piece that a sample lies in has its middle
 * within a third of the radius from it, and every other sample farther, so no sample goes without
 * area. */
static const double EDGE_MOST = 0.5;

/* What a block of triangles found: pieces of the surface and whose they are, in order. */
typedef struct share_list {
    size_t count, room;
    struct share {
        uint32_t sample;
        double area;
    } * share;
    bool failed;
} share_list;

typedef struct share_job {
    const parian_env *env;
    const sampling *s;
    share_list *list; /* [blocks] */
} share_job;

static void add_share(const parian_env *env, share_list *list, uint32_t sample, double area)
{
    if (list->count > 0 && list->share[list->count - 1].sample == sample) {
        list->share[list->count - 1].area += area;
        return;
    }
    if (list->count == list->room) {
        size_t room = list->room ? 2 * list->room : BLOCK;
        struct share *made = parian_alloc(env, room, sizeof *made);
        if (!made) {
            list->failed = true;
            return;
        }
        if (list->count > 0) {
            memcpy(made, list->share, list->count * sizeof *made);
        }
        parian_free(env, list->share);
        list->share = made;
        list->room = room;
    }
    list->share[list->count++] = (struct share){sample, area};
}

static uint32_t owner_of(const sampling *s, uint32_t triangle, const double (*place)[3])
{
    parian_point middle;
    double squared;
    for (int i = 0; i < 3; i++) {
        middle.position[i] = (place[0][i] + place[1][i] + place[2][i]) / 3;
    }
    memcpy(middle.normal, s->normal[triangle], sizeof middle.normal);
    return parian_point_grid_nearest(&s->grid, &middle, s->radius, PARIAN_NO_POINT, &squared);
}

/* Depth first; halves of halves: the stack never holds more than the number of bisections. */
static void share_triangle(const share_job *job, uint32_t triangle, share_list *list)
{
    const sampling *s = job->s;
    sampling_piece stack[STACK_MAX];
    int depth = 0;
    double whole = sampling_triangle_area(s, triangle);
    stack[depth++] = (sampling_piece){triangle, {{1, 0}, {0, 1}, {0, 0}}};
    while (depth > 0) {
        sampling_piece piece = stack[--depth];
        double place[3][3];
        int longest = 0;
        double edge = sampling_piece_places(s, &piece, place, &longest);
        if (edge > EDGE_MOST * s->radius && depth < STACK_MAX - 2) {
            sampling_piece_split(&piece, longest, &stack[depth]);
            depth += 2;
            continue;
        }
        uint32_t owner = owner_of(s, triangle, (const double(*)[3])place);
        if (owner != PARIAN_NO_POINT) {
            add_share(job->env, list, owner, sampling_piece_share(&piece) * whole);
        }
    }
}

static void share_block(void *context, size_t block)
{
    share_job *job = context;
    uint32_t first = (uint32_t)(block * BLOCK), end = job->s->surface->triangle_count;
    end = end - first < BLOCK ? end : first + BLOCK;
    for (uint32_t t = first; t < end; t++) {
        if (sampling_has_area(job->s, t)) {
            share_triangle(job, t, &job->list[block]);
        }
    }
}

/* What lies in gaps too small to look at goes to all in proportion. */
static void scale_to_surface(const sampling *s, double *area)
{
    double sum = 0;
    for (uint32_t i = 0; i < s->grid.count; i++) {
        sum += area[i];
    }
    for (uint32_t i = 0; sum > 0 && i < s->grid.count; i++) {
        area[i] *= s->area / sum;
    }
}

parian_result sampling_areas(const parian_env *env, const sampling *s, double *area)
{
    size_t blocks = ((size_t)s->surface->triangle_count + BLOCK - 1) / BLOCK;
    share_job job = {.env = env, .s = s};
    parian_result r = PARIAN_OK;
    if (!PARIAN_NEW0(env, job.list, blocks)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for the areas of %u samples",
                           s->grid.count);
    }
    memset(area, 0, s->grid.count * sizeof *area);
    parian_par(env, blocks, share_block, &job);
    for (size_t b = 0; b < blocks; b++) {
        for (size_t i = 0; i < job.list[b].count; i++) {
            area[job.list[b].share[i].sample] += job.list[b].share[i].area;
        }
        r = job.list[b].failed ? PARIAN_E_NOMEM : r;
        parian_free(env, job.list[b].share);
    }
    parian_free(env, job.list);
    if (r != PARIAN_OK) {
        return parian_fail(env, r, "no memory for the areas of %u samples", s->grid.count);
    }
    scale_to_surface(s, area);
    return PARIAN_OK;
}
