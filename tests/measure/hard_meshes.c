/* hard_meshes.c - the models and lights of the hard cases: solids of small cubes, and what is made
 * from them.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <string.h>

#include "core/memory.h"
#include "tests/measure/hard_cases.h"
#include "tests/measure/results_table.h"

static const double QUARTER_PI = 0.78539816339744831;

/* A solid made of cubes of a grid, inside(x, y, z) for 0 <= x < size[0] and so on. */
typedef struct cube_solid {
    int size[3];
    bool (*inside)(int x, int y, int z);
    bool open; /* without the faces that look up at the top layer */
} cube_solid;

static bool all_cubes(int x, int y, int z)
{
    (void)x;
    (void)y;
    (void)z;
    return true;
}

/* 20 x 20 x 20 without a quarter: the crease runs along z. */
static bool crease_cubes(int x, int y, int z)
{
    (void)z;
    return x < 10 || y < 10;
}

/* Two blocks of 10 x 10 x 10 that share one edge along z. */
static bool touching_cubes(int x, int y, int z)
{
    (void)z;
    return (x < 10) == (y < 10);
}

static bool is_inside(const cube_solid *solid, const int at[3])
{
    for (int c = 0; c < 3; c++) {
        if (at[c] < 0 || at[c] >= solid->size[c]) {
            return false;
        }
    }
    return solid->inside(at[0], at[1], at[2]);
}

/* Lists quads of a solid's surface; vertices are shared by grid place. */
typedef struct cube_surface {
    const cube_solid *solid;
    uint32_t *vertex_at; /* [(size + 1)^3] or UINT32_MAX */
    parian_mesh *mesh;
} cube_surface;

static uint32_t corner_vertex(cube_surface *surface, const int at[3])
{
    const int *size = surface->solid->size;
    size_t k = ((size_t)at[2] * (size_t)(size[1] + 1) + (size_t)at[1]) * (size_t)(size[0] + 1) +
               (size_t)at[0];
    if (surface->vertex_at[k] == UINT32_MAX) {
        double *p = surface->mesh->position[surface->mesh->vertex_count];
        for (int c = 0; c < 3; c++) {
            p[c] = at[c] - 0.5 * size[c];
        }
        surface->vertex_at[k] = surface->mesh->vertex_count++;
    }
    return surface->vertex_at[k];
}

