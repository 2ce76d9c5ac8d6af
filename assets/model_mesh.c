/* model_mesh.c - checks of a generated mesh, and the meshes that need no field: lathe, sphere, box.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/memory.h"

/* A directed edge of a triangle as one number, smaller vertex first; bit 0 tells the direction. */
typedef struct half_edge {
    uint64_t key;
    uint32_t forward;
} half_edge;

void model_mesh_free(const parian_env *env, model_mesh *mesh)
{
    if (mesh) {
        parian_free(env, mesh->position);
        parian_free(env, mesh->normal);
        parian_free(env, mesh->triangle);
        memset(mesh, 0, sizeof *mesh);
    }
}

static int compare_edges(const void *left, const void *right)
{
    const half_edge *a = left, *b = right;
    if (a->key != b->key) {
        return a->key < b->key ? -1 : 1;
    }
    return (a->forward > b->forward) - (a->forward < b->forward);
}

/* The number of edges that are not shared by exactly two triangles of opposite direction. */
static parian_result count_bad_edges(const parian_env *env, const model_mesh *mesh, uint32_t *bad)
{
    size_t count = 3 * (size_t)mesh->triangle_count;
    half_edge *edge;
    if (!PARIAN_NEW(env, edge, count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu edges", count);
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t a = mesh->triangle[i / 3][i % 3], b = mesh->triangle[i / 3][(i + 1) % 3];
        edge[i].key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
        edge[i].forward = a < b;
    }
    qsort(edge, count, sizeof *edge, compare_edges);
    *bad = 0;
    for (size_t i = 0, end; i < count; i = end) {
        for (end = i + 1; end < count && edge[end].key == edge[i].key; end++) {
        }
        *bad += end - i != 2 || edge[i].forward == edge[i + 1].forward;
    }
    parian_free(env, edge);
    return PARIAN_OK;
}

/* The number of vertices whose triangles do not form one fan. In a closed mesh each corner
 * (triangle, vertex) leads to the next one around the vertex; a vertex is manifold when that walk
 * meets all its triangles. */
static parian_result count_bad_vertices(const parian_env *env, const model_mesh *mesh,
                                        uint32_t *bad)
{
    size_t corners = 3 * (size_t)mesh->triangle_count;
    uint32_t *start, *corner = NULL, *used = NULL;
    parian_result result = PARIAN_OK;
    if (!PARIAN_NEW0(env, start, (size_t)mesh->vertex_count + 2) ||
        !PARIAN_NEW(env, corner, corners) || !PARIAN_NEW0(env, used, mesh->vertex_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu corners", corners);
        goto done;
    }
    for (size_t i = 0; i < corners; i++) {
        start[mesh->triangle[i / 3][i % 3] + 2]++;
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        start[v + 2] += start[v + 1];
    }
    for (size_t i = 0; i < corners; i++) {
        corner[start[mesh->triangle[i / 3][i % 3] + 1]++] = (uint32_t)i;
    }
    *bad = 0;
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        uint32_t degree = start[v + 1] - start[v], seen = 0;
        uint32_t first = degree ? corner[start[v]] : 0, at = first;
        while (seen < degree) {
            /* The next triangle is the one whose edge leaves v towards the vertex before v in this
             * one. */
            uint32_t previous = mesh->triangle[at / 3][(at % 3 + 2) % 3], next = UINT32_MAX;
            for (uint32_t k = start[v]; k < start[v + 1]; k++) {
                if (mesh->triangle[corner[k] / 3][(corner[k] % 3 + 1) % 3] == previous) {
                    next = corner[k];
                }
            }
            seen++;
            if (next == UINT32_MAX || next == first) {
                break;
            }
            at = next;
        }
        *bad += degree == 0 || seen != degree;
    }
done:
    parian_free(env, start);
    parian_free(env, corner);
    parian_free(env, used);
    return result;
}

static double enclosed_volume(const model_mesh *mesh)
{
    double sum = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangle[t];
        sum +=
            v3_dot(mesh->position[v[0]], v3_cross(mesh->position[v[1]], mesh->position[v[2]])) / 6;
    }
    return sum;
}

