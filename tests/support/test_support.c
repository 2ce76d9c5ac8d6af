/* test_support.c - what tests share: an env with threads, generated meshes, scratch folders,
 * failing memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include "support/test_support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/memory.h"
#include "tool/thread_pool.h"

enum {
    ENV_MAX = 16,
    PATH_SLOTS = 8,
    PATH_LENGTH = 1024,
    ICOSA_EDGES = 30,
    ICOSA_CORNERS = 12,
    ICOSA_FACES = 20
};

/* ---- env ---------------------------------------------------------------------------------------
 */
static void log_to_stderr(void *user, parian_log_level level, const char *text)
{
    static const char *const label[] = {"error", "warning", "info", "debug"};
    (void)user;
    if (getenv("PARIAN_TEST_VERBOSE")) {
        fprintf(stderr, "%s: %s\n", label[level], text);
    }
}

static void run_on_pool(void *user, size_t count, void (*body)(void *, size_t), void *context)
{
    parian_thread_pool_run(user, count, body, context);
}

const parian_env *test_env(unsigned threads)
{
    static struct {
        unsigned threads;
        parian_env env;
    } made[ENV_MAX];
    static size_t made_count;
    for (size_t i = 0; i < made_count; i++) {
        if (made[i].threads == threads) {
            return &made[i].env;
        }
    }
    parian_thread_pool *pool = NULL;
    if (made_count == ENV_MAX || parian_thread_pool_create(threads, &pool) != PARIAN_OK) {
        fprintf(stderr, "test_env: no pool of %u threads\n", threads);
        abort();
    }
    made[made_count].threads = threads;
    made[made_count].env = (parian_env){.log = log_to_stderr, .par = run_on_pool, .user = pool};
    return &made[made_count++].env;
}

static void *failing_alloc(void *user, size_t size)
{
    test_memory *memory = user;
    if (memory->calls++ == memory->fail_at) {
        return NULL;
    }
    void *ptr = malloc(size);
    memory->live += ptr != NULL;
    return ptr;
}

static void failing_free(void *user, void *ptr)
{
    test_memory *memory = user;
    memory->live -= ptr != NULL;
    free(ptr);
}

parian_env test_failing_env(test_memory *memory)
{
    return (parian_env){.alloc = failing_alloc, .free = failing_free, .user = memory};
}

/* ---- paths -------------------------------------------------------------------------------------
 */
static char *next_slot(void)
{
    static char slot[PATH_SLOTS][PATH_LENGTH];
    static unsigned next;
    return slot[next++ % PATH_SLOTS];
}

const char *test_scratch(const char *name)
{
    static char folder[PATH_LENGTH / 2];
    if (!folder[0]) {
        char program[PATH_LENGTH / 4];
        ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
        program[length > 0 ? length : 0] = '\0';
        const char *slash = strrchr(program, '/');
        mkdir(PARIAN_BINARY_DIR "/scratch", 0777);
        snprintf(folder, sizeof folder, PARIAN_BINARY_DIR "/scratch/%s",
                 slash ? slash + 1 : "test");
        mkdir(folder, 0777);
    }
    char *path = next_slot();
    snprintf(path, PATH_LENGTH, "%s/%s", folder, name);
    return path;
}

const char *test_source(const char *name)
{
    char *path = next_slot();
    snprintf(path, PATH_LENGTH, PARIAN_SOURCE_DIR "/%s", name);
    return path;
}

const char *test_shared(const char *name)
{
    char *path = next_slot();
    snprintf(path, PATH_LENGTH, PARIAN_SOURCE_DIR "/../shared/%s", name);
    return access(path, R_OK) == 0 ? path : NULL;
}

/* ---- meshes ------------------------------------------------------------------------------------
 */
static parian_result make_arrays(const parian_env *env, size_t vertices, size_t triangles,
                                 parian_mesh *mesh)
{
    memset(mesh, 0, sizeof *mesh);
    if (!PARIAN_NEW(env, mesh->position, vertices) || !PARIAN_NEW(env, mesh->triangle, triangles)) {
        parian_mesh_free(env, mesh);
        return PARIAN_E_NOMEM;
    }
    mesh->vertex_count = (uint32_t)vertices;
    mesh->triangle_count = (uint32_t)triangles;
    return PARIAN_OK;
}

