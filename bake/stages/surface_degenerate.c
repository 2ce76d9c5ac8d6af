/* surface_degenerate.c - takes flat triangles out without opening gaps.
 *
 * SPDX-License-Identifier: GPL-3.0-or-later
 */
#include <math.h>
#include <string.h>

#include "bake/stages/surface_steps.h"
#include "core/memory.h"

enum { PASS_MAX = 10 };

/* What is still flatter than this against its longest edge after the last pass has no usable
 * normal. */
static const double flatness_min = 1e-9;

typedef struct flat_pass {
    parian_mesh *mesh;
    surface_edges edges;
    uint32_t *group; /* [3 * triangle_count] of each half-edge */
    bool *touched, *keep;
    uint32_t changed;
} flat_pass;

static double edge_length(const parian_mesh *mesh, uint32_t half_edge)
{
    const double *a = mesh->position[surface_from(mesh, half_edge)];
    const double *b = mesh->position[surface_to(mesh, half_edge)];
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static uint32_t longest_edge(const parian_mesh *mesh, uint32_t triangle, double *length)
{
    uint32_t longest = 3 * triangle;
    *length = edge_length(mesh, longest);
    for (uint32_t h = longest + 1; h < 3 * triangle + 3; h++) {
        double candidate = edge_length(mesh, h);
        if (candidate > *length) {
            *length = candidate;
            longest = h;
        }
    }
    return longest;
}

static bool repeats_corner(const uint32_t corner[3])
{
    return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
}

static bool is_flat(const parian_mesh *mesh, uint32_t triangle, double tolerance, uint32_t *longest)
{
    double length;
    *longest = longest_edge(mesh, triangle, &length);
    return !(surface_doubled_area(mesh, triangle) > tolerance * length);
}

static parian_result drop_collapsed(const parian_env *env, parian_mesh *mesh, uint32_t *dropped)
{
    bool *keep;
    uint32_t before = mesh->triangle_count;
    if (!PARIAN_NEW(env, keep, before)) {
        return parian_fail(env, PARIAN_E_NOMEM, "surface: out of memory for %u triangles", before);
    }
    for (uint32_t t = 0; t < before; t++) {
        keep[t] = !repeats_corner(mesh->triangle[t]);
    }
    surface_keep_triangles(mesh, keep);
    *dropped += before - mesh->triangle_count;
    parian_free(env, keep);
    return PARIAN_OK;
}

/* Where the projection of a vertex falls on a half-edge, from 0 to 1. */
static double project(const parian_mesh *mesh, uint32_t half_edge, uint32_t vertex)
{
    const double *a = mesh->position[surface_from(mesh, half_edge)];
    const double *b = mesh->position[surface_to(mesh, half_edge)];
    const double *p = mesh->position[vertex];
    double along = 0, length = 0;
    for (int k = 0; k < 3; k++) {
        along += (p[k] - a[k]) * (b[k] - a[k]);
        length += (b[k] - a[k]) * (b[k] - a[k]);
    }
    double s = length > 0 ? along / length : 0;
    return s < 0 ? 0 : s > 1 ? 1 : s;
}

static void blend(const float *a, const float *b, double s, int count, float *out)
{
    for (int k = 0; k < count; k++) {
        out[k] = (float)((1 - s) * a[k] + s * b[k]);
    }
}

/* Make the corners of the flat triangle those of the neighbour's second half: middle, end of the
 * half-edge, its apex; the neighbour keeps the first. Attributes come from the neighbour. */
static void split_attributes(parian_mesh *mesh, uint32_t flat, uint32_t half_edge, double s)
{
    uint32_t u = half_edge / 3, p = half_edge % 3, q = (p + 1) % 3, d = (p + 2) % 3;
    if (mesh->corner_uv) {
        float(*from)[2] = mesh->corner_uv[u], (*to)[2] = mesh->corner_uv[flat];
        blend(from[p], from[q], s, 2, to[0]);
        memcpy(to[1], from[q], sizeof to[1]);
        memcpy(to[2], from[d], sizeof to[2]);
        memcpy(from[q], to[0], sizeof to[0]);
    }
    if (mesh->corner_normal) {
        float(*from)[3] = mesh->corner_normal[u], (*to)[3] = mesh->corner_normal[flat];
        blend(from[p], from[q], s, 3, to[0]);
        float length = sqrtf(to[0][0] * to[0][0] + to[0][1] * to[0][1] + to[0][2] * to[0][2]);
        for (int k = 0; k < 3; k++) {
            to[0][k] = length > 0 ? to[0][k] / length : from[p][k];
        }
        memcpy(to[1], from[q], sizeof to[1]);
        memcpy(to[2], from[d], sizeof to[2]);
        memcpy(from[q], to[0], sizeof to[0]);
    }
    if (mesh->material) {
        mesh->material[flat] = mesh->material[u];
    }
}

/* Give the vertex opposite a flat triangle's longest edge to the neighbour across that edge. */
static void mend_flat(flat_pass *pass, uint32_t flat, uint32_t longest)
{
    parian_mesh *mesh = pass->mesh;
    uint32_t group = pass->group[longest], first = pass->edges.offset[group];
    uint32_t members = pass->edges.offset[group + 1] - first;
    uint32_t other = pass->edges.half_edge[first] == longest
                         ? pass->edges.half_edge[first + members - 1]
                         : pass->edges.half_edge[first];
    uint32_t u = other / 3, middle = mesh->triangle[flat][(longest % 3 + 2) % 3];
    if (members == 2 && pass->touched[u]) {
        pass->changed++; /* the neighbour changed in this pass: wait for the next */
        return;
    }
    pass->touched[flat] = true;
    pass->changed++;
    uint32_t apex = mesh->triangle[u][(other % 3 + 2) % 3];
    if (members != 2 || apex == middle) {
        pass->keep[flat] = false;
        return;
    }
    pass->touched[u] = true;
    split_attributes(mesh, flat, other, project(mesh, other, middle));
    mesh->triangle[flat][0] = middle;
    mesh->triangle[flat][1] = surface_to(mesh, other);
    mesh->triangle[flat][2] = apex;
    mesh->triangle[u][(other % 3 + 1) % 3] = middle;
}

static void run_pass(flat_pass *pass, double tolerance)
{
    uint32_t longest;
    for (uint32_t k = 0; k < pass->edges.group_count; k++) {
        for (uint32_t i = pass->edges.offset[k]; i < pass->edges.offset[k + 1]; i++) {
            pass->group[pass->edges.half_edge[i]] = k;
        }
    }
    for (uint32_t t = 0; t < pass->mesh->triangle_count; t++) {
        pass->keep[t] = true;
        pass->touched[t] = false;
    }
    for (uint32_t t = 0; t < pass->mesh->triangle_count; t++) {
        if (!pass->touched[t] && is_flat(pass->mesh, t, tolerance, &longest)) {
            mend_flat(pass, t, longest);
        }
    }
    surface_keep_triangles(pass->mesh, pass->keep);
}

static parian_result mend_once(const parian_env *env, parian_mesh *mesh, double tolerance,
                               uint32_t *changed)
{
    flat_pass pass = {.mesh = mesh};
    parian_result result = surface_edges_make(env, mesh, &pass.edges);
    if (result == PARIAN_OK && (!PARIAN_NEW(env, pass.group, (size_t)3 * mesh->triangle_count) ||
                                !PARIAN_NEW(env, pass.touched, mesh->triangle_count) ||
                                !PARIAN_NEW(env, pass.keep, mesh->triangle_count))) {
        result = parian_fail(env, PARIAN_E_NOMEM, "surface: out of memory for %u triangles",
                             mesh->triangle_count);
    }
    if (result == PARIAN_OK) {
        run_pass(&pass, tolerance);
        *changed = pass.changed;
    }
    surface_edges_free(env, &pass.edges);
    parian_free(env, pass.group);
    parian_free(env, pass.touched);
    parian_free(env, pass.keep);
    return result;
}

static uint32_t count_flat(const parian_mesh *mesh, double tolerance)
{
    uint32_t count = 0, longest;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        count += is_flat(mesh, t, tolerance, &longest);
    }
    return count;
}

static parian_result drop_unusable(const parian_env *env, parian_mesh *mesh)
{
    bool *keep;
    if (!PARIAN_NEW(env, keep, mesh->triangle_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "surface: out of memory for %u triangles",
                           mesh->triangle_count);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double length;
        longest_edge(mesh, t, &length);
        keep[t] = surface_doubled_area(mesh, t) > flatness_min * length * length;
    }
    surface_keep_triangles(mesh, keep);
    parian_free(env, keep);
    return PARIAN_OK;
}

parian_result surface_drop_degenerate(const parian_env *env, parian_mesh *mesh, double tolerance,
                                      uint32_t *dropped)
{
    parian_result result = drop_collapsed(env, mesh, dropped);
    uint32_t flat = count_flat(mesh, tolerance), changed = flat, repeated = 0;
    *dropped += flat;
    for (int pass = 0; pass < PASS_MAX && changed > 0 && result == PARIAN_OK; pass++) {
        result = mend_once(env, mesh, tolerance, &changed);
        if (result == PARIAN_OK) {
            result = surface_drop_duplicates(env, mesh, &repeated);
        }
    }
    return result == PARIAN_OK && flat > 0 ? drop_unusable(env, mesh) : result;
}