parian_result model_mesh_check(const parian_env *env, const model_mesh *mesh, const char *name)
{
    uint32_t bad_edges = 0, bad_vertices = 0;
    parian_result result = count_bad_edges(env, mesh, &bad_edges);
    if (result == PARIAN_OK && bad_edges == 0) {
        result = count_bad_vertices(env, mesh, &bad_vertices);
    }
    if (result != PARIAN_OK) {
        return result;
    }
    if (bad_edges || bad_vertices) {
        return parian_fail(
            env, PARIAN_E_COMPUTE,
            "%s: %u edges and %u vertices are not manifold: more triangles are needed", name,
            bad_edges, bad_vertices);
    }
    double volume = enclosed_volume(mesh);
    if (!(volume > 0)) {
        return parian_fail(env, PARIAN_E_COMPUTE, "%s: encloses %g, a positive volume was expected",
                           name, volume);
    }
    return PARIAN_OK;
}

static parian_result allocate(const parian_env *env, uint32_t vertices, uint32_t triangles,
                              bool normals, model_mesh *mesh)
{
    model_mesh made = {.vertex_count = vertices, .triangle_count = triangles};
    if (!PARIAN_NEW0(env, made.position, vertices) || !PARIAN_NEW0(env, made.triangle, triangles) ||
        (normals && !PARIAN_NEW0(env, made.normal, vertices))) {
        model_mesh_free(env, &made);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u vertices", vertices);
    }
    *mesh = made;
    return PARIAN_OK;
}

static void add_triangle(model_mesh *mesh, uint32_t *count, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *triangle = mesh->triangle[(*count)++];
    triangle[0] = a;
    triangle[1] = b;
    triangle[2] = c;
}

/* Area-weighted vertex normals. */
static void make_normals(model_mesh *mesh)
{
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangle[t];
        vec3 a = mesh->position[v[0]];
        vec3 n = v3_cross(v3_sub(mesh->position[v[1]], a), v3_sub(mesh->position[v[2]], a));
        for (int k = 0; k < 3; k++) {
            mesh->normal[v[k]] = v3_add(mesh->normal[v[k]], n);
        }
    }
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        mesh->normal[v] = v3_normalize(mesh->normal[v]);
    }
}

parian_result model_mesh_lathe(const parian_env *env, const double (*profile)[2], uint32_t count,
                               uint32_t segments, model_mesh *mesh)
{
    const uint32_t rings = count - 2, top = 1 + rings * segments;
    model_mesh made;
    parian_result result = allocate(env, top + 1, 2 * segments * rings, true, &made);
    if (result != PARIAN_OK) {
        return result;
    }
    uint32_t t = 0;
    made.position[0] = v3(0, profile[0][1], 0);
    made.position[top] = v3(0, profile[count - 1][1], 0);
    for (uint32_t s = 0; s < segments; s++) {
        double angle = 2 * M_PI * s / segments;
        uint32_t next = (s + 1) % segments;
        for (uint32_t r = 0; r < rings; r++) {
            double radius = profile[r + 1][0];
            uint32_t base = 1 + r * segments;
            made.position[base + s] =
                v3(radius * sin(angle), profile[r + 1][1], radius * cos(angle));
            if (r == 0) {
                add_triangle(&made, &t, 0, base + next, base + s);
            } else {
                add_triangle(&made, &t, base - segments + s, base - segments + next, base + next);
                add_triangle(&made, &t, base - segments + s, base + next, base + s);
            }
        }
        add_triangle(&made, &t, top - segments + s, top - segments + next, top);
    }
    make_normals(&made);
    *mesh = made;
    return PARIAN_OK;
}

