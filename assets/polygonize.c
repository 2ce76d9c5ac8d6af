/* polygonize.c - surface nets over a grid, then even triangles by sliding vertices along the
 * surface.
 *
 * SPDX-License-Identifier: MIT
 */
#include "polygonize.h"

#include <math.h>
#include <string.h>

#include "core/memory.h"

enum {
    BLOCK = 4,        /* nodes of a grid block along an axis: one piece of work, skipped as one */
    CHUNK = 1024,     /* vertices in one piece of work */
    RELAX_STEPS = 14, /* rounds of sliding */
    CALIBRATE_STEPS = 4, /* grids tried to meet the wanted number of triangles */
    NODE_COUNT_MAX = 1 << 28,
};
static const double STEEPNESS = 1.5; /* fields may grow this much faster than the distance */

/* Field values on the nodes of a grid; sizes count nodes. */
typedef struct grid {
    field_function field;
    vec3 lower;
    double cell;
    uint32_t size[3], blocks[3];
    float *value;    /* [size z][size y][size x] */
    uint32_t *index; /* per node: the vertex of the cell above it, or UINT32_MAX */
} grid;

typedef struct net {
    field_function field;
    double cell;
    uint32_t vertex_count, quad_count;
    vec3 *position, *next, *normal;
    uint32_t *degree;
    uint32_t (*quad)[4];
} net;

static void grid_free(const parian_env *env, grid *g)
{
    parian_free(env, g->value);
    parian_free(env, g->index);
    g->value = NULL;
    g->index = NULL;
}

static size_t node_of(const grid *g, uint32_t x, uint32_t y, uint32_t z)
{
    return ((size_t)z * g->size[1] + y) * g->size[0] + x;
}

static vec3 node_position(const grid *g, double x, double y, double z)
{
    return v3_add(g->lower, v3_scale(v3(x, y, z), g->cell));
}

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void sample_block(void *context, size_t index)
{
    grid *g = context;
    uint32_t bx = (uint32_t)(index % g->blocks[0]) * BLOCK;
    uint32_t by = (uint32_t)(index / g->blocks[0] % g->blocks[1]) * BLOCK;
    uint32_t bz = (uint32_t)(index / g->blocks[0] / g->blocks[1]) * BLOCK;
    double half = 0.5 * (BLOCK - 1);
    double middle = g->field(node_position(g, bx + half, by + half, bz + half));
    bool far = fabs(middle) > STEEPNESS * sqrt(3.0) * (half + 1) * g->cell;
    for (uint32_t z = bz; z < smaller(bz + BLOCK, g->size[2]); z++) {
        for (uint32_t y = by; y < smaller(by + BLOCK, g->size[1]); y++) {
            for (uint32_t x = bx; x < smaller(bx + BLOCK, g->size[0]); x++) {
                g->value[node_of(g, x, y, z)] =
                    (float)(far ? middle : g->field(node_position(g, x, y, z)));
            }
        }
    }
}

static parian_result sample_grid(const parian_env *env, grid *g, vec3 lower, vec3 upper,
                                 double cell)
{
    double extent[3] = {upper.x - lower.x, upper.y - lower.y, upper.z - lower.z};
    double nodes = 1;
    g->cell = cell;
    g->lower = v3_sub(lower, v3(cell, cell, cell));
    for (int a = 0; a < 3; a++) {
        double count = ceil(extent[a] / cell) + 3;
        nodes *= count;
        if (!(nodes < NODE_COUNT_MAX)) {
            return parian_fail(env, PARIAN_E_LIMIT,
                               "a grid of %g nodes was asked for, at most %d are possible", nodes,
                               NODE_COUNT_MAX);
        }
        g->size[a] = (uint32_t)count;
        g->blocks[a] = (g->size[a] + BLOCK - 1) / BLOCK;
    }
    if (!PARIAN_NEW(env, g->value, (size_t)nodes) || !PARIAN_NEW(env, g->index, (size_t)nodes)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for a grid of %g nodes", nodes);
    }
    parian_par(env, (size_t)g->blocks[0] * g->blocks[1] * g->blocks[2], sample_block, g);
    return PARIAN_OK;
}

/* Where the signs of a cell leave open how the surface runs (a face with inside and outside on
 * crossed diagonals, or two opposite corners), the node that is to become inside; UINT32_MAX where
 * all is clear. */
