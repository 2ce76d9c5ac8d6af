/* surface_weld.c - drops unreferenced vertices, merges vertices that coincide, drops repeated
 * triangles.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/stages/surface_steps.h"
#include "core/memory.h"

enum { CELL_TOLERANCES = 16, CELL_BITS = 20 };

static const uint32_t none = UINT32_MAX;

parian_result surface_drop_unreferenced(const parian_env *env, parian_mesh *mesh, uint32_t *dropped)
{
    uint32_t *target, count = 0;
    if (!PARIAN_NEW0(env, target, mesh->vertex_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "surface: out of memory for %u vertices",
                           mesh->vertex_count);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            target[mesh->triangle[t][i]] = 1;
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        if (target[v]) {
            memmove(mesh->position[count], mesh->position[v], sizeof *mesh->position);
            target[v] = count++;
        }
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            mesh->triangle[t][i] = target[mesh->triangle[t][i]];
        }
    }
    *dropped = mesh->vertex_count - count;
    mesh->vertex_count = count;
    parian_free(env, target);
    return PARIAN_OK;
}

/* Vertices that stand for themselves, chained by cell in a hash table. */
typedef struct weld_grid {
    const parian_mesh *mesh;
    double lower[3], cell, tolerance;
    uint64_t *key;   /* [slot_count] */
    uint32_t *first; /* [slot_count] newest vertex of the cell, or none */
    uint32_t *next;  /* [vertex_count] */
    uint32_t slot_mask;
} weld_grid;

static uint32_t find_slot(const weld_grid *grid, uint64_t key)
{
    uint64_t hash = key * 0x9E3779B97F4A7C15u;
    uint32_t slot = (uint32_t)(hash >> 32) & grid->slot_mask;
    while (grid->first[slot] != none && grid->key[slot] != key) {
        slot = (slot + 1) & grid->slot_mask;
    }
    return slot;
}

static uint64_t cell_of(const weld_grid *grid, const double p[3])
{
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double at = floor((p[k] - grid->lower[k]) / grid->cell) + 1;
        key = key << CELL_BITS | (uint64_t)(at > 0 ? at : 0);
    }
    return key;
}

static bool is_near(const double a[3], const double b[3], double tolerance)
{
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z <= tolerance * tolerance;
}

/* The first vertex within the tolerance, or none. Cells that the tolerance reaches into are looked
 * at too. */
static uint32_t find_near(const weld_grid *grid, const double p[3])
{
    uint64_t seen[8];
    uint32_t best = none;
    for (int corner = 0; corner < 8; corner++) {
        double q[3];
        for (int k = 0; k < 3; k++) {
            q[k] = p[k] + ((corner >> k & 1) ? grid->tolerance : -grid->tolerance);
        }
        seen[corner] = cell_of(grid, q);
        bool repeated = false;
        for (int k = 0; k < corner; k++) {
            repeated = repeated || seen[k] == seen[corner];
        }
        uint32_t v = repeated ? none : grid->first[find_slot(grid, seen[corner])];
        for (; v != none; v = grid->next[v]) {
            if (v < best && is_near(p, grid->mesh->position[v], grid->tolerance)) {
                best = v;
            }
        }
    }
    return best;
}

static void weld_vertices(weld_grid *grid, parian_mesh *mesh, uint32_t *target, uint32_t *welded)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t near = find_near(grid, mesh->position[v]);
        if (near != none) {
            target[v] = near;
            (*welded)++;
            continue;
        }
        uint64_t key = cell_of(grid, mesh->position[v]);
        uint32_t slot = find_slot(grid, key);
        grid->key[slot] = key;
        grid->next[v] = grid->first[slot];
        grid->first[slot] = v;
        target[v] = v;
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        for (int i = 0; i < 3; i++) {
            mesh->triangle[t][i] = target[mesh->triangle[t][i]];
        }
    }
}