static void set_triangle(parian_mesh *mesh, size_t index, uint32_t a, uint32_t b, uint32_t c)
{
    mesh->triangle[index][0] = a;
    mesh->triangle[index][1] = b;
    mesh->triangle[index][2] = c;
}

static const uint8_t icosa_face[ICOSA_FACES][3] = {
    {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};

static void icosa_corner(unsigned corner, double p[3])
{
    const double golden = 0.5 * (1 + sqrt(5.0));
    const double first = corner & 1 ? 1.0 : -1.0, second = corner & 2 ? -golden : golden;
    const unsigned axis = corner / 4; /* (first, second, 0) and its cyclic turns */
    p[axis] = first;
    p[(axis + 1) % 3] = second;
    p[(axis + 2) % 3] = 0;
}

/* Where the points of a cut icosahedron are kept: corners, then edges, then insides of faces. */
typedef struct sphere_job {
    unsigned cuts;
    uint8_t edge[ICOSA_EDGES][2];
    unsigned edge_count;
} sphere_job;

static unsigned find_edge(sphere_job *job, unsigned low, unsigned high)
{
    for (unsigned e = 0; e < job->edge_count; e++) {
        if (job->edge[e][0] == low && job->edge[e][1] == high) {
            return e;
        }
    }
    job->edge[job->edge_count][0] = (uint8_t)low;
    job->edge[job->edge_count][1] = (uint8_t)high;
    return job->edge_count++;
}

/* Index of the point of a face with these weights of its corners; they sum to cuts. */
static uint32_t sphere_vertex(sphere_job *job, unsigned face, const unsigned weight[3])
{
    const unsigned n = job->cuts;
    for (unsigned k = 0; k < 3; k++) {
        unsigned a = icosa_face[face][k], b = icosa_face[face][(k + 1) % 3];
        if (weight[k] == n) {
            return a;
        }
        if (weight[(k + 2) % 3] == 0 && weight[k] > 0 && weight[(k + 1) % 3] > 0) {
            unsigned of_high = a > b ? weight[k] : weight[(k + 1) % 3];
            unsigned edge = find_edge(job, a < b ? a : b, a < b ? b : a);
            return ICOSA_CORNERS + edge * (n - 1) + of_high - 1;
        }
    }
    unsigned i = weight[1], j = weight[2]; /* both from 1 on, i + j < n */
    unsigned before = (j - 1) * (n - 1) - j * (j - 1) / 2;
    return ICOSA_CORNERS + ICOSA_EDGES * (n - 1) + face * ((n - 1) * (n - 2) / 2) + before + i - 1;
}

static uint32_t place_sphere_vertex(sphere_job *job, parian_mesh *mesh, double radius,
                                    unsigned face, unsigned i, unsigned j)
{
    const unsigned weight[3] = {job->cuts - i - j, i, j};
    uint32_t index = sphere_vertex(job, face, weight);
    double sum[3] = {0, 0, 0};
    for (unsigned k = 0; k < 3; k++) {
        double corner[3];
        icosa_corner(icosa_face[face][k], corner);
        for (int c = 0; c < 3; c++) {
            sum[c] += weight[k] * corner[c];
        }
    }
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (int c = 0; c < 3; c++) {
        mesh->position[index][c] = radius * sum[c] / length;
    }
    return index;
}

parian_result test_sphere(const parian_env *env, double radius, unsigned cuts, parian_mesh *mesh)
{
    sphere_job job = {.cuts = cuts};
    size_t square = (size_t)cuts * cuts, next = 0;
    parian_result result = make_arrays(env, 10 * square + 2, ICOSA_FACES * square, mesh);
    for (unsigned face = 0; face < ICOSA_FACES && result == PARIAN_OK; face++) {
        for (unsigned j = 0; j < cuts; j++) {
            for (unsigned i = 0; i + j < cuts; i++) {
                uint32_t a = place_sphere_vertex(&job, mesh, radius, face, i, j);
                uint32_t b = place_sphere_vertex(&job, mesh, radius, face, i + 1, j);
                uint32_t c = place_sphere_vertex(&job, mesh, radius, face, i, j + 1);
                set_triangle(mesh, next++, a, b, c);
                if (i + j + 1 < cuts) {
                    set_triangle(mesh, next++, b,
                                 place_sphere_vertex(&job, mesh, radius, face, i + 1, j + 1), c);
                }
            }
        }
    }
    return result;
}

parian_result test_plane(const parian_env *env, double side, unsigned n, parian_mesh *mesh)
{
    size_t row = (size_t)n + 1;
    parian_result result = make_arrays(env, row * row, 2 * (size_t)n * n, mesh);
    for (size_t v = 0; v < row && result == PARIAN_OK; v++) {
        for (size_t u = 0; u < row; u++) {
            double *p = mesh->position[v * row + u];
            p[0] = side * ((double)u / n - 0.5);
            p[1] = side * ((double)v / n - 0.5);
            p[2] = 0;
            if (u < n && v < n) {
                uint32_t a = (uint32_t)(v * row + u), d = (uint32_t)(a + row + 1);
                set_triangle(mesh, 2 * (v * n + u), a, a + 1, d);
                set_triangle(mesh, 2 * (v * n + u) + 1, a, d, (uint32_t)(a + row));
            }
        }
    }
    return result;
}

/* Vertex of a box at a lattice point of its surface, made when first seen. */
static uint32_t box_vertex(parian_mesh *mesh, uint32_t *at, unsigned n, const unsigned cell[3],
                           const double size[3])
{
    size_t row = (size_t)n + 1;
    uint32_t *index = &at[(cell[2] * row + cell[1]) * row + cell[0]];
    if (*index == 0) {
        *index = ++mesh->vertex_count; /* one more than the index */
        for (int c = 0; c < 3; c++) {
            mesh->position[*index - 1][c] = size[c] * ((double)cell[c] / n - 0.5);
        }
    }
    return *index - 1;
}

/* The side where coordinate `axis` is at its low (0) or high (1) end. */
static void add_box_side(parian_mesh *mesh, uint32_t *at, unsigned n, int axis, bool high,
                         const double size[3])
{
    int u_axis = (axis + (high ? 1 : 2)) % 3, v_axis = (axis + (high ? 2 : 1)) % 3;
    for (unsigned v = 0; v < n; v++) {
        for (unsigned u = 0; u < n; u++) {
            uint32_t corner[4];
            for (unsigned k = 0; k < 4; k++) {
                unsigned cell[3];
                cell[axis] = high ? n : 0;
                cell[u_axis] = u + (k == 1 || k == 2);
                cell[v_axis] = v + (k >= 2);
                corner[k] = box_vertex(mesh, at, n, cell, size);
            }
            set_triangle(mesh, mesh->triangle_count++, corner[0], corner[1], corner[2]);
            set_triangle(mesh, mesh->triangle_count++, corner[0], corner[2], corner[3]);
        }
    }
}

parian_result test_box(const parian_env *env, double a, double b, double c, unsigned n,
                       parian_mesh *mesh)
{
    const double size[3] = {a, b, c};
    size_t row = (size_t)n + 1, square = (size_t)n * n;
    uint32_t *at = parian_zalloc(env, row * row * row, sizeof *at);
    parian_result result = make_arrays(env, 6 * square + 2, 12 * square, mesh);
    if (!at || result != PARIAN_OK) {
        parian_free(env, at);
        parian_mesh_free(env, mesh);
        return PARIAN_E_NOMEM;
    }
    mesh->vertex_count = mesh->triangle_count = 0;
    for (int axis = 0; axis < 3; axis++) {
        add_box_side(mesh, at, n, axis, false, size);
        add_box_side(mesh, at, n, axis, true, size);
    }
    parian_free(env, at);
    return PARIAN_OK;
}