/* A box of cuts[0] x cuts[1] x cuts[2] lattice cells; vertices carry lattice coordinates. */
static parian_result make_lattice_box(const parian_env *env, const uint32_t cuts[3], bool normals,
                                      model_mesh *mesh)
{
    const uint32_t size[3] = {cuts[0] + 1, cuts[1] + 1, cuts[2] + 1};
    const size_t nodes = (size_t)size[0] * size[1] * size[2];
    const uint32_t quads = 2 * (cuts[0] * cuts[1] + cuts[1] * cuts[2] + cuts[2] * cuts[0]);
    uint32_t *index, count = 0, triangles = 0;
    model_mesh made;
    if (!PARIAN_NEW(env, index, nodes)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu lattice nodes", nodes);
    }
    parian_result result = allocate(env, quads + 2, 2 * quads, normals, &made);
    if (result != PARIAN_OK) {
        parian_free(env, index);
        return result;
    }
    for (size_t i = 0; i < nodes; i++) {
        uint32_t x = (uint32_t)(i % size[0]), y = (uint32_t)(i / size[0] % size[1]);
        uint32_t z = (uint32_t)(i / size[0] / size[1]);
        if (x % cuts[0] == 0 || y % cuts[1] == 0 || z % cuts[2] == 0) {
            made.position[count] = v3(x, y, z);
            index[i] = count++;
        }
    }
    const uint32_t stride[3] = {1, size[0], size[0] * size[1]};
    for (uint32_t axis = 0; axis < 3; axis++) {
        uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
        for (uint32_t i = 0; i < 2 * cuts[b] * cuts[c]; i++) {
            uint32_t side = i & 1, u = i / 2 % cuts[b], v = i / 2 / cuts[b];
            uint32_t from = side * cuts[axis] * stride[axis] + u * stride[b] + v * stride[c];
            uint32_t p = index[from], q = index[from + stride[b]];
            uint32_t r = index[from + stride[b] + stride[c]], s = index[from + stride[c]];
            add_triangle(&made, &triangles, p, side ? q : r, side ? r : q);
            add_triangle(&made, &triangles, p, side ? r : s, side ? s : r);
        }
    }
    parian_free(env, index);
    *mesh = made;
    return PARIAN_OK;
}

parian_result model_mesh_box(const parian_env *env, vec3 size, uint32_t cuts, model_mesh *mesh)
{
    const double longest = fmax(size.x, fmax(size.y, size.z));
    const double side[3] = {size.x, size.y, size.z};
    uint32_t n[3];
    for (int a = 0; a < 3; a++) {
        n[a] = (uint32_t)fmax(round(cuts * side[a] / longest), 1);
    }
    parian_result result = make_lattice_box(env, n, false, mesh);
    for (uint32_t v = 0; result == PARIAN_OK && v < mesh->vertex_count; v++) {
        vec3 p = mesh->position[v];
        mesh->position[v] = v3(size.x * (p.x / n[0] - 0.5), size.y * (p.y / n[1] - 0.5),
                               size.z * (p.z / n[2] - 0.5));
    }
    return result;
}

parian_result model_mesh_sphere(const parian_env *env, double radius, uint32_t cuts,
                                model_mesh *mesh)
{
    const uint32_t n[3] = {cuts, cuts, cuts};
    parian_result result = make_lattice_box(env, n, true, mesh);
    for (uint32_t v = 0; result == PARIAN_OK && v < mesh->vertex_count; v++) {
        vec3 p = mesh->position[v];
        double t[3] = {p.x, p.y, p.z};
        for (int a = 0; a < 3; a++) {
            t[a] = tan(M_PI / 4 * (2 * t[a] / cuts - 1));
        }
        mesh->normal[v] = v3_normalize(v3(t[0], t[1], t[2]));
        mesh->position[v] = v3_scale(mesh->normal[v], radius);
    }
    return result;
}
