/* samples_order.c - the order in which any first part of a set is well spread: half of the samples
 * are taken out, the one with the nearest neighbours first, then half of the rest, and so on; the
 * last to go comes first.
 *
 * Source  [Yuksel15]
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>

#include "bake/stages/samples_parts.h"
#include "core/memory.h"

static const double BETA = 0.65, GAMMA = 1.5;

/* Samples in a heap by weight, largest on top; of equal ones the first sample. */
typedef struct elimination {
    const sampling *s;
    uint32_t count;         /* in the heap */
    uint32_t *heap;         /* [count] indices into sample */
    uint32_t *place;        /* [all] where a sample stands in the heap; PARIAN_NO_POINT: out */
    double *weight;         /* [all] */
    uint32_t *sample;       /* [all] samples that this round began with */
    parian_point_grid grid; /* of these */
    double reach, least;
} elimination;

static bool is_before(const elimination *e, uint32_t a, uint32_t b)
{
    return e->weight[a] > e->weight[b] ||
           (e->weight[a] == e->weight[b] && e->sample[a] < e->sample[b]);
}

static void set_place(elimination *e, uint32_t at, uint32_t i)
{
    e->heap[at] = i;
    e->place[i] = at;
}

static void sink(elimination *e, uint32_t at)
{
    uint32_t moved = e->heap[at];
    for (;;) {
        uint32_t child = 2 * at + 1;
        if (child >= e->count) {
            break;
        }
        if (child + 1 < e->count && is_before(e, e->heap[child + 1], e->heap[child])) {
            child++;
        }
        if (is_before(e, moved, e->heap[child])) {
            break;
        }
        set_place(e, at, e->heap[child]);
        at = child;
    }
    set_place(e, at, moved);
}

static double weight_of(const elimination *e, double squared)
{
    double d = fmax(sqrt(squared), e->least), w = 1 - d / e->reach;
    w *= w;
    w *= w;
    return w > 0 ? w * w : 0; /* alpha = 8 */
}

typedef struct weighing {
    elimination *e;
    uint32_t self;
    bool away; /* the sample itself goes: its neighbours become lighter */
} weighing;

static void weigh(void *context, uint32_t point, double squared)
{
    weighing *w = context;
    if (point == w->self || w->e->place[point] == PARIAN_NO_POINT) {
        return;
    }
    double share = weight_of(w->e, squared);
    if (w->away) {
        w->e->weight[point] -= share;
        sink(w->e, w->e->place[point]);
    } else {
        w->e->weight[w->self] += share;
    }
}

static void weigh_block(void *context, size_t i)
{
    elimination *e = context;
    weighing w = {e, (uint32_t)i, false};
    e->weight[i] = 0;
    parian_point_grid_visit(&e->grid, &e->grid.point[i], e->reach, weigh, &w);
}

static parian_result begin_round(const parian_env *env, elimination *e, uint32_t all, uint32_t kept)
{
    double most = sqrt(e->s->area / (2 * sqrt(3.0) * kept));
    e->reach = 2 * most;
    e->least = e->reach * BETA * (1 - pow((double)kept / all, GAMMA));
    e->count = all;
    parian_point_grid_clear(&e->grid, e->reach);
    for (uint32_t i = 0; i < all; i++) {
        parian_result r = parian_point_grid_put(env, &e->grid, &e->s->grid.point[e->sample[i]]);
        if (r != PARIAN_OK) {
            return r;
        }
        set_place(e, i, i);
    }
    parian_par(env, all, weigh_block, e);
    for (uint32_t i = all / 2; i-- > 0;) {
        sink(e, i);
    }
    return PARIAN_OK;
}

/* Take the heaviest out and write them behind the rest, the last to go first. */
static void end_round(elimination *e, uint32_t all, uint32_t kept, uint32_t *order)
{
    while (e->count > kept) {
        uint32_t out = e->heap[0];
        e->count--;
        order[e->count] = e->sample[out];
        e->place[out] = PARIAN_NO_POINT;
        if (e->count > 0) {
            set_place(e, 0, e->heap[e->count]);
            sink(e, 0);
        }
        weighing w = {e, out, true};
        parian_point_grid_visit(&e->grid, &e->grid.point[out], e->reach, weigh, &w);
    }
    uint32_t left = 0;
    for (uint32_t i = 0; i < all; i++) {
        if (e->place[i] != PARIAN_NO_POINT) {
            e->sample[left++] = e->sample[i];
        }
    }
}

parian_result sampling_order(const parian_env *env, const sampling *s, uint32_t *order)
{
    uint32_t all = s->grid.count;
    elimination e = {.s = s};
    parian_result r = parian_point_grid_create(env, s->radius, all, &e.grid);
    if (r == PARIAN_OK && (!PARIAN_NEW(env, e.heap, all) || !PARIAN_NEW(env, e.place, all) ||
                           !PARIAN_NEW(env, e.weight, all) || !PARIAN_NEW(env, e.sample, all))) {
        r = parian_fail(env, PARIAN_E_NOMEM, "no memory to order %u samples", all);
    }
    for (uint32_t i = 0; r == PARIAN_OK && i < all; i++) {
        e.sample[i] = i;
    }
    while (r == PARIAN_OK && all > 0) {
        uint32_t kept = all / 2;
        r = begin_round(env, &e, all, kept > 0 ? kept : 1);
        if (r == PARIAN_OK) {
            end_round(&e, all, kept, order);
            all = kept;
        }
    }
    parian_free(env, e.heap);
    parian_free(env, e.place);
    parian_free(env, e.weight);
    parian_free(env, e.sample);
    parian_point_grid_free(env, &e.grid);
    return r;
}