/* The face of a cube towards +axis or -axis, as two triangles counterclockwise from outside. */
static void add_face(cube_surface *surface, const int cube[3], int axis, int side)
{
    static const int ring[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    int a = (axis + 1) % 3, b = (axis + 2) % 3;
    uint32_t corner[4];
    for (int k = 0; k < 4; k++) {
        int at[3] = {cube[0], cube[1], cube[2]}, from = side ? k : 3 - k;
        at[axis] += side;
        at[a] += ring[from][0];
        at[b] += ring[from][1];
        corner[k] = corner_vertex(surface, at);
    }
    for (int t = 0; t < 2; t++) {
        uint32_t *triangle = surface->mesh->triangle[surface->mesh->triangle_count++];
        triangle[0] = corner[0];
        triangle[1] = corner[1 + t];
        triangle[2] = corner[2 + t];
    }
}

static void add_cube(cube_surface *surface, const int cube[3])
{
    for (int face = 0; face < 6; face++) {
        int axis = face / 2, side = face % 2, beside[3] = {cube[0], cube[1], cube[2]};
        beside[axis] += side ? 1 : -1;
        bool lid = surface->solid->open && axis == 1 && side == 1 &&
                   cube[1] == surface->solid->size[1] - 1;
        if (!is_inside(surface->solid, beside) && !lid) {
            add_face(surface, cube, axis, side);
        }
    }
}

static parian_result make_solid(const parian_env *env, const cube_solid *solid, parian_mesh *mesh)
{
    const int *n = solid->size;
    size_t places = (size_t)(n[0] + 1) * (size_t)(n[1] + 1) * (size_t)(n[2] + 1);
    size_t triangles = 12 * (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    cube_surface surface = {.solid = solid, .mesh = mesh};
    if (!PARIAN_NEW(env, surface.vertex_at, places) || !PARIAN_NEW(env, mesh->position, places) ||
        !PARIAN_NEW(env, mesh->triangle, triangles)) {
        parian_free(env, surface.vertex_at);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %zu cubes", triangles / 12);
    }
    memset(surface.vertex_at, 0xFF, places * sizeof *surface.vertex_at);
    for (int z = 0; z < n[2]; z++) {
        for (int y = 0; y < n[1]; y++) {
            for (int x = 0; x < n[0]; x++) {
                const int cube[3] = {x, y, z};
                if (is_inside(solid, cube)) {
                    add_cube(&surface, cube);
                }
            }
        }
    }
    parian_free(env, surface.vertex_at);
    return PARIAN_OK;
}

/* Blow a cube of n up to a sphere of diameter n; power above 1 crowds vertices around the faces'
 * middles. */
static void blow_up(parian_mesh *mesh, int n, double power)
{
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        double *p = mesh->position[v], square = 0;
        for (int c = 0; c < 3; c++) {
            double s = 2 * p[c] / n;
            p[c] = tan(QUARTER_PI * copysign(pow(fabs(s), power), s));
            square += p[c] * p[c];
        }
        for (int c = 0; c < 3; c++) {
            p[c] *= 0.5 * n / sqrt(square);
        }
    }
}

/* Split the first edge of every fifth triangle at its middle, on one side of the edge alone, and
 * close the gap by a triangle of no area. */
static parian_result add_zero_areas(const parian_env *env, parian_mesh *mesh)
{
    uint32_t old = mesh->triangle_count, more = (old + 4) / 5;
    double(*position)[3] = NULL;
    uint32_t(*triangle)[3] = NULL;
    if (!PARIAN_NEW(env, position, mesh->vertex_count + more) ||
        !PARIAN_NEW(env, triangle, old + 2 * more)) {
        parian_free(env, position);
        parian_free(env, triangle);
        return parian_fail(env, PARIAN_E_NOMEM, "no memory for %u triangles", old);
    }
    memcpy(position, mesh->position, mesh->vertex_count * sizeof *position);
    memcpy(triangle, mesh->triangle, old * sizeof *triangle);
    parian_free(env, mesh->position);
    parian_free(env, mesh->triangle);
    mesh->position = position;
    mesh->triangle = triangle;
    for (uint32_t t = 0; t < old; t += 5) {
        uint32_t a = triangle[t][0], b = triangle[t][1], c = triangle[t][2],
                 m = mesh->vertex_count++;
        for (int k = 0; k < 3; k++) {
            position[m][k] = 0.5 * (position[a][k] + position[b][k]);
        }
        const uint32_t pieces[3][3] = {{a, m, c}, {m, b, c}, {a, b, m}};
        memcpy(triangle[t], pieces[0], sizeof pieces[0]);
        memcpy(triangle[mesh->triangle_count], pieces[1], 2 * sizeof pieces[0]);
        mesh->triangle_count += 2;
    }
    return PARIAN_OK;
}

static void scale_to(parian_mesh *mesh, double size_m)
{
    double lower[3], upper[3], extent = 0;
    parian_mesh_bounds(mesh, lower, upper);
    for (int c = 0; c < 3; c++) {
        extent = fmax(extent, upper[c] - lower[c]);
    }
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++) {
        mesh->position[i / 3][i % 3] *= size_m / extent;
    }
}

