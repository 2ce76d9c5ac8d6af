/* surface_walk.c - vertices near one vertex along the edges of the transfer surface (Dijkstra).
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include "bake/stages/surface_walk.h"

#include <string.h>

#include "core/memory.h"
#include "core/small_maths.h"

parian_result parian_walk_make(const parian_env *env, const parian_body *body,
                               const parian_vertex_frame *frame, parian_walk *walk)
{
    size_t vertices = body->vertex_count, pushes = 6 * (size_t)body->triangle_count + 1;
    memset(walk, 0, sizeof *walk);
    walk->body = body;
    walk->frame = frame;
    if (!PARIAN_NEW(env, walk->found, vertices) || !PARIAN_NEW(env, walk->heap, pushes) ||
        !PARIAN_NEW(env, walk->distance, vertices) || !PARIAN_NEW0(env, walk->stamp, vertices)) {
        parian_walk_free(env, walk);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory to walk over %zu vertices", vertices);
    }
    return PARIAN_OK;
}

void parian_walk_free(const parian_env *env, parian_walk *walk)
{
    parian_free(env, walk->found);
    parian_free(env, walk->heap);
    parian_free(env, walk->distance);
    parian_free(env, walk->stamp);
    memset(walk, 0, sizeof *walk);
}

/* A total order, so that ties fall the same way always. */
static bool before(parian_walk_step a, parian_walk_step b)
{
    return a.distance < b.distance || (a.distance == b.distance && a.vertex < b.vertex);
}

static void push(parian_walk *walk, uint32_t vertex, float distance)
{
    parian_walk_step step = {distance, vertex}, *heap = walk->heap;
    if (walk->stamp[vertex] == walk->token && walk->distance[vertex] <= distance) {
        return;
    }
    walk->stamp[vertex] = walk->token;
    walk->distance[vertex] = distance;
    uint32_t at = walk->heap_count++;
    for (; at > 0 && before(step, heap[(at - 1) / 2]); at = (at - 1) / 2) {
        heap[at] = heap[(at - 1) / 2];
    }
    heap[at] = step;
}

static parian_walk_step pop(parian_walk *walk)
{
    parian_walk_step *heap = walk->heap, top = heap[0], last = heap[--walk->heap_count];
    uint32_t at = 0, count = walk->heap_count;
    for (uint32_t child = 1; child < count; child = 2 * at + 1) {
        child += child + 1 < count && before(heap[child + 1], heap[child]);
        if (!before(heap[child], last)) {
            break;
        }
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = last;
    return top;
}

static void push_neighbours(parian_walk *walk, parian_walk_step from, const float up[3],
                            double reach, double facing)
{
    const parian_vertex_frame *frame = walk->frame;
    const float(*position)[3] = (const float(*)[3])walk->body->vertex_position;
    uint32_t last = frame->fan_offset[from.vertex + 1];
    for (uint32_t i = frame->fan_offset[from.vertex]; i < last; i++) {
        for (int k = 0; k < 3; k++) {
            uint32_t v = walk->body->triangle[frame->fan[i]][k];
            const float *n = frame->normal[v];
            float distance =
                from.distance + sqrtf(parian_distance2f(position[v], position[from.vertex]));
            if (v != from.vertex && distance <= reach &&
                n[0] * up[0] + n[1] * up[1] + n[2] * up[2] >= facing) {
                push(walk, v, distance);
            }
        }
    }
}

void parian_walk_from(parian_walk *walk, uint32_t start, double reach, double facing)
{
    walk->count = 0;
    walk->heap_count = 0;
    walk->token++;
    push(walk, start, 0);
    while (walk->heap_count > 0) {
        parian_walk_step step = pop(walk);
        if (step.distance == walk->distance[step.vertex]) {
            walk->found[walk->count++] = step;
            push_neighbours(walk, step, walk->frame->normal[start], reach, facing);
        }
    }
}