parian_result surface_weld(const parian_env *env, parian_mesh *mesh, double tolerance,
                           uint32_t *welded)
{
    weld_grid grid = {.mesh = mesh, .tolerance = tolerance, .cell = CELL_TOLERANCES * tolerance};
    double upper[3];
    uint32_t *target = NULL;
    uint64_t slot_count = 16;
    parian_result result = PARIAN_E_NOMEM;
    while (slot_count < 2 * (uint64_t)mesh->vertex_count) {
        slot_count *= 2;
    }
    grid.slot_mask = (uint32_t)(slot_count - 1);
    parian_mesh_bounds(mesh, grid.lower, upper);
    *welded = 0;
    if (!PARIAN_NEW(env, grid.key, slot_count) || !PARIAN_NEW(env, grid.first, slot_count) ||
        !PARIAN_NEW(env, grid.next, mesh->vertex_count) ||
        !PARIAN_NEW(env, target, mesh->vertex_count)) {
        parian_fail(env, result, "surface: out of memory welding %u vertices", mesh->vertex_count);
    } else {
        memset(grid.first, 0xFF, slot_count * sizeof *grid.first);
        weld_vertices(&grid, mesh, target, welded);
        uint32_t dropped;
        result = surface_drop_unreferenced(env, mesh, &dropped);
    }
    parian_free(env, grid.key);
    parian_free(env, grid.first);
    parian_free(env, grid.next);
    parian_free(env, target);
    return result;
}

/* A triangle's vertices in ascending order, and its number. */
typedef struct face_key {
    uint32_t corner[3], triangle;
} face_key;

static int compare_faces(const void *left, const void *right)
{
    const face_key *a = left, *b = right;
    for (int k = 0; k < 3; k++) {
        if (a->corner[k] != b->corner[k]) {
            return a->corner[k] < b->corner[k] ? -1 : 1;
        }
    }
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static face_key make_key(const parian_mesh *mesh, uint32_t t)
{
    const uint32_t *c = mesh->triangle[t];
    uint32_t low = c[0] < c[1] ? c[0] : c[1], high = c[0] < c[1] ? c[1] : c[0];
    uint32_t first = c[2] < low ? c[2] : low, last = c[2] > high ? c[2] : high;
    uint32_t middle = c[2] < low ? low : c[2] > high ? high : c[2];
    return (face_key){{first, middle, last}, t};
}

/* Triangles are put into buckets by their lowest vertex, so that only a few are ever sorted
 * together. */
static void mark_duplicates(const parian_mesh *mesh, uint32_t *start, face_key *key, bool *keep)
{
    memset(start, 0, ((size_t)mesh->vertex_count + 2) * sizeof *start);
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        start[make_key(mesh, t).corner[0] + 2]++;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        start[v + 2] += start[v + 1];
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        face_key made = make_key(mesh, t);
        key[start[made.corner[0] + 1]++] = made;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t first = start[v], count = start[v + 1] - first;
        if (count > 1) {
            qsort(&key[first], count, sizeof *key, compare_faces);
        }
        for (uint32_t i = 0; i < count; i++) {
            const face_key *at = &key[first + i];
            keep[at->triangle] =
                i == 0 || memcmp(at->corner, at[-1].corner, sizeof at->corner) != 0;
        }
    }
}

parian_result surface_drop_duplicates(const parian_env *env, parian_mesh *mesh, uint32_t *dropped)
{
    uint32_t before = mesh->triangle_count;
    uint32_t *start = NULL;
    face_key *key = NULL;
    bool *keep = NULL;
    parian_result result = PARIAN_E_NOMEM;
    if (PARIAN_NEW(env, start, (size_t)mesh->vertex_count + 2) &&
        PARIAN_NEW(env, key, mesh->triangle_count) && PARIAN_NEW(env, keep, mesh->triangle_count)) {
        mark_duplicates(mesh, start, key, keep);
        surface_keep_triangles(mesh, keep);
        *dropped += before - mesh->triangle_count;
        result = PARIAN_OK;
    } else {
        parian_fail(env, result, "surface: out of memory for %u triangles", before);
    }
    parian_free(env, start);
    parian_free(env, key);
    parian_free(env, keep);
    return result;
}