parian_result parian_hard_mesh(const parian_env *env, parian_hard_shape shape, double size_m,
                               parian_mesh *mesh)
{
    static const cube_solid solids[] = {
        [PARIAN_SHAPE_SPHERE] = {{24, 24, 24}, all_cubes, false},
        [PARIAN_SHAPE_UNEVEN_SPHERE] = {{32, 32, 32}, all_cubes, false},
        [PARIAN_SHAPE_ZERO_AREA] = {{24, 24, 24}, all_cubes, false},
        [PARIAN_SHAPE_BOWL] = {{24, 24, 24}, all_cubes, true},
        [PARIAN_SHAPE_TOUCHING] = {{20, 20, 10}, touching_cubes, false},
        [PARIAN_SHAPE_BOX] = {{20, 20, 20}, all_cubes, false},
        [PARIAN_SHAPE_CREASE] = {{20, 20, 20}, crease_cubes, false},
        [PARIAN_SHAPE_SHEET] = {{40, 1, 40}, all_cubes, false},
    };
    *mesh = (parian_mesh){0};
    parian_result r = make_solid(env, &solids[shape], mesh);
    bool round = shape == PARIAN_SHAPE_SPHERE || shape == PARIAN_SHAPE_UNEVEN_SPHERE ||
                 shape == PARIAN_SHAPE_ZERO_AREA || shape == PARIAN_SHAPE_BOWL;
    if (r == PARIAN_OK && round) {
        blow_up(mesh, solids[shape].size[0], shape == PARIAN_SHAPE_UNEVEN_SPHERE ? 2.5 : 1);
    }
    if (r == PARIAN_OK && shape == PARIAN_SHAPE_ZERO_AREA) {
        r = add_zero_areas(env, mesh);
    }
    if (r != PARIAN_OK) {
        parian_mesh_free(env, mesh);
        return r;
    }
    scale_to(mesh, size_m);
    return PARIAN_OK;
}

parian_result parian_hard_mesh_write(const parian_env *env, const parian_mesh *mesh,
                                     const char *path)
{
    parian_text text = {.env = env};
    parian_text_add(&text, "OFF\n%u %u 0\n", mesh->vertex_count, mesh->triangle_count);
    for (uint32_t v = 0; v < mesh->vertex_count; v++) {
        const double *p = mesh->position[v];
        parian_text_add(&text, "%.12g %.12g %.12g\n", p[0], p[1], p[2]);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->triangle[t];
        parian_text_add(&text, "3 %u %u %u\n", v[0], v[1], v[2]);
    }
    return parian_text_write(&text, path);
}

size_t parian_hard_lights(parian_hard_light kind, double size_m,
                          parian_light light[PARIAN_HARD_LIGHTS_MAX])
{
    float size = (float)size_m;
    parian_light sky = {.type = PARIAN_LIGHT_ENVIRONMENT, .color = {0.1f, 0.1f, 0.1f}};
    switch (kind) {
    case PARIAN_HARD_SUN: /* from (1, 1, 0.4): along the diagonal of the crease, so that nothing is
                             in shadow */
        light[0] = (parian_light){.type = PARIAN_LIGHT_DIRECTIONAL,
                                  .direction = {-0.68f, -0.68f, -0.27f},
                                  .color = {3, 3, 3}};
        light[1] = sky;
        return 2;
    case PARIAN_HARD_SKY:
        light[0] = sky;
        return 1;
    case PARIAN_HARD_SPOT:
        light[0] = (parian_light){.type = PARIAN_LIGHT_SPOT,
                                  .position = {0.3f * size, 0.4f * size, 2 * size},
                                  .direction = {-0.1f, -0.2f, -1},
                                  .color = {size * size, size * size, size * size},
                                  .inner_deg = 2,
                                  .outer_deg = 3};
        return 1;
    case PARIAN_HARD_NIGHT: /* turned away */
        light[0] = (parian_light){.type = PARIAN_LIGHT_SPOT,
                                  .position = {0, 2 * size, 0},
                                  .direction = {0, 1, 0},
                                  .color = {1, 1, 1},
                                  .inner_deg = 10,
                                  .outer_deg = 20};
        return 1;
    }
    return 0;
}