static uint32_t ambiguous_corner(const bool inside[8], const float value[8])
{
    static const uint8_t face[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    uint32_t count = 0;
    for (uint32_t f = 0; f < 6; f++) {
        const uint8_t *c = face[f];
        if (inside[c[0]] == inside[c[2]] && inside[c[1]] == inside[c[3]] &&
            inside[c[0]] != inside[c[1]]) {
            uint32_t first = inside[c[0]] ? c[1] : c[0], second = inside[c[0]] ? c[3] : c[2];
            return value[first] <= value[second] ? first : second;
        }
    }
    for (uint32_t c = 0; c < 8; c++) {
        count += inside[c];
    }
    for (uint32_t c = 0; c < 4; c++) {
        if (inside[c] == inside[7 - c] && count == (inside[c] ? 2u : 6u)) {
            return inside[c] ? c ^ 1 : c;
        }
    }
    return UINT32_MAX;
}

/* Thicken the solid by single nodes until every cell is clear: then each of its cells holds one
 * piece of surface and the net is manifold. Vertices return to the true surface later. */
static void make_unambiguous(grid *g)
{
    bool changed = true;
    while (changed) {
        changed = false;
        for (uint32_t z = 0; z + 1 < g->size[2]; z++) {
            for (uint32_t y = 0; y + 1 < g->size[1]; y++) {
                for (uint32_t x = 0; x + 1 < g->size[0]; x++) {
                    bool inside[8];
                    float value[8];
                    for (uint32_t c = 0; c < 8; c++) {
                        value[c] =
                            g->value[node_of(g, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
                        inside[c] = value[c] < 0;
                    }
                    uint32_t c = ambiguous_corner(inside, value);
                    if (c != UINT32_MAX) {
                        g->value[node_of(g, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))] =
                            (float)(-1e-3 * g->cell);
                        changed = true;
                    }
                }
            }
        }
    }
}

/* The mean of the zero crossings on a cell's edges; false where the cell does not meet the surface.
 */
static bool cell_vertex(const grid *g, uint32_t x, uint32_t y, uint32_t z, vec3 *vertex)
{
    float value[8];
    int inside = 0, crossings = 0;
    vec3 sum = {0, 0, 0};
    for (uint32_t c = 0; c < 8; c++) {
        value[c] = g->value[node_of(g, x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
        inside += value[c] < 0;
    }
    if (inside == 0 || inside == 8) {
        return false;
    }
    for (uint32_t axis = 0; axis < 3; axis++) {
        for (uint32_t c = 0; c < 8; c++) {
            uint32_t d = c | 1u << axis;
            if (c == d || (value[c] < 0) == (value[d] < 0)) {
                continue;
            }
            double t = (double)value[c] / ((double)value[c] - (double)value[d]);
            double offset[3] = {c & 1, c >> 1 & 1, c >> 2};
            offset[axis] += t;
            sum = v3_add(sum, v3(offset[0], offset[1], offset[2]));
            crossings++;
        }
    }
    *vertex = node_position(g, x + sum.x / crossings, y + sum.y / crossings, z + sum.z / crossings);
    return true;
}

/* Number the cells that meet the surface; with position, also place their vertices. */
static uint32_t place_vertices(grid *g, vec3 *position)
{
    uint32_t count = 0;
    memset(g->index, 0xff, (size_t)g->size[0] * g->size[1] * g->size[2] * sizeof *g->index);
    for (uint32_t z = 0; z + 1 < g->size[2]; z++) {
        for (uint32_t y = 0; y + 1 < g->size[1]; y++) {
            for (uint32_t x = 0; x + 1 < g->size[0]; x++) {
                vec3 vertex;
                if (cell_vertex(g, x, y, z, &vertex)) {
                    if (position) {
                        position[count] = vertex;
                    }
                    g->index[node_of(g, x, y, z)] = count++;
                }
            }
        }
    }
    return count;
}

/* The quad dual to the grid edge from node (x, y, z) along axis, if the surface crosses it. */
static bool edge_quad(const grid *g, const uint32_t at[3], uint32_t axis, uint32_t quad[4])
{
    const uint32_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    const uint32_t step[4][2] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
    uint32_t to[3] = {at[0], at[1], at[2]};
    to[axis]++;
    if (to[axis] >= g->size[axis] || at[b] == 0 || at[c] == 0) {
        return false;
    }
    bool inside = g->value[node_of(g, at[0], at[1], at[2])] < 0;
    if (inside == (g->value[node_of(g, to[0], to[1], to[2])] < 0)) {
        return false;
    }
    for (int k = 0; k < 4; k++) {
        uint32_t from[3] = {at[0], at[1], at[2]};
        from[b] -= step[k][0];
        from[c] -= step[k][1];
        quad[inside ? k : 3 - k] = g->index[node_of(g, from[0], from[1], from[2])];
    }
    return true;
}

static uint32_t make_quads(const grid *g, uint32_t (*quad)[4])
{
    uint32_t count = 0, found[4];
    for (uint32_t z = 0; z + 1 < g->size[2]; z++) {
        for (uint32_t y = 0; y + 1 < g->size[1]; y++) {
            for (uint32_t x = 0; x + 1 < g->size[0]; x++) {
                for (uint32_t axis = 0; axis < 3; axis++) {
                    uint32_t at[3] = {x, y, z};
                    if (edge_quad(g, at, axis, found)) {
                        if (quad) {
                            memcpy(quad[count], found, sizeof found);
                        }
                        count++;
                    }
                }
            }
        }
    }
    return count;
}

/* A grid whose net has about the wanted number of triangles (two for each quad). */
static parian_result fit_grid(const parian_env *env, grid *g, vec3 lower, vec3 upper,
                              uint32_t triangle_count)
{
    vec3 d = v3_sub(upper, lower);
    double cell = 2 * sqrt(2 * (d.x * d.y + d.y * d.z + d.z * d.x) / triangle_count);
    for (int step = 0;; step++) {
        parian_result result = sample_grid(env, g, lower, upper, cell);
        if (result != PARIAN_OK) {
            return result;
        }
        make_unambiguous(g);
        double ratio = 2.0 * make_quads(g, NULL) / triangle_count;
        if (step + 1 == CALIBRATE_STEPS || fabs(ratio - 1) < 0.03) {
            return PARIAN_OK;
        }
        cell *= ratio > 0 ? fmin(fmax(sqrt(ratio), 0.25), 4) : 0.25;
        grid_free(env, g);
    }
}

/* Value and gradient from four points of a small tetrahedron. */
static double field_gradient(field_function field, vec3 p, double h, vec3 *gradient)
{
    static const double corner[4][3] = {{1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}, {1, 1, 1}};
    double sum = 0;
    vec3 g = {0, 0, 0};
    for (int i = 0; i < 4; i++) {
        vec3 k = v3(corner[i][0], corner[i][1], corner[i][2]);
        double value = field(v3_add(p, v3_scale(k, h)));
        sum += value;
        g = v3_add(g, v3_scale(k, value));
    }
    *gradient = v3_scale(g, 1 / (4 * h));
    return sum / 4;
}

/* Newton steps to the zero set, at most half a cell long; leaves the unit normal. */
static vec3 project(const net *n, vec3 p, int steps, vec3 *normal)
{
    double h = 0.05 * n->cell;
    for (int i = 0; i < steps; i++) {
        vec3 g;
        double value = field_gradient(n->field, p, h, &g);
        double square = fmax(v3_dot(g, g), 0.01);
        double step = fmin(fmax(-value / sqrt(square), -0.5 * n->cell), 0.5 * n->cell);
        *normal = v3_normalize(g);
        p = v3_add(p, v3_scale(*normal, step));
    }
    return p;
}

static void project_chunk(void *context, size_t index)
{
    net *n = context;
    uint32_t end = smaller((uint32_t)(index + 1) * CHUNK, n->vertex_count);
    for (uint32_t i = (uint32_t)index * CHUNK; i < end; i++) {
        n->position[i] = project(n, n->position[i], 3, &n->normal[i]);
    }
}

static void slide_chunk(void *context, size_t index)
{
    net *n = context;
    uint32_t end = smaller((uint32_t)(index + 1) * CHUNK, n->vertex_count);
    for (uint32_t i = (uint32_t)index * CHUNK; i < end; i++) {
        vec3 move = v3_scale(v3_sub(v3_scale(n->next[i], 1.0 / n->degree[i]), n->position[i]), 0.6);
        move = v3_sub(move, v3_scale(n->normal[i], v3_dot(move, n->normal[i])));
        n->position[i] = project(n, v3_add(n->position[i], move), 1, &n->normal[i]);
    }
}

/* Slide every vertex towards the mean of the middles of the quads around it. */
static void relax(const parian_env *env, net *n)
{
    size_t chunks = (n->vertex_count + CHUNK - 1) / CHUNK;
    parian_par(env, chunks, project_chunk, n);
    for (int step = 0; step < RELAX_STEPS; step++) {
        memset(n->next, 0, n->vertex_count * sizeof *n->next);
        memset(n->degree, 0, n->vertex_count * sizeof *n->degree);
        for (uint32_t q = 0; q < n->quad_count; q++) {
            vec3 middle = {0, 0, 0};
            for (int k = 0; k < 4; k++) {
                middle = v3_add(middle, v3_scale(n->position[n->quad[q][k]], 0.25));
            }
            for (int k = 0; k < 4; k++) {
                n->next[n->quad[q][k]] = v3_add(n->next[n->quad[q][k]], middle);
                n->degree[n->quad[q][k]]++;
            }
        }
        parian_par(env, chunks, slide_chunk, n);
    }
    parian_par(env, chunks, project_chunk, n);
}

/* How bad a triangle is: its longest edge squared over its doubled area. */
static double badness(vec3 a, vec3 b, vec3 c)
{
    vec3 ab = v3_sub(b, a), bc = v3_sub(c, b), ca = v3_sub(a, c);
    double longest = fmax(v3_dot(ab, ab), fmax(v3_dot(bc, bc), v3_dot(ca, ca)));
    return longest / fmax(v3_length(v3_cross(ab, bc)), 1e-300);
}

static void cut_quads(const net *n, uint32_t (*triangle)[3])
{
    for (uint32_t q = 0; q < n->quad_count; q++) {
        const uint32_t *v = n->quad[q];
        vec3 a = n->position[v[0]], b = n->position[v[1]], c = n->position[v[2]],
             d = n->position[v[3]];
        uint32_t first =
            fmax(badness(a, b, c), badness(a, c, d)) <= fmax(badness(a, b, d), badness(b, c, d))
                ? 0
                : 1;
        for (uint32_t k = 0; k < 3; k++) {
            triangle[2 * q][k] = v[(first + k) % 4];
            triangle[2 * q + 1][k] = v[(first + (k ? k + 1 : 0)) % 4];
        }
    }
}

static parian_result allocate_net(const parian_env *env, grid *g, net *n)
{
    n->cell = g->cell;
    n->field = g->field;
    n->vertex_count = place_vertices(g, NULL);
    n->quad_count = make_quads(g, NULL);
    if (n->vertex_count == 0) {
        return parian_fail(env, PARIAN_E_COMPUTE, "the field has no surface inside its box");
    }
    if (!PARIAN_NEW(env, n->position, n->vertex_count) ||
        !PARIAN_NEW(env, n->next, n->vertex_count) ||
        !PARIAN_NEW(env, n->normal, n->vertex_count) ||
        !PARIAN_NEW(env, n->degree, n->vertex_count) || !PARIAN_NEW(env, n->quad, n->quad_count)) {
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u vertices", n->vertex_count);
    }
    place_vertices(g, n->position);
    make_quads(g, n->quad);
    return PARIAN_OK;
}

parian_result polygonize(const parian_env *env, field_function field, vec3 lower, vec3 upper,
                         uint32_t triangle_count, model_mesh *mesh)
{
    grid g = {.field = field};
    net n = {0};
    uint32_t(*triangle)[3] = NULL;
    parian_result result = fit_grid(env, &g, lower, upper, triangle_count);
    if (result == PARIAN_OK) {
        result = allocate_net(env, &g, &n);
    }
    if (result == PARIAN_OK && !PARIAN_NEW(env, triangle, 2 * (size_t)n.quad_count)) {
        result = parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", 2 * n.quad_count);
    }
    if (result == PARIAN_OK) {
        relax(env, &n);
        cut_quads(&n, triangle);
        *mesh = (model_mesh){n.vertex_count, 2 * n.quad_count, n.position, n.normal, triangle};
        n.position = NULL;
        n.normal = NULL;
        triangle = NULL;
    }
    parian_free(env, triangle);
    parian_free(env, n.position);
    parian_free(env, n.next);
    parian_free(env, n.normal);
    parian_free(env, n.degree);
    parian_free(env, n.quad);
    grid_free(env, &g);
    return result;
}
